// Vega as Debian has it is a set of modules that ask for each other by `require`.
"use strict";
const kinshipModules = {
  makers: new Map(),
  made: new Map(),
  add(name, maker) {
    this.makers.set(name, maker);
  },
  require(name) {
    // vega-functions asks for vega-selection under its later name
    const known = name === "vega-selections" ? "vega-selection" : name;
    if (!this.made.has(known)) {
      const maker = this.makers.get(known);
      if (!maker) throw new Error("no module " + name);
      const module = {exports: {}};
      this.made.set(known, module.exports);
      maker.call(module.exports, module.exports, module, (other) => this.require(other));
      this.made.set(known, module.exports);
    }
    return this.made.get(known);
  },
};
