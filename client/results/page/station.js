// The figure in which the robots move: one path of each, with what it holds, from its start to its goal.
"use strict";
const kinshipStation = (() => {
  const {make, metres, several, count, byId} = kinshipPage;

  const heldOf = (frame) => frame.held;
  const between = (demo, place) => demo.frames[Math.round(place * (demo.frames.length - 1))];

  /// Each path of the hand as segments between its poses.
  function segments(paths) {
    const positions = [];
    for (const path of paths) {
      const p = metres(path.positions);
      for (let i = 3; i < p.length; i += 3) positions.push(...p.slice(i - 3, i + 3));
    }
    return positions;
  }

  /// What does not move of an actor.
  function standing({demo, color}) {
    const first = demo.frames[0], last = demo.frames[demo.frames.length - 1];
    return {
      scene: {objects: demo.obstacles},
      way: {color, ways: [{positions: thinned(metres(demo.way), 160), width: 0.012}]},
      start: {arms: [{bones: first.bones, opacity: 0.16}], objects: heldOf(first), opacity: 0.25},
      goal: {arms: [{bones: last.bones, opacity: 0.16}], objects: heldOf(last), opacity: 0.25}};
  }

  /// At most so many of the points of a way, first and last among them.
  function thinned(positions, most) {
    const points = positions.length / 3;
    const step = Math.max(1, Math.ceil(points / most));
    const kept = [];
    for (let i = 0; i < points - 1; i += step) kept.push(...positions.slice(3 * i, 3 * i + 3));
    return kept.concat(positions.slice(-3));
  }

  /// \param actors  [{label, color, role, demo, paths}]; the first is shown first.
  function show(element, actors) {
    const figure = make("figure", {});
    const caption = make("p", {class: "note", "aria-live": "polite"});
    const buttons = actors.map((actor, i) => make("button", {
      type: "button", "aria-pressed": "false", style: `--hue: var(--${actor.color})`, "data-actor": actor.label,
      onclick: () => choose(i)}, actor.label));
    const group = make("div", {class: "choice", role: "group", "aria-label": "Which robot"}, ...buttons);
    if (actors.length > 1) element.append(group);
    element.append(figure);
    let actor = actors[0];
    const place = 0.3;
    const moving = (frame) => [
      ["arm", {color: actor.color, text: actor.label, arms: [{bones: frame.bones}]}],
      ["held", {objects: heldOf(frame)}]];
    const rest = standing(actor), now = new Map(moving(between(actor.demo, place)));
    const cloud = actors.filter((each) => each.paths).map((each) => ({
      name: "ways " + each.label, text: `all ways of ${each.label}'s hand`, color: each.color, shown: false,
      lines: [{positions: segments(each.paths), opacity: 0.5}],
      points: [{positions: each.paths.flatMap((path) => metres(path.positions)), size: 0.026, opacity: 0.8}]}));
    const hasHeld = actors.some((each) => each.demo.frames[0].held.length > 0);
    const view = kinshipView.show(figure, {
      label: "The station: " + actors.map((each) => `${each.role} ${each.label}`).join(", ") +
             "; obstacles, a path of the hand with its start and its goal.",
      from: [-1.7, 2.3, 1.35],
      layers: [
        {name: "scene", text: "obstacles", color: "scene", opacity: 0.3, ...rest.scene},
        {name: "arm", ...now.get("arm")},
        {name: "held", text: hasHeld ? "what it holds" : "", color: "held", opacity: 1, ...now.get("held")},
        {name: "way", text: "path of its hand", ...rest.way},
        {name: "start", text: "start", color: "start", ...rest.start},
        {name: "goal", text: "goal", color: "goal", ...rest.goal},
        // Not drawn: makes the camera see all of the movement of all actors.
        {name: "room", color: "scene", shown: false, arms: actors.flatMap((each) =>
          each.demo.frames.filter((_, i) => i % 6 === 0).map((frame) => ({bones: frame.bones})))},
        ...cloud]});
    const playing = kinshipPlayer.player("Place along the path", 1, 6, (at) => {
      const frame = between(actor.demo, at);
      for (const [name, layer] of moving(frame)) view.replace(name, layer);
      return at <= 0 ? "at the start" : at >= 1 ? "at the goal" : `${Math.round(100 * at)}\u202f% of the path`;
    });
    element.append(playing.element, caption);

    function choose(index) {
      actor = actors[index];
      buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === index)));
      for (const [name, layer] of Object.entries(standing(actor))) view.replace(name, layer);
      playing.pause();
      playing.put(place);
      caption.textContent = `${actor.label}, ${actor.role}: the path of instance \u201c${actor.demo.problem}\u201d, found with ` +
        `${several(actor.demo.checks, "collision check")}. ${actor.why}`;
    }
    choose(0);
  }

  return {show};
})();
