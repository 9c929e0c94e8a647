"""The live console of a real kinshipd, in a browser: each page opened, clicked, narrow and wide, its numbers those of the CLI."""
import contextlib
import http.client
import json
import os
import pathlib
import re
import resource
import socket
import sqlite3
import ssl
import statistics
import subprocess
import threading
import time
import unittest
import urllib.parse
import uuid

import numpy as np
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from browser import Browser
from kinshipd_process import Kinshipd

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
TASK = "shelf:1"
MACHINE = "<img src=x> & \"2\""  # what a page must not take for HTML
READY = {"panda": np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785]), "ur10e": np.array([0, -1.2, 1.8, -2.2, -1.57, 0])}


def attempt(robot: str, seed: int, task: str = TASK, **record) -> dict:
    """A line of an experience file: the hand sweeps in front of the robot, a little different for every seed."""
    waypoints = np.tile(READY[robot], (4, 1))
    waypoints[:, 0] += -0.9 + 0.6 * np.arange(4)
    waypoints += np.random.default_rng(seed).uniform(-0.1, 0.1, waypoints.shape)
    known = {"outcome": "solved", "planner": "birrt", "planner_options": "", "planning_time_s": 0.5, "collision_checks": 1000,
             "time_limit_s": 10, **record}
    return {"report_uuid": str(uuid.UUID(int=seed + 1000 * sum((robot + task).encode()))), "task": task, "robot": robot, "machine": MACHINE,
            "T_task_base": [0, 0, 0, 0, 0, 0, 1], "waypoints": waypoints.tolist() if known["outcome"] == "solved" else None,
            "record": known, "scene": None}


class ServedConsole:
    """A kinshipd with a console, and what a browser would know of it."""

    def __init__(self, *options: str):
        self.server = Kinshipd()
        self.serve(*options)

    def serve(self, *options: str) -> None:
        self.server.start("--console", "127.0.0.1:0", "--rehearsal-cpu", "0", *options)
        self.link = self.kinship("console").strip()
        self.host, self.token = re.fullmatch(r"http://([^/]+)/\?token=(\w+)", self.link).groups()
        self.cookie = f"kinship-console-{self.host.split(':')[1]}={self.token}"

    def close(self) -> None:
        self.server.__exit__(None, None, None)

    def kinship(self, *words: str) -> str:
        program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinship"
        done = subprocess.run([program, "--domain", str(self.server.domain), "--timeout", "30", *words], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr}")
        return done.stdout

    def rows(self, *words: str) -> list:
        return json.loads(self.kinship(*words, "--json"))["rows"]

    def give(self, attempts: "list[dict]") -> None:
        file = self.server.folder / "given.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in attempts))
        self.kinship("paths", "import", str(file))

    def ask(self, path: str, method: str = "GET", body: "str | None" = None, **fields: str) -> http.client.HTTPResponse:
        """A request with the cookie, unless it has another; names of fields with _ for -."""
        connection = http.client.HTTPConnection(self.host, timeout=30)
        named = {name.replace("_", "-"): value for name, value in {"Cookie": self.cookie, **fields}.items()}
        connection.request(method, path, body, {name: value for name, value in named.items() if value})
        reply = connection.getresponse()
        reply.text = reply.read().decode()
        connection.close()
        return reply

    def stream(self) -> socket.socket:
        """A listener to the events, who does not read."""
        address, port = self.host.split(":")
        listener = socket.create_connection((address, int(port)), timeout=30)
        listener.sendall(f"GET /api/events HTTP/1.1\r\nHost: {self.host}\r\nCookie: {self.cookie}\r\n\r\n".encode())
        return listener


