// The console's frame: pages by address, links, what the server sends, changes that a person confirms.
"use strict";
const kinshipConsole = (() => {
  const {make, byId} = kinshipPage;
  const pages = [];
  const isAdmin = document.documentElement.dataset.admin === "yes";
  let shown = {}; // what the page that is shown wants to hear
  let shownAt = ""; // its address
  let lastStatus = null;
  let visit = 0; // counts navigations, so that a late answer finds its page gone

  /// Registers a page.
  ///
  /// \param page.path   "/robots/:label": what follows a colon is handed to show()
  /// \param page.title  of the browser's tab: a text, or a function of the parameters
  /// \param page.nav    its word in the navigation, if it is there
  /// \param page.show   fills an element: show(element, parameters). May be asynchronous, and return any of status(status),
  ///   event(event): called as they come, close(): when the reader leaves
  function page(page) {
    const parts = page.path.split("/").filter(Boolean);
    pages.push({...page, parts});
  }

  /// The address of a robot, task, distribution, path or attempt; null for what has no page.
  function href(kind, name) {
    const folder = {robot: "robots", task: "tasks", distribution: "distributions", path: "paths", attempt: "attempts"}[kind];
    return folder && name ? `/${folder}/${encodeURIComponent(name)}` : null;
  }

  const link = (kind, name, text) => make("a", {href: href(kind, name)}, text === undefined ? name : text);

  async function answerOf(reply) {
    const answer = await reply.json().catch(() => ({message: reply.statusText}));
    if (!reply.ok) throw new Error(answer.message || reply.statusText);
    return answer;
  }

  const get = async (path) => answerOf(await fetch(path));

  /// Rows of an admin verb: all of a listing, or the first `most` of them.
  async function rows(verb, query = {}, most = 5000) {
    const found = [];
    let cursor = "";
    do {
      const answer = await get(`/api/rows/${verb}?` + new URLSearchParams({limit: Math.min(1000, most), ...query, cursor}));
      found.push(...answer.rows);
      cursor = answer.next_cursor;
    } while (cursor && found.length < most);
    return found;
  }

  const figure = (kind, name) => get(`/api/figures/${kind}/${encodeURIComponent(name)}`);

  /// A button for a change, which a person confirms by typing its object; null where the console only reads.
  /// \param change  {text, verb}; by: the member that names the object, unless it is `argument`; asks: what else is typed, as
  ///                `argument`; undo: how it is undone
  /// \param told    (row): it is done
  function changeButton({text, verb, by = "argument", asks, undo = "This cannot be undone here."}, object, told) {
    if (!isAdmin) return null;
    const ask = () => {
      const field = (label) => make("input", {type: "text", autocomplete: "off", "aria-label": label, oninput: () => { go.disabled = typed.value !== object || (asked && !asked.value); }});
      const typed = field(`Type ${object} to confirm`), asked = asks && field(asks);
      const trouble = make("p", {class: "alarm", role: "alert"});
      const go = make("button", {type: "button", class: "grave", disabled: true, onclick: async () => {
        try {
          const reply = await fetch(`/api/rows/${verb}`, {method: "POST", headers: {"Content-Type": "application/json"},
                                                          body: JSON.stringify({...(asked && {argument: asked.value}), [by]: object, confirm: typed.value})});
          const row = (await answerOf(reply)).rows[0] || {};
          if (row.lost > 0) throw new Error(`${row.paths} restored, ${row.lost} cannot be; the last: ${row.reason}`);
          if (row.paths === 0 && row.reason) throw new Error(row.reason);
          dialog.close();
          told(row);
        } catch (error) {
          trouble.textContent = error.message;
        }
      }}, text);
      const dialog = make("dialog", {"aria-label": text, onclose: () => dialog.remove()}, make("h2", {}, text),
        ...(asked ? [make("p", {}, asks), asked] : []),
        make("p", {}, `${undo} To confirm, type `, make("code", {}, object)), typed, trouble,
        make("div", {class: "tools"}, make("button", {type: "button", onclick: () => dialog.close()}, "Leave it"), go));
      document.body.append(dialog);
      dialog.showModal();
    };
    return make("button", {type: "button", class: "grave", onclick: ask}, text + " \u2026");
  }

  function find(path) {
    const given = path.split("/").filter(Boolean).map(decodeURIComponent);
    for (const page of pages) {
      const fits = page.parts.length === given.length && page.parts.every((part, i) => part.startsWith(":") || part === given[i]);
      if (fits) return {page, parameters: Object.fromEntries(page.parts.flatMap((part, i) => (part.startsWith(":") ? [[part.slice(1), given[i]]] : [])))};
    }
    return null;
  }

  const titleOf = ({page, parameters}) => (typeof page.title === "function" ? page.title(parameters) : page.title);

  /// Shows what the address asks for.
  async function show() {
    const own = ++visit;
    if (shown.close) shown.close();
    shown = {};
    shownAt = location.pathname;
    const main = byId("main");
    const element = make("div", {class: "page"});
    main.replaceChildren(element);
    const found = find(shownAt);
    for (const each of byId("nav").children) {
      if (each.getAttribute("href") === location.pathname) each.setAttribute("aria-current", "page");
      else each.removeAttribute("aria-current");
    }
    document.title = (found ? titleOf(found) + " \u2013 " : "") + "Kinship";
    try {
      if (!found) throw new Error(`There is no page ${location.pathname}.`);
      const wants = await found.page.show(element, found.parameters) || {};
      if (own !== visit) {
        if (wants.close) wants.close();
        return;
      }
      shown = wants;
      if (wants.status && lastStatus) wants.status(lastStatus);
    } catch (error) {
      if (own !== visit) return;
      element.append(make("section", {role: "alert"}, make("h1", {}, found ? titleOf(found) : "Not here"), make("p", {class: "alarm"}, error.message)));
    }
    main.dataset.ready = location.pathname;
  }

  function go(address) {
    history.pushState(null, "", address);
    scrollTo(0, 0);
    delete byId("main").dataset.ready;
    show();
    byId("main").focus({preventScroll: true});
  }

  /// Links within the console change the page without loading it anew.
  function follow(event) {
    const anchor = event.target.closest && event.target.closest("a[href]");
    if (!anchor || event.defaultPrevented || event.button !== 0 || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
    const to = new URL(anchor.href, location.href);
    if (anchor.target || anchor.hasAttribute("download") || to.origin !== location.origin || to.hash || to.pathname.startsWith("/api/")) return;
    event.preventDefault();
    go(to.pathname + to.search);
  }

  function listen() {
    const live = byId("live");
    const tell = (state, text) => {
      live.dataset.state = state;
      live.textContent = text;
    };
    const source = new EventSource("/api/events");
    source.onopen = () => tell("live", "live");
    source.onerror = () => tell("lost", "no connection to the server");
    source.addEventListener("status", (message) => {
      lastStatus = JSON.parse(message.data);
      if (shown.status) shown.status(lastStatus);
    });
    source.addEventListener("event", (message) => shown.event && shown.event(JSON.parse(message.data)));
    addEventListener("pagehide", () => source.close());
    addEventListener("pageshow", (event) => event.persisted && location.reload());
  }

  function start() {
    byId("nav").append(...pages.filter((each) => each.nav).map((each) => make("a", {href: each.path}, each.nav)));
    document.addEventListener("click", follow);
    document.addEventListener("keydown", (event) => {
      const search = document.querySelector("main input[type=search]");
      if (event.key !== "/" || !search || /^(INPUT|TEXTAREA|SELECT)$/.test(document.activeElement.tagName)) return;
      event.preventDefault();
      search.focus();
    });
    addEventListener("popstate", () => {
      if (location.pathname !== shownAt) show();
    });
    show();
    listen();
  }

  return {page, href, link, get, rows, figure, changeButton, go, start, reload: show};
})();
