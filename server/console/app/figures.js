// Pages of one robot, task, distribution, path or attempt: figures of pages/plots, whose programs are loaded with the first of them.
"use strict";
(() => {
  const {make} = kinshipPage;
  const {page, href, figure, changeButton, go, reload} = kinshipConsole;
  let loaded = null;

  /// Runs in order, like scripts of the page itself.
  function loadPrograms() {
    loaded = loaded || Promise.all(JSON.parse(document.documentElement.dataset.figures).map((address) => new Promise((done, failed) => {
      const script = make("script", {src: address, onload: done, onerror: () => failed(new Error(`${address} did not load`))});
      script.async = false;
      document.head.append(script);
    })));
    return loaded;
  }

  /// Once the page has painted something, so that nobody waits for a figure's programs before he sees a page; at once in a window
  /// that is not seen.
  function painted() {
    const isKnown = (PerformanceObserver.supportedEntryTypes || []).includes("paint");
    if (!isKnown || document.hidden || performance.getEntriesByName("first-contentful-paint").length) return Promise.resolve();
    return new Promise((done) => {
      new PerformanceObserver((list, observer) => {
        if (list.getEntriesByName("first-contentful-paint").length === 0) return;
        observer.disconnect();
        done();
      }).observe({type: "paint", buffered: true});
      document.addEventListener("visibilitychange", done, {once: true});
    });
  }

  /// \param changes  what an administrator may do: of changeButton; to (row): the address where it is then, unless it is here
  function figurePage(kind, folder, changes = []) {
    page({
      path: `/${folder}/:name`,
      title: ({name}) => `${kind[0].toUpperCase() + kind.slice(1)} ${name}`,
      async show(element, {name}) {
        const buttons = changes.map((change) => changeButton(change, name, (row) => (change.to ? go(change.to(row)) : reload()))).filter(Boolean);
        if (buttons.length) element.append(make("div", {class: "tools"}, ...buttons));
        const inside = make("div", {class: "figure", "data-kind": kind}), told = make("p", {role: "status"}, "Reading \u2026");
        element.append(told, inside);
        try {
          const [data] = await Promise.all([figure(kind, name), painted().then(loadPrograms)]);
          kinshipFigures[kind](inside, data, {href});
        } finally {
          told.remove();
        }
      }});
  }

  figurePage("robot", "robots");
  figurePage("task", "tasks", [
    {text: "Retire all its paths", verb: "reset_task", undo: "Restoring its paths undoes this."},
    {text: "Restore its paths", verb: "restore_path", by: "task", undo: "Retiring its paths undoes this."},
    {text: "Rename", verb: "rename_task", by: "task", asks: "New name", undo: "Robots that report the former name begin that task again.",
     to: ({task}) => `/tasks/${encodeURIComponent(task)}`},
    {text: "Remove", verb: "remove_task", undo: "Its paths are retired, its attempts stay on record; it is listed again once its paths are restored.",
     to: () => "/tasks"}]);
  figurePage("distribution", "distributions", [{text: "Evict it", verb: "evict_distribution"}]);
  figurePage("path", "paths", [
    {text: "Retire this path", verb: "retire_path", undo: "Restoring this path undoes it."},
    {text: "Restore this path", verb: "restore_path", undo: "Retiring the restored path undoes it.", to: ({report_uuid: uuid}) => `/paths/${uuid}`}]);
  figurePage("attempt", "attempts");
})();
