// Vega's figures in the page's colours.
"use strict";
const kinshipCharts = (() => {
  const {color, make, onColors, onSize} = kinshipPage;
  const part = (name) => kinshipModules.require("vega-" + name);
  Object.assign(part("dataflow").transforms, part("transforms"), part("view-transforms"), part("encode"));
  const font = "system-ui, 'DejaVu Sans', sans-serif";

  /// Draws what `specOf(width)` says, a Vega specification without its look, and draws it again when the element has
  /// another width or the colours change. Expressions are interpreted: no page needs to allow `eval`.
  /// \param label    what a reader hears who does not see it
  /// \param onPoint  called with the value of the scale "x" where somebody clicks
  /// \return {signal(name, value): sets a signal of the specification; draw(): what specOf says now}
  function show(element, label, specOf, onPoint) {
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", label);
    const inside = make("div", {"aria-hidden": "true"}); // Vega gives what it draws into a label of its own
    element.append(inside);
    const signals = new Map();
    let view = null;
    const draw = () => {
      if (view) view.finalize();
      inside.textContent = "";
      const axis = {labelFont: font, titleFont: font, labelColor: color("soft"), titleColor: color("soft"),
                    gridColor: color("line"), labelFontSize: 12, titleFontSize: 12, titleFontWeight: "normal",
                    domain: false, ticks: false, labelPadding: 6, titlePadding: 8};
      const spec = {background: null, padding: 6, autosize: {type: "fit-x", contains: "padding"}, config: {axis},
                    ...specOf(element.clientWidth)};
      view = new (part("view").View)(part("parser").parse(spec, null, {ast: true}), {
        renderer: "svg", container: inside, expr: part("interpreter").expressionInterpreter});
      for (const [name, value] of signals) view.signal(name, value);
      if (onPoint) view.addEventListener("click", (event) => {
        const [left] = view.origin();
        onPoint(view.scale("x").invert(event.clientX - inside.getBoundingClientRect().left - left));
      });
      view.run();
    };
    draw();
    onSize(element, draw);
    onColors(element, draw);
    return {
      draw,
      signal(name, value) {
        signals.set(name, value);
        view.signal(name, value).run();
      }};
  }

  return {show, font};
})();
