"""The pages of `distributions plot`, `tasks plot` and `robots compare`, of a real kinshipd, in a browser."""
import json
import pathlib
import re
import tempfile
import unittest
import uuid

import numpy as np

from browser import BrowserTest, pixels_of, share_drawn
from kinshipd_process import Kinshipd
from strict_server import StrictServer, taken_apart

TASK = "sweep"
READY = {"panda": np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785]), "ur10e": np.array([0, -1.2, 1.8, -2.2, -1.57, 0])}
GUIDED = (11, 122, 117)  # of the style, light
# What a page shows, told by its parts and by the colours that styles give them.
SHOWN = """return [document.querySelectorAll("canvas").length, document.querySelectorAll("svg *").length, document.querySelectorAll("td").length,
  [...document.querySelectorAll("i, button")].map(element => getComputedStyle(element).backgroundColor)]"""


def attempt(robot: str, seed: int, **record) -> dict:
    """A line of an experience file: the hand sweeps in front of the robot, a little different for every seed."""
    waypoints = np.tile(READY[robot], (4, 1))
    waypoints[:, 0] += -0.9 + 0.6 * np.arange(4)
    waypoints += np.random.default_rng(seed).uniform(-0.1, 0.1, waypoints.shape)
    known = {"outcome": "solved", "planner": "birrt", "planner_options": "", "planning_time_s": 0.5, "collision_checks": 1000,
             "time_limit_s": 10, **record}
    return {"report_uuid": str(uuid.UUID(int=seed + 1000 * sum(robot.encode()))), "task": TASK, "robot": robot, "machine": "test",
            "T_task_base": [0, 0, 0, 0, 0, 0, 1], "waypoints": waypoints.tolist() if known["outcome"] == "solved" else None,
            "record": known, "scene": None}


def digits(text: str) -> str:
    """A count as people see it without its narrow spaces."""
    return text.replace("\u202f", "")


