// A task in space (task_space.js) and over time: experience, solved attempts, what planning cost, what guidance was worth.
"use strict";
kinshipFigures.task = (element, data, {href = () => null} = {}) => {
  const {color, count, fixed, percent, several, listed, total, fillTable, fillTiles} = kinshipPage;
  const byId = kinshipPlots.fill(element, `
<header>
  <p class="eyebrow">Kinship task</p>
  <h1 id="title"></h1>
  <p id="lead" class="lead"></p>
  <div id="tiles" class="tiles"></div>
</header>

<section id="space-section"></section>

<section>
  <h2>Experience</h2>
  <p id="experience-text"></p>
  <div id="experience-keys"></div>
  <div id="experience" class="chart"></div>
</section>

<section>
  <h2>Solved</h2>
  <p id="solved-text"></p>
  <div id="solved-keys"></div>
  <div id="solved" class="chart"></div>
</section>

<section>
  <h2>What planning cost</h2>
  <p id="checks-text"></p>
  <div id="checks-keys"></div>
  <div id="checks" class="panels wide"></div>
</section>

<section>
  <h2>What guidance was worth</h2>
  <p id="benefit-text"></p>
  <div id="benefit-keys"></div>
  <div id="benefit" class="panels wide"></div>
</section>

<section>
  <h2>Numbers</h2>
  <div class="scroll" tabindex="0" role="region" aria-label="Robots"><table id="robots"></table></div>
  <p class="note" id="robots-note"></p>
</section>

<section>
  <h2>Distributions</h2>
  <p id="revisions-text"></p>
  <div class="scroll" tabindex="0" role="region" aria-label="Distributions"><table id="revisions"></table></div>
</section>`);
  const {keys, panel, chart, hueOf, dashOf, timeText, dayText, lengthText, hide} = kinshipPlots;
  const {robots, revisions} = data;
  const modes = [["guided", "guided"], ["control", "uniform"], ["uniform", "robot-1"]]; // by SamplingMode: word, hue
  const until = data.from_ms + data.bins * data.bin_ms;
  const startOf = (bin) => data.from_ms + bin * data.bin_ms;
  const sum = (name) => total(robots.map((robot) => robot[name]));
  const newest = (robot) => robot.benefit[robot.benefit.length - 1];
  const compared = robots.filter((robot) => robot.benefit.length > 0);
  const span = dayText(data.from_ms) === dayText(until - 1) ? dayText(data.from_ms) : `${dayText(data.from_ms)} to ${dayText(until - 1)}`;
  const ratioText = (benefit) => `${fixed(benefit.ratio, 2)} (${fixed(benefit.low, 2)} to ${fixed(benefit.high, 2)})`;

  function tell() {
    byId("title").textContent = `\u201c${data.task}\u201d`;
    byId("lead").textContent = `${listed(robots.map((robot) => robot.label))} reported ${several(sum("attempts"), "attempt")} of the task ` +
      `\u201c${data.task}\u201d between ${timeText(data.from_ms)} and ${timeText(until)}. Times are those of arrival at the server, in UTC; ` +
      `a bin is ${lengthText(data.bin_ms)} long.`;
    const judged = sum("solved") + sum("unsolved");
    fillTiles(byId("tiles"), [
      [count(sum("attempts")), `attempts of ${several(robots.length, "robot")}`],
      [count(sum("solved")), "of them solved, each with a path"],
      [count(sum("attempts") - sum("solved")), judged < sum("attempts")
        ? `not solved, ${count(sum("attempts") - judged)} of them with no start or goal that is free` : "not solved"],
      ...compared.slice(0, 2).map((robot) => [fixed(newest(robot).ratio, 2) + "\u2009\u00d7",
        `uniform / guided, ${robot.label} now: 90 % ${fixed(newest(robot).low, 2)} to ${fixed(newest(robot).high, 2)}`])]);
  }

  /// A common axis of time, so that figures can be compared.
  const timeScale = {name: "x", type: "utc", range: "width", domain: [data.from_ms, until], nice: false};
  const kDay = 86400000;
  const ofDay = data.bins * data.bin_ms < 600000 ? "%H:%M:%S" : "%H:%M";
  const timeAxis = () => ({
    orient: "bottom", scale: "x", tickCount: 6, labelOverlap: true, labelSeparation: 8, title: "UTC, " + span,
    encode: {labels: {update: {text: {signal: `utcFormat(datum.value, +datum.value % ${kDay} === 0 ? '%b %d' : '${ofDay}')`}}}}});
  const seriesScale = () => ({name: "hue", type: "ordinal", domain: robots.map((robot) => robot.label), range: robots.map((r, i) => color(hueOf(i)))});
  const dashScale = () => ({name: "dash", type: "ordinal", domain: robots.map((robot) => robot.label), range: robots.map((r, i) => dashOf(i))});
  const robotKeys = () => robots.map((robot, i) => [hueOf(i), robot.label, i < 8 ? "" : "dashed"]);

  function experienceSpec() {
    const values = robots.flatMap((robot) => {
      const first = startOf(robot.bins[0].bin);
      const rows = robot.bins.map((bin) => ({robot: robot.label, time: startOf(bin.bin + 1), attempts: bin.attempts, paths: bin.paths}));
      const last = rows[rows.length - 1];
      return [{robot: robot.label, time: first, attempts: 0, paths: 0}, ...rows, {...last, time: until}];
    });
    const lines = (field, width, opacity) => ({
      type: "group", from: {facet: {name: "of_robot", data: "rows", groupby: "robot"}}, marks: [{
        type: "line", from: {data: "of_robot"}, encode: {update: {
          x: {scale: "x", field: "time"}, y: {scale: "y", field}, stroke: {scale: "hue", field: "robot"}, strokeDash: {scale: "dash", field: "robot"},
          strokeWidth: {value: width}, strokeOpacity: {value: opacity}}}}]});
    return {
      height: 240, data: [{name: "rows", values}],
      scales: [timeScale, {name: "y", type: "linear", range: "height", domain: {data: "rows", field: "attempts"}, nice: true, zero: true}, seriesScale(), dashScale()],
      axes: [{orient: "left", scale: "y", grid: true, tickCount: 5, tickMinStep: 1, format: ",d", title: "so far"}, timeAxis()],
      marks: [lines("attempts", 1.5, 0.45), lines("paths", 2.5, 1)]};
  }

  function solvedSpec() {
    const values = robots.flatMap((robot) => robot.bins.map((bin) => {
      const attempts = total(bin.modes.map((mode) => mode.attempts));
      return {robot: robot.label, time: startOf(bin.bin + 0.5), n: attempts, share: attempts ? total(bin.modes.map((mode) => mode.solved)) / attempts : null};
    })).filter((row) => row.n > 0);
    return {
      height: 170, data: [{name: "rows", values}],
      scales: [timeScale, {name: "y", type: "linear", range: "height", domain: [0, 1]}, seriesScale(), dashScale(),
               {name: "size", type: "linear", domain: {data: "rows", field: "n"}, range: [20, 130], zero: true}],
      axes: [{orient: "left", scale: "y", grid: true, tickCount: 5, format: ".0%", title: "solved"}, timeAxis()],
      marks: [
        {type: "group", from: {facet: {name: "of_robot", data: "rows", groupby: "robot"}}, marks: [{type: "line", from: {data: "of_robot"}, encode: {update: {
          x: {scale: "x", field: "time"}, y: {scale: "y", field: "share"}, stroke: {scale: "hue", field: "robot"}, strokeWidth: {value: 1.2},
          strokeDash: {scale: "dash", field: "robot"}}}}]},
        {type: "symbol", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "time"}, y: {scale: "y", field: "share"}, size: {scale: "size", field: "n"}, fill: {scale: "hue", field: "robot"}, fillOpacity: {value: 0.75},
          tooltip: {signal: "datum.robot + ': ' + format(datum.share, '.0%') + ' of ' + datum.n"}}}}]};
  }

  /// One row a mode and bin; an end that nobody knows (unsolved) is the top of the figure.
  function checkRows(robot) {
    return robot.bins.flatMap((bin) => bin.modes.map((mode, i) => ({mode: modes[i][0], time: startOf(bin.bin + 0.5), n: mode.attempts, ...mode}))
      .filter((row) => row.attempts > 0 && row.lower !== null));
  }

  function checksSpec(rows) {
    const known = rows.flatMap((row) => [row.lower, row.median, row.upper]).filter((n) => n !== null);
    const top = 1.08 * Math.max(...known, 1);
    const capped = rows.map((row) => ({...row, median: row.median === null ? top : row.median, upper: row.upper === null ? top : row.upper}));
    const hue = {name: "hue", type: "ordinal", domain: modes.map(([name]) => name), range: modes.map(([, name]) => color(name))};
    const at = {x: {scale: "x", field: "time"}, stroke: {scale: "hue", field: "mode"}};
    return {
      height: 180, data: [{name: "rows", values: capped}],
      scales: [timeScale, {name: "y", type: "linear", range: "height", domain: [0, top], nice: true, zero: true}, hue],
      axes: [{orient: "left", scale: "y", grid: true, tickCount: 4, format: ",d", title: "collision checks"}, timeAxis()],
      marks: [
        {type: "rule", from: {data: "rows"}, encode: {update: {
          ...at, y: {scale: "y", field: "lower"}, y2: {scale: "y", field: "upper"}, strokeWidth: {value: 4}, strokeOpacity: {value: 0.28}}}},
        {type: "group", from: {facet: {name: "of_mode", data: "rows", groupby: "mode"}}, marks: [{type: "line", from: {data: "of_mode"}, encode: {update: {
          ...at, y: {scale: "y", field: "median"}, strokeWidth: {value: 1.8}}}}]},
        {type: "symbol", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "time"}, y: {scale: "y", field: "median"}, size: {value: 26}, fill: {scale: "hue", field: "mode"},
          tooltip: {signal: "datum.mode + ': median ' + format(datum.median, ',d') + ', n ' + datum.n"}}}}]};
  }

  function benefitSpec(robot) {
    const own = revisions.filter((revision) => revision.label === robot.label && revision.first_ms > 0);
    const low = Math.min(0.8, ...robot.benefit.map((b) => b.low)), high = Math.max(1.25, ...robot.benefit.map((b) => b.high));
    return {
      height: 180,
      data: [{name: "rows", values: robot.benefit}, {name: "revisions", values: own}],
      scales: [timeScale, {name: "y", type: "log", range: "height", domain: [low / 1.05, high * 1.05], nice: false, zero: false}],
      axes: [{orient: "left", scale: "y", grid: true, values: [0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10, 20, 50].filter((n) => n >= low / 1.05 && n <= high * 1.05), format: "~r", title: "uniform / guided"},
             timeAxis()],
      marks: [
        {type: "area", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "time_ms"}, y: {scale: "y", field: "high"}, y2: {scale: "y", field: "low"}, fill: {value: color("guided")}, fillOpacity: {value: 0.2}}}},
        {type: "rule", encode: {update: {x: {value: 0}, x2: {signal: "width"}, y: {scale: "y", value: 1}, stroke: {value: color("ink")}, strokeWidth: {value: 1}}}},
        {type: "rule", from: {data: "rows"}, encode: {update: { // an area of one point cannot be seen
          x: {scale: "x", field: "time_ms"}, y: {scale: "y", field: "low"}, y2: {scale: "y", field: "high"}, stroke: {value: color("guided")},
          strokeWidth: {value: 2}, strokeOpacity: {value: robot.benefit.length === 1 ? 0.5 : 0}}}},
        {type: "line", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "time_ms"}, y: {scale: "y", field: "ratio"}, stroke: {value: color("guided")}, strokeWidth: {value: 2.5}}}},
        {type: "symbol", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "time_ms"}, y: {scale: "y", field: "ratio"}, size: {value: 30}, fill: {value: color("guided")},
          tooltip: {signal: "format(datum.ratio, '.2f') + ' (' + format(datum.low, '.2f') + ' to ' + format(datum.high, '.2f') + '), ' + datum.guided + ' guided, ' + datum.control + ' control'"}}}},
        {type: "rule", from: {data: "revisions"}, encode: {update: {
          x: {scale: "x", field: "first_ms"}, y: {signal: "height"}, y2: {signal: "height - 12"}, stroke: {value: color("goal")}, strokeWidth: {value: 2},
          tooltip: {signal: "'revision ' + datum.revision"}}}}]};
  }

  function showExperience() {
    byId("experience-text").textContent = "Attempts so far (thin) and paths among them, which is what others learn from (thick). Retired paths count: they were reported.";
    byId("experience-keys").append(keys(robotKeys()));
    chart(byId("experience"), "Attempts and paths of each robot over time, cumulated: " +
      robots.map((robot) => `${robot.label} ${count(robot.attempts)} attempts, ${count(robot.solved)} paths`).join("; ") + ".", experienceSpec);
  }

  function showSolved() {
    byId("solved-text").textContent = "Solved within the time limit, of the attempts of a bin that could be planned; a larger dot stands for more of them." +
      (sum("not_planned") ? ` Left out: ${several(sum("not_planned"), "attempt")} that could not be planned at all (start or goal in collision, say).` : "");
    byId("solved-keys").append(keys(robotKeys()));
    chart(byId("solved"), "Share of solved attempts over time: " + robots.map((robot) => robot.solved + robot.unsolved > 0
      ? `${robot.label} ${percent(robot.solved / (robot.solved + robot.unsolved))} in all` : `${robot.label} none`).join("; ") + ".", solvedSpec);
  }

  function showChecks() {
    byId("checks-text").textContent = "Median of the collision checks of a bin and, as a bar, the middle half of them. An unsolved attempt is dearer than " +
      "every solved one: where it reaches median or bar, they end at the top. Each robot has a scale of its own.";
    byId("checks-keys").append(keys([["guided", "guided"], ["uniform", "control: uniform on purpose, to compare"], ["robot-1", "uniform: without guidance to be had"]]));
    for (const robot of robots) {
      const rows = checkRows(robot);
      const n = (i) => total(robot.bins.map((bin) => bin.modes[i].attempts));
      const figure = panel(robot.label, modes.map(([name], i) => `${name} ${count(n(i))}`).join(", ") + " attempts");
      if (rows.length === 0) continue;
      byId("checks").append(figure.panel);
      chart(figure.chart, `Collision checks of ${robot.label} over time, medians and quartiles of each bin.`, () => checksSpec(rows));
    }
  }

  function showBenefit() {
    if (compared.length === 0) {
      byId("benefit-text").textContent = "Not known yet: no robot has ten guided and ten control attempts, from which on they are compared.";
      hide(byId("benefit"));
      return;
    }
    byId("benefit-text").textContent = "What a typical query costs in processor time (in collision checks where no time is known) without guidance, relative to one with it: above 1 guidance saves. The server\u2019s own estimate " +
      "(proto/evidence) as it stood after each bin, with its 90 % interval, from ten guided and ten control attempts on; all profiles together, where the server\u2019s advice takes each by itself.";
    byId("benefit-keys").append(keys([["guided", "ratio, 90 % interval"], ["ink", "1: no difference"], ["goal", "first attempt with another revision of a distribution", "block"]]));
    for (const robot of compared) {
      const others = robot.other_planners ? `; ${several(robot.other_planners, "attempt")} of other planners left out` : "";
      const now = newest(robot);
      const figure = panel(`${robot.label}: ${ratioText(now)}`, `${several(now.guided, "guided attempt")}, ${count(now.control)} control, planner ${robot.planner}${others}`);
      byId("benefit").append(figure.panel);
      chart(figure.chart, `Ratio uniform / guided of ${robot.label} over time; now ${ratioText(now)}.`, () => benefitSpec(robot));
    }
  }

  function showTables() {
    const planned = (robot, i) => {
      const n = total(robot.bins.map((bin) => bin.modes[i].attempts));
      return n ? count(n) : "\u2013";
    };
    fillTable(byId("robots"), [
      ["robot", "attempts", "solved", "unsolved", "not planned", ...modes.map(([name]) => name), "uniform / guided, 90 %"],
      ...robots.map((robot) => [robot.label, count(robot.attempts), count(robot.solved), count(robot.unsolved), count(robot.not_planned),
                                ...modes.map((mode, i) => planned(robot, i)), robot.benefit.length ? ratioText(newest(robot)) : "\u2013"])]);
    byId("robots-note").textContent = "Guided, control, uniform: attempts of each sampling mode that could be planned.";
    if (revisions.length === 0) {
      byId("revisions-text").textContent = "None was made or used.";
      hide(byId("revisions"));
      return;
    }
    byId("revisions-text").textContent = "Revisions that attempts name, and those that the server keeps now. When older ones were made is not kept.";
    fillTable(byId("revisions"), [
      ["robot", "distribution", "revision", "made", "first used", "attempts"],
      ...revisions.map((r) => [r.label, r.id.slice(0, 12), count(r.revision), r.fitted_ms ? timeText(r.fitted_ms) : "\u2013",
                               r.first_ms ? timeText(r.first_ms) : "\u2013", count(r.attempts)])]);
  }

  tell();
  const view = kinshipTaskSpace.show(byId("space-section"), data, href);
  showExperience();
  showSolved();
  showChecks();
  showBenefit();
  showTables();
  return view;
};