def processor_time_s(pid: int) -> float:
    """Of all threads that live, to the nanosecond."""
    return sum(int(file.read_text().split()[0]) for file in pathlib.Path(f"/proc/{pid}/task").glob("*/schedstat")) / 1e9


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.console = ServedConsole()
        cls.addClassCleanup(cls.console.close)
        for robot in READY:
            cls.console.kinship("robots", "register", str(MODELS / robot))
        cls.console.give([attempt("panda", seed, collision_checks=900 + 20 * seed) for seed in range(12)])
        query = ("--task", TASK, "--robot", "ur10e", "--placement", "0 0 0 0 0 0 1", "--profile", "default,components=auto", "--wait", "100")
        cls.distribution = json.loads(cls.console.kinship("distributions", "fetch", *query, "--json"))
        used = {"distribution_id": cls.distribution["id"], "distribution_revision": cls.distribution["revision"]}
        own = []
        for seed in range(12):
            own.append(attempt("ur10e", 2 * seed, sampling_mode="guided", share=0.5, planning_time_s=0.2 + 0.01 * seed,
                               collision_checks=250 + 10 * seed, **used))
            own.append(attempt("ur10e", 2 * seed + 1, sampling_mode="control", planning_time_s=0.9 + 0.01 * seed, **used))
        own.append(attempt("ur10e", 50, outcome="timeout", collision_checks=5000, planning_time_s=10))
        own.append(attempt("panda", 51, task="other", planning_time_s=7.5))
        cls.console.give(own)
        cls.console.kinship("backup", "monday.db")
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.__exit__, None, None, None)
        cls.browser.driver.get(cls.console.link)
        cls.browser.wait("document.querySelector('main[data-ready]')")

    def setUp(self):
        self.browser.prefer("light")
        self.browser.resize(1280, 900)

    def tearDown(self):
        self.browser.check_console(self)

    def open(self, path: str) -> None:
        self.browser.driver.get(f"http://{self.console.host}{path}")
        self.ready()

    def ready(self) -> None:
        self.browser.wait("document.querySelector('main').dataset.ready === location.pathname")
        self.assertEqual(self.browser.elements("main > .page > [role=alert]"), [], self.browser.text("main"))

    def table(self, label: str) -> "list[list[str]]":
        return self.browser.run("return [...document.querySelector(`table[aria-label=\"${arguments[0]}\"]`).tBodies[0].rows]"
                                ".map(row => [...row.cells].map(cell => cell.textContent))", label)

    def column(self, label: str, index: int) -> "list[str]":
        return [row[index].replace("\u202f", "") for row in self.table(label)]

    def tile(self, text: str) -> str:
        return self.browser.run("return [...document.querySelectorAll('.tile')].find(t => t.lastChild.textContent.startsWith(arguments[0])).firstChild.textContent",
                                text).replace("\u202f", "")

    def test_every_page_fits_its_window(self):
        paths = ["/", "/robots", "/tasks", "/distributions", "/slow", "/jobs", "/audit", "/clients", "/robots/panda",
                 "/tasks/" + urllib.parse.quote(TASK, safe=""),
                 f"/distributions/{self.distribution['id']}", f"/attempts/{attempt('ur10e', 50)['report_uuid']}", f"/paths/{attempt('panda', 1)['report_uuid']}"]
        for path in paths:
            for width, scheme in ((800, "light"), (1920, "dark")):
                with self.subTest(path=path, width=width):
                    self.browser.prefer(scheme)
                    self.browser.resize(width, 900)
                    self.open(path)
                    self.assertEqual(self.browser.run("return document.documentElement.scrollWidth"), width, "wider than its window")
                    self.assertEqual(len(self.browser.elements("h1")), 1)
                    unnamed = self.browser.run("return [...document.querySelectorAll('main button, main input, main table, main svg[role=img], main canvas')]"
                                               ".filter(e => !e.textContent.trim() && !e.getAttribute('aria-label') && !e.closest('[aria-hidden=true], [hidden]'))"
                                               ".map(e => e.outerHTML.slice(0, 100))")
                    self.assertEqual(unnamed, [], "what has no name for those who do not see it")
                    self.browser.check_console(self)

    def test_the_fleet_is_that_of_the_status(self):
        self.open("/")
        self.browser.wait("document.querySelectorAll('#tiles .tile').length")
        status = json.loads(self.console.kinship("status", "--json"))
        for name in ("robots", "tasks", "paths", "attempts", "distributions"):
            self.assertEqual(self.tile(name), str(status[name]), name)
        self.browser.wait("document.querySelectorAll('.series path').length === 4")
        self.browser.wait("document.querySelector('table[aria-label=\"What guidance saves\"] tbody').rows.length")
        saved = {row[0]: row for row in self.table("What guidance saves")}
        self.assertEqual(saved[TASK][1:4], ["ur10e", "12", "12"])
        ratio = float(saved[TASK][4].split()[0])
        self.assertTrue(2 < ratio < 5, ratio)  # 1000 checks / 305
        self.assertAlmostEqual(float(re.match(r"[\d.]+", saved[TASK][5]).group()), 12 * (0.955 - 0.255), delta=0.011)

    def test_the_fleet_is_live(self):
        self.open("/")
        self.browser.wait("document.querySelector('#live').dataset.state === 'live' && document.querySelectorAll('#tiles .tile').length")
        before = int(self.tile("attempts"))
        self.console.give([attempt("panda", 100, task="live")])
        self.browser.wait(f"[...document.querySelectorAll('.tile')].some(t => t.lastChild.textContent === 'attempts' && t.firstChild.textContent === '{before + 1}')")
        self.browser.wait("[...document.querySelectorAll('.events .report')].some(e => e.textContent.includes('live'))")
        self.browser.click(".events .report a")
        self.ready()
        self.assertEqual(self.browser.run("return location.pathname"), "/tasks/live")
        self.browser.run("history.back()")
        self.browser.wait("document.querySelector('h1') && document.querySelector('h1').textContent === 'Fleet'")

    def test_tables_have_the_rows_of_the_command_line(self):
        for path, label, words, name in (("/robots", "Robots", ("robots", "list"), "label"), ("/tasks", "Tasks", ("tasks", "list"), "task"),
                                         ("/distributions", "Distributions", ("distributions", "list"), "id"),
                                         ("/jobs", "Jobs", ("jobs", "list"), "id")):
            self.open(path)
            listed = [row[name][:12] if name == "id" else row[name] for row in self.console.rows(*words)]
            self.assertGreater(len(listed), 0, label)
            self.assertEqual(sorted(self.column(label, 0)), sorted(listed), label)
        self.open("/audit")
        self.assertEqual(len(self.table("Audit log")), len(self.console.rows("audit")))
        self.open("/clients")
        self.assertGreater(len(self.table("Clients")), 0)

    def test_a_table_is_sorted_and_filtered_by_keys(self):
        self.open("/tasks")
        self.browser.press("body", "/")
        self.browser.run("return document.activeElement").send_keys("other")
        self.assertEqual(self.column("Tasks", 0), ["other"])
        self.browser.element("input[type=search]").clear()
        self.browser.press("input[type=search]", "o", Keys.BACKSPACE)
        self.browser.click("th:nth-child(3) button")
        rising = [int(n) for n in self.column("Tasks", 2)]
        self.assertEqual(rising, sorted(rising))
        self.assertEqual(self.browser.element("th:nth-child(3)").get_attribute("aria-sort"), "ascending")
        self.browser.press("th:nth-child(3) button", Keys.ENTER)
        self.assertEqual([int(n) for n in self.column("Tasks", 2)], rising[::-1])

    def test_jobs_audit_and_clients_are_sorted_and_filtered(self):
        for path, label, head in (("/jobs", "Jobs", "verb"), ("/audit", "Audit log", "outcome"), ("/clients", "Clients", "attempts")):
            self.open(path)
            before = self.table(label)
            self.assertGreater(len(before), 0, label)
            heads = self.browser.run("return [...document.querySelectorAll(`table[aria-label='${arguments[0]}'] thead th`)].map(head => head.textContent)", label)
            index = heads.index(head)
            self.browser.press(f"th:nth-child({index + 1}) button", Keys.ENTER)
            numeric = label == "Clients"
            values = [float(text) if numeric else text for text in self.column(label, index)]
            self.assertEqual(values, sorted(values), label)
            self.browser.press("input[type=search]", "no such word")
            self.assertEqual(self.table(label), [])
            self.browser.element("input[type=search]").clear()
            self.browser.press("input[type=search]", before[0][1].split()[0], Keys.SPACE)
            self.assertGreater(len(self.table(label)), 0)

    def test_the_keyboard_reaches_everything(self):
        self.open("/")
        self.browser.wait("document.querySelectorAll('#tiles .tile').length")
        self.browser.run("document.activeElement.blur()")
        self.browser.press("body", Keys.TAB)
        self.assertEqual(self.browser.run("return document.activeElement.className"), "skip")
        reached = []
        for _ in range(40):
            reached.append(self.browser.run("return document.activeElement.outerHTML.slice(0, 60)"))
            self.browser.run("return document.activeElement").send_keys(Keys.TAB)
        self.assertTrue(any('href="/slow"' in each for each in reached), reached)
        self.assertTrue(any("data-hours" in each for each in reached), reached)
        self.browser.run("document.querySelector('#nav a[href=\"/tasks\"]').focus()")
        self.browser.run("return document.activeElement").send_keys(Keys.ENTER)
        self.ready()
        self.assertEqual(self.browser.run("return [location.pathname, document.activeElement.id, document.title]"), ["/tasks", "main", "Tasks \u2013 Kinship"])

    def test_slow_and_failed_attempts_are_those_reported(self):
        self.open("/slow")
        self.assertEqual(self.column("Unsolved", 0), [attempt("ur10e", 50)["report_uuid"][:8]])
        self.assertEqual(self.column("Unsolved", 1), ["its time was over; no search record"])
        slowest = self.table("Slowest of those solved")
        self.assertEqual([slowest[0][i] for i in (1, 2, 3, 4, 9)],
                         ["1.0 times the mean of its task and robot; no search record", "other", "panda", "7.50\u202fs of 10\u202fs", MACHINE])
        status = json.loads(self.console.kinship("status", "--json"))
        self.assertEqual(self.tile("attempts"), str(status["attempts"]))
        self.browser.click("[data-hours='1']")
        self.browser.wait("document.querySelector('[data-hours=\"1\"]').getAttribute('aria-pressed') === 'true'")
        self.browser.click("table[aria-label='Unsolved'] tbody a")
        self.ready()
        self.assertIn("/attempts/", self.browser.run("return location.pathname"))

    def test_a_distribution_and_a_task_are_drawn(self):
        self.open(f"/distributions/{self.distribution['id']}")
        self.browser.wait("document.querySelector('.figure canvas')")
        self.assertGreater(len(self.browser.elements(".figure .chart svg")), 5)
        self.open("/tasks/other")
        self.browser.wait("document.querySelector('.figure #tiles .tile')")
        self.assertEqual(self.browser.text(".figure #tiles .tile b"), "1")

    def test_what_is_not_there_is_said(self):
        self.browser.driver.get(f"http://{self.console.host}/nowhere")
        self.browser.wait("document.querySelector('main[data-ready]')")
        self.assertIn("no page /nowhere", self.browser.text("main"))
        self.browser.driver.get(f"http://{self.console.host}/robots/nobody")
        self.browser.wait("document.querySelector('main[data-ready]')")
        self.assertIn("nobody", self.browser.text("main [role=alert]"))
        self.assertEqual(len(self.browser.console_errors()), 1)  # the reply itself, 404

    def test_it_only_reads(self):
        self.open("/jobs")
        self.assertEqual(self.browser.elements(".grave"), [])
        reply = self.console.ask("/api/rows/reset_task", "POST", json.dumps({"argument": "other", "confirm": "other"}),
                                 Origin="http://" + self.console.host, Content_Type="application/json")
        self.assertEqual(reply.status, 403, reply.text)
        self.assertIn("--console-admin", reply.text)


