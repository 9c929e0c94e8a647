// The slowest and the unsolved attempts of some time, each with its reason.
"use strict";
(() => {
  const {make, count, fixed, percent, seconds, fillTiles} = kinshipPage;
  const {page, link, rows, figure} = kinshipConsole;
  const periods = [["1", "hour"], ["24", "day"], ["168", "week"]];
  const kUnsolved = 200, kSlowest = 50; // that are shown
  const timeText = (ms) => new Date(ms).toISOString().slice(0, 19).replace("T", " ");
  const isSolved = (a) => a.record.outcome === "solved";

  /// What the planner's options say of the gate, which draws uniformly where a distribution is far from the query.
  const gateText = (options) => (/\bgate=fired\b/.test(options) ? ", by its gate uniform" : "");
  const samplingText = ({sampling_mode: mode, share, outcome, planner_options: options}) =>
    outcome === "failed" && mode !== "guided" ? "none" : (mode === "guided" ? `guided, ${percent(share)}` : mode) + gateText(options);
  const timeOf = ({planning_time_s: time, time_limit_s: limit}) => seconds(time) + (limit ? ` of ${fixed(limit, limit < 10 ? 1 : 0)}\u202fs` : "");

  function checksOf({collision_checks: checks, planner_options: options}) {
    const [, most] = /\bmax_checks=(\d+)/.exec(options) || [];
    return count(checks) + (most ? ` of ${count(Number(most))}` : "");
  }

  /// Why an attempt failed, or took long: its search record's words, else what is known without one.
  function whyOf(a, meanOf) {
    const mean = meanOf(a);
    const times = isSolved(a) && mean > 0 ? `${fixed(a.record.planning_time_s / mean, 1)} times the mean of its task and robot` : "";
    const outcome = a.record.outcome === "timeout" ? "its time was over" : a.record.outcome === "failed" ? "could not be planned" : "";
    return [times, a.why || outcome, a.has_search || isSolved(a) ? "" : "no search record"].filter(Boolean).join("; ");
  }

  const columns = (meanOf) => [
    {title: "attempt", of: (a) => a.report_uuid, show: (a) => link("attempt", a.report_uuid, a.report_uuid.slice(0, 8)), kind: "text"},
    {title: "why", of: (a) => whyOf(a, meanOf), kind: "reason"},
    {title: "task", of: (a) => a.task, show: (a) => link("task", a.task), kind: "text"},
    {title: "robot", of: (a) => a.label, show: (a) => link("robot", a.label || a.robot, a.label || a.robot.slice(0, 12)), kind: "text"},
    {title: "time", of: (a) => a.record.planning_time_s, show: (a) => timeOf(a.record)},
    {title: "checks", of: (a) => a.record.collision_checks, show: (a) => checksOf(a.record)},
    {title: "sampling", of: (a) => samplingText(a.record), kind: "text"},
    {title: "received, UTC", of: (a) => a.received_ms, show: (a) => timeText(a.received_ms), text: (a) => timeText(a.received_ms), kind: "text"},
    {title: "planner", of: (a) => a.record.planner, kind: "text"},
    {title: "machine", of: (a) => a.machine, kind: "text"}];

  const pairColumns = [
    {title: "task", of: (p) => p.task, show: (p) => link("task", p.task), kind: "text"},
    {title: "robot", of: (p) => p.robot, show: (p) => link("robot", p.robot), kind: "text"},
    {title: "attempts", of: (p) => p.attempts},
    {title: "unsolved", of: (p) => p.unsolved},
    {title: "unsolved, %", of: (p) => 100 * p.unsolved / p.attempts, show: (p) => Math.round(100 * p.unsolved / p.attempts) + "\u202f%"},
    {title: "time in all", of: (p) => p.time_s, show: (p) => seconds(p.time_s)},
    {title: "time each", of: (p) => p.time_s / p.attempts, show: (p) => seconds(p.time_s / p.attempts)}];

  /// A choice of one of the names that the attempts have, or all.
  function chooser(word, chosen, onchange) {
    const select = make("select", {"aria-label": `Only of this ${word}`, onchange: () => onchange(select.value)});
    const fill = (names) => select.replaceChildren(make("option", {value: ""}, `all ${word}s`),
      ...[...new Set([...names, ...(chosen ? [chosen] : [])])].sort().map((name) => make("option", {value: name, selected: name === chosen}, name)));
    fill([]);
    return {element: select, fill(names) { chosen = select.value; fill(names); }};
  }

  page({
    path: "/slow", title: "Slow and failed", nav: "Slow and failed",
    async show(element) {
      const given = new URLSearchParams(location.search);
      const wanted = {hours: periods.some(([hours]) => hours === given.get("hours")) ? given.get("hours") : "24", task: given.get("task") || "", robot: given.get("robot") || ""};
      let means = new Map();
      const keyOf = (task, robot) => JSON.stringify([task, robot]);
      const meanOf = (a) => means.get(keyOf(a.task, a.label)) || 0;
      const tiles = make("div", {class: "tiles"});
      const told = make("p", {role: "status"});
      const listOf = (title, shown, empty, sort) => {
        const section = make("section", {}, make("h2", {}, title));
        return {section, table: kinshipTables.show(section, {label: title, columns: shown, empty, sort})};
      };
      const unsolved = listOf("Unsolved", columns(meanOf), "None in that time.");
      const slowest = listOf("Slowest of those solved", columns(meanOf), "None in that time.");
      const pairs = listOf("By task and robot", pairColumns, "None in that time.", ["time in all", "descending"]);
      const set = (name, value) => {
        wanted[name] = value;
        history.replaceState(null, "", "?" + new URLSearchParams(Object.entries(wanted).filter(([, each]) => each)));
        read();
      };
      const tasks = chooser("task", wanted.task, (task) => set("task", task)), robots = chooser("robot", wanted.robot, (robot) => set("robot", robot));
      const choice = make("div", {class: "tools choice", role: "group", "aria-label": "Time and kind"}, ...periods.map(([hours, word]) =>
        make("button", {type: "button", "data-hours": hours, onclick: () => set("hours", hours)}, "The last " + word)), tasks.element, robots.element);
      element.append(make("header", {}, make("h1", {}, "Slow and failed"), told, choice, tiles), unsolved.section, slowest.section, pairs.section);
      let reading = 0; // only the last answer is shown

      async function read() {
        const own = ++reading;
        told.textContent = "reading \u2026";
        for (const button of choice.querySelectorAll("button")) button.setAttribute("aria-pressed", String(button.dataset.hours === wanted.hours));
        try {
          const data = await figure("slow", wanted.hours);
          const ask = (filter, most) => rows("find_attempts", {argument: `since_ms=${data.since_ms},${filter}`, task: wanted.task, robot: wanted.robot}, most);
          const [failed, solved] = await Promise.all([ask("outcome=unsolved", kUnsolved), ask("outcome=solved,order=slowest", kSlowest)]);
          if (own !== reading) return;
          const kept = data.pairs.filter((pair) => (!wanted.task || pair.task === wanted.task) && (!wanted.robot || pair.robot === wanted.robot));
          means = new Map(data.pairs.map((pair) => [keyOf(pair.task, pair.robot), pair.time_s / pair.attempts]));
          tasks.fill(data.pairs.map((pair) => pair.task));
          robots.fill(data.pairs.map((pair) => pair.robot));
          const sum = (of) => kept.reduce((all, pair) => all + of(pair), 0);
          told.textContent = `Since ${timeText(data.since_ms)} UTC` + (data.is_whole ? "." : `; the newest ${count(data.attempts)} attempts of it.`) +
            (failed.length === kUnsolved ? ` Of the unsolved, the newest ${kUnsolved}.` : "");
          tiles.replaceChildren();
          fillTiles(tiles, [[count(sum((pair) => pair.attempts)), "attempts"], [count(sum((pair) => pair.unsolved)), "of them unsolved"],
                            [seconds(sum((pair) => pair.time_s)), "planning time in all"], [count(kept.length), "pairs of task and robot"]]);
          unsolved.table.set(failed);
          slowest.table.set(solved);
          pairs.table.set(kept);
        } catch (error) {
          if (own === reading) told.textContent = error.message;
        }
      }
      await read();
    }});
})();
