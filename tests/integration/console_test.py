"""The live console of a real kinshipd, in a browser: each page opened, clicked, narrow and wide, its numbers those of the CLI."""
import json
import re
import unittest
import urllib.parse

from selenium.webdriver.common.keys import Keys

from served_console import MACHINE, MODELS, READY, TASK, ConsoleTest, Reports, ServedConsole, attempt


class Pages(ConsoleTest):
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
        super().setUpClass()

    def table(self, label: str) -> "list[list[str]]":
        return self.browser.run("return [...document.querySelector(`table[aria-label=\"${arguments[0]}\"]`).tBodies[0].rows]"
                                ".map(row => [...row.cells].map(cell => cell.textContent))", label)

    def column(self, label: str, index: int) -> "list[str]":
        return [row[index].replace("\u202f", "") for row in self.table(label)]

    def tile(self, text: str) -> str:
        return self.browser.run("return [...document.querySelectorAll('.tile')].find(t => t.lastChild.textContent.startsWith(arguments[0])).firstChild.textContent",
                                text).replace("\u202f", "")

    def test_every_page_fits_its_window_while_robots_report(self):
        paths = ["/", "/robots", "/tasks", "/distributions", "/slow", "/jobs", "/audit", "/clients", "/robots/panda",
                 "/tasks/" + urllib.parse.quote(TASK, safe=""),
                 f"/distributions/{self.distribution['id']}", f"/attempts/{attempt('ur10e', 50)['report_uuid']}", f"/paths/{attempt('panda', 1)['report_uuid']}"]
        with Reports(self.console.give, 10):
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
        self.browser.wait(f"[...document.querySelectorAll('.tile')].some(t => t.lastChild.textContent === 'attempts' && t.firstChild.textContent.replace(/\\D/g, '') === '{before + 1}')")
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
            self.browser.press("input[type=search]", before[0][1 if label != "Clients" else 0].split()[0])
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
                         ["1.0 times the mean of its task and robot", "other", "panda", "7.50\u202fs of 10\u202fs", MACHINE])
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


if __name__ == "__main__":
    unittest.main()
