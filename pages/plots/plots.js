// What the figures share: facts, keys, times. A figure is kinshipFigures.NAME(element, data, {href}): it fills an element of a page
// of its own or of a server's console. `href(kind, name)` is the address of a robot, task, distribution, path or attempt, or null.
"use strict";
const kinshipFigures = {};
const kinshipPlots = (() => {
  const {make} = kinshipPage;

  /// Puts HTML of this folder into an element. \return finds its parts by id.
  function fill(element, html) {
    element.innerHTML = html;
    return (id) => element.querySelector("#" + id);
  }

  /// A list of what is known: [[term, text or null], ...]; what is null or empty is left out.
  function fillFacts(element, facts) {
    for (const [term, text] of facts)
      if (text) element.append(make("dt", {}, term), make("dd", {}, text));
  }

  /// What a figure's colours mean: [[colour of the style, text, class of the mark], ...].
  const keys = (entries) => make("div", {class: "keys"}, ...entries.map(([name, text, mark]) =>
    make("span", {}, make("i", {style: `--hue: var(--${name})`, class: mark || null}), text)));

  /// A figure with a heading, and a note below it. \return {panel, chart}
  function panel(title, note) {
    const chart = make("div", {class: "chart"});
    return {panel: make("figure", {}, make("h3", {}, title), chart, make("p", {class: "note"}, note || "")), chart};
  }

  /// Draws what `spec()` says, a Vega specification without a width, as wide as the element. See kinshipCharts.show.
  const chart = (element, label, spec, onPoint) => kinshipCharts.show(element, label, (width) => ({width, ...spec()}), onPoint);

  const hueOf = (index) => "robot-" + index % 8;
  const dashOf = (index) => (index < 8 ? [1, 0] : index < 16 ? [6, 3] : [2, 3]);

  /// Of what a Date cannot hold, the first or the last that it can.
  const isoText = (ms) => new Date(Math.max(-8.64e15, Math.min(8.64e15, ms))).toISOString();
  /// 2026-11-25 14:03:07 UTC
  const timeText = (ms) => isoText(ms).replace("T", " ").replace(/\..*/, "") + " UTC";
  const dayText = (ms) => isoText(ms).replace(/T.*/, "");

  const lengthText = (ms) => {
    const units = [[86400000, "day"], [3600000, "hour"], [60000, "minute"], [1000, "second"]];
    const [unit, word] = units.find(([length]) => ms >= length && ms % length === 0) || [1000, "second"];
    const n = ms / unit;
    return n === 1 ? "a" + (word === "hour" ? "n " : " ") + word : `${n} ${word}s`;
  };

  const hide = (element) => { element.hidden = true; };

  /// A name, as a link where there is an address.
  const linked = (text, address) => (address ? make("a", {href: address}, text) : text);

  return {fill, linked, fillFacts, keys, panel, chart, hueOf, dashOf, timeText, dayText, lengthText, hide};
})();
