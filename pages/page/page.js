// What every page uses: its data, elements, numbers in words.
"use strict";
const kinshipPage = (() => {
  const embedded = document.getElementById("data"); // none where a server gives the data
  const data = embedded && JSON.parse(embedded.textContent);
  const byId = (id) => document.getElementById(id);
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  /// make("p", {class: "note"}, "text", element, ...); a property that begins with "on" listens. A style is set as a property,
  /// which a page's Content-Security-Policy does not forbid, as it may an attribute.
  function make(tag, properties, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties || {})) {
      if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
      else if (name === "style") element.style.cssText = value || "";
      else if (value !== null && value !== false) element.setAttribute(name, value === true ? "" : value);
    }
    element.append(...children);
    return element;
  }

  // A narrow space between thousands.
  const count = (n) => (n === null ? "unsolved" : Math.round(n).toString().replace(/\B(?=(\d{3})+$)/g, "\u202f"));
  const fixed = (n, digits) => (n === null || n === undefined ? "\u2013" : n.toFixed(digits));
  const percent = (n) => (n === null ? "\u2013" : Math.round(100 * n) + "\u202f%");
  const seconds = (s) => (s === null ? "\u2013" : s < 1 ? fixed(1000 * s, 1) + "\u202fms" : fixed(s, 2) + "\u202fs");
  const several = (n, word) => `${count(n)} ${word}${n === 1 ? "" : "s"}`;
  const listed = (words) =>
    (words.length < 2 ? words.join("") : words.slice(0, -1).join(", ") + " and " + words[words.length - 1]);
  const total = (numbers) => numbers.reduce((a, b) => a + b, 0);
  const metres = (millimetres) => millimetres.map((n) => n / 1000);

  /// Rows of cells into a <table>; the first row and the first cell of each are its headers.
  function fillTable(table, rows) {
    rows.forEach((cells, row) => {
      const line = make("tr", {}, ...cells.map((cell, column) => {
        const isHeader = row === 0 || column === 0;
        return make(isHeader ? "th" : "td", isHeader ? {scope: row === 0 ? "col" : "row"} : {}, cell);
      }));
      if (row === 0) table.append(make("thead", {}, line), make("tbody"));
      else table.tBodies[0].append(line);
    });
  }

  /// Big figures with a sentence each: [[figure, text], ...] into an element.
  function fillTiles(element, tiles) {
    for (const [figure, text] of tiles)
      element.append(make("div", {class: "tile"}, make("b", {}, figure), make("span", {}, text)));
  }

  /// Calls `draw` when the colours change, by the reader's system, as long as the element is in the page.
  function onColors(element, draw) {
    const scheme = matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", function changed() {
      if (element.isConnected) draw();
      else scheme.removeEventListener("change", changed);
    });
  }

  /// Calls `draw` when an element has another width or height, not at first.
  function onSize(element, draw) {
    let seen = [element.clientWidth, element.clientHeight].join();
    new ResizeObserver(() => {
      const now = [element.clientWidth, element.clientHeight].join();
      if (now === seen) return;
      seen = now;
      draw();
    }).observe(element);
  }

  const isStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

  return {data, byId, color, make, count, fixed, percent, seconds, several, listed, total, metres, fillTable, fillTiles,
          onColors, onSize, isStill};
})();
