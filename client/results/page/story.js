// Tells the run from its data.
"use strict";
(() => {
  const {data, byId, count, fixed, percent, several, listed, total, metres, fillTable, fillTiles, color, make} = kinshipPage;
  const {comparison, distribution, fleet, samples, typical} = data;

  const usesExperience = data.uses_experience;
  const names = listed(fleet.map((robot) => robot.label));
  const taught = names || listed(distribution.sources.map((source) => source.label)) || "A fleet";
  const paths = total(fleet.map((robot) => robot.paths.length));
  const ratio = comparison.ratio.mean_checks, timeRatio = comparison.ratio.mean_time;
  const instances = comparison.pairs;

  /// A probability for who reads no p-values: "once in about 28 000 such runs".
  function oncePer(p) {
    if (p >= 0.5) return "in every other such run or more often";
    const runs = 1 / p;
    const unit = Math.pow(10, Math.max(0, Math.floor(Math.log10(runs)) - 1));
    return p < 1e-9 ? "less than once in a billion such runs" : `once in about ${count(Math.round(runs / unit) * unit)} such runs`;
  }

  /// What guided the guided queries: not always the distribution.
  function guidesInWords() {
    const words = {recall: "whole recorded paths, moved onto each query",
                   retreat: "backing the hand out of its goal along the palm", ways: "recorded ways of the hand, moved onto each query",
                   mixture: "samples from the distribution"};
    const parts = (guide) => guide.split("+").map((part) => words[part] || "nothing");
    const all = total(data.guides.map((each) => each.queries));
    return `Four things can guide a query: ${listed(Object.values(words))}. By planning recorded queries again the server found what takes ` +
      `this robot the least time; here that was ` +
      data.guides.map(({guide, queries}) => `${listed(parts(guide))} (${count(queries)} of ${several(all, "query").replace(/ys$/, "ies")})`).join("; ") + ".";
  }

  /// The line of the terminal's table: its name, uniform, guided, ratio and p.
  const tableRow = (name) => data.table.rows.find((row) => row[0] === name);

  /// How many times as much was needed, and how much that is.
  function ratioTile(times, what, name) {
    const [, uniform, guided] = tableRow(name);
    if (times === null) return ["\u2013", `no ratio, ${name}: nothing was solved`];
    return [fixed(Math.max(times, 1 / times), 2) + "\u2009\u00d7",
            `${what} ${times >= 1 ? "without" : "with"} guidance, in the mean: uniform ${uniform}, guided ${guided}` +
            (times >= 1 ? "" : "; it did not help")];
  }

  /// What the experience saved beside the best that needs none, where that was planned, too.
  function worthTile() {
    const worth = comparison.worth;
    if (!worth || worth.by_checks === null) return [];
    const times = (value) => (value === null ? "\u2013" : fixed(value, 2) + "\u2009\u00d7");
    return [[times(worth.by_checks), `worth of the experience: checks of the best without it, uniform or the retreat, to those of the best with it; by time ${times(worth.by_time)}`]];
  }

  /// Planning time as a sentence, and what it is.
  function timeInWords() {
    if (timeRatio === null) return "";
    const [, uniform, guided] = tableRow("planning time, mean");
    return (timeRatio >= 1 ? `Without guidance planning took ${fixed(timeRatio, 2)} times as long, ` : `With guidance planning took ${fixed(1 / timeRatio, 2)} times as long, `) +
      `${uniform} to ${guided} of processor time in the mean; that counts what guidance itself costs, drawing samples and moving recorded ways onto the query. `;
  }

  /// What chance has to do with it, as a sentence.
  function chance() {
    const p = comparison.wilcoxon_checks.p;
    if (p === null) return "";
    return p < 0.05
      ? `Were both equally good, chance alone would bring about so clear a difference ${oncePer(p)}.`
      : `That is no clear difference: were both equally good, chance alone would bring about as much ${oncePer(p)}.`;
  }

  function tell() {
    const holding = data.held.length ? `, holding ${listed(data.held.map((name) => `\u201c${name}\u201d`))},` : "";
    const teachers = fleet.length || distribution.sources.length || 1;
    byId("title").textContent = usesExperience ? `${taught} ${teachers === 1 ? "teaches" : "teach"} ${data.robot} a task`
      : `${data.robot} plans a task, and nobody\u2019s experience helps`;
    byId("story").textContent =
      (fleet.length
        ? `${names} planned the task \u201c${distribution.task}\u201d${holding} with uniform sampling and reported ` +
          `${several(paths, "path")} to a Kinship server. `
        : `A Kinship server has experience of the task \u201c${distribution.task}\u201d. `) +
      `The server moved it into the joint space of ${data.robot}, another robot, and fitted a sampling distribution. ${data.robot} then ` +
      `planned ${several(instances, "new instance")} twice: with uniform samples, and ` +
      (usesExperience ? "guided by what the server made of that experience." : "guided by what needs no experience, as the server had found best.");
    fillTiles(byId("tiles"), [
      ratioTile(ratio, "as many collision checks", "collision checks, mean"),
      ratioTile(timeRatio, "as much planning time", "planning time, mean"),
      ...worthTile(),
      [`${count(data.cheaper_guided)} of ${count(instances)}`, "instances took fewer checks with guidance"],
      [`${percent(samples.uniform_free_share)} \u2192 ${percent(samples.free_share)}`, "of the samples are free of collision, uniform \u2192 distribution"]]);
  }

  function showStation() {
    const actors = fleet.filter((robot) => robot.example).map((robot, i) => ({
      label: robot.label, role: "experienced", color: "robot-" + i % 4, demo: robot.example, paths: robot.paths,
      why: "It is the one in the middle of all that it solved, by checks."}));
    if (data.newcomer)
      actors.push({label: data.robot, role: "new to the task", color: "accent", demo: data.newcomer,
                   why: usesExperience ? "It planned this one guided by what the server made of that experience." : "It planned this one guided by what needs no experience."});
    if (!actors.length) return byId("station").remove();
    byId("station-text").textContent =
      `Every instance has its obstacles a little elsewhere. One path of each robot is drawn in its own instance, with the hand's start and ` +
      `goal; play it, or look at all ways of the hand at once.`;
    kinshipStation.show(byId("station-figure"), actors);
  }

  function showSearches() {
    if (!data.searches) return;
    byId("searches").hidden = false;
    byId("searches-text").textContent =
      `${data.robot} plans instance \u201c${typical.problem}\u201d: where its hand would be in every configuration that the two trees reached, ` +
      `one tree from the start and others from the goals, until they meet. A collision check is what planning pays with. ${guidesInWords()}`;
    kinshipSearches.show(byId("searches-figure"), data.searches,
                         {uniform: typical.uniform_checks, guided: typical.guided_checks}, data.obstacles);
    byId("searches-note").textContent =
      `These are the run's own searches. The instance was chosen by rule: of ${several(typical.candidates, "instance")} solved both ways its ratio of checks, ` +
      `${fixed(typical.ratio, 2)}, is nearest the median of their ratios, ${fixed(typical.median_ratio, 2)}. Both figures turn together. Straight lines between hands stand for ` +
      `short motions of all joints; the path is the one found, before it is shortened.`;
  }

  function showSamples() {
    const drawn = samples.hand.positions.length / 3;
    byId("samples-title").textContent = `What ${data.robot} was given`;
    byId("samples-text").textContent =
      `Its hand in ${count(drawn)} configurations drawn from the distribution: a mixture of ${several(distribution.components, "Gaussian")} in its ` +
      `${several(distribution.joints, "joint")}, fitted to ${several(distribution.configurations, "configuration")}. ` +
      (samples.postures.length ? `${several(samples.postures.length, "sample")}, free of collision and far from each other, can be seen as the whole arm. ` : "") +
      `The planner checks every sample all the same: ${percent(samples.free_share)} of these are free in the scene shown, of uniform ones ${percent(samples.uniform_free_share)}.`;
    kinshipView.show(byId("samples-figure"), {
      label: `${data.robot} in samples of its distribution, and where its hand is in ${count(drawn)} of them`, from: [-1.7, 2.3, 1.35], layers: [
        {name: "scene", text: "obstacles", color: "scene", opacity: 0.3, objects: data.obstacles},
        {name: "samples", text: "its hand, a dot a sample", color: "sample",
         points: [{positions: metres(samples.hand.positions), size: 0.034, opacity: 0.85}]},
        {name: "arm", text: "one sample as the whole arm", color: "arm", arms: samples.postures.slice(0, 1).map((bones) => ({bones}))},
        {name: "arms", text: `${samples.postures.length - 1} more`, color: "arm", shown: false,
         arms: samples.postures.slice(1).map((bones) => ({bones, opacity: 0.4}))}].filter((layer) => !layer.arms || layer.arms.length)});
  }

  function showBars() {
    const rows = [["uniform", data.uniform_checks], ["guided", data.guided_checks]].map(([planner, checks]) =>
      ({planner, ...checks, label: count(checks.mean)}));
    const says = ratio === null ? "" : ratio >= 1 ? `Without guidance ${fixed(ratio, 2)} times as many collision checks were needed. `
      : `With guidance ${fixed(1 / ratio, 2)} times as many collision checks were needed. `;
    byId("worth-text").textContent =
      `${says}${chance()} ${timeInWords()}Both planned the same ${several(instances, "instance")} with the same seeds; bars are means, whiskers their 95\u202f% intervals.` +
      (data.searches ? "" : " " + guidesInWords());
    kinshipCharts.show(byId("bars"), `Mean collision checks: uniform ${rows[0].label}, guided ${rows[1].label}`,
                       (width) => barsOf(rows, "collision checks per query", width));
    const told = tableRow("planning time, mean");
    const times = [["uniform", data.uniform_time_s, told[1]], ["guided", data.guided_time_s, told[2]]].map(([planner, time, label]) =>
      ({planner, mean: 1000 * time.mean, low: 1000 * time.low, high: 1000 * time.high, label}));
    kinshipCharts.show(byId("time-bars"), `Mean planning time: uniform ${told[1]}, guided ${told[2]}`,
                       (width) => barsOf(times, "planning time per query, ms of a processor", width));
  }

  /// What mixture, ways and retreat would have brought by themselves.
  function showAlone() {
    if (!data.also.length) return;
    byId("alone").hidden = false;
    byId("alone-text").textContent =
      `The same ${several(instances, "instance")} and seeds once more, not reported. Mixture and ways are made of what the other robots reported; ` +
      `retreat backs the hand out of its goal and needs no experience. Ratio: uniform planning to it, above 1 it helps. ${data.worth}`;
    fillTable(byId("alone-table"), [["guided by", "solved", "checks, mean", "ratio", "planning time, mean", "ratio", "path length, mean",
      "hand's", "least clearance, mean"], ...data.also]);
  }

  /// Bars of means with their intervals; a row has planner, mean, low, high and label.
  function barsOf(rows, title, width) {
    const ink = color("ink"), font = kinshipCharts.font;
    const whisker = (x, x2, band) => ({
      type: "rule", from: {data: "rows"}, encode: {update: {
        x: {scale: "x", field: x}, x2: {scale: "x", field: x2}, stroke: {value: ink}, strokeWidth: {value: 1.5},
        y: {scale: "y", field: "planner", band: band[0]}, y2: {scale: "y", field: "planner", band: band[1]}}}});
    return {
      width, height: 120,
      data: [{name: "rows", values: rows}],
      scales: [
        {name: "y", type: "band", domain: {data: "rows", field: "planner"}, range: "height", padding: 0.32},
        {name: "x", domain: {data: "rows", field: "high"}, range: "width", zero: true, nice: true},
        {name: "hue", type: "ordinal", domain: ["uniform", "guided"], range: [color("uniform"), color("guided")]}],
      axes: [
        {orient: "bottom", scale: "x", grid: true, tickCount: Math.max(3, Math.min(7, Math.round(width / 110))), title,
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
    fillTable(byId("comparison"), [["", "uniform", "guided", "ratio", "p"], ...data.table.rows]);
    for (const note of data.table.notes) byId("comparison-notes").append(make("p", {}, note));
    byId("comparison-notes").append(make("p", {}, `One run of ${several(instances, "instance")} is one draw: another seed gives another ratio.`));
    fillTable(byId("sources"), [
      ["robot", "paths", "poses", "reached by " + data.robot, "of the poses"],
      ...distribution.sources.map((s) => [s.label, count(s.paths), count(s.poses), count(s.poses_solved),
                                          s.poses ? percent(s.poses_solved / s.poses) : ""])]);
    byId("distribution-note").textContent =
      `Distribution ${distribution.id}, revision ${distribution.revision}, profile \u201c${distribution.profile}\u201d: transfer ` +
      `${fixed(distribution.transfer_time_s, 2)}\u202fs, fit ${fixed(distribution.fit_time_s, 2)}\u202fs.`;
    byId("footer").textContent =
      "Written by kinship results page from the run's own files. The page holds everything it needs and loads nothing. " +
      "Drawn with three.js (MIT) and Vega (BSD 3-clause).";
  }

  function advise() {
    if (!data.advice) return;
    byId("advice").hidden = false;
    const tenths = Math.round(10 * data.advice.share);
    const words = tenths <= 0 ? `Do not guide ${data.robot} here: plan with uniform samples.`
      : tenths >= 10 ? `Take all samples of a guided query from experience.`
      : `In a guided query take about ${tenths} of 10 samples from experience and the others uniformly.`;
    byId("advice-text").textContent = `${words} Its reasons: ${data.advice.evidence}.`;
  }

  tell();
  showTables();
  advise();
  showBars();
  showAlone();
  showStation();
  showSearches();
  showSamples();
})();
