// A distribution: the hand over its robot, poses that were lost, others that are kept, joints, components, sources.
"use strict";
kinshipFigures.distribution = (element, data, {href = () => null} = {}) => {
  const {color, make, count, fixed, percent, seconds, several, listed, total, metres, fillTable, fillTiles} = kinshipPage;
  const byId = kinshipPlots.fill(element, `
<header>
  <p class="eyebrow">Kinship distribution</p>
  <h1 id="title"></h1>
  <p id="lead" class="lead"></p>
  <div id="tiles" class="tiles"></div>
</header>

<section>
  <h2>Where it is from</h2>
  <dl id="facts" class="facts"></dl>
</section>

<section>
  <h2>Where it puts the hand</h2>
  <p id="hands-text"></p>
  <p id="lost-text"></p>
  <figure id="hands"></figure>
  <div id="kept" class="sliders"></div>
  <p id="kept-text" class="note" role="status"></p>
</section>

<section>
  <h2>Joints</h2>
  <p id="joints-text"></p>
  <div id="joint-keys"></div>
  <div id="joints" class="panels"></div>
</section>

<section>
  <h2 id="components-title"></h2>
  <p id="components-text"></p>
  <div class="panels" id="components"></div>
</section>

<section>
  <h2>Sources</h2>
  <p id="sources-text"></p>
  <div id="source-keys"></div>
  <div id="poses" class="chart"></div>
  <div class="scroll" tabindex="0" role="region" aria-label="Sources"><table id="sources"></table></div>
  <p class="note" id="sources-note"></p>
</section>`);
  const {fillFacts, keys, panel, chart, timeText, hide} = kinshipPlots;
  const {distribution, label, components, marginals, postures} = data;
  const {sources, recommended_share: share, evidence} = distribution;
  const word = data.are_kernels ? "kernel" : "component";
  const {lost} = data;
  const own = {hands: data.hands, marginals};
  let shown = own; // by its samples: this distribution, or another that is kept
  const samplesOf = ({hands}) => hands.length / 3;
  const samples = samplesOf(own);
  const placement = distribution.T_task_base;

  function tell() {
    byId("title").textContent = `${label} on \u201c${distribution.task}\u201d`;
    const teachers = sources.filter((source) => source.configurations > 0);
    byId("lead").textContent = `Where a planner of ${label} should look first on the task \u201c${distribution.task}\u201d: a mixture of ` +
      `${several(data.mixture_size, word)} in ${several(marginals.length, "joint")}, fitted to ${several(distribution.configurations, "configuration")} ` +
      `that the experience of ${listed(teachers.map((source) => source.label)) || "nobody"} became.`;
    fillTiles(byId("tiles"), [
      [count(data.mixture_size), word + (data.mixture_size === 1 ? "" : "s")],
      [count(distribution.configurations), "configurations it was fitted to"],
      [count(total(sources.map((source) => source.paths_used))), `paths of ${several(teachers.length, "robot")} in it`],
      [fixed(share, 2), "share of samples to draw from it, as the server recommends now"]]);
  }

  function showFacts() {
    const selection = distribution.selection || {};
    fillFacts(byId("facts"), [
      ["Distribution", `${distribution.id.slice(0, 12)}, revision ${distribution.revision}, ${distribution.state}`],
      ["Robot", `${label}, ${distribution.robot.slice(0, 12)}`],
      ["Placement", placement ? `base at ${placement.map((n) => fixed(n, 3)).join(" ")} in the task\u2019s frame (x y z, quaternion x y z w; m)`
                              : "not given: the task\u2019s frame is that of the base"],
      ["Profile", distribution.profile],
      ["Engines", distribution.engines],
      ["Experience", [selection.weighting ? "weighting " + selection.weighting : "",
                      selection.since_ms ? "received since " + timeText(selection.since_ms) : "",
                      selection.sources && selection.sources.length ? "only of " + selection.sources.map((id) => id.slice(0, 12)).join(", ") : ""]
                       .filter(Boolean).join("; ")],
      ["Made", `${timeText(distribution.fitted_ms)}; transfer ${seconds(distribution.transfer_time_s)}, fit ${seconds(distribution.fit_time_s)}`],
      ["Share", `${fixed(share, 2)}${evidence ? ": " + evidence : ""}`],
      ["Filters", distribution.filters],
      ["Shapes", data.shapes],
      ["Note", distribution.reason]]);
  }

  function showHands() {
    byId("hands-text").textContent = `The transfer frame, in the palm, in ${count(samples)} configurations drawn from the distribution (one dot each; ` +
      `seeded, within the limits), in the frame of the ${placement ? "task" : "robot\u2019s base"}. The arm stands in the mean of its ${
      postures.length > 1 ? `${postures.length} heaviest ${word}s, of weight ${listed(postures.map((p) => percent(p.weight)))}` : `only ${word}`}: ` +
      "means are not samples, and nothing of a scene is drawn.";
    const low = [0, 1, 2].map((axis) => Math.min(...data.hands.filter((n, i) => i % 3 === axis)));
    const high = [0, 1, 2].map((axis) => Math.max(...data.hands.filter((n, i) => i % 3 === axis)));
    return kinshipView.show(byId("hands"), {
      label: `${count(samples)} dots where the hand of ${label} is in samples, between ` +
        `${listed(["x", "y", "z"].map((axis, i) => `${axis} ${fixed(low[i] / 1000, 2)} and ${fixed(high[i] / 1000, 2)} m`))}, over the arm.`,
      from: [-1, -1.5, 0.8],
      layers: [
        {name: "first", text: `${label} in the heaviest mean`, color: "arm", arms: postures.slice(0, 1).map(({bones}) => ({bones}))},
        ...(postures.length > 1 ? [{name: "others", text: "in the next ones", color: "scene", arms: postures.slice(1).map(({bones}) => ({bones, opacity: 0.35}))}] : []),
        {name: "samples", text: "hand, one dot a sample", color: "sample", points: cloud(own)},
        ...lostLayers()]});
  }

  const cloud = ({hands}) => [{positions: metres(hands), size: 0.024, opacity: 0.85}];

  /// By Loss: what became of a pose, and the layer that shows it.
  const losses = [["out of reach", "unreached"], ["outside limits", "unreached"], ["not converged", "unreached"], ["colliding", "colliding"]];
  const numberLost = (layer) => total(lost.sources.flatMap((source) => source.lost.filter((n, why) => losses[why][1] === layer)));

  function lostLayers() {
    const layer = (name, text, hue) => ({
      name, text: numberLost(name) ? `${text} (${count(numberLost(name))})` : "", color: hue,
      points: [{positions: metres(lost.places.filter((places, why) => losses[why][1] === name).flat()), size: 0.055, opacity: 0.95}]});
    return [layer("unreached", "poses not reached", "blocking"), layer("colliding", "poses reached in collision only", "path")];
  }

  function tellLost() {
    const searched = lost.sources.filter((source) => source.poses > 0), takenOver = lost.sources.filter((source) => source.taken_over > 0);
    const parts = losses.map(([text], why) => [total(searched.map((source) => source.lost[why])), text]).filter(([n]) => n > 0);
    const poses = total(searched.map((source) => source.poses));
    byId("lost-text").textContent = lost.problem ? `Which poses its transfer lost is not shown: ${lost.problem}.`
      : (poses ? `Red: poses of the sources’ paths that ${label} cannot take. Of ${several(poses, "pose")} of the newest paths (${
        listed(searched.map((source) => `${count(source.paths)} of ${source.label}`))}) ` +
        (parts.length ? `${listed(parts.map(([n, text]) => `${count(n)} ${n === 1 ? "is" : "are"} ${text}`))}. ` : "none is lost. ") +
        "The server keeps numbers (see Sources), not poses: these were searched anew for this page, without the tracks of a transfer, which reach a few more. " : "") +
        (takenOver.length ? `Paths of ${listed(takenOver.map((source) => source.label))} were taken over as they are, so nothing of them is lost.` : "");
    if (numberLost("colliding")) byId("lost-text").append(" Orange: every configuration found touches the robot itself or the recorded scene.");
  }

  /// A slider over what is kept of the same robot, task and placement.
  function showKept(view) {
    const {kept} = data, at = kept.findIndex(({summary}) => summary.id === distribution.id);
    const former = distribution.revision > 1 ? ` Of the ${several(distribution.revision - 1, "revision")} before this one, attempts name ${
      distribution.revision === 2 ? "its number" : "their numbers"}, and nothing else is kept.` : "";
    if (kept.length < 2 || at < 0) {
      byId("kept-text").textContent = "The server keeps the newest revision of a distribution, and no other distribution of this robot, task and placement." + former;
      return;
    }
    const describe = ({summary, engines}, i) => `${i + 1} of ${kept.length}: ${summary.id.slice(0, 12)}, revision ${summary.revision}` +
      `${i === at ? " (this page\u2019s)" : ""}, profile \u201c${summary.profile}\u201d, made ${timeText(summary.fitted_ms)} of ${several(summary.paths, "path")}, ` +
      `${several(summary.components, "component")}; ${engines}.`;
    const tell = (i) => {
      byId("kept-text").replaceChildren(describe(kept[i], i), i !== at && href("distribution", kept[i].summary.id)
        ? make("span", {}, " ", make("a", {href: href("distribution", kept[i].summary.id)}, "Its page")) : "",
        ` The server keeps the newest revision of each distribution: the slider goes over those of this robot, task and placement, by the time of their fits.${former}` +
        (i === at ? "" : " The arm, weights and sources are still those of this page\u2019s distribution."));
    };
    const output = make("output", {}, `${at + 1} of ${kept.length}`);
    const input = make("input", {type: "range", min: "0", max: String(kept.length - 1), value: String(at), "aria-label": "Kept distribution", oninput: () => {
      const i = Number(input.value);
      shown = i === at ? own : kept[i];
      output.textContent = `${i + 1} of ${kept.length}`;
      input.setAttribute("aria-valuetext", describe(kept[i], i));
      view.replace("samples", {points: cloud(shown), text: i === at ? "hand, one dot a sample" : `hand, by ${kept[i].summary.id.slice(0, 12)}`});
      redrawJoints();
      tell(i);
    }});
    byId("kept").append(make("label", {}, make("span", {}, "Distributions kept, the oldest fit first"), output, input));
    tell(at);
  }

  /// More of the samples than this in the outermost fiftieth of a joint's range: somebody should see it.
  const kCrowded = 0.05;

  function jointNote(marginal) {
    if (marginal.cut !== null) return `continuous: no limits; its circle is cut at ${fixed(marginal.cut, 2)} rad`;
    const drawn = samplesOf(shown);
    const [low, high] = [marginal.counts[0] / drawn, marginal.counts[marginal.counts.length - 1] / drawn];
    const said = [[low, "lower"], [high, "upper"]].filter(([part]) => part > kCrowded)
      .map(([part, side]) => `${percent(part)} of the samples at the ${side} limit`);
    return said.length ? said.join(", ") : "";
  }

  function jointSpec(marginal) {
    const width = (marginal.upper - marginal.lower) / marginal.counts.length, drawn = samplesOf(shown);
    const bins = marginal.counts.map((n, i) => ({
      from: marginal.lower + i * width, to: marginal.lower + (i + 1) * width, part: n / drawn,
      hue: marginal.cut === null && (i === 0 || i === marginal.counts.length - 1) && n / drawn > kCrowded ? "limit" : "sample"}));
    const margin = 0.03 * (marginal.upper - marginal.lower);
    const ends = marginal.cut === null ? [{at: marginal.lower, dash: [1, 0]}, {at: marginal.upper, dash: [1, 0]}] : [{at: marginal.cut, dash: [4, 3]}];
    return {
      height: 128,
      data: [{name: "bins", values: bins}, {name: "ends", values: ends}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: [marginal.lower - margin, marginal.upper + margin], nice: false, zero: false},
        {name: "y", type: "linear", range: "height", domain: {data: "bins", field: "part"}, nice: true, zero: true}],
      axes: [
        {orient: "left", scale: "y", grid: true, tickCount: 3, format: ".0%"},
        {orient: "bottom", scale: "x", tickCount: 6, title: marginal.unit}],
      marks: [
        {type: "rect", from: {data: "bins"}, encode: {update: {
          x: {scale: "x", field: "from"}, x2: {scale: "x", field: "to", offset: -0.5}, y: {scale: "y", field: "part"}, y2: {scale: "y", value: 0},
          fill: {signal: `datum.hue === 'limit' ? '${color("limit")}' : '${color("sample")}'`},
          tooltip: {signal: "format(datum.from, '.2f') + ' to ' + format(datum.to, '.2f') + ': ' + format(datum.part, '.1%')"}}}},
        {type: "rule", from: {data: "ends"}, encode: {update: {
          x: {scale: "x", field: "at"}, y: {value: 0}, y2: {signal: "height"}, stroke: {value: color("limit")}, strokeWidth: {value: 1.5},
          strokeDash: {field: "dash"}}}}]};
  }

  function showJoints() {
    byId("joints-text").textContent = `Each joint alone, in the same ${count(samples)} samples: share of the samples in each of ` +
      `${marginals[0].counts.length} equal bins between the joint\u2019s limits. Each panel has a scale of its own.`;
    byId("joint-keys").append(keys([
      ["sample", "samples", "block"],
      ["limit", `limit; bars of this colour: more than ${percent(kCrowded)} of the samples within a fiftieth of the range at a limit`],
      ...(marginals.some((m) => m.cut !== null) ? [["limit", "cut of a continuous joint", "dashed"]] : [])]));
    marginals.forEach((marginal, i) => {
      const figure = panel(marginal.joint, " ");
      byId("joints").append(figure.panel);
      jointPanels.push({...figure, drawn: chart(figure.chart, "", () => jointSpec(shown.marginals[i]))});
    });
    tellJoints();
  }

  const jointPanels = [];

  function tellJoints() {
    jointPanels.forEach((figure, i) => {
      const marginal = shown.marginals[i], note = jointNote(marginal);
      const most = marginal.counts.indexOf(Math.max(...marginal.counts));
      const at = marginal.lower + (most + 0.5) * (marginal.upper - marginal.lower) / marginal.counts.length;
      figure.panel.querySelector(".note").textContent = note;
      figure.chart.setAttribute("aria-label", `Joint ${marginal.joint}, ${fixed(marginal.lower, 2)} to ${fixed(marginal.upper, 2)} ${marginal.unit}: most samples ` +
        `near ${fixed(at, 2)} ${marginal.unit}${note ? "; " + note : ""}.`);
    });
  }

  /// Once for all changes before the next picture.
  let joints = 0;
  function redrawJoints() {
    cancelAnimationFrame(joints);
    joints = requestAnimationFrame(() => {
      for (const figure of jointPanels) figure.drawn.draw();
      tellJoints();
    });
  }

  /// Digits behind the point with which the ticks of small weights differ.
  const weightDigits = Math.max(0, Math.min(4, Math.ceil(-Math.log10(components[0][0])) - 1));

  function weightSpec() {
    const values = components.map(([weight], i) => ({rank: i + 1, weight}));
    return {
      height: 180, data: [{name: "rows", values}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: [0.5, components.length + 0.5], nice: false, zero: false},
        {name: "y", type: "linear", range: "height", domain: {data: "rows", field: "weight"}, nice: true, zero: true}],
      axes: [
        {orient: "left", scale: "y", grid: true, tickCount: 4, format: `.${weightDigits}%`, title: "weight"},
        {orient: "bottom", scale: "x", tickCount: 6, tickMinStep: 1, format: "d", labelOverlap: true, title: word + "s, heaviest first"}],
      marks: [{type: "rect", from: {data: "rows"}, encode: {update: {
        x: {signal: "scale('x', datum.rank - 0.42)"}, x2: {signal: "scale('x', datum.rank + 0.42)"}, y: {scale: "y", field: "weight"},
        y2: {scale: "y", value: 0}, fill: {value: color("sample")},
        tooltip: {signal: "'" + word + " ' + datum.rank + ': ' + format(datum.weight, '.2%')"}}}}]};
  }

  function cumulatedSpec() {
    const values = [{rank: 0, share: 0}, ...components.map(([, share], i) => ({rank: i + 1, share}))];
    return {
      height: 180, data: [{name: "rows", values}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: [0, components.length], nice: false, zero: true},
        {name: "y", type: "linear", range: "height", domain: [0, 1]}],
      axes: [
        {orient: "left", scale: "y", grid: true, tickCount: 5, format: ".0%", title: "cumulated weight"},
        {orient: "bottom", scale: "x", tickCount: 6, tickMinStep: 1, format: "d", labelOverlap: true, title: `so many of the heaviest ${word}s`}],
      marks: [{type: "line", from: {data: "rows"}, encode: {update: {
        x: {scale: "x", field: "rank"}, y: {scale: "y", field: "share"}, stroke: {value: color("sample")}, strokeWidth: {value: 2.5}}}}]};
  }

  function curveSpec(curve, best) {
    return {
      height: 180,
      data: [{name: "rows", values: [...curve].sort((a, b) => a.K - b.K)}, {name: "best", values: [best]}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: {data: "rows", field: "K"}, nice: true, zero: true},
        {name: "y", type: "linear", range: "height", domain: {data: "rows", field: "score"}, nice: true, zero: false}],
      axes: [
        {orient: "left", scale: "y", grid: true, tickCount: 5, title: "held-out score, nats"},
        {orient: "bottom", scale: "x", tickCount: 6, tickMinStep: 1, format: "d", labelOverlap: true, title: "components K"}],
      marks: [
        {type: "line", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "K"}, y: {scale: "y", field: "score"}, stroke: {value: color("soft")}, strokeWidth: {value: 1.5}}}},
        {type: "symbol", from: {data: "rows"}, encode: {update: {
          x: {scale: "x", field: "K"}, y: {scale: "y", field: "score"}, size: {value: 28}, fill: {value: color("soft")},
          tooltip: {signal: "'K ' + datum.K + ': ' + format(datum.score, '.4f')"}}}},
        {type: "rule", from: {data: "best"}, encode: {update: {
          x: {scale: "x", field: "K"}, y: {scale: "y", field: "score"}, y2: {signal: "height"}, stroke: {value: color("accent")}, strokeDash: {value: [3, 3]}}}},
        {type: "symbol", from: {data: "best"}, encode: {update: {
          x: {scale: "x", field: "K"}, y: {scale: "y", field: "score"}, size: {value: 90}, fill: {value: color("accent")}}}},
        {type: "text", from: {data: "best"}, encode: {update: {
          x: {scale: "x", field: "K"}, y: {signal: "height - 6"}, dx: {value: 6}, text: {signal: "'chosen: ' + datum.K"},
          fill: {value: color("ink")}, font: {value: kinshipCharts.font}, fontSize: {value: 13}}}}]};
  }

  function showComponents() {
    const needed = (part) => components.findIndex(([, cumulated]) => cumulated >= part) + 1;
    const cutOff = components.length < data.mixture_size ? ` Shown are the heaviest ${components.length} of ${count(data.mixture_size)}.` : "";
    byId("components-title").textContent = data.are_kernels ? "Kernels" : "Components";
    byId("components-text").textContent = (needed(0.9) > 0
      ? `Half of the weight is in ${several(needed(0.5), word)}, nine tenths in ${count(needed(0.9))} of ${count(data.mixture_size)}.`
      : `The heaviest ${components.length} have ${percent(components[components.length - 1][1])} of the weight.`) + cutOff;
    const add = (title, text, label, spec) => {
      const figure = panel(title, text);
      byId("components").append(figure.panel);
      chart(figure.chart, label, spec);
    };
    add("Weights", "", `Weights of the ${word}s, falling from ${percent(components[0][0])}.`, weightSpec);
    add("Cumulated", "", `Cumulated weight: ${byId("components-text").textContent}`, cumulatedSpec);
    const curve = distribution.k_curve || [];
    if (curve.length === 0) {
      byId("components").append(make("p", {class: "note"}, "No curve of scores: the number was not chosen by held-out paths" +
        (data.are_kernels ? " (kernels)." : ` (profile \u201c${distribution.profile}\u201d, or too few paths).`)));
      return;
    }
    const best = curve.reduce((a, b) => (b.score > a.score ? b : a)); // the first of the highest, as the server chose
    const fit = distribution.fit && distribution.fit.from_revision > 0 ? `, at the full fit of revision ${distribution.fit.full_revision}` : "";
    add("How many were tried", `Mean score of configurations of held-out paths${fit}; the highest was chosen: ${best.K}.` +
      (best.K === data.mixture_size ? "" : ` The mixture, fitted to all paths, has ${count(data.mixture_size)}.`),
      `Held-out score over the number of components: ${several(curve.length, "number")} tried, from ${curve[curve.length - 1].K} to ${curve[0].K}; ` +
      `${best.K} was chosen with ${fixed(best.score, 3)} nats.`, () => curveSpec(curve, best));
  }

  const fates = [["poses_solved", "solved", "sample"], ["out_of_reach", "out of reach", "lost-0"], ["outside_limits", "outside limits", "lost-1"],
                 ["not_converged", "not converged", "lost-2"], ["colliding", "every solution left out by filters", "lost-3"]];

  function posesSpec() {
    const rows = sources.filter((source) => source.poses > 0).flatMap((source) => {
      let from = 0;
      return fates.map(([name, text, hue]) => {
        const row = {source: source.label, from: from / source.poses, to: (from + source[name]) / source.poses, n: source[name], text, hue: color(hue)};
        from += source[name];
        return row;
      });
    });
    const names = [...new Set(rows.map((row) => row.source))];
    return {
      height: 34 * names.length, data: [{name: "rows", values: rows}],
      scales: [
        {name: "x", type: "linear", range: "width", domain: [0, 1]},
        {name: "y", type: "band", range: "height", domain: names, padding: 0.3}],
      axes: [
        {orient: "bottom", scale: "x", format: ".0%", tickCount: 6, grid: true, title: "of the poses of each source"},
        {orient: "left", scale: "y", labelColor: color("ink"), labelFontSize: 13}],
      marks: [{type: "rect", from: {data: "rows"}, encode: {update: {
        x: {scale: "x", field: "from"}, x2: {scale: "x", field: "to"}, y: {scale: "y", field: "source"}, height: {scale: "y", band: 1},
        fill: {field: "hue"}, tooltip: {signal: "datum.source + ': ' + datum.n + ' poses ' + datum.text"}}}}]};
  }

  function showSources() {
    const part = (n, of) => (of ? percent(n / of) : "\u2013");
    byId("sources-text").textContent = "What became of the poses of each robot\u2019s paths: poses of the hand that this robot could take, and why not.";
    if (sources.some((source) => source.poses > 0)) {
      byId("source-keys").append(keys(fates.map(([, text, hue]) => [hue, text, "block"])));
      chart(byId("poses"), "Poses of each source by what became of them; the numbers are in the table below.", posesSpec);
    } else hide(byId("poses"));
    fillTable(byId("sources"), [
      ["robot", "relation", "paths used", "known", "poses", "solved", "configurations", "mass", "tracks kept", "self-colliding", "in recorded scene"],
      ...sources.map((s) => [s.label, s.relation, count(s.paths_used), count(s.paths), count(s.poses), part(s.poses_solved, s.poses),
                             count(s.configurations), percent(s.mass), s.tracks_tried ? `${count(s.tracks_kept)} of ${count(s.tracks_tried)}` : "\u2013",
                             part(s.self_collisions, s.filter_checks), part(s.scene_collisions, s.filter_checks)])]);
    byId("sources-note").textContent = "Mass: share of the weight of all configurations. Tracks: continuous families of solutions along a path. " +
      "Self-colliding, in recorded scene: of the configurations that the filters were asked about, those left out.";
  }

  tell();
  showFacts();
  tellLost();
  const view = showHands();
  showKept(view);
  showJoints();
  showComponents();
  showSources();
  return view;
};