class PlotPages(BrowserTest):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start()
        cls.folder = cls.server.folder
        cls.kinship = cls.server.kinship
        cls.server.register(*READY)
        cls.server.give([attempt("panda", seed, collision_checks=900 + 20 * seed) for seed in range(12)])
        query = ("--task", TASK, "--robot", "ur10e", "--placement", "0 0 0 0 0 0 1", "--profile", "default,components=auto", "--wait", "100")
        cls.first = json.loads(cls.kinship("distributions", "fetch", *query, "--json"))
        used = {"distribution_id": cls.first["id"], "distribution_revision": cls.first["revision"]}
        own = []
        for seed in range(12):
            own.append(attempt("ur10e", 2 * seed, sampling_mode="guided", share=0.5, collision_checks=300 + 11 * seed, **used))
            own.append(attempt("ur10e", 2 * seed + 1, sampling_mode="control", collision_checks=900 + 13 * seed, **used))
        own.append(attempt("ur10e", 50, outcome="timeout", collision_checks=5000))
        own.append(attempt("ur10e", 51, outcome="failed", collision_checks=0))
        cls.server.give(own)
        cls.kinship("distributions", "fetch", *query)
        cls.shown = json.loads(cls.kinship("distributions", "show", cls.first["id"], "--json"))
        cls.explained = cls.kinship("distributions", "explain", "--distribution", cls.first["id"])
        cls.kinship("distributions", "plot", cls.first["id"], "--output", str(cls.folder / "distribution.html"))
        cls.kinship("tasks", "plot", TASK, "--output", str(cls.folder / "task.html"))
        cls.compared = json.loads(cls.kinship("robots", "compare", "--task", TASK, "--json", "--output", str(cls.folder / "worths.html")))
        super().setUpClass()

    def table(self, selector: str) -> "list[list[str]]":
        return self.browser.run("return [...document.querySelector(arguments[0]).rows].map(row => [...row.cells].map(cell => cell.textContent))",
                                selector)

    def marks(self, selector: str, color: str) -> int:
        """How many marks of charts have a colour and a size."""
        return self.browser.run("return [...document.querySelectorAll(arguments[0] + ' svg [fill=\"' + arguments[1] + '\"]')]"
                                ".filter(mark => mark.getBBox().width > 0 && mark.getBBox().height > 0).length", selector, color)

    def test_a_distribution_has_the_numbers_of_show(self):
        data = self.load("distribution.html")
        shown = self.shown
        self.assertEqual(data["distribution"], {**shown, "weights": None, "means": None, "covariances": None})
        tiles = [digits(each.text) for each in self.browser.elements(".tile b")]
        self.assertEqual(tiles, [str(len(shown["weights"])), str(shown["configurations"]), str(sum(s["paths_used"] for s in shown["sources"])),
                                 f"{shown['recommended_share']:.2f}"])
        np.testing.assert_allclose([weight for weight, _ in data["components"]], sorted(shown["weights"], reverse=True)[:200], rtol=1e-6)
        facts = self.browser.text("#facts")
        for known in (f"revision {shown['revision']}", shown["profile"], shown["engines"], "ur10e"):
            self.assertIn(known, facts)
        rows = self.table("#sources")[1:]
        self.assertEqual([(row[0], digits(row[4])) for row in rows], [(s["label"], str(s["poses"])) for s in shown["sources"]])
        best = max(shown["k_curve"], key=lambda each: each["score"])
        self.assertIn(f"the highest was chosen: {best['K']}", self.browser.text("#components"))

    def test_a_distribution_is_drawn(self):
        data = self.load("distribution.html")
        self.assertGreater(pixels_of(self.browser.picture("#hands canvas"), GUIDED, 40), 300, "the cloud")
        self.browser.click("[data-layer=samples]")
        self.assertLess(pixels_of(self.browser.picture("#hands canvas"), GUIDED, 40), 300, "hidden")
        self.assertGreater(share_drawn(self.browser.picture("#hands canvas")), 0.01, "the arm stays")
        self.assertEqual([sum(each["counts"]) for each in data["marginals"]], 6 * [2000])
        for number, marginal in enumerate(data["marginals"], 1):
            figure = f"#joints figure:nth-child({number})"
            self.assertEqual(self.browser.text(f"{figure} h3"), marginal["joint"])
            self.assertEqual(self.marks(figure, "#0b7a75") + self.marks(figure, "#b03a48"), sum(n > 0 for n in marginal["counts"]))
        picture = self.browser.picture("#joints")
        self.assertGreater(pixels_of(picture, GUIDED, 12), 2000, "bars")
        self.assertGreater(int((picture[:, :, 0].astype(int) - picture[:, :, 1] > 40).sum()), 1000, "red lines at the limits")
        self.assertEqual(self.marks("#components figure:nth-child(1)", "#0b7a75"), len(data["components"]))
        self.assertGreater(pixels_of(self.browser.picture("#poses"), GUIDED, 30), 1000, "poses solved")

    def test_a_task_has_the_numbers_of_show(self):
        data = self.load("task.html")
        task = json.loads(self.kinship("tasks", "show", TASK, "--json"))
        self.assertEqual([(r["label"], r["attempts"], r["solved"]) for r in data["robots"]],
                         [(r["label"], r["attempts"], r["paths"]) for r in task["robots"]])
        self.assertEqual(self.table("#robots")[2][:8], ["ur10e", "26", "24", "1", "1", "12", "12", "1"])
        self.assertIn(self.first["id"][:12], [row[1] for row in self.table("#revisions")])
        self.assertGreater(share_drawn(self.browser.picture("#experience")), 0.01)
        solved = sum(any(mode["attempts"] for mode in each["modes"]) for robot in data["robots"] for each in robot["bins"])
        self.assertEqual(self.marks("#solved", "#2f6fde") + self.marks("#solved", "#d07a1f"), solved, "a dot for each bin of a robot")
        self.assertGreaterEqual(self.marks("#checks figure:nth-child(2)", "#0b7a75"), 1, "medians of guided attempts")
        self.assertGreaterEqual(self.marks("#benefit", "#0b7a75"), 1)

    def test_benefit_is_what_the_server_advises_by(self):
        self.load("task.html")
        advised = re.search(r"typical ratio uniform / guided (\S+) \(90 % (\S+) to (\S+)\)", self.explained)
        self.assertIsNotNone(advised, self.explained)
        self.assertIn(f"ur10e: {advised[1]} ({advised[2]} to {advised[3]})", self.browser.text("#benefit"))

    def test_a_matrix_has_the_numbers_of_compare(self):
        data = self.load("worths.html")
        self.assertEqual(data, self.compared)
        self.assertGreaterEqual(len(data["rows"]), 4)
        known = [row for row in data["rows"] if row["worth"] is not None]
        self.assertTrue(known)
        cells = {each.get_attribute("aria-label").split(":")[0]: each for each in self.browser.elements("#matrix button")}
        self.assertEqual(len(cells), len(data["rows"]))
        self.assertIn("No query is helped by its own answer, in a robot\u2019s own cell neither", self.browser.text("#matrix-text"))
        for row in known:
            self.assertIn(f"{row['worth']:.2f}", cells[f"{row['target_label']} from {row['source_label']}"].text)
        own = cells["ur10e from ur10e"]
        self.assertIn("own", own.get_attribute("class"))
        self.browser.run("arguments[0].focus()", own)
        rehearsal = next(row["rehearsal"] for row in data["rows"] if row["target_label"] == row["source_label"] == "ur10e")
        self.assertIn(f"{rehearsal['queries']} recorded quer", self.browser.text("#detail"))
        self.assertEqual(len(self.table("#pairs")), 1 + len(data["rows"]))

    def test_figures_are_drawn_under_a_strict_content_security_policy(self):
        for page in ("distribution.html", "task.html", "worths.html"):
            with tempfile.TemporaryDirectory() as folder, StrictServer(pathlib.Path(folder)) as server:
                taken_apart(self.folder / page, pathlib.Path(folder))
                self.load(page)
                inline = self.browser.run(SHOWN)
                self.browser.driver.get(f"{server.address}/index.html")
                self.browser.settle()
                self.assertEqual(self.browser.run(SHOWN), inline, page)
                self.browser.check_console(self)

    def test_pages_fit_a_phone_and_the_dark(self):
        for page in ("distribution.html", "task.html", "worths.html"):
            self.browser.resize(400, 800)
            self.load(page)
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 400, page)
            light = {color: self.marks("body", color) for color in ("#0b7a75", "#3fc1b8")}
            self.browser.prefer("dark")
            self.assertEqual(self.browser.run("return getComputedStyle(document.body).backgroundColor"), "rgb(15, 19, 23)", page)
            self.assertEqual(self.marks("body", "#3fc1b8"), light["#0b7a75"], page + ": charts are drawn anew")
            self.assertEqual(light["#3fc1b8"], 0)
            self.browser.prefer("light")

    def test_a_table_that_is_cut_shows_that_there_is_more(self):
        """By a shadow at that side; keys scroll it."""
        self.browser.resize(400, 800)
        for page, table in (("distribution.html", "sources"), ("task.html", "revisions"), ("worths.html", "pairs")):
            self.load(page)
            for frame in self.browser.elements(".scroll"):
                self.assertEqual(frame.get_attribute("tabindex"), "0", page)
                self.assertTrue(frame.get_attribute("aria-label"), page)
            hidden = self.browser.run("const frame = document.getElementById(arguments[0]).parentElement; frame.dataset.of = arguments[0];"
                                      "return frame.scrollWidth - frame.clientWidth", table)
            self.assertGreater(hidden, 40, page)
            for scrolled, has_left, has_right in ((0, False, True), (hidden, True, False)):
                self.browser.run("document.querySelector(arguments[0]).scrollLeft = arguments[1]", f"[data-of={table}]", scrolled)
                above = self.browser.picture(f"[data-of={table}]")[4].mean(axis=1)  # the table's margin, where there is nothing else
                self.assertEqual((above[1] < 250, above[-2] < 250), (has_left, has_right), f"{page} at {scrolled}: {above[1]}, {above[-2]}")

    def test_a_toggle_that_is_off_is_not_struck_through(self):
        self.load("distribution.html")
        toggle = self.browser.element(".legend button[aria-pressed=true]")
        self.browser.run("arguments[0].click()", toggle)
        self.assertEqual(toggle.get_attribute("aria-pressed"), "false")
        self.assertEqual(toggle.value_of_css_property("text-decoration-line"), "none")
        self.assertEqual(toggle.value_of_css_property("border-top-style"), "dashed")

    def test_what_is_not_there_is_code_three_and_leaves_the_file(self):
        kept = self.folder / "kept.html"
        kept.write_text("mine")
        for words in (("distributions", "plot", "abcdef"), ("distributions", "plot", "--task", "nothing", "--robot", "ur10e"),
                      ("tasks", "plot", "nothing"), ("robots", "compare", "--task", "nothing")):
            done = self.server.run_kinship(*words, "--output", str(kept))
            self.assertEqual(done.returncode, 3, done.stderr.decode())
            self.assertIn(" ".join(words[:2]), done.stderr.decode())
            self.assertEqual(kept.read_text(), "mine")
            self.assertFalse((self.folder / "kept.html.part").exists())

    def test_a_page_goes_to_standard_output(self):
        page = self.kinship("tasks", "plot", TASK, "--output", "-")
        self.assertTrue(page.startswith("<!DOCTYPE html>"))
        self.kinship("tasks", "plot", TASK, "--output", str(self.folder / "again.html"))
        self.assertEqual(page, (self.folder / "again.html").read_text())


if __name__ == "__main__":
    unittest.main()
