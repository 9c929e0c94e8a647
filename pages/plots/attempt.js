// An attempt in its recorded scene: the arm along its path, how near it comes to what; or what was in the way.
"use strict";
kinshipFigures.attempt = (element, data, {href = () => null} = {}) => {
  const {make, count, fixed, percent, seconds, several, metres, fillTable, fillTiles} = kinshipPage;
  const {fillFacts, keys, chart, hide, linked} = kinshipPlots;
  const {attempt, robot, path, search} = data;
  const byId = kinshipPlots.fill(element, `
<header>
  <p class="eyebrow" id="kind"></p>
  <h1 id="title"></h1>
  <p id="lead" class="lead"></p>
  <div id="tiles" class="tiles"></div>
</header>

<section id="why" hidden>
  <h2>Why not</h2>
  <p id="why-text"></p>
</section>

<section>
  <h2>In its scene</h2>
  <p id="scene-text"></p>
  <div id="places" class="choice" role="group" aria-label="Configuration" hidden></div>
  <figure id="scene"></figure>
  <div id="player"></div>
  <p class="note" id="place" aria-live="polite"></p>
  <div id="growth" hidden>
    <h3>The trees as they grew</h3>
  </div>
</section>

<section id="blockers-section" hidden>
  <h2>What was in the way</h2>
  <p class="note">Of the configurations that were looked at. Choose a pair to see it above.</p>
  <div class="scroll" tabindex="0" role="region" aria-label="What blocked"><table id="blockers"></table></div>
</section>

<section id="beside" hidden>
  <h2>The same query, planned otherwise</h2>
  <p id="beside-text"></p>
</section>

<section id="clearance-section">
  <h2>How near it comes</h2>
  <p id="clearance-text"></p>
  <div id="clearance-keys"></div>
  <div id="clearance" class="chart"></div>
</section>

<section>
  <h2>The attempt</h2>
  <dl id="facts" class="facts"></dl>
</section>`);
  const {record} = attempt;
  const base = attempt.T_task_base || [0, 0, 0, 0, 0, 0, 1];
  const scene = data.scene || [];
  const sentence = (text) => (text ? `${text[0].toUpperCase()}${text.slice(1)}.` : "");
  const millimetresText = (metre) => `${fixed(1000 * metre, metre < 0.01 ? 1 : 0)}\u2009mm`;

  const solids = (q) => kinshipChain.solidsOf(robot, q, base, data.held);
  /// Layers of the arm in a configuration; bodies of these names in the colour of what is in the way.
  function armLayers(q, names = []) {
    const {links, held} = q ? solids(q) : {links: [], held: []};
    const isIn = (solid) => names.includes(solid.name);
    return {
      arm: {objects: links.filter((solid) => !isIn(solid))}, held: {objects: held.filter((solid) => !isIn(solid))},
      scene: {objects: scene.filter((solid) => !isIn(solid))},
      blocking: {objects: [...links, ...held, ...scene].filter(isIn)}};
  }
  const ghost = (q) => ({objects: q ? [...solids(q).links, ...solids(q).held] : []});

  const start = path ? path.waypoints[0] : search && search.start.length ? search.start : null;
  const goals = path ? [path.waypoints[path.waypoints.length - 1]] : search ? search.goals : [];

  /// Configurations that a reader can choose where there is no path: {name, q, names of bodies that touch, text}.
  function choices() {
    if (path || !search) return [];
    const touching = (goal) => search.goal_contacts.filter((contact) => contact.goal === goal);
    return [
      ...(start ? [{name: "start", q: start, names: [], text: "The configuration at the start."}] : []),
      ...search.goals.map((q, i) => ({
        name: search.goals.length > 1 ? `goal ${i + 1}` : "goal", q, names: touching(i).flatMap(({first, second}) => [first, second]),
        text: touching(i).length ? `At this goal ${touching(i).map(({first, second}) => `\u201c${first}\u201d touches \u201c${second}\u201d`).join(", ")}.`
          : "No contact was recorded at this goal."})),
      ...(search.last_free.length ? [{name: "last free", q: search.last_free, names: blockers().slice(0, 2),
                                      text: "The free configuration nearest to a goal that the search reached" +
                                        (search.blockers.length ? "; marked is what was in the way of most goals, or most often." : ".")}] : [])];
  }
  const blockers = () => search.blockers.flatMap(({first, second}) => [first, second]);

  const trees = ((search && search.trees) || []).map((tree, i) => {
    const hand = metres(tree.hand);
    const edges = tree.parents.flatMap((parent, node) => (parent < 0 ? [] : [[parent, node]]));
    return {
      name: `tree-${i}`, nodes: tree.parents.length, edges, text: i === 0 ? "tree from the start" : "tree from the goals", color: i === 0 ? "tree-start" : "tree-goal",
      lines: [{positions: edges.flatMap((ends) => ends.flatMap((node) => hand.slice(3 * node, 3 * node + 3))), opacity: 0.7}],
      points: [{positions: hand, size: 0.014, opacity: 0.8}]};
  });

  /// Grows the trees in the order in which their nodes came, each by the same part of it: between them no order is recorded.
  function showGrowth({view}) {
    const grown = trees.filter(({nodes}) => nodes > 0);
    byId("growth").hidden = grown.length === 0;
    if (grown.length === 0) return;
    const sum = grown.reduce((all, {nodes}) => all + nodes, 0);
    const growing = kinshipPlayer.player("Growth of the trees", 1, 6, (part) => {
      let shown = 0;
      for (const {name, nodes, edges} of grown) {
        const now = Math.max(1, Math.round(part * nodes));
        view.grow(name, edges.filter(([, node]) => node < now).length, now);
        shown += now;
      }
      return `${count(shown)} of ${several(sum, "node")}`;
    });
    byId("growth").append(growing.element);
    growing.put(1);
  }

  /// The same query by the other way of sampling, where the server found such an attempt.
  function showBeside() {
    const other = data.others && data.others[0];
    if (!other) return;
    byId("beside").hidden = false;
    const both = [{attempt, path, search}, other].sort((a, b) => (a.attempt.record.sampling_mode === "guided") - (b.attempt.record.sampling_mode === "guided"));
    const ratio = both[0].attempt.record.collision_checks / both[1].attempt.record.collision_checks;
    byId("beside-text").textContent = "One start, one goal, one scene" + (both.every((each) => each.attempt.record.outcome === "solved") && Number.isFinite(ratio)
      ? `: with guidance ${ratio >= 1 ? `${fixed(ratio, 1)} times fewer` : `${fixed(1 / ratio, 1)} times more`} collision checks.` : ".");
    kinshipPath.beside(byId("beside"), both, {scene, solids, titleOf: (one) => (one.attempt === attempt ? `${record.sampling_mode} (this one)`
      : linked(one.attempt.record.sampling_mode, href("attempt", one.attempt.report_uuid)))});
  }

  function showScene() {
    const goal = goals.length ? goals[0] : null;
    const first = armLayers(start || goal);
    const wayText = path ? "way of the hand" : "";
    const view = kinshipView.show(byId("scene"), {
      label: `${robot.label} in the recorded scene of ${several(scene.length, "object")}${path ? ", moving along its path" : ""}`,
      from: [-1.2, -1.6, 0.9], layers: [
        {name: "scene", text: scene.length ? "obstacles" : "", color: "scene", opacity: 0.3, ...first.scene},
        {name: "arm", text: robot.label, color: "arm", opacity: 1, ...first.arm},
        {name: "held", text: data.held.length ? "what it holds" : "", color: "held", opacity: 1, ...first.held},
        {name: "blocking", text: "", color: "blocking", opacity: 0.9, ...first.blocking},
        {name: "way", text: wayText, color: "path", ways: path ? [{positions: metres(path.hand), width: 0.01}] : []},
        {name: "start", text: start ? "start" : "", color: "start", opacity: 0.14, ...ghost(start)},
        {name: "goal", text: goal ? "goal" : "", color: "goal", opacity: 0.14, ...ghost(goal)},
        ...trees,
        {name: "room", color: "scene", shown: false, points: [{positions: path ? metres(path.hand) : []}]}]});
    const put = (q, names = []) => {
      for (const [name, layer] of Object.entries(armLayers(q, names))) view.replace(name, layer);
      view.replace("blocking", {text: names.length ? "in the way" : ""});
    };
    return {view, put};
  }

  /// What is said of a place: how near the nearest pairs are there.
  function placeText(index) {
    const near = (series, word) => {
      const distance = series.distance_m[index];
      if (distance === null) return null;
      const [first, second] = series.pairs[index];
      return distance <= 0 ? `\u201c${first}\u201d touches \u201c${second}\u201d${word}` : `\u201c${first}\u201d is ${millimetresText(distance)} from \u201c${second}\u201d${word}`;
    };
    return [near(path.obstacle, ""), near(path.own, ", of itself")].filter(Boolean).join("; ") || "Nothing to compare with: no recorded object, no pair of links.";
  }

  function clearanceSpec() {
    const places = path.obstacle.distance_m.length;
    const rows = [["obstacle", path.obstacle], ["own", path.own]].flatMap(([name, series]) =>
      series.distance_m.map((distance, i) => ({name, at: i / (places - 1), distance: distance === null ? null : 1000 * distance})).filter((row) => row.distance !== null));
    const least = [["obstacle", path.obstacle], ["own", path.own]].filter(([, series]) => series.least !== null)
      .map(([name, series]) => ({name, at: series.least / (places - 1), distance: 1000 * series.distance_m[series.least]}));
    const {color} = kinshipPage;
    return {
      height: 200, signals: [{name: "at", value: 0}],
      data: [{name: "rows", values: rows}, {name: "least", values: least}, {name: "waypoints", values: path.waypoints_at.map((at) => ({at}))}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: [0, 1]},
        {name: "y", type: "linear", range: "height", domain: {data: "rows", field: "distance"}, nice: true, zero: true},
        {name: "hue", type: "ordinal", domain: ["obstacle", "own"], range: [color("path"), color("uniform")]}],
      axes: [
        {orient: "left", scale: "y", grid: true, tickCount: 5, title: "distance, mm"},
        {orient: "bottom", scale: "x", tickCount: 6, format: ".0%", title: "of the path\u2019s length in joint space"}],
      marks: [
        {type: "rule", from: {data: "waypoints"}, encode: {update: {
          x: {scale: "x", field: "at"}, y: {signal: "height"}, y2: {signal: "height - 5"}, stroke: {value: color("soft")}}}},
        {type: "group", from: {facet: {name: "of_name", data: "rows", groupby: "name"}}, marks: [{type: "line", from: {data: "of_name"}, encode: {update: {
          x: {scale: "x", field: "at"}, y: {scale: "y", field: "distance"}, stroke: {scale: "hue", field: "name"}, strokeWidth: {value: 2}}}}]},
        {type: "symbol", from: {data: "least"}, encode: {update: {
          x: {scale: "x", field: "at"}, y: {scale: "y", field: "distance"}, size: {value: 50}, fill: {scale: "hue", field: "name"},
          tooltip: {signal: "format(datum.distance, '.1f') + ' mm'"}}}},
        {type: "rule", encode: {update: {x: {scale: "x", signal: "at"}, y: {value: 0}, y2: {signal: "height"}, stroke: {value: color("ink")}, strokeWidth: {value: 1.5}}}}]};
  }

  function tell() {
    const solved = record.outcome === "solved";
    byId("kind").textContent = path ? "Kinship path" : "Kinship attempt";
    byId("title").replaceChildren(linked(robot.label, href("robot", robot.label)), " on \u201c", linked(attempt.task, href("task", attempt.task)), "\u201d");
    byId("lead").textContent = `${attempt.report_uuid}: ${solved ? "solved" : record.outcome === "timeout" ? "not solved within its limits" : "could not be planned"} ` +
      `after ${several(record.collision_checks, "collision check")}` + (record.outcome === "failed" ? "" : `, sampled ${record.sampling_mode}`) + (path ? "." : solved ? "; its path is not kept." : ".");
    const least = (series) => (series.least === null ? "\u2013" : millimetresText(series.distance_m[series.least]));
    fillTiles(byId("tiles"), [
      [count(record.collision_checks), "collision checks"], [seconds(record.planning_time_s), "planning time"],
      ...(path ? [[`${fixed(path.hand_length_m, 2)}\u2009m`, "way of the hand"], [least(path.obstacle), "nearest to an obstacle"], [least(path.own), "nearest to itself"]] : [])]);
    byId("scene-text").textContent = (data.scene === null ? "No scene was recorded: only the robot is drawn. " : "") +
      `Of the robot, the shapes that the server knows: ${robot.shapes}. ` + (data.is_constrained ? "The hand had to keep a region along the path, which is not drawn. " : "") +
      (path ? "Play the path, drag along it, or click the curve below." : "");
    fillFacts(byId("facts"), [
      ["Report", attempt.report_uuid], ["Outcome", record.outcome], ["Planner", `${record.planner} ${record.planner_options}`.trim()],
      ["Machine", attempt.machine], ["Time limit", record.time_limit_s ? seconds(record.time_limit_s) : ""],
      ["Sampling", record.sampling_mode === "guided" ? `guided, ${percent(record.share)} of the samples from the distribution` : record.outcome === "failed" ? `none: no sample was drawn (planned as ${record.sampling_mode})` : record.sampling_mode],
      ["Waypoints", path ? count(path.waypoints.length) : ""], ["Length in joint space", path ? fixed(path.length, 2) : ""],
      ["Not compared", data.always_touching.length ? data.always_touching.map(([a, b]) => `${a} and ${b}`).join(", ") + ": they touch almost everywhere" : ""]]);
    if (record.distribution_id)
      fillFacts(byId("facts"), [["Distribution", linked(`${record.distribution_id.slice(0, 12)}, revision ${record.distribution_revision}`, href("distribution", record.distribution_id))]]);
  }

  function showPath(stage) {
    const places = path.obstacle.distance_m.length;
    byId("clearance-text").textContent = "Distance of the nearest bodies at " + count(places) + " places of the path: lower bounds, at most 1\u2009% below, between the shapes that the server knows " +
      "and the recorded objects; of itself, the pairs of links and held objects that a check looks at. Between two places it may come nearer. Ticks below are waypoints." +
      (path.steady.length ? ` Left out, as they stay at one distance: ${path.steady.map(({pair: [a, b], distance_m: distance}) => `${a} and ${b} at ${millimetresText(distance)}`).join(", ")}.` : "");
    byId("clearance-keys").append(keys([["path", "to the nearest obstacle"], ["uniform", "to itself"]]));
    const playing = kinshipPlayer.player("Place along the path", 1, 6, (place) => {
      stage.put(kinshipPath.at(path, place));
      if (curve) curve.signal("at", place);
      byId("place").textContent = placeText(Math.round(place * (places - 1)));
      return place <= 0 ? "at the start" : place >= 1 ? "at the goal" : `${Math.round(100 * place)}\u202f% of the path`;
    });
    byId("player").append(playing.element);
    const worst = (series) => (series.least === null ? "nothing to compare with" : `least ${millimetresText(series.distance_m[series.least])} at ${percent(series.least / (places - 1))} of the path`);
    const hasCurve = path.obstacle.least !== null || path.own.least !== null;
    const curve = hasCurve && chart(byId("clearance"), `Distance along the path: to obstacles ${worst(path.obstacle)}; to itself ${worst(path.own)}.`, clearanceSpec,
      (place) => {
        playing.pause();
        playing.put(Math.max(0, Math.min(1, place)));
      });
    if (!hasCurve) hide(byId("clearance"));
    playing.put(0.3);
  }

  function showSearch(stage) {
    hide(byId("clearance-section"));
    const known = choices();
    const choose = (button, {q, names, text}) => {
      for (const other of byId("places").children) other.setAttribute("aria-pressed", String(other === button));
      stage.put(q, names);
      byId("place").textContent = text;
    };
    for (const choice of known) {
      const button = make("button", {type: "button", "aria-pressed": "false", onclick: () => choose(button, choice)}, choice.name);
      byId("places").append(button);
    }
    byId("places").hidden = known.length === 0;
    if (known.length) choose(byId("places").lastChild, known[known.length - 1]);
    if (!search || record.outcome === "solved") return;
    byId("why").hidden = false;
    const most = search.last_free.length ? search.blockers[0] || null : null; // else no search was begun, and the reason names them
    const often = most && [most.goals ? `${most.goals} of ${several(search.goals.length, "goal")}` : "", most.count ? several(most.count, "configuration") : ""].filter(Boolean).join(" and ");
    byId("why-text").textContent = [sentence(search.reason), most ? `\u201c${most.first}\u201d and \u201c${most.second}\u201d made ${often} not free.` : "",
                                    search.goal_contacts.length ? `${several(new Set(search.goal_contacts.map((contact) => contact.goal)).size, "goal configuration")} of ${count(search.goals.length)} touched something.` : ""]
      .filter(Boolean).join(" ") || "Nothing was recorded of it.";
    byId("blockers-section").hidden = search.blockers.length === 0;
    fillTable(byId("blockers"), [["bodies", "goals", "configurations not free"], ...search.blockers.map(({first, second, goals, count: times}) => [
      make("button", {type: "button", onclick: () => {
        const last = known[known.length - 1];
        stage.put(last ? last.q : null, [first, second]);
        byId("place").textContent = `Marked: \u201c${first}\u201d and \u201c${second}\u201d.`;
      }}, `${first} and ${second}`), goals ? `${goals} of ${search.goals.length}` : "\u2013", count(times)])]);
  }

  tell();
  const stage = showScene();
  if (path) showPath(stage);
  else showSearch(stage);
  showGrowth(stage);
  showBeside();
  return stage.view;
};
kinshipFigures.path = kinshipFigures.attempt;
