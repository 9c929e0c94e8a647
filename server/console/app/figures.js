// Pages of one robot, task, distribution, path or attempt: figures of pages/plots, whose programs are loaded with the first of them.
"use strict";
(() => {
  const {make, byId} = kinshipPage;
  const {page, href, rows, figure, changeButton, reload} = kinshipConsole;
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

  /// What a row says, member by member, where no figure is known.
  function showMembers(element, title, value) {
    const list = make("dl", {class: "facts"});
    for (const [name, member] of Object.entries(value)) {
      const text = JSON.stringify(member);
      list.append(make("dt", {}, name), make("dd", {}, text.length > 400 ? text.slice(0, 400) + " \u2026" : text));
    }
    element.append(make("section", {}, make("h1", {}, title), list));
  }

  /// \param verb    whose row is shown where there is no figure
  /// \param change  what an administrator may do: [text, verb]
  function figurePage(kind, folder, verb, change) {
    page({
      path: `/${folder}/:name`,
      title: ({name}) => `${kind[0].toUpperCase() + kind.slice(1)} ${name}`,
      async show(element, {name}) {
        const button = change && changeButton(change[0], change[1], name, reload);
        if (button) element.append(make("div", {class: "tools"}, button));
        const inside = make("div", {class: "figure", "data-kind": kind});
        element.append(inside);
        await loadPrograms();
        if (kinshipFigures[kind]) kinshipFigures[kind](inside, await figure(kind, name), {href});
        else showMembers(inside, `${kind} ${name}`, (await rows(verb, {argument: name}))[0]);
      }});
  }

  figurePage("robot", "robots", "show_robot");
  figurePage("task", "tasks", "show_task", ["Retire all its paths", "reset_task"]);
  figurePage("distribution", "distributions", "show_distribution", ["Evict it", "evict_distribution"]);
  figurePage("path", "paths", "show_path", ["Retire this path", "retire_path"]);
  figurePage("attempt", "attempts", "show_path");
})();
