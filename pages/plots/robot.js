// A robot whose joints a reader moves: the solids of its links, its joints and their limits, its transfer frame.
"use strict";
kinshipFigures.robot = (element, data) => {
  const {make, count, fixed, several, fillTable, fillTiles, total} = kinshipPage;
  const {fillFacts, timeText} = kinshipPlots;
  const byId = kinshipPlots.fill(element, `
<header>
  <p class="eyebrow">Kinship robot</p>
  <h1 id="title"></h1>
  <p id="lead" class="lead"></p>
  <div id="tiles" class="tiles"></div>
</header>

<section>
  <h2>As the server sees it</h2>
  <p id="shapes-text"></p>
  <figure id="robot"></figure>
  <p class="note" id="pose" aria-live="polite"></p>
</section>

<section>
  <h2>Joints</h2>
  <p>Drag a joint, or choose it and use the arrow keys.</p>
  <div id="joints" class="sliders"></div>
  <button type="button" id="again">Back to the first configuration</button>
</section>

<section>
  <h2>Links</h2>
  <div class="scroll" tabindex="0" role="region" aria-label="Links"><table id="links"></table></div>
</section>

<section>
  <h2>What is known</h2>
  <dl id="facts" class="facts"></dl>
</section>`);
  const {robot, summary} = data;
  const solids = total(robot.links.map((link) => link.solids.length));
  const identity = [0, 0, 0, 0, 0, 0, 1];
  const geometries = Object.fromEntries(Object.entries(robot.contents).map(([content, text]) => [content, kinshipSolids.meshGeometry(text)]));
  const drawnAs = (role) => robot.meshes.filter((mesh) => mesh.role === role || mesh.role === "both").length;
  let q = [...data.shown];

  function tell() {
    byId("title").textContent = robot.label;
    byId("lead").textContent = `A chain of ${several(robot.joints.length, "joint")} from \u201c${robot.base_link}\u201d to \u201c${robot.tip_link}\u201d` +
      (robot.mimics.length ? `, and ${several(robot.mimics.length, "joint")} that follow${robot.mimics.length === 1 ? "s" : ""} these` : "") + ".";
    fillTiles(byId("tiles"), [
      [count(robot.joints.length), "joints"], [count(solids), `solids of ${several(robot.links.filter((link) => link.solids.length).length, "link")}`],
      [count(summary.paths), "paths that it reported"], [count(summary.attempts), "attempts"]]);
    byId("shapes-text").textContent = `Known to the server: ${robot.shapes}. What it does not know is not drawn, nor does a filter see it. ` +
      (robot.meshes.length ? `Drawn are ${several(drawnAs("visual"), "visual")} and ${several(drawnAs("collision"), "collision part")} of meshes` +
        (robot.meshes.some((mesh) => mesh.error_m) ? `, simplified within ${fixed(1000 * Math.max(...robot.meshes.map((mesh) => mesh.error_m)), 1)} mm. ` : ". ") : "") +
      (data.touches_itself ? "In every configuration that was tried these solids touch each other. " : "") +
      "The three lines are the axes of the transfer frame, which robots place alike: x red, y green, z blue.";
    fillFacts(byId("facts"), [
      ["Digest", robot.digest], ["Solver", summary.solver], ["Shapes", summary.geometry], ["Meshes", summary.meshes],
      ["Registered", timeText(summary.registered_ms)], ["Better shapes", summary.geometry_ms ? timeText(summary.geometry_ms) : ""]]);
  }

  function layers() {
    const {links, transfer} = kinshipChain.solidsOf(robot, q, identity);
    return {links: {objects: links}, visual: {meshes: kinshipChain.meshesOf(robot, geometries, "visual", q)},
            collision: {meshes: kinshipChain.meshesOf(robot, geometries, "collision", q)}, transfer: {ways: kinshipChain.axesOf(transfer)}, pose: kinshipChain.poseOf(transfer)};
  }

  /// Where the arm could be, so that the camera need not follow it.
  function room() {
    const origins = [[0, 0, 0]];
    for (let side = 0; side < 4; ++side) {
      const turned = robot.joints.map((joint, i) => (i === 0 ? joint.lower + (joint.upper - joint.lower) * side / 3 : data.shown[i]));
      origins.push(...kinshipChain.posesOf(robot, turned).links.map(kinshipChain.originOf));
    }
    return origins.flat();
  }

  const first = layers();
  const view = kinshipView.show(byId("robot"), {
    label: `${robot.label}: ${several(solids, "solid")} of its links, and its transfer frame`, from: [-1, -1.5, 0.8], layers: [
      ...(drawnAs("visual") ? [{name: "visual", text: "as it looks", color: "arm", opacity: 1, ...first.visual}] : []),
      ...(drawnAs("collision") ? [{name: "collision", text: "collision meshes", color: "goal", opacity: 0.4, shown: !drawnAs("visual"), ...first.collision}] : []),
      {name: "links", text: "solids", color: "arm", opacity: robot.meshes.length ? 0.22 : 1, shown: !robot.meshes.length, ...first.links},
      {name: "transfer", text: "transfer frame", color: "axis-z", ...first.transfer},
      {name: "room", color: "scene", shown: false, points: [{positions: room()}]}]});

  function put() {
    const now = layers();
    for (const name of ["visual", "collision"]) if (drawnAs(name)) view.replace(name, now[name]);
    view.replace("links", now.links);
    view.replace("transfer", now.transfer);
    byId("pose").textContent = `Transfer frame in \u201c${robot.base_link}\u201d: ${now.pose.slice(0, 3).map((n) => fixed(n, 3)).join(" ")} m, ` +
      `quaternion x y z w ${now.pose.slice(3).map((n) => fixed(n, 3)).join(" ")}.`;
  }

  const sliders = robot.joints.map((joint, i) => {
    const text = make("output", {});
    const slider = make("input", {type: "range", min: joint.lower, max: joint.upper, step: "any", value: q[i], "aria-label": joint.name, "data-joint": joint.name});
    const say = () => {
      text.textContent = `${fixed(q[i], 3)} ${joint.unit}`;
      slider.setAttribute("aria-valuetext", text.textContent);
    };
    slider.addEventListener("input", () => {
      q[i] = Number(slider.value);
      say();
      put();
    });
    slider.addEventListener("keydown", (event) => { // a browser's own step would be none with "any"
      const step = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key];
      if (!step) return;
      event.preventDefault();
      slider.value = Number(slider.value) + step * (joint.upper - joint.lower) / 100;
      slider.dispatchEvent(new Event("input"));
    });
    byId("joints").append(make("label", {}, make("span", {}, joint.name), slider, text,
      make("small", {}, joint.type === "continuous" ? "continuous" : `${fixed(joint.lower, 2)} to ${fixed(joint.upper, 2)} ${joint.unit}`)));
    say();
    return {slider, say};
  });
  byId("again").addEventListener("click", () => {
    q = [...data.shown];
    sliders.forEach(({slider, say}, i) => {
      slider.value = q[i];
      say();
    });
    put();
  });

  fillTable(byId("links"), [["link", "moved by", "solids"], ...robot.links.map((link) => [
    link.name, link.joint < 0 ? "nothing: stands" : link.joint < robot.joints.length ? robot.joints[link.joint].name
      : robot.mimics[link.joint - robot.joints.length].joint.name + " (follows)",
    link.solids.map((solid) => ["box", "cylinder", "capsule", "sphere"].find((kind) => solid[kind]) + (solid.approximate ? " around a mesh" : "")).join(", ") || "\u2013"])]);
  tell();
  put();
  return view;
};
