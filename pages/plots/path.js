// Configurations of a path, and two attempts of one query beside each other.
"use strict";
const kinshipPath = (() => {
  const {make, count, fixed, seconds, metres, fillTable} = kinshipPage;

  /// The configuration at a part of a path's length in joint space, 0 to 1.
  function at(path, place) {
    const places = path.waypoints_at;
    let i = 1;
    while (i < places.length - 1 && places[i] <= place) ++i;
    const part = places[i] > places[i - 1] ? (place - places[i - 1]) / (places[i] - places[i - 1]) : 0;
    return path.waypoints[i].map((to, joint) => path.waypoints[i - 1][joint] + part * (to - path.waypoints[i - 1][joint]));
  }

  const least = ({least: place, distance_m: distances}) => (place === null ? "\u2013" : `${fixed(1000 * distances[place], 1)}\u2009mm`);
  const ofPath = (path, text) => (path ? text(path) : "\u2013");
  const rowsOf = [
    ["outcome", ({attempt}) => attempt.record.outcome],
    ["planning time", ({attempt}) => seconds(attempt.record.planning_time_s)],
    ["collision checks", ({attempt}) => count(attempt.record.collision_checks)],
    ["length in joint space", ({path}) => ofPath(path, ({length}) => fixed(length, 2))],
    ["way of the hand", ({path}) => ofPath(path, ({hand_length_m: length}) => `${fixed(length, 2)}\u2009m`)],
    ["nearest to an obstacle", ({path}) => ofPath(path, ({obstacle}) => least(obstacle))]];

  /// Attempts beside each other: their figures in a table, their arms in two views that turn and move together.
  /// \param both    each {attempt, path or null, search or null}
  /// \param titleOf (one): of its view, a text or an element
  /// \param solids  (q): {links, held} of the robot in a configuration
  /// \return the views
  function beside(element, both, {scene, solids, titleOf}) {
    const table = make("table", {"aria-label": "One query, two attempts"});
    fillTable(table, [["", ...both.map(titleOf)], ...rowsOf.map(([name, of]) => [name, ...both.map(of)])]);
    const stages = both.map(() => make("figure", {}));
    element.append(make("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": "Two attempts"}, table), make("div", {class: "panels wide"}, ...both.map((one, i) => make("div", {}, make("h3", {}, titleOf(one)), stages[i]))));
    const bodies = (q) => (q ? solids(q).links.concat(solids(q).held) : []);
    const startOf = ({path, search}) => (path ? path.waypoints[0] : search && search.start.length ? search.start : null);
    const everywhere = both.flatMap(({path}) => (path ? metres(path.hand) : [])); // both are seen from one place
    const views = both.map((one, i) => kinshipView.show(stages[i], {
      label: `${one.attempt.record.sampling_mode}: ${one.attempt.record.outcome}`, from: [-1.2, -1.6, 0.9], layers: [
        {name: "scene", text: scene.length ? "obstacles" : "", color: "scene", opacity: 0.3, objects: scene},
        {name: "arm", color: "arm", opacity: 1, objects: bodies(startOf(one))},
        {name: "way", text: one.path ? "way of the hand" : "", color: "path", ways: one.path ? [{positions: metres(one.path.hand), width: 0.01}] : []},
        {name: "room", color: "scene", shown: false, points: [{positions: everywhere}]}]}));
    if (views.length === 2) {
      views[0].follow(views[1]);
      views[1].follow(views[0]);
    }
    const moving = both.map(({path}, i) => ({path, view: views[i]})).filter(({path}) => path);
    if (moving.length === 0) return views;
    const playing = kinshipPlayer.player("Place along both paths", 1, 6, (place) => {
      for (const {path, view} of moving) view.replace("arm", {objects: bodies(at(path, place))});
      return place <= 0 ? "at the start" : place >= 1 ? "at the goal" : `${Math.round(100 * place)}\u202f% of each path`;
    });
    element.append(playing.element);
    playing.put(0.3);
    return views;
  }

  return {at, beside};
})();
