// What the experience of each robot is worth to each other one: a matrix of buttons, and a table of all its numbers.
"use strict";
kinshipFigures.worths = (element, data) => {
  const {make, count, fixed, listed, fillTable} = kinshipPage;
  const byId = kinshipPlots.fill(element, `
<header>
  <p class="eyebrow">Kinship transferability</p>
  <h1 id="title"></h1>
  <p id="lead" class="lead"></p>
</header>

<section>
  <h2>Worth of each source's experience to each target</h2>
  <p id="matrix-text"></p>
  <div id="scale" class="scale" role="img"></div>
  <div class="scroll" tabindex="0" role="region" aria-label="Worth of each source to each target"><table id="matrix" class="matrix"></table></div>
  <div id="detail" aria-live="polite"></div>
</section>

<section>
  <h2>Every pair in numbers</h2>
  <div class="scroll" tabindex="0" role="region" aria-label="Pairs of robots"><table id="pairs"></table></div>
  <ul class="note" id="remarks"></ul>
  <p class="note" id="pairs-note"></p>
</section>`);
  const {rows: pairs, task} = data;
  const targets = [...new Set(pairs.map((pair) => pair.target_label))];
  const sources = [...new Set(pairs.map((pair) => pair.source_label))];
  const pairOf = (target, source) => pairs.find((pair) => pair.target_label === target && pair.source_label === source);
  const bestOf = (target) => Math.max(0, ...pairs.filter((pair) => pair.target_label === target && pair.worth !== null).map((pair) => pair.worth));
  const isOwn = (pair) => pair.target === pair.source;

  // Blue saves, orange costs, in steps of lightness: told apart also by who sees few colours, and in grey. [from, text, shade, ink]
  const steps = [
    [0, "below 0.67", "#b35806", "#ffffff"], [0.67, "0.67 to 0.91", "#f1b16e", "#16202b"], [0.91, "0.91 to 1.1: no difference", "#e9ecf0", "#16202b"],
    [1.1, "1.1 to 1.5", "#b8d3ee", "#16202b"], [1.5, "1.5 to 2.5", "#6ba3d6", "#16202b"], [2.5, "2.5 and more", "#1d5b99", "#ffffff"]];
  const stepOf = (worth) => [...steps].reverse().find(([from]) => worth >= from);
  const shading = ([, , shade, ink]) => `--shade: ${shade}; --on-shade: ${ink}`;

  function costOf(pair, guide) {
    const cost = pair.rehearsal && pair.rehearsal.costs.find((each) => each.guide === guide);
    return cost || null;
  }
  const time = (cost) => (cost && cost.mean_time_s ? `${fixed(1e3 * cost.mean_time_s, 2)}\u2009ms` : "\u2013");
  const costs = (cost) => `${time(cost)}, ${count(cost.mean_checks)} checks in the mean, ${count(cost.solved)} of ${count(cost.plans)} plans solved`;

  /// What is known of a pair, in sentences.
  function sentences(pair) {
    const said = [`${pair.target_label} with the experience of ${isOwn(pair) ? "its own" : pair.source_label}: ` +
                  (pair.worth === null ? "not known." : `the best guide without experience takes ${fixed(pair.worth, 2)}\u2009\u00d7 as ` +
                    (pair.worth_by_time === null ? "many collision checks as the best with it." :
                      `long as the best with it; ${fixed(pair.worth_by_checks, 2)}\u2009\u00d7 as many collision checks.`))];
    const {rehearsal} = pair;
    if (rehearsal) {
      const without = costOf(pair, pair.without_experience), guided = costOf(pair, pair.with_experience);
      said.push(`${rehearsal.is_complete ? "Rehearsed" : "Being rehearsed"} on ${count(rehearsal.queries)} recorded ${rehearsal.queries === 1 ? "query" : "queries"}` +
        (rehearsal.left_out ? `; ${count(rehearsal.left_out)} left out, whose start or goal it cannot take where it stands.` : "."));
      if (without && guided)
        said.push(`With experience, ${pair.with_experience}: ${costs(guided)}. Without, ${pair.without_experience}: ${costs(without)}. Chosen: ${rehearsal.guide}.`);
    }
    if (pair.message) said.push(pair.message);
    return said;
  }

  function showDetail(pair, button) {
    for (const other of byId("matrix").querySelectorAll("button")) other.setAttribute("aria-pressed", String(other === button));
    byId("detail").replaceChildren(...sentences(pair).map((text) => make("p", {}, text)));
  }

  function cellOf(target, source) {
    const pair = pairOf(target, source);
    if (!pair) return "";
    const known = pair.worth !== null;
    const isBest = known && pair.worth === bestOf(target);
    const button = make("button", {
      type: "button", "aria-pressed": "false", class: [isOwn(pair) ? "own" : "", isBest ? "best" : "", known ? "" : "unknown"].filter(Boolean).join(" ") || null,
      style: known ? shading(stepOf(pair.worth)) : null,
      "aria-label": `${target} from ${source}: ${known ? fixed(pair.worth, 2) : "not known"}${isBest ? ", the best of its row" : ""}${isOwn(pair) ? ", its own experience" : ""}`,
      onclick: () => showDetail(pair, button), onfocus: () => showDetail(pair, button), onmouseenter: () => showDetail(pair, button)},
      known ? fixed(pair.worth, 2) + (isBest ? "*" : "") : "\u2013");
    return button;
  }

  byId("title").textContent = `Whose experience helps whom on \u201c${task}\u201d`;
  byId("lead").textContent = `Predicted before anybody planned with it: the server planned the recorded queries of ${listed(sources)} again for ${listed(targets)}, ` +
    "each time with the experience of one robot alone.";
  byId("matrix-text").textContent = "A row is a robot that plans, a column the robot that it learns from. The number is how many times the processor time of the best guide with experience " +
    "the best without any takes (uniform planning, or the retreat; means): above 1 the experience saves. * is the best of a row; a dashed frame is a robot\u2019s own experience; \u2013 is not known. " +
    "No query is helped by its own answer, in a robot\u2019s own cell neither: the path that once answered it is left out. Other paths of that robot stay, also to places nearby. Point at a cell, or step through them with Tab, for its counts.";
  byId("scale").append(...steps.map((step) => make("span", {style: shading(step)}, step[1])));
  byId("scale").setAttribute("aria-label", "Colours from orange, where the experience costs, over grey to dark blue, where it saves most.");
  fillTable(byId("matrix"), [["plans \\ teaches", ...sources], ...targets.map((target) => [target, ...sources.map((source) => cellOf(target, source))])]);
  byId("detail").append(make("p", {class: "note"}, "The counts of a cell appear here."));

  fillTable(byId("pairs"), [
    ["target", "source", "worth by time", "by checks", "without experience", "with", "queries", "left out", "time without", "with", "checks without", "with"],
    ...pairs.map((pair) => {
      const {rehearsal} = pair;
      if (!rehearsal) return [pair.target_label, pair.source_label, ...Array(10).fill("\u2013")];
      const without = costOf(pair, pair.without_experience), guided = costOf(pair, pair.with_experience);
      const checks = (cost) => (cost ? count(cost.mean_checks) : "\u2013");
      return [pair.target_label, pair.source_label, fixed(pair.worth_by_time, 2), fixed(pair.worth_by_checks, 2), pair.without_experience || "\u2013",
              pair.with_experience || "\u2013", count(rehearsal.queries), count(rehearsal.left_out), time(without), time(guided), checks(without), checks(guided)];
    })]);
  byId("pairs-note").textContent = "Time: processor time, checks: collision checks; means of all plans of a rehearsal; one that was not solved counts what it had spent. The guides are the " +
    "fastest without experience (none, retreat) and with it (ways of the hand, mixture). By checks each side has the guide with the fewest. A rehearsal is one draw of seeds over the queries that the source recorded.";
  byId("remarks").append(...pairs.filter((pair) => pair.message).map((pair) =>
    make("li", {}, `${pair.target_label} from ${pair.source_label}: ${pair.message}`)));
};