class Guard(unittest.TestCase):
    """What the console keeps out. A browser's part of it is in the browser, here are its requests."""

    @classmethod
    def setUpClass(cls):
        cls.console = ServedConsole()
        cls.addClassCleanup(cls.console.close)

    def status(self, path: str = "/api/rows/status", **fields: str) -> int:
        return self.console.ask(path, **fields).status

    def test_without_the_token_nothing_is_told(self):
        self.assertEqual(self.status(), 200)
        for cookie in ("", "kinship-console=" + self.console.token, self.console.cookie + "0", self.console.cookie[:-1]):
            for path in ("/", "/assets/console.js", "/api/rows/status", "/api/events", "/api/figures/slow/24"):
                self.assertEqual(self.status(path, Cookie=cookie), 401, path)
        self.assertEqual(self.status("/?token=" + "0" * 64, Cookie=""), 403)

    def test_a_name_that_was_made_to_lead_here_is_not_served(self):
        port = self.console.host.split(":")[1]
        self.assertEqual(self.status(Host="localhost:" + port), 200)
        for host in ("evil.example", "evil.example:" + port, "127.0.0.1.evil.example"):
            self.assertEqual(self.status(Host=host), 421, host)

    def test_other_pages_are_not_answered(self):
        self.assertEqual(self.status(Sec_Fetch_Site="same-site", Sec_Fetch_Mode="no-cors"), 403)
        self.assertEqual(self.status(Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="cors"), 403)
        self.assertEqual(self.status("/", Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="navigate"), 200)

    def test_every_reply_has_the_policy(self):
        for path in ("/", "/api/rows/status", "/api/nothing", "/assets/console.js"):
            for cookie in (self.console.cookie, ""):
                reply = self.console.ask(path, Cookie=cookie)
                self.assertTrue(reply.headers["Content-Security-Policy"].startswith("default-src 'self'; "), path)
                self.assertNotIn("unsafe", reply.headers["Content-Security-Policy"])
                self.assertIsNone(reply.headers["Access-Control-Allow-Origin"])
        cookie = self.console.ask("/?token=" + self.console.token, Cookie="").headers["Set-Cookie"]
        self.assertIn("; HttpOnly; SameSite=Strict;", cookie)

    def test_token_and_link_are_for_their_owner(self):
        store = self.console.server.folder / "store.db"
        for ending in (".console", ".console-token"):
            self.assertEqual(pathlib.Path(str(store) + ending).stat().st_mode & 0o777, 0o600, ending)

    def test_a_thousand_connections_shut_nobody_out(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        listener = self.console.stream()
        self.assertIn(b"200 OK", listener.recv(100))
        address, port = self.console.host.split(":")
        held = [socket.create_connection((address, int(port)), timeout=30) for _ in range(1000)]
        try:
            self.assertEqual(self.status(), 200)
            self.assertGreater(len(listener.recv(100_000)), 0)
            self.assertLess(len(list(pathlib.Path(f"/proc/{self.console.server.pid}/fd").iterdir())), 400)
        finally:
            for each in [*held, listener]:
                each.close()

    def test_ten_open_pages_cost_little_while_robots_report(self):
        """Two hundred reports a second, with and without ten pages that listen, by turns, as what else runs makes both dearer."""
        self.console.kinship("robots", "register", str(MODELS / "panda"))
        end = threading.Event()

        def report() -> None:
            first = 0
            while not end.wait(max(0, 1 - time.monotonic() % 1)):
                self.console.give([attempt("panda", first + i, task="load") for i in range(200)])
                first += 200

        def share_of_a_core() -> float:
            begin, time_s = time.monotonic(), processor_time_s(self.console.server.pid)
            time.sleep(4)
            return (processor_time_s(self.console.server.pid) - time_s) / (time.monotonic() - begin)

        def with_pages() -> float:
            listeners = [self.console.stream() for _ in range(10)]
            read = [0] * len(listeners)

            def drain(i: int) -> None:
                while text := listeners[i].recv(100_000):
                    read[i] += text.count(b"event: status")

            readers = [threading.Thread(target=drain, args=(i,)) for i in range(len(listeners))]
            for reader in readers:
                reader.start()
            try:
                return share_of_a_core()
            finally:
                for listener, reader in zip(listeners, readers):
                    listener.shutdown(socket.SHUT_RDWR)
                    reader.join()
                    listener.close()
                self.assertGreaterEqual(min(read), 3)

        reports = threading.Thread(target=report)
        reports.start()
        try:
            time.sleep(2)  # until they come evenly
            shares = [(with_pages(), share_of_a_core()) for _ in range(4)]
        finally:
            end.set()
            reports.join()
        paged, bare = (statistics.median(each) for each in zip(*shares))
        print(f"200 reports a second: {100 * paged:.2f} % of a core with ten open pages, {100 * bare:.2f} % without")
        self.assertGreater(int(json.loads(self.console.kinship("status", "--json"))["attempts"]), 4000)
        self.assertLess(paged - bare, 0.01)


class Changes(unittest.TestCase):
    def test_are_confirmed_by_the_name_typed(self):
        console = ServedConsole("--console-admin")
        self.addCleanup(console.close)
        console.kinship("robots", "register", str(MODELS / "panda"))
        console.give([attempt("panda", 1, task="old")])
        own = {"Origin": "http://" + console.host, "Content_Type": "application/json"}

        def reset(confirm: str, **fields: str) -> int:
            return console.ask("/api/rows/reset_task", "POST", json.dumps({"argument": "old", "confirm": confirm}), **{**own, **fields}).status

        self.assertEqual(reset("old", Origin="http://evil.example"), 403)
        self.assertEqual(reset("old", Origin=""), 403)
        self.assertEqual(reset("old", Content_Type="text/plain"), 400)
        self.assertEqual(reset("other"), 400)
        self.assertEqual(console.ask("/api/rows/reset_task?argument=old").status, 405)
        self.assertEqual([row["outcome"] for row in console.rows("audit")], [])
        with Browser() as browser:
            self.let_in(browser, console)
            browser.driver.get(f"http://{console.host}/tasks/old")
            browser.wait("document.querySelector('main[data-ready]')")
            browser.click(".grave")
            go = "dialog .grave"
            browser.press("dialog input", "ol")
            self.assertFalse(browser.element(go).is_enabled())
            browser.press("dialog input", "d")
            browser.click(go)
            browser.wait("!document.querySelector('dialog')")
            browser.check_console(self)
        self.assertEqual([(row["name"], row["verb"], row["target"]) for row in console.rows("audit")][-1], ("console", "reset_task", "old"))

    def test_what_may_be_changed_is_on_its_page(self):
        console = ServedConsole()
        self.addCleanup(console.close)
        console.server.stop()
        self.grow(console.server.folder / "store.db", 200_000_000)  # so that a backup takes a while
        backups = ("--backup-folder", str(console.server.folder / "backups"))
        console.serve("--console-admin", *backups)
        console.kinship("robots", "register", str(MODELS / "panda"))
        path = attempt("panda", 1, task="old")
        console.give([path])
        with Browser() as browser:
            self.let_in(browser, console)
            self.change(browser, console, f"/paths/{path['report_uuid']}", ".page > .tools .grave", path["report_uuid"])
            browser.wait("document.querySelector('main').dataset.ready === location.pathname")
            self.assertGreater(console.rows("paths", "list")[0]["retired_ms"], 0)
            jobs = [json.loads(console.kinship("backup", f"{day}.db", "--no-wait", "--json"))["id"] for day in ("monday", "tuesday", "wednesday", "thursday", "friday")]
            row = f"//table[@aria-label='Jobs']//tr[th='{jobs[-1]}']"
            self.change(browser, console, "/jobs", f"xpath:{row}//button", jobs[-1])
            browser.wait(f"document.evaluate(\"{row}/td[3]\", document, null, XPathResult.STRING_TYPE).stringValue === 'cancelled'")
            self.assertEqual(browser.run("return document.evaluate(`count(${arguments[0]}//button)`, document, null, XPathResult.NUMBER_TYPE).numberValue", row), 0)
            for job in jobs[:-1]:
                console.kinship("jobs", "cancel", job)
            browser.check_console(self)
        self.assertEqual({row["id"]: row["state"] for row in console.rows("jobs", "list")}[jobs[-1]], "cancelled")
        done = [(row["name"], row["verb"], row["target"]) for row in console.rows("audit")]
        self.assertIn(("console", "retire_path", path["report_uuid"]), done)
        self.assertIn(("console", "cancel_job", jobs[-1]), done)

    @staticmethod
    def grow(store: pathlib.Path, size: int) -> None:
        """Free pages, which a copy has too."""
        with contextlib.closing(sqlite3.connect(store)) as database:
            database.execute("CREATE TABLE padding (bytes BLOB)")
            database.execute("INSERT INTO padding VALUES (zeroblob(?))", (size,))
            database.commit()
            database.execute("DROP TABLE padding")
            database.commit()

    @staticmethod
    def let_in(browser: Browser, console: ServedConsole) -> None:
        browser.driver.get(console.link)
        browser.wait("document.querySelector('main[data-ready]')")

    def change(self, browser: Browser, console: ServedConsole, path: str, button: str, name: str) -> None:
        """Opens a page, presses a button, types the name and confirms."""
        browser.driver.get(f"http://{console.host}{path}")
        by = (By.XPATH, button[6:]) if button.startswith("xpath:") else (By.CSS_SELECTOR, button)
        WebDriverWait(browser.driver, 60).until(lambda driver: driver.find_elements(*by))[0].click()
        self.assertFalse(browser.element("dialog .grave").is_enabled())
        browser.press("dialog input", name)
        browser.click("dialog .grave")
        browser.wait("!document.querySelector('dialog')")


class Networks(unittest.TestCase):
    def test_other_networks_are_served_over_tls_alone(self):
        with Kinshipd() as server:
            program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinshipd"
            plain = subprocess.run([program, "--store", server.folder / "none.db", "--domain", str(server.domain), "--console", "0.0.0.0:0"],
                                   capture_output=True, text=True, timeout=60)
            self.assertEqual(plain.returncode, 2)
            self.assertIn("--console '0.0.0.0:0' is not loopback, and without --security", plain.stderr)
            folder = server.folder / "security"
            subprocess.run([program, "secure", "init", folder], check=True, capture_output=True, timeout=60)
            server.start("--security", str(folder), "--console", "0.0.0.0:0", "--console-host", "cell-3.example")
            link = (server.folder / "store.db.console").read_text()
            port, token = re.fullmatch(r"https://[^/]+:(\d+)/\?token=(\w+)\n", link).groups()
            trusted = ssl.create_default_context(cafile=folder / "server" / "ca.pem")  # checks chain and name

            def shown(name: str, context: ssl.SSLContext) -> "tuple":
                with socket.create_connection(("127.0.0.1", int(port)), timeout=30) as plain, context.wrap_socket(plain, server_hostname=name) as secured:
                    return secured.getpeercert()["subjectAltName"]

            for name in ("localhost", "127.0.0.1", "cell-3.example", socket.gethostname()):
                self.assertIn(name, [value for _, value in shown(name, trusted)])
            with self.assertRaisesRegex(ssl.SSLCertVerificationError, "Hostname mismatch"):
                shown("evil.example", trusted)
            with self.assertRaisesRegex(ssl.SSLCertVerificationError, "unable to get local issuer|self.signed"):
                shown("localhost", ssl.create_default_context())
            connection = http.client.HTTPSConnection("127.0.0.1", int(port), context=trusted, timeout=30)
            connection.request("GET", "/?token=" + token)
            reply = connection.getresponse()
            self.assertEqual(reply.status, 200, reply.read())
            self.assertIn("; Secure", reply.headers["Set-Cookie"])
            connection.close()
            with socket.create_connection(("127.0.0.1", int(port)), timeout=30) as clear:
                clear.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertNotIn(b"HTTP/1.1", clear.recv(1000))


if __name__ == "__main__":
    unittest.main()
