// Fills the page from its data.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const {comparison, distribution, fleet} = data;
  const byId = (id) => document.getElementById(id);
  const count = (n) => (n === null ? "unsolved" : Math.round(n).toString().replace(/\B(?=(\d{3})+$)/g, "\u202f"));
  const fixed = (n, digits) => (n === null ? "\u2013" : n.toFixed(digits));
  const percent = (n) => Math.round(100 * n) + " %";
  const listed = (words) => (words.length < 2 ? words.join("") : words.slice(0, -1).join(", ") + " and " + words[words.length - 1]);
  const total = (numbers) => numbers.reduce((a, b) => a + b, 0);
  const pText = (p) => (p === null ? "\u2013" : p < 0.001 ? p.toExponential(1) : p.toFixed(4));

  const seconds = (s) => (s === null ? "\u2013" : s < 1 ? fixed(1000 * s, 1) + " ms" : fixed(s, 2) + " s");
  const several = (n, word) => `${count(n)} ${word}${n === 1 ? "" : "s"}`;

  const names = listed(fleet.map((robot) => robot.label));
  const paths = total(fleet.map((robot) => robot.paths.length));
  const ratio = comparison.ratio.mean_checks;
  const isBetter = data.guided_checks.mean < data.uniform_checks.mean;

  function tell() {
    byId("title").textContent = `${names} teach ${data.robot} a task new to it`;
    byId("story").textContent =
      `${names} planned the task \u201c${distribution.task}\u201d, moving a held box from a table into a shelf, with uniform ` +
      `sampling and reported ${several(paths, "path")} to a Kinship server. The server moved these paths into the joint space of ` +
      `${data.robot}, which has other kinematics and had never done the task, and fitted a sampling distribution. ` +
      `${data.robot} then planned ${comparison.pairs} new instances twice: with uniform samples, and with samples from the distribution.`;
    const tiles = [
      [ratio === null ? "\u2013" : fixed(ratio, 2) + "\u2009\u00d7", isBetter ? "fewer collision checks with guidance (ratio of the means)" : "ratio of mean checks, uniform / guided"],
      [`${count(data.uniform_checks.mean)} \u2192 ${count(data.guided_checks.mean)}`, "mean collision checks, uniform \u2192 guided"],
      [pText(comparison.wilcoxon_checks.p), "p of a two-sided Wilcoxon signed-rank test" +
        (comparison.wilcoxon_checks.p < 0.05 ? "" : ": not a clear difference")],
      [`${percent(data.uniform_free_share)} \u2192 ${percent(data.free_share)}`, "samples free of collision, uniform \u2192 guided"]];
    for (const [figure, text] of tiles) {
      const tile = document.createElement("div");
      const number = document.createElement("b");
      const label = document.createElement("span");
      tile.className = "tile";
      number.textContent = figure;
      label.textContent = text;
      tile.append(number, label);
      byId("tiles").append(tile);
    }
  }

  function tableOf(id, rows) {
    rows.forEach((cells, row) => {
      const line = byId(id).insertRow();
      for (const cell of cells) {
        const element = document.createElement(row === 0 ? "th" : "td");
        element.textContent = cell;
        line.append(element);
      }
    });
  }

  const metres = (numbers) => numbers.map((n) => n / 1000);

  /// Each path as segments between its poses.
  function segments(robot) {
    const positions = [];
    for (const path of robot.paths) {
      const p = metres(path.positions);
      for (let i = 3; i < p.length; i += 3) positions.push(...p.slice(i - 3, i + 3));
    }
    return positions;
  }

  /// A short stroke backwards from each pose, against its approach direction.
  function approaches(poses, length) {
    const positions = [];
    const p = metres(poses.positions);
    for (let i = 0; i < p.length; i += 3)
      for (const back of [0, length])
        for (let axis = 0; axis < 3; ++axis) positions.push(p[i + axis] - back * poses.directions[i + axis] / 100);
    return positions;
  }

  const target = [0.24, 0, 0.3];

  function showFleet() {
    const poses = total(fleet.flatMap((robot) => robot.paths.map((path) => path.positions.length / 3)));
    byId("fleet-text").textContent =
      `Where the palm of the gripper was along the recorded paths, in the frame of the station: ${count(poses)} poses of ` +
      `${several(paths, "path")}. Each stroke points back out of the palm. The obstacles are those of one instance; they stand a little elsewhere in each.`;
    kinshipScene.show(byId("fleet-view"), {
      eye: [-1.55, -2.3, 1.6], target, obstacles: data.scene, arms: [],
      lines: fleet.flatMap((robot, i) => [
        {positions: segments(robot), color: "robot-" + i % 4, opacity: 0.3},
        {positions: robot.paths.flatMap((path) => approaches(path, 0.035)), color: "robot-" + i % 4, opacity: 0.55}]),
      points: fleet.map((robot, i) => ({
        positions: robot.paths.flatMap((path) => metres(path.positions)), color: "robot-" + i % 4, size: 0.032, opacity: 0.95})),
      legend: fleet.map((robot, i) => ["robot-" + i % 4, `${robot.label}, ${several(robot.paths.length, "path")}`])});
  }

  function showSamples() {
    const samples = data.samples.positions.length / 3;
    byId("samples-title").textContent = `What ${data.robot} was given`;
    byId("samples-text").textContent =
      `The palm of ${data.robot} in ${count(samples)} configurations drawn from its distribution: a mixture of ` +
      `${distribution.components} Gaussians in its ${distribution.joints} joints, fitted to ${count(distribution.configurations)} ` +
      `configurations. ${data.postures.length} of them, free of collision and far from each other, are drawn as the whole arm. ` +
      `The planner still checks every sample: about ${percent(data.free_share)} of these are free in the scene shown, of uniform ones ${percent(data.uniform_free_share)}.`;
    kinshipScene.show(byId("samples-view"), {
      eye: [-1.75, -2.5, 1.75], target, obstacles: data.scene, lines: [],
      arms: data.postures.map((bones, i) => ({bones, color: "arm", opacity: i === 0 ? 1 : 0.5})),
      points: [{positions: metres(data.samples.positions), color: "sample", size: 0.036, opacity: 0.9}],
      legend: [["sample", "palm, one dot per sample"], ["arm", `${data.robot} in ${data.postures.length} samples`]]});
  }

  function showBars() {
    const rows = [["uniform", data.uniform_checks], ["guided", data.guided_checks]].map(([planner, checks]) =>
      ({planner, ...checks, label: count(checks.mean)}));
    byId("worth-text").textContent =
      `Collision checks of both planners over the same ${comparison.pairs} instances with the same seeds; bars are means, ` +
      `whiskers their 95 % intervals (bootstrap).`;
    const vega = kinshipVega();
    const draw = () => {
      byId("bars").textContent = "";
      const width = Math.max(260, byId("bars").clientWidth - 150);
      new vega.View(vega.parse(barsOf(rows, width)), {renderer: "svg", container: byId("bars")}).run();
    };
    draw();
    window.addEventListener("resize", draw);
    matchMedia("(prefers-color-scheme: dark)").addListener(draw);
  }

  function barsOf(rows, width) {
    const ink = kinshipScene.color("ink"), soft = kinshipScene.color("soft"), line = kinshipScene.color("line");
    const font = "system-ui, 'DejaVu Sans', sans-serif";
    const whisker = (x, x2, band) => ({
      type: "rule", from: {data: "rows"}, encode: {update: {
        x: {scale: "x", field: x}, x2: {scale: "x", field: x2}, stroke: {value: ink}, strokeWidth: {value: 1.5},
        y: {scale: "y", field: "planner", band: band[0]}, y2: {scale: "y", field: "planner", band: band[1]}}}});
    return {
      width, height: 132, padding: 6, background: null,
      data: [{name: "rows", values: rows}],
      scales: [
        {name: "y", type: "band", domain: {data: "rows", field: "planner"}, range: "height", padding: 0.32},
        {name: "x", domain: {data: "rows", field: "high"}, range: "width", zero: true, nice: true},
        {name: "hue", type: "ordinal", domain: ["uniform", "guided"], range: [kinshipScene.color("uniform"), kinshipScene.color("guided")]}],
      axes: [
        {orient: "bottom", scale: "x", grid: true, gridColor: line, domain: false, ticks: false, tickCount: 6,
         encode: {labels: {update: {text: {signal: "replace(format(datum.value, ','), regexp(',', 'g'), '\u202f')"}}}},
         labelColor: soft, labelFont: font, labelFontSize: 12, labelPadding: 6, title: "collision checks per query", titleColor: soft,
         titleFont: font, titleFontSize: 12, titleFontWeight: "normal", titlePadding: 8},
        {orient: "left", scale: "y", domain: false, ticks: false, labelColor: ink, labelFont: font, labelFontSize: 14, labelPadding: 10}],
      marks: [
        {type: "rect", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", value: 0}, x2: {scale: "x", field: "mean"}, y: {scale: "y", field: "planner"},
          height: {scale: "y", band: 1}, fill: {scale: "hue", field: "planner"}, cornerRadius: {value: 3}}}},
        whisker("low", "high", [0.5, 0.5]), whisker("low", "low", [0.36, 0.64]), whisker("high", "high", [0.36, 0.64]),
        {type: "text", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", value: 0, offset: 10}, y: {scale: "y", field: "planner", band: 0.5}, baseline: {value: "middle"},
          text: {field: "label"}, fill: {value: kinshipScene.color("card")}, font: {value: font}, fontSize: {value: 15}, fontWeight: {value: 600}}}}]};
  }

  function kinshipVega() {
    const part = (name) => kinshipModules.require("vega-" + name);
    Object.assign(part("dataflow").transforms, part("transforms"), part("view-transforms"), part("encode"));
    return {View: part("view").View, parse: part("parser").parse};
  }

  function showTables() {
    const {uniform: u, guided: g, ratio: r} = comparison;
    tableOf("comparison", [
      ["", "uniform", "guided", "ratio", "p"],
      ["solved", `${u.solved}/${comparison.pairs}`, `${g.solved}/${comparison.pairs}`, "", ""],
      ["collision checks, mean", count(u.mean_checks), count(g.mean_checks), fixed(r.mean_checks, 2), pText(comparison.wilcoxon_checks.p)],
      ["collision checks, median", count(u.median_checks), count(g.median_checks), fixed(r.median_checks, 2), ""],
      ["planning time, mean", seconds(u.mean_time_s), seconds(g.mean_time_s), fixed(r.mean_time, 2), pText(comparison.wilcoxon_time.p)],
      ["95 % interval of mean checks", `${count(data.uniform_checks.low)} to ${count(data.uniform_checks.high)}`,
       `${count(data.guided_checks.low)} to ${count(data.guided_checks.high)}`, "", ""]]);
    byId("comparison-note").textContent =
      "Ratio: uniform / guided. p: two-sided Wilcoxon signed-rank test over the pairs, unsolved ranked worst. One run of " +
      `${comparison.pairs} instances is one draw: another seed gives another ratio.` +
      (u.solved < comparison.pairs || g.solved < comparison.pairs ? " An unsolved attempt counts in a mean with what it had used when it gave up." : "");
    tableOf("sources", [
      ["robot", "paths", "poses", "reached by " + data.robot, "of the poses"],
      ...distribution.sources.map((s) => [s.label, count(s.paths), count(s.poses), count(s.poses_solved),
                                          s.poses ? percent(s.poses_solved / s.poses) : ""])]);
    byId("distribution-note").textContent =
      `Distribution ${distribution.id}, revision ${distribution.revision}, profile \u201c${distribution.profile}\u201d: transfer ` +
      `${fixed(distribution.transfer_time_s, 2)} s, fit ${fixed(distribution.fit_time_s, 2)} s. What the server advises from the attempts above: share of guided samples ${fixed(data.advice.share, 2)}: ${data.advice.evidence}.`;
    byId("footer").textContent =
      "Written by deploy/quickstart from the run's own files. The page holds everything it needs and loads nothing. " +
      "Drawn with three.js (MIT) and Vega (BSD 3-clause).";
  }

  tell();
  showTables();
  showBars();
  showFleet();
  showSamples();
})();
