// Fills the page from its data.
"use strict";
(() => {
  const {data, byId, count, fixed, percent, seconds, several, listed, total, metres, fillTable, fillTiles, color} = kinshipPage;
  const {comparison, distribution, fleet} = data;
  const pText = (p) => (p === null ? "\u2013" : p < 0.001 ? p.toExponential(1) : p.toFixed(4));


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
    fillTiles(byId("tiles"), tiles);
  }

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

  function showFleet() {
    const poses = total(fleet.flatMap((robot) => robot.paths.map((path) => path.positions.length / 3)));
    byId("fleet-text").textContent =
      `Where the palm of the gripper was along the recorded paths, in the frame of the station: ${count(poses)} poses of ` +
      `${several(paths, "path")}. Each stroke points back out of the palm. The obstacles are those of one instance; they stand a little elsewhere in each.`;
    kinshipView.show(byId("fleet-view"), {
      label: `The station with the ways of the hand of ${names}`, from: [-1.8, -2.3, 1.3], layers: [
        {name: "scene", text: "obstacles", color: "scene", objects: data.scene},
        ...fleet.map((robot, i) => ({
          name: robot.label, text: `${robot.label}, ${several(robot.paths.length, "path")}`, color: "robot-" + i % 4,
          lines: [{positions: segments(robot), opacity: 0.3},
                  {positions: robot.paths.flatMap((path) => approaches(path, 0.035)), opacity: 0.45}],
          points: [{positions: robot.paths.flatMap((path) => metres(path.positions)), size: 0.022, opacity: 0.8}]}))]});
  }

  function showSamples() {
    const samples = data.samples.positions.length / 3;
    byId("samples-title").textContent = `What ${data.robot} was given`;
    byId("samples-text").textContent =
      `The palm of ${data.robot} in ${count(samples)} configurations drawn from its distribution: a mixture of ` +
      `${distribution.components} Gaussians in its ${distribution.joints} joints, fitted to ${count(distribution.configurations)} ` +
      `configurations. ${data.postures.length} of them, free of collision and far from each other, are drawn as the whole arm. ` +
      `The planner still checks every sample: about ${percent(data.free_share)} of these are free in the scene shown, of uniform ones ${percent(data.uniform_free_share)}.`;
    kinshipView.show(byId("samples-view"), {
      label: `${data.robot} in samples of its distribution`, from: [-1.8, -2.4, 1.4], layers: [
        {name: "scene", text: "obstacles", color: "scene", objects: data.scene},
        {name: "arms", text: `${data.robot} in ${data.postures.length} samples`, color: "arm",
         arms: data.postures.map((bones, i) => ({bones, opacity: i === 0 ? 1 : 0.35}))},
        {name: "samples", text: "palm, one dot per sample", color: "sample",
         points: [{positions: metres(data.samples.positions), size: 0.022, opacity: 0.5}]}]});
  }

  function showBars() {
    const rows = [["uniform", data.uniform_checks], ["guided", data.guided_checks]].map(([planner, checks]) =>
      ({planner, ...checks, label: count(checks.mean)}));
    byId("worth-text").textContent =
      `Collision checks of both planners over the same ${comparison.pairs} instances with the same seeds; bars are means, ` +
      `whiskers their 95 % intervals (bootstrap).`;
    kinshipCharts.show(byId("bars"), "Mean collision checks, uniform and guided", () => barsOf(rows));
  }

  function barsOf(rows) {
    const ink = color("ink"), font = kinshipCharts.font;
    const whisker = (x, x2, band) => ({
      type: "rule", from: {data: "rows"}, encode: {update: {
        x: {scale: "x", field: x}, x2: {scale: "x", field: x2}, stroke: {value: ink}, strokeWidth: {value: 1.5},
        y: {scale: "y", field: "planner", band: band[0]}, y2: {scale: "y", field: "planner", band: band[1]}}}});
    return {
      width: byId("bars").clientWidth, height: 132,
      data: [{name: "rows", values: rows}],
      scales: [
        {name: "y", type: "band", domain: {data: "rows", field: "planner"}, range: "height", padding: 0.32},
        {name: "x", domain: {data: "rows", field: "high"}, range: "width", zero: true, nice: true},
        {name: "hue", type: "ordinal", domain: ["uniform", "guided"], range: [color("uniform"), color("guided")]}],
      axes: [
        {orient: "bottom", scale: "x", grid: true, tickCount: 6, title: "collision checks per query",
         encode: {labels: {update: {text: {signal: "replace(format(datum.value, ','), regexp(',', 'g'), '\u202f')"}}}}},
        {orient: "left", scale: "y", labelColor: ink, labelFontSize: 14, labelPadding: 10}],
      marks: [
        {type: "rect", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", value: 0}, x2: {scale: "x", field: "mean"}, y: {scale: "y", field: "planner"},
          height: {scale: "y", band: 1}, fill: {scale: "hue", field: "planner"}, cornerRadius: {value: 3}}}},
        whisker("low", "high", [0.5, 0.5]), whisker("low", "low", [0.36, 0.64]), whisker("high", "high", [0.36, 0.64]),
        {type: "text", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", value: 0, offset: 10}, y: {scale: "y", field: "planner", band: 0.5}, baseline: {value: "middle"},
          text: {field: "label"}, fill: {value: color("card")}, font: {value: font}, fontSize: {value: 15}, fontWeight: {value: 600}}}}]};
  }

  function showTables() {
    const {uniform: u, guided: g, ratio: r} = comparison;
    fillTable(byId("comparison"), [
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
    fillTable(byId("sources"), [
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
