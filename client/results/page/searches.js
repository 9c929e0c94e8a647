// Two searches of one instance side by side, as their trees grew.
"use strict";
const kinshipSearches = (() => {
  const {make, metres, count, several} = kinshipPage;

  /// The trees of a search, from the start and from the goals: segments and points in the order in which they came.
  function treesOf(search) {
    const hand = metres(search.hand);
    const at = (node) => hand.slice(3 * node, 3 * node + 3);
    const side = [];
    const trees = {start: {lines: [], points: [], checksOfLines: [], checksOfPoints: []},
                   goal: {lines: [], points: [], checksOfLines: [], checksOfPoints: []}};
    search.parents.forEach((parent, node) => {
      side[node] = parent < 0 ? (node === 0 ? "start" : "goal") : side[parent];
      const tree = trees[side[node]];
      tree.points.push(...at(node));
      tree.checksOfPoints.push(search.checks[node]);
      if (parent < 0) return;
      tree.lines.push(...at(parent), ...at(node));
      tree.checksOfLines.push(search.checks[node]);
    });
    return {...trees, path: search.path.flatMap(at)};
  }

  /// How many of ascending numbers are at most `limit`.
  function countUpTo(numbers, limit) {
    let low = 0, high = numbers.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (numbers[middle] <= limit) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /// One of the two figures. \return {element, view, put(checks)}
  function panel(name, search, total, {most, obstacles, room}) {
    const trees = treesOf(search);
    const figure = make("figure", {});
    const bar = make("i", {});
    const text = make("p", {class: "count"});
    const element = make("div", {style: `--hue: var(--${name})`, "data-search": name},
                         make("h3", {}, name === "uniform" ? "Uniform samples" : "Guided"),
                         make("div", {class: "race"}, bar), text, figure);
    const layer = (tree, color, words) => ({
      name: tree, text: words, color, lines: [{positions: trees[tree].lines, opacity: 0.75}],
      points: [{positions: trees[tree].points, size: 0.02, opacity: 0.9}]});
    const put = (checks) => {
      const isOver = checks >= total;
      const nodes = countUpTo(search.checks, checks);
      for (const tree of ["start", "goal"])
        view.grow(tree, countUpTo(trees[tree].checksOfLines, checks), countUpTo(trees[tree].checksOfPoints, checks));
      view.replace("path", {ways: isOver && trees.path.length > 3 ? [{positions: trees.path, width: 0.014}] : []});
      bar.style.width = `${100 * Math.min(checks, total) / most}%`;
      text.replaceChildren(make("b", {}, count(Math.min(checks, total))), ` collision checks, ${several(nodes, "node")}` +
        (isOver ? (trees.path.length ? ": path found" : ": gave up") : ""));
    };
    let view = null;
    return {
      element, put,
      get view() { return view; },
      draw() {
        view = kinshipView.show(figure, {
          label: `Trees of the ${name} search: ${several(search.parents.length, "node")} after ${several(total, "collision check")}`,
          from: [-1.7, 2.3, 1.35], layers: [
            {name: "scene", text: "obstacles", color: "scene", opacity: 0.14, objects: obstacles},
            layer("start", "start", "tree from the start"), layer("goal", "goal", "trees from the goals"),
            {name: "path", text: "path", color: "path", ways: []},
            // Not drawn: both figures see the same room.
            {name: "room", color: "scene", shown: false, points: [{positions: room}]}]});
      }};
  }

  /// \param totals  {uniform, guided}: collision checks of each.
  function show(element, searches, totals, obstacles) {
    const most = Math.max(totals.uniform, totals.guided);
    const room = metres(searches.uniform.hand.concat(searches.guided.hand));
    const panels = ["uniform", "guided"].map((name) => panel(name, searches[name], totals[name], {most, obstacles, room}));
    element.append(make("div", {class: "pair"}, ...panels.map((each) => each.element)));
    for (const each of panels) each.draw();
    panels[0].view.follow(panels[1].view);
    panels[1].view.follow(panels[0].view);
    const playing = kinshipPlayer.player("Collision checks", most, 9, (checks) => {
      for (const each of panels) each.put(checks);
      return `${count(checks)} checks each`;
    });
    element.append(playing.element);
    playing.put(most);
  }

  return {show};
})();
