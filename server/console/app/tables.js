// Tables that are sorted and filtered where they stand.
"use strict";
const kinshipTables = (() => {
  const {make, count} = kinshipPage;
  const kMost = 300; // rows in the page, until somebody asks for more

  const compare = (a, b) => (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", {numeric: true}));

  /// Shows rows in an element.
  ///
  /// \param table.label    what a reader hears
  /// \param table.columns  each {title, of(row): the value that is sorted and filtered by, show(row): what is seen if that differs,
  ///   text(row): what it is filtered by if that differs,
  ///   kind: "text", "long" or "reason" (longer still) for what is read from the left}
  /// \param table.sort     [title, "ascending" or "descending"] at first; as they come without
  /// \param table.empty    what is said without rows
  /// \return {set(rows)}
  function show(element, {label, columns, sort, empty}) {
    let rows = [];
    let most = kMost;
    let [by, direction] = sort || ["", "ascending"];
    const search = make("input", {type: "search", placeholder: "Filter", "aria-label": `Filter ${label}`, oninput: () => draw()});
    const told = make("span", {class: "note", role: "status"});
    const more = make("button", {type: "button", hidden: true, onclick: () => { most = Infinity; draw(); }}, "Show all");
    const body = make("tbody", {});
    const heads = columns.map((column) => make("th", {scope: "col", class: column.kind ? "text" : null}, make("button", {type: "button", onclick: () => {
      direction = by === column.title && direction === "ascending" ? "descending" : "ascending";
      by = column.title;
      draw();
    }}, column.title)));
    element.append(make("div", {class: "tools"}, search, told, more),
                   make("div", {class: "scroll"}, make("table", {"aria-label": label}, make("thead", {}, make("tr", {}, ...heads)), body)));

    function lineOf(row) {
      return make("tr", {}, ...columns.map((column, i) => {
        const seen = column.show ? column.show(row) : column.of(row);
        const cell = seen === null || seen === undefined ? "\u2013" : typeof seen === "number" ? count(seen) : seen;
        return make(i === 0 ? "th" : "td", {scope: i === 0 ? "row" : null, class: {long: "text long", reason: "text long reason"}[column.kind] || column.kind || null}, cell);
      }));
    }

    function draw() {
      columns.forEach((column, i) => {
        if (column.title === by) heads[i].setAttribute("aria-sort", direction);
        else heads[i].removeAttribute("aria-sort");
      });
      const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
      const textOf = (row) => columns.map((column) => (column.text || column.of)(row)).join(" ").toLowerCase();
      let kept = words.length === 0 ? rows.slice() : rows.filter((row) => words.every((word) => textOf(row).includes(word)));
      const column = columns.find((each) => each.title === by);
      if (column) kept.sort((a, b) => (direction === "ascending" ? 1 : -1) * compare(column.of(a), column.of(b)));
      body.replaceChildren(...kept.slice(0, most).map(lineOf));
      more.hidden = kept.length <= most;
      told.textContent = rows.length === 0 ? empty || "None." : kept.length === rows.length && kept.length <= most ? count(rows.length)
        : `${count(Math.min(most, kept.length))} of ${count(rows.length)}`;
    }

    return {set(next) { rows = next; draw(); }};
  }

  return {show};
})();
