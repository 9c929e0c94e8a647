// The fleet now: rates, latency, refusals, what guidance saves, store, events.
"use strict";
(() => {
  const {make, count, fixed, seconds, fillTiles} = kinshipPage;
  const {page, link, figure} = kinshipConsole;
  const kEvents = 200; // that are kept in the page
  const periods = [["1", "hour"], ["24", "day"], ["720", "month"]];

  const bytes = (n) => {
    const power = n > 0 ? Math.min(4, Math.floor(Math.log10(n) / 3)) : 0;
    return fixed(n / 1000 ** power, power ? 1 : 0) + "\u202f" + ["B", "kB", "MB", "GB", "TB"][power];
  };
  const perSecond = (n) => fixed(n, n < 10 ? 1 : 0) + "\u202f/\u202fs";
  const timeText = (ms) => new Date(ms).toISOString().slice(11, 19);

  /// The time within which a part of what was counted between two readings of a histogram fell: a bucket's end.
  function quantile(now, before, part) {
    const counts = now.counts.map((n, i) => n - before.counts[i]);
    const sum = counts.reduce((a, b) => a + b, 0);
    if (sum <= 0) return null;
    let below = 0;
    const bucket = counts.findIndex((n) => (below += n) >= part * sum);
    return now.bounds_s[Math.min(bucket, now.bounds_s.length - 1)];
  }

  /// \param unsolved  attempts of the last day; null: not known yet.
  function tilesOf({status, disk}, unsolved) {
    return [[count(status.robots), "robots"], [count(status.tasks), "tasks"], [count(status.paths), "paths"], [count(status.attempts), "attempts"],
            ...(unsolved === null ? [] : [[count(unsolved), "attempts of the last day unsolved"]]),
            [count(status.distributions), "distributions"],
            [bytes(status.store_bytes), disk ? `of store; ${bytes(disk.free)} free` : "of store"]];
  }

  /// What needs a person, first.
  function warningsOf({status, message}) {
    if (message) return [message];
    return [status.writable ? null : "Reports are put off: " + status.storage_message,
            status.upstream && !status.upstream.connected ? `The memory above does not answer: ${status.upstream.message}` : null].filter(Boolean);
  }

  function showStoreFacts(list, {status}) {
    const facts = [["store", status.store_file], ["version", status.version], ["up since", new Date(Date.now() - 1000 * status.uptime_s).toISOString().slice(0, 19).replace("T", " ") + " UTC"],
                   ["waiting", `${count(status.queued_reports)} reports, ${count(status.queued_fits)} fits, ${count(status.jobs)} jobs`],
                   ["followed", `${count(status.followed)} distributions`]];
    if (status.storage_message) facts.push(["note", status.storage_message]);
    if (status.upstream) facts.push(["memory above", `${status.upstream.name}: ${status.upstream.connected ? "connected" : "not connected"}, ${count(status.upstream.waiting)} reports wait, ${count(status.upstream.sent)} sent, ${count(status.upstream.received)} received`]);
    for (const replica of status.replicas || []) facts.push(["replica " + replica.host, replica.message || `${count(replica.readings)} readings, ${count(replica.behind)} behind, ${count(replica.failed)} failed`]);
    list.replaceChildren(...facts.flatMap(([term, text]) => [make("dt", {}, term), make("dd", {}, text)]));
  }

  function showEvents(section) {
    const list = make("ol", {class: "events", tabindex: "0", role: "log", "aria-label": "Events", "aria-live": "off"});
    const pause = make("button", {type: "button", "aria-pressed": "false", onclick: () => pause.setAttribute("aria-pressed", String(pause.getAttribute("aria-pressed") === "false"))}, "Pause");
    section.append(make("div", {class: "tools"}, pause), list);
    return (event) => {
      if (pause.getAttribute("aria-pressed") === "true") return;
      list.prepend(make("li", {class: event.kind}, make("time", {}, timeText(event.time_ms)), make("b", {}, event.kind),
        ...(event.task ? [link("task", event.task), " "] : []), ...(event.robot ? [link("robot", event.robot), " "] : []), event.text));
      while (list.children.length > kEvents) list.lastChild.remove();
    };
  }

  function showSavings(section) {
    const told = make("p", {role: "status"}, "");
    const choice = make("div", {class: "tools choice", role: "group", "aria-label": "Time"}, ...periods.map(([hours, word]) =>
      make("button", {type: "button", "data-hours": hours, onclick: () => read(hours)}, "The last " + word)));
    section.append(told, choice);
    const table = kinshipTables.show(section, {
      label: "What guidance saves", empty: "No guided attempt in that time.", sort: ["saved", "descending"],
      columns: [{title: "task", of: (p) => p.task, show: (p) => link("task", p.task), kind: "text"}, {title: "robot", of: (p) => p.robot, show: (p) => link("robot", p.robot), kind: "text"},
        {title: "guided", of: (p) => p.guided}, {title: "control", of: (p) => p.control},
        {title: "uniform / guided, 90 %", of: (p) => p.ratio || 0, show: (p) => (p.ratio === null ? "not known yet" : `${fixed(p.ratio, 2)} (${fixed(p.low, 2)} to ${fixed(p.high, 2)})`)},
        {title: "saved", of: (p) => p.saved_s || 0, show: (p) => (p.saved_s === null ? null : p.saved_s < 0 ? "\u2212" + seconds(-p.saved_s) : seconds(p.saved_s))}]});
    let chosen = "24";
    async function read(hours) {
      chosen = hours;
      try {
        const data = await figure("savings", hours);
        for (const button of choice.children) button.setAttribute("aria-pressed", String(button.dataset.hours === hours));
        told.textContent = "Processor time that guided queries saved, against the mean of those that planned uniformly to compare; from ten of each on." +
          (data.is_whole ? "" : ` Of the newest ${count(data.attempts)} attempts.`);
        table.set(data.pairs);
      } catch (error) {
        told.textContent = error.message;
      }
    }
    read(chosen);
    return setInterval(() => read(chosen), 60000);
  }

  page({
    path: "/", title: "Fleet", nav: "Fleet",
    show(element) {
      const section = (title) => make("section", {}, make("h2", {}, title));
      const [rates, latency, savings, refusals, store, events] =
        ["Reports and fetches", "Receipts", "What guidance saves", "Refusals", "Server and store", "Events"].map(section);
      const tiles = make("div", {class: "tiles", id: "tiles"});
      const warnings = make("div", {role: "alert"});
      element.append(make("header", {}, make("h1", {}, "Fleet"), warnings, tiles), make("div", {class: "grid"}, rates, latency, savings, refusals, store, events));
      const rateSeries = kinshipSeries.show(rates, {label: "Reports and fetches a second", text: perSecond, least: 1,
        lines: [{name: "attempts reported", color: "guided"}, {name: "fetches", color: "robot-1"}]});
      const latencySeries = kinshipSeries.show(latency, {label: "From a batch of reports to its receipts", text: seconds, least: 0.001,
        lines: [{name: "median", color: "guided"}, {name: "95 %", color: "goal"}]});
      const refusalTable = kinshipTables.show(refusals, {label: "Refusals by reason", empty: "Nothing was refused since the start.",
        columns: [{title: "reason", of: (t) => t.what, kind: "text"}, {title: "count", of: (t) => t.count}, {title: "last, UTC", of: (t) => t.last_ms, show: (t) => timeText(t.last_ms), kind: "text"},
                  {title: "the last one", of: (t) => t.last, kind: "long"}]});
      const facts = make("dl", {class: "facts"});
      store.append(facts);
      const tellEvent = showEvents(events);
      const timer = showSavings(savings);
      let before = null, toldRefusals = "", unsolved = null;
      async function readUnsolved() {
        try {
          unsolved = (await figure("slow", "24")).pairs.reduce((all, pair) => all + pair.unsolved, 0);
        } catch (error) {
          unsolved = null;
        }
        if (before) status(before);
      }
      readUnsolved();
      const unsolvedTimer = setInterval(readUnsolved, 60000);
      function status(now) {
        warnings.replaceChildren(...warningsOf(now).map((text) => make("p", {class: "alarm"}, text)));
        if (!now.status) return;
        tiles.replaceChildren();
        fillTiles(tiles, tilesOf(now, unsolved));
        showStoreFacts(facts, now);
        const troubles = JSON.stringify(now.status.troubles);
        if (troubles !== toldRefusals) refusalTable.set(now.status.troubles);
        toldRefusals = troubles;
        if (before && now.now_ms > before.now_ms) {
          const passed = (now.now_ms - before.now_ms) / 1000;
          const rate = (name) => Math.max(0, now.status[name] - before.status[name]) / passed;
          rateSeries.add(now.now_ms / 1000, [rate("reports_received"), rate("fetches")]);
          latencySeries.add(now.now_ms / 1000, [quantile(now.receipts, before.receipts, 0.5), quantile(now.receipts, before.receipts, 0.95)]);
        }
        before = now;
      }
      return {status, event: tellEvent, close: () => {
        clearInterval(timer);
        clearInterval(unsolvedTimer);
      }};
    }});
})();
