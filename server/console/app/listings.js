// Pages that list what the CLI lists: robots, tasks, distributions, jobs, audit log, clients.
"use strict";
(() => {
  const {make, count, fixed} = kinshipPage;
  const {page, link, rows, changeButton} = kinshipConsole;
  const timeText = (ms) => (ms ? new Date(ms).toISOString().slice(0, 19).replace("T", " ") : null);
  const text = (title, of, show) => ({title, of, show, kind: "text"});
  const long = (title, of) => ({title, of, kind: "long"});
  const time = (title, of) => ({title: title + ", UTC", of, show: (row) => timeText(of(row)), text: (row) => timeText(of(row)), kind: "text"});
  const fraction = (of, digits) => (row) => (of(row) === undefined ? null : fixed(of(row), digits));

  /// \param listing.columns  as kinshipTables has them
  /// \param listing.seconds  between two readings; 0: only once
  function listingPage({path, title, nav, lead, verb, columns, sort, empty, seconds = 0}) {
    page({
      path, title, nav,
      async show(element) {
        const section = make("section", {}, make("h1", {}, title), make("p", {}, lead));
        element.append(section);
        const table = kinshipTables.show(section, {label: title, columns: columns(() => refresh()), sort, empty});
        const trouble = make("p", {class: "alarm", role: "alert"});
        section.append(trouble);
        const refresh = async () => {
          try {
            table.set(await rows(verb));
            trouble.textContent = "";
          } catch (error) {
            trouble.textContent = error.message;
          }
        };
        await refresh();
        const timer = seconds && setInterval(refresh, 1000 * seconds);
        return {close: () => clearInterval(timer)};
      }});
  }

  listingPage({
    path: "/robots", title: "Robots", nav: "Robots", verb: "list_robots", seconds: 10, empty: "No robot is registered.",
    lead: "Robots that are registered, each with what it reported.",
    columns: () => [text("robot", (r) => r.label, (r) => link("robot", r.label || r.robot, r.label || r.robot.slice(0, 12))), {title: "joints", of: (r) => r.dof},
      {title: "paths", of: (r) => r.paths}, {title: "attempts", of: (r) => r.attempts}, text("from", (r) => r.base_link), text("to", (r) => r.tip_link),
      long("solver", (r) => r.solver), time("registered", (r) => r.registered_ms)]});

  listingPage({
    path: "/tasks", title: "Tasks", nav: "Tasks", verb: "list_tasks", seconds: 10, empty: "No task has experience.",
    lead: "Tasks with experience, and whose it is.",
    columns: () => [text("task", (t) => t.task, (t) => link("task", t.task)), {title: "paths", of: (t) => t.paths}, {title: "attempts", of: (t) => t.attempts},
      {title: "dropped", of: (t) => t.dropped || 0}, {title: "robots", of: (t) => t.robots.length}, long("whose", (t) => t.robots.map((r) => r.label).join(", "))]});

  listingPage({
    path: "/distributions", title: "Distributions", nav: "Distributions", verb: "list_distributions", seconds: 10, empty: "None was fitted.",
    lead: "Mixtures that the server keeps, each for a robot, a task and a base pose.",
    columns: () => [text("distribution", (d) => d.id, (d) => link("distribution", d.id, d.id.slice(0, 12))), text("task", (d) => d.task, (d) => link("task", d.task)),
      text("robot", (d) => d.label, (d) => link("robot", d.label || d.robot)), {title: "revision", of: (d) => d.revision}, text("state", (d) => d.state),
      {title: "components", of: (d) => d.components}, {title: "paths", of: (d) => d.paths}, time("fitted", (d) => d.fitted_ms), long("why", (d) => d.reason || "")]});

  listingPage({
    path: "/jobs", title: "Jobs", nav: "Jobs", verb: "list_jobs", seconds: 2, empty: "No job runs or has ended lately.",
    lead: "Long verbs: backups, exports. One runs at a time; ended ones are kept for an hour.",
    columns: (refresh) => [text("job", (j) => j.id), text("verb", (j) => j.verb), text("object", (j) => j.argument), text("state", (j) => j.state),
      {title: "done", of: (j) => j.progress, show: (j) => Math.round(100 * j.progress) + "\u202f%"}, {title: "rows", of: (j) => j.rows},
      time("started", (j) => j.started_ms), time("ended", (j) => j.ended_ms), long("message", (j) => j.message),
      {title: "change", of: () => "", show: (j) => (j.state === "queued" || j.state === "running" ? changeButton({text: "Cancel", verb: "cancel_job"}, j.id, refresh) : "") || ""}]});

  listingPage({
    path: "/audit", title: "Audit log", nav: "Audit", verb: "list_audit", seconds: 10, empty: "Nothing was changed, or refused.",
    lead: "Who had what done, or was refused it; the newest first.",
    columns: () => [{title: "number", of: (a) => a.number}, time("time", (a) => a.time_ms), text("who", (a) => a.name || a.client), text("role", (a) => a.role),
      text("verb", (a) => a.verb), text("object", (a) => a.target), text("outcome", (a) => a.outcome),
      long("what", (a) => [a.before, a.after].filter(Boolean).join(" \u2192 ")), long("message", (a) => a.message)]});

  listingPage({
    path: "/clients", title: "Clients", nav: "Clients", verb: "list_clients", seconds: 5, empty: "No client has asked for anything yet.",
    lead: "Who takes how much of the server, since it started or since it last forgot this client.",
    columns: () => [text("client", (c) => (c.program || c.host ? `${c.program || "?"} on ${c.host || "?"}` : c.client)), long("robots", (c) => c.robots.join(", ")),
      {title: "attempts / s", of: (c) => c.attempts_per_s, show: fraction((c) => c.attempts_per_s, 2)},
      {title: "kB / s", of: (c) => c.bytes_per_s / 1000, show: fraction((c) => c.bytes_per_s / 1000, 1)}, {title: "attempts", of: (c) => c.attempts},
      {title: "on their way", of: (c) => c.on_way}, {title: "waiting", of: (c) => c.waiting}, {title: "leases", of: (c) => c.leases}, {title: "fits", of: (c) => c.fits},
      {title: "stored, kB", of: (c) => c.stored_bytes / 1000}, {title: "bad requests", of: (c) => c.bad_requests || 0}, {title: "refused", of: (c) => c.refused}, text("for", (c) => c.refused_for), time("last seen", (c) => c.last_seen_ms)]});
})();
