// Pages of one robot, task, distribution, path or attempt: figures of pages/plots, whose programs are loaded with the first of them.
"use strict";
(() => {
  const {make} = kinshipPage;
  const {page, href, figure, changeButton, reload} = kinshipConsole;
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

  /// \param change  what an administrator may do: [text, verb]
  function figurePage(kind, folder, change) {
    page({
      path: `/${folder}/:name`,
      title: ({name}) => `${kind[0].toUpperCase() + kind.slice(1)} ${name}`,
      async show(element, {name}) {
        const button = change && changeButton(change[0], change[1], name, reload);
        if (button) element.append(make("div", {class: "tools"}, button));
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
  figurePage("task", "tasks", ["Retire all its paths", "reset_task"]);
  figurePage("distribution", "distributions", ["Evict it", "evict_distribution"]);
  figurePage("path", "paths", ["Retire this path", "retire_path"]);
  figurePage("attempt", "attempts");
})();
