// Vega's figures in the page's colours.
"use strict";
const kinshipCharts = (() => {
  const {color, make, onColors, onSize} = kinshipPage;
  const part = (name) => kinshipModules.require("vega-" + name);
  Object.assign(part("dataflow").transforms, part("transforms"), part("view-transforms"), part("encode"));
  const font = "system-ui, 'DejaVu Sans', sans-serif";

  /// Draws what `specOf(width)` says, a Vega specification without its look, and draws it again when the element has
  /// another width or the colours change. \param label  what a reader hears who does not see it.
  function show(element, label, specOf) {
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", label);
    const inside = make("div", {"aria-hidden": "true"}); // Vega gives what it draws into a label of its own
    element.append(inside);
    const draw = () => {
      inside.textContent = "";
      const axis = {labelFont: font, titleFont: font, labelColor: color("soft"), titleColor: color("soft"),
                    gridColor: color("line"), labelFontSize: 12, titleFontSize: 12, titleFontWeight: "normal",
                    domain: false, ticks: false, labelPadding: 6, titlePadding: 8};
      const spec = {background: null, padding: 6, autosize: {type: "fit-x", contains: "padding"}, config: {axis},
                    ...specOf(element.clientWidth)};
      new (part("view").View)(part("parser").parse(spec), {renderer: "svg", container: inside}).run();
    };
    draw();
    onSize(element, draw);
    onColors(draw);
  }

  return {show, font};
})();
