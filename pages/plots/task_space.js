// The paths of a task in space, over the scenes recorded with them: coloured, brushed by robot and time, picked, and beside a table.
"use strict";
const kinshipTaskSpace = (() => {
  const {make, count, fixed, seconds, several, metres} = kinshipPage;
  const {fill, fillFacts, hueOf, linked, timeText, dayText} = kinshipPlots;
  const kHues = 8, kSteps = 6;

  const kHtml = `
<h2>In space</h2>
<p id="space-text"></p>
<div id="space-parts">
  <div class="brush">
    <div><span>Colour</span><div id="space-colors" class="choice" role="group" aria-label="What colours mean"></div></div>
    <div><span>Robots</span><div id="space-robots" class="choice" role="group" aria-label="Robots whose paths are shown"></div></div>
    <div id="space-scenes"><label for="space-scene">Scene</label><select id="space-scene"></select></div>
  </div>
  <div class="sliders" id="space-time"></div>
  <p id="space-shown" class="note" role="status"></p>
  <div class="beside">
    <figure id="space"></figure>
    <div>
      <div class="list" tabindex="0" role="region" aria-label="Paths"><table id="space-paths"></table></div>
      <div id="space-picked" role="status"></div>
    </div>
  </div>
</div>`;

  /// Cuts values into steps of about equal numbers. \return {bounds: the greatest value of each step, of(value): its step}
  function stepsOf(values) {
    const sorted = [...values].sort((a, b) => a - b);
    const bounds = Array.from({length: kSteps}, (none, i) => sorted[Math.ceil((i + 1) * sorted.length / kSteps) - 1]);
    return {bounds, of: (value) => bounds.findIndex((bound) => value <= bound)};
  }

  const lengthOf = (hand) => {
    let length = 0;
    for (let i = 3; i < hand.length; i += 3) length += Math.hypot(hand[i] - hand[i - 3], hand[i + 1] - hand[i - 2], hand[i + 2] - hand[i - 1]);
    return length;
  };

  /// Fills a section. \param data  of a task, see plot_pages.hpp \return  the figure, or undefined without a path
  function show(section, data, href) {
    const byId = fill(section, kHtml);
    const {in_use: inUse, scenes, scenes_known: scenesKnown, left_out: leftOut} = data.space;
    const robots = data.space.robots.map((robot) => ({...robot, hue: data.robots.findIndex((other) => other.robot === robot.robot)}));
    const paths = data.space.paths.map((path) => ({...path, hand: metres(path.hand)}));
    paths.forEach((path) => { path.length = lengthOf(path.hand); });
    if (!paths.length) {
      byId("space-text").textContent = "No path of the task is in use" + (leftOut ? `: ${several(leftOut, "path")} could not be read.` : ".");
      byId("space-parts").remove();
      return undefined;
    }
    const last = paths.length - 1;
    const brush = {color: "robot", robots: new Set(robots.keys()), from: 0, to: last, scene: scenes.length ? 0 : null, picked: null};
    const isIn = (i) => brush.robots.has(paths[i].robot) && i >= brush.from && i <= brush.to;
    const isOneDay = dayText(paths[0].received_ms) === dayText(paths[last].received_ms);
    const whenText = (ms) => (isOneDay ? timeText(ms).slice(11, 19) : timeText(ms).slice(0, 16));

    const ages = stepsOf(paths.map((path) => path.received_ms)), costs = stepsOf(paths.map((path) => path.checks));
    /// By word: the group of a path, the colour of a group and what it means.
    const colorings = {
      robot: {of: (path) => robots[path.robot].hue % kHues, hue: hueOf,
              text: (group) => robots.filter((robot) => robot.hue % kHues === group).map((robot) => robot.label).join(", ")},
      age: {of: (path) => ages.of(path.received_ms), hue: (group) => "age-" + group, text: (group) => "until " + whenText(ages.bounds[group])},
      cost: {of: (path) => costs.of(path.checks), hue: (group) => "cost-" + group, text: (group) => `\u2264 ${several(costs.bounds[group], "check")}`}};

    function tell() {
      const some = paths.length < inUse ? `The newest ${count(paths.length)} of ${several(inUse, "path")} in use` : several(paths.length, "path") + " in use";
      byId("space-text").textContent = `${some}, as the way of the hand (the transfer frame) in the task\u2019s frame; points within 2\u2009mm of a line are left out. ` +
        (scenesKnown ? `Their scenes: ${several(scenesKnown, "different one")}` + (scenes.length < scenesKnown ? `, of which the ${count(scenes.length)} of most paths can be shown.` : ".")
                     : "No scene was recorded with them.") + (leftOut ? ` Left out: ${several(leftOut, "path")} that could not be read.` : "");
      byId("space-scenes").hidden = scenes.length === 0;
    }

    const wayOf = ({arm}) => ({positions: metres(arm), width: 0.03}); // slim, so that it hides no paths
    const layers = [
      {name: "scene", text: scenes.length ? "obstacles" : "", color: "scene", fits: false, objects: []},
      {name: "arms", text: robots.length > 1 ? "robots where their newest paths start" : "robot where its newest path starts", color: "arm", ways: robots.map(wayOf)},
      ...Array.from({length: kHues}, (none, i) => ({name: `group-${i}`, text: "", color: hueOf(i), fits: false, lines: []})),
      {name: "starts", text: "starts", color: "start", fits: false, points: []},
      {name: "goals", text: "goals", color: "goal", fits: false, points: []},
      {name: "picked", text: "", color: "picked", fits: false, ways: []},
      {name: "room", color: "scene", shown: false, points: [{positions: paths.flatMap((path) => path.hand), size: 0.02}]}];
    const view = kinshipView.show(byId("space"), {
      label: `${several(paths.length, "path")} of the hand of ${robots.map((robot) => robot.label).join(", ")} in space; the table beside has each of them.`,
      from: [-1.1, -1.5, 1], layers, onPick: (path) => pick(path, "picture")});

    function drawGroups() {
      const coloring = colorings[brush.color];
      const groups = Array.from({length: kHues}, () => ({positions: [], owners: []}));
      const starts = [], goals = [];
      let shown = 0;
      paths.forEach((path, i) => {
        if (!isIn(i)) return;
        ++shown;
        const {positions, owners} = groups[coloring.of(path)];
        const {hand} = path;
        for (let k = 3; k < hand.length; k += 3) {
          positions.push(hand[k - 3], hand[k - 2], hand[k - 1], hand[k], hand[k + 1], hand[k + 2]);
          owners.push(i);
        }
        starts.push(hand[0], hand[1], hand[2]);
        goals.push(...hand.slice(-3));
      });
      const opacity = (brush.picked === null ? 1 : 0.4) * (shown > 1000 ? 0.5 : shown > 300 ? 0.65 : shown > 60 ? 0.8 : 0.95);
      groups.forEach(({positions, owners}, group) => view.replace(`group-${group}`, {
        color: owners.length ? coloring.hue(group) : hueOf(group), text: owners.length ? coloring.text(group) : "",
        lines: owners.length ? [{positions, owners, opacity}] : []}));
      const size = shown > 300 ? 0.018 : 0.024;
      view.replace("starts", {points: [{positions: starts, size, opacity: 0.85}]});
      view.replace("goals", {points: [{positions: goals, size, opacity: 0.85}]});
      view.replace("arms", {ways: robots.filter((robot, i) => brush.robots.has(i)).map(wayOf)});
      byId("space-shown").textContent = `${count(shown)} of ${several(paths.length, "path")} shown.`;
    }

    function drawScene() {
      view.replace("scene", {objects: brush.scene === null ? [] : scenes[brush.scene].objects});
      byId("space-scene").value = String(brush.scene);
    }

    const rows = paths.map((path, i) => {
      const name = make("button", {type: "button", tabindex: "-1", "aria-label": `Path ${path.uuid}`, onclick: () => pick(i)}, path.uuid.slice(0, 8));
      return make("tr", {"data-path": path.uuid, onclick: (event) => event.target === name || pick(i)}, make("th", {scope: "row"}, name),
                  ...[robots[path.robot].label, whenText(path.received_ms), count(path.checks), fixed(path.length, 2)].map((text) => make("td", {}, text)));
    });
    const buttonOf = (i) => rows[i].querySelector("button");

    /// One row is reached by Tab, the others by the arrow keys.
    function listRows() {
      let first = null;
      const order = [...byId("space-paths").tBodies[0].rows].map((row) => rows.indexOf(row));
      for (const i of order) {
        rows[i].hidden = !isIn(i);
        buttonOf(i).tabIndex = -1;
        if (first === null && isIn(i)) first = i;
      }
      const reached = brush.picked === null ? first : brush.picked;
      if (reached !== null) buttonOf(reached).tabIndex = 0;
    }

    function makeTable() {
      const columns = [["path", (path) => path.uuid], ["robot", (path) => robots[path.robot].label], ["arrived", (path) => path.received_ms],
                       ["checks", (path) => path.checks], ["way, m", (path) => path.length]];
      const body = make("tbody", {onkeydown: (event) => {
        const visible = [...body.rows].filter((row) => !row.hidden);
        const at = visible.indexOf(event.target.closest("tr"));
        const to = {ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: visible.length - 1}[event.key];
        if (to === undefined || !visible[to]) return;
        event.preventDefault();
        pick(rows.indexOf(visible[to]));
        visible[to].querySelector("button").focus();
      }});
      const heads = columns.map(([text, value]) => make("th", {scope: "col"}, make("button", {type: "button", onclick: (event) => {
        const head = event.target.closest("th");
        const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
        const keys = paths.map(value);
        body.append(...[...rows.keys()].sort((a, b) => (keys[a] < keys[b] ? -sign : keys[a] > keys[b] ? sign : a - b)).map((i) => rows[i]));
        listRows();
      }}, text)));
      heads[2].setAttribute("aria-sort", "descending");
      byId("space-paths").append(make("thead", {}, make("tr", {}, ...heads)), body);
      body.append(...[...rows].reverse());
    }

    function tellPicked() {
      const element = byId("space-picked");
      element.textContent = "";
      if (brush.picked === null) {
        element.append(make("p", {class: "note"}, "Pick a path in the picture or in the table; in the table the arrow keys go on to the next."));
        return;
      }
      const path = paths[brush.picked], robot = robots[path.robot], address = href("path", path.uuid);
      const list = make("dl", {class: "facts"});
      fillFacts(list, [
        ["Path", address ? make("a", {href: address, id: "space-open"}, path.uuid) : make("code", {}, path.uuid)],
        ["Robot", linked(robot.label, href("robot", robot.label))], ["Arrived", timeText(path.received_ms)],
        ["Cost", `${several(path.checks, "collision check")}, ${seconds(path.time_s)}, sampled ${path.mode}`],
        ["Way of the hand", `${fixed(path.length, 2)}\u2009m`], ["Scene", path.scene === null ? "not recorded, or not among those shown" : sceneText(path.scene)],
        ["Its own page", address ? "" : make("code", {}, `kinship paths plot ${path.uuid} --output path.html`)]]);
      element.append(list);
    }

    /// \param path  its number, or null for none \param where  "picture": the table follows
    function pick(path, where) {
      if (brush.picked !== null) rows[brush.picked].removeAttribute("aria-current");
      brush.picked = path;
      if (path === null) view.replace("picked", {text: "", ways: [], points: []});
      else {
        const {hand, scene} = paths[path];
        view.replace("picked", {text: "picked path", ways: [{positions: hand, width: 0.014}],
                                points: [{positions: [...hand.slice(0, 3), ...hand.slice(-3)], size: 0.05, opacity: 1}]});
        rows[path].setAttribute("aria-current", "true");
        if (scene !== null) brush.scene = scene;
        drawScene();
        const list = rows[path].closest(".list");
        const [top, height] = [rows[path].offsetTop, rows[path].offsetHeight], head = byId("space-paths").tHead.offsetHeight;
        if (where === "picture" || top < list.scrollTop + head || top + height > list.scrollTop + list.clientHeight)
          list.scrollTop = top - (where === "picture" ? list.clientHeight / 2 : head);
      }
      drawGroups();
      listRows();
      tellPicked();
    }

    /// Once for all changes before the next picture.
    let waiting = false;
    function brushed() {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        if (brush.picked !== null && !isIn(brush.picked)) pick(null);
        else {
          drawGroups();
          listRows();
        }
      });
    }

    const sceneText = (i) => `${several(scenes[i].objects.length, "object")}, of ${several(scenes[i].paths, "path")}`;

    function makeChoices() {
      for (const color of Object.keys(colorings))
        byId("space-colors").append(make("button", {type: "button", "data-color": color, "aria-pressed": String(color === brush.color), onclick: () => {
          brush.color = color;
          for (const button of byId("space-colors").children) button.setAttribute("aria-pressed", String(button.dataset.color === color));
          brushed();
        }}, color === "cost" ? "cost in checks" : color));
      robots.forEach((robot, i) => {
        const button = make("button", {type: "button", "data-robot": robot.label, "aria-pressed": "true", style: `--hue: var(--${hueOf(robot.hue)})`, onclick: () => {
          if (!brush.robots.delete(i)) brush.robots.add(i);
          button.setAttribute("aria-pressed", String(brush.robots.has(i)));
          brushed();
        }}, robot.label);
        byId("space-robots").append(button);
      });
      byId("space-scene").append(...scenes.map((scene, i) => make("option", {value: String(i)}, `${i + 1}: ${sceneText(i)}`)), make("option", {value: "null"}, "none"));
      byId("space-scene").addEventListener("change", (event) => {
        brush.scene = event.target.value === "null" ? null : Number(event.target.value);
        drawScene();
      });
      for (const [end, text] of [["from", "Arrived from"], ["to", "until"]]) {
        const tell = () => `${whenText(paths[brush[end]].received_ms)}, path ${count(brush[end] + 1)} of ${count(paths.length)}`;
        const output = make("output", {}, tell());
        const input = make("input", {type: "range", min: "0", max: String(last), value: String(brush[end]), "data-end": end,
          "aria-label": end === "from" ? "Arrived from" : "Arrived until", oninput: () => {
          const other = byId("space-time").querySelector(`[data-end=${end === "from" ? "to" : "from"}]`);
          brush[end] = Number(input.value);
          if (brush.from > brush.to) { // the other end gives way
            other.value = input.value;
            other.dispatchEvent(new Event("input"));
          }
          output.textContent = tell();
          input.setAttribute("aria-valuetext", tell());
          brushed();
        }});
        byId("space-time").append(make("label", {}, make("span", {}, text), output, input));
      }
      byId("space-time").hidden = last === 0;
    }

    tell();
    makeChoices();
    makeTable();
    pick(null);
    drawScene();
    return view;
  }

  return {show};
})();
