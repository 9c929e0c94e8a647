// The dearest and the unsolved attempts of some time.
"use strict";
(() => {
  const {make, count, several, seconds, fillTiles} = kinshipPage;
  const {page, link, figure} = kinshipConsole;
  const periods = [["1", "an hour"], ["24", "a day"], ["168", "a week"]];
  const timeText = (ms) => new Date(ms).toISOString().slice(0, 19).replace("T", " ");
  const costOf = (a) => (a.record.processor_time_s > 0 ? a.record.processor_time_s : a.record.planning_time_s);

  const columns = [
    {title: "attempt", of: (a) => a.report_uuid, show: (a) => link("attempt", a.report_uuid, a.report_uuid.slice(0, 8)), kind: "text"},
    {title: "received, UTC", of: (a) => a.received_ms, show: (a) => timeText(a.received_ms), kind: "text"},
    {title: "task", of: (a) => a.task, show: (a) => link("task", a.task), kind: "text"},
    {title: "robot", of: (a) => a.label, show: (a) => link("robot", a.label || a.robot, a.label || a.robot.slice(0, 12)), kind: "text"},
    {title: "outcome", of: (a) => a.record.outcome, kind: "text"},
    {title: "time", of: costOf, show: (a) => seconds(costOf(a))},
    {title: "checks", of: (a) => a.record.collision_checks},
    {title: "mode", of: (a) => a.record.sampling_mode, kind: "text"},
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

  page({
    path: "/slow", title: "Slow and failed", nav: "Slow and failed",
    async show(element) {
      const tiles = make("div", {class: "tiles"});
      const told = make("p", {role: "status"});
      const sections = [["Unsolved", "unsolved"], ["Dearest of those solved", "dearest"], ["By task and robot", "pairs"]].map(([title, name]) => {
        const section = make("section", {}, make("h2", {}, title));
        const table = kinshipTables.show(section, {label: title, columns: name === "pairs" ? pairColumns : columns, empty: "None in that time.",
                                                   sort: name === "pairs" ? ["time in all", "descending"] : undefined});
        return {name, section, table};
      });
      const choice = make("div", {class: "tools choice", role: "group", "aria-label": "Time"}, ...periods.map(([hours, word]) =>
        make("button", {type: "button", "data-hours": hours, onclick: () => read(hours)}, "The last " + word.replace(/^an? /, ""))));
      element.append(make("header", {}, make("h1", {}, "Slow and failed"), told, choice, tiles), ...sections.map((each) => each.section));
      const read = async (hours) => {
        told.textContent = "reading \u2026";
        const data = await figure("slow", hours);
        for (const button of choice.children) button.setAttribute("aria-pressed", String(button.dataset.hours === hours));
        const unsolved = data.pairs.reduce((sum, pair) => sum + pair.unsolved, 0);
        told.textContent = `Since ${timeText(data.since_ms)} UTC` + (data.is_whole ? "." : `; the newest ${count(data.attempts)} attempts of it.`);
        tiles.replaceChildren();
        fillTiles(tiles, [[count(data.attempts), "attempts"], [count(unsolved), "of them unsolved"],
                          [seconds(data.pairs.reduce((sum, pair) => sum + pair.time_s, 0)), "planning time in all"], [count(data.pairs.length), "pairs of task and robot"]]);
        for (const {name, table} of sections) table.set(data[name]);
      };
      await read("24");
    }});
})();
