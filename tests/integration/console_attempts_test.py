"""Why attempts failed, in the console of a kinshipd that robots report to: real plans, the pages in a browser, their sizes and times."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "docs" / "drawings"))
import console as drawings  # noqa: E402
from served_console import ConsoleTest, Reports  # noqa: E402

TASK = drawings.TASK
_3D = ("three", "OrbitControls")  # the library of 3D, which has no bar
_MOST_BYTES, _MOST_PAINT_MS = 300_000, 500


class Attempts(ConsoleTest):
    @classmethod
    def setUpClass(cls):
        cls.console = drawings.FilledConsole()
        cls.addClassCleanup(cls.console.close)
        cls.rows = cls.console.attempts()
        cls.failed = [row for row in cls.rows if row["record"]["outcome"] != "solved"]
        super().setUpClass()

    def table(self, label: str) -> "list[dict]":
        """Rows by their heads."""
        return self.browser.run("const table = document.querySelector(`table[aria-label='${arguments[0]}']`);"
                                "const heads = [...table.tHead.rows[0].cells].map(cell => cell.textContent);"
                                "return [...table.tBodies[0].rows].map(row => Object.fromEntries([...row.cells].map((cell, i) => [heads[i], cell.textContent])))", label)

    def drawn(self, layer: str, view: int = 0) -> dict:
        return self.browser.run("return kinshipView.counts(document.querySelectorAll('figure.view')[arguments[1]], arguments[0])", layer, view)

    def explained(self, needs_trees: bool) -> dict:
        """A failed attempt, as the command line shows it."""
        for row in self.failed:
            shown = json.loads(self.console.run("kinship", "attempts", "show", row["report_uuid"], "--json"))
            if bool(shown["search"]["trees"]) == needs_trees:
                return shown
        raise AssertionError(f"no failed attempt with trees: {needs_trees}")

    def test_a_row_says_why(self):
        self.open(f"/slow?task={TASK}")
        rows = {row["attempt"]: row for row in self.table("Unsolved")}
        self.assertEqual(set(rows), {row["report_uuid"][:8] for row in self.failed})
        self.assertGreater(len(rows), 3)
        for row in self.failed:
            seen = rows[row["report_uuid"][:8]]
            self.assertEqual(seen["why"], row["why"])
            self.assertIn("touches", row["why"])
            self.assertEqual((seen["task"], seen["robot"]), (TASK, row["label"]))
        searched = [row["why"] for row in self.failed if "last free configuration" in row["why"]]
        self.assertGreater(len(searched), 0)
        self.assertRegex(searched[0], r"400 .*; '.*' touches '.*' \(\d+\).*; last free configuration \d\.\d\d from a goal$")
        slowest = self.table("Slowest of those solved")
        self.assertRegex(slowest[0]["why"], r"^\d+\.\d times the mean of its task and robot")
        times = [row["record"]["planning_time_s"] for row in self.rows if row["record"]["outcome"] == "solved"]
        self.assertEqual([row["attempt"] for row in slowest[:3]],
                         [row["report_uuid"][:8] for row in sorted((r for r in self.rows if r["record"]["outcome"] == "solved"),
                                                                   key=lambda r: -r["record"]["planning_time_s"])[:3]])
        self.assertEqual(len(slowest), min(50, len(times)))
        modes = {row["report_uuid"][:8]: row["record"]["sampling_mode"] for row in self.rows}
        self.assertEqual([row["sampling"].split(",")[0] for row in slowest], [modes[row["attempt"]] for row in slowest])

    def test_rows_are_of_a_robot_and_a_link_keeps_that(self):
        self.open("/slow")
        choose = "const select = document.querySelector(`select[aria-label='Only of this robot']`); select.value = arguments[0]; select.dispatchEvent(new Event('change'))"
        self.browser.run(choose, "my_arm")
        self.browser.wait("document.querySelector(`table[aria-label='Unsolved']`).tBodies[0].rows.length === 0")
        self.assertEqual({row["robot"] for row in self.table("Slowest of those solved")}, {"my_arm"})
        self.assertEqual([row["robot"] for row in self.table("By task and robot")], ["my_arm"])
        address = self.browser.run("return location.href")
        self.assertIn("robot=my_arm", address)
        self.browser.click("table[aria-label='Slowest of those solved'] tbody a")
        self.ready()
        self.browser.run("history.back()")
        self.browser.wait("document.querySelector(`table[aria-label='By task and robot']`)?.tBodies[0].rows.length === 1")
        self.assertEqual(self.browser.run("return location.href"), address)
        self.assertEqual({row["robot"] for row in self.table("Slowest of those solved")}, {"my_arm"})

    def test_from_a_failed_query_to_its_cause(self):
        """The way of somebody who was told that a query failed: two clicks."""
        begin = time.monotonic()
        self.open("/")
        self.browser.click("#nav a[href='/slow']")
        self.browser.wait("document.querySelector(`table[aria-label='Unsolved']`)?.tBodies[0].rows.length")
        first = self.table("Unsolved")[0]
        self.browser.click("table[aria-label='Unsolved'] tbody a")
        self.browser.wait("document.querySelector('.figure canvas')")
        self.assertIn(first["attempt"], self.browser.run("return location.pathname"))
        most = re.search(r"'([^']*)' touches '([^']*)' \(", first["why"]).groups()
        self.assertTrue(all(name in self.browser.text("#why-text") for name in most), self.browser.text("#why-text"))
        self.assertGreater(self.drawn("blocking")["objects"], 0)
        print(f"from the fleet's page to the bodies in the way: {time.monotonic() - begin:.1f} s without the reader's")

    def test_what_touches_at_each_goal_is_marked(self):
        attempt = self.explained(needs_trees=False)
        search = attempt["search"]
        self.open(f"/attempts/{attempt['report_uuid']}")
        self.browser.wait("document.querySelector('.figure canvas')")
        names = [button.text for button in self.browser.elements("#places button")]
        goals = len(search["goals"])
        self.assertEqual(names, ["start", *(f"goal {i + 1}" for i in range(goals))])
        solids = self.drawn("arm")["objects"] + self.drawn("blocking")["objects"] + self.drawn("scene")["objects"]
        for i in range(goals):
            self.browser.click(f"#places button:nth-child({i + 2})")
            contacts = [each for each in search["goal_contacts"] if each["goal"] == i]
            text = self.browser.text("#place")
            self.assertGreater(len(contacts), 0)
            for each in contacts:
                self.assertIn(f"\u201c{each['first']}\u201d touches \u201c{each['second']}\u201d", text)
            self.assertGreaterEqual(self.drawn("blocking")["objects"], len({name for each in contacts for name in (each["first"], each["second"])}))
            self.assertEqual(self.drawn("arm")["objects"] + self.drawn("blocking")["objects"] + self.drawn("scene")["objects"], solids)
        rows = self.browser.run("return [...document.querySelectorAll('#blockers tbody tr')].map(row => [...row.cells].map(cell => cell.textContent))")
        blocked = {(each["first"], each["second"]): [0, each["count"]] for each in search["blockers"]}
        for pair in {(each["first"], each["second"], each["goal"]): each for each in search["goal_contacts"]}:
            blocked.setdefault(pair[:2], [0, 0])[0] += 1
        first = sorted(blocked.items(), key=lambda each: each[1], reverse=True)  # what blocks goals
        self.assertEqual(rows, [[" and ".join(pair), f"{of} of {goals}" if of else "\u2013", str(count)] for pair, (of, count) in first])

    def test_trees_grow_as_they_were_recorded(self):
        attempt = self.explained(needs_trees=True)
        self.open(f"/attempts/{attempt['report_uuid']}")
        self.browser.wait("document.querySelector('#growth .player')")
        nodes = [len(tree["parents"]) for tree in attempt["search"]["trees"]]
        for i, tree in enumerate(attempt["search"]["trees"]):
            self.assertEqual((self.drawn(f"tree-{i}")["points"], self.drawn(f"tree-{i}")["segments"]),
                             (nodes[i], sum(parent >= 0 for parent in tree["parents"])))
        put = "const slider = document.querySelector('#growth input'); slider.value = arguments[0]; slider.dispatchEvent(new Event('input'))"
        self.browser.run(put, 0.5)
        self.assertEqual(self.browser.text("#growth output"), f"{sum(max(1, int(n / 2 + 0.5)) for n in nodes)} of {sum(nodes)} nodes")
        half = [self.drawn(f"tree-{i}")["grown"] for i in range(len(nodes))]
        self.assertEqual([points for _, points in half], [max(1, int(n / 2 + 0.5)) for n in nodes])
        for (lines, points), tree in zip(half, attempt["search"]["trees"]):
            self.assertEqual(lines, sum(parent >= 0 for parent in tree["parents"][:points]))
        self.browser.run(put, 0)
        self.browser.click("#growth button")
        self.browser.wait("Number(document.querySelector('#growth input').value) > 0")
        self.assertIn("last free", [button.text for button in self.browser.elements("#places button")])

    def test_the_same_query_uniform_is_beside_the_guided_one(self):
        guided = next(row["report_uuid"] for row in self.rows if row["record"]["sampling_mode"] == "guided")
        self.open(f"/attempts/{guided}")
        self.browser.wait("document.querySelectorAll('#beside canvas').length === 2")
        cells = self.browser.run("return [...document.querySelectorAll('#beside table tr')].map(row => [...row.cells].map(cell => cell.textContent))")
        self.assertEqual(cells[0], ["", "uniform", "guided (this one)"])
        other = self.browser.element("#beside thead a").get_attribute("href").rsplit("/", 1)[1]
        record = {row["report_uuid"]: row["record"] for row in self.rows}
        checks = next(row for row in cells if row[0] == "collision checks")
        self.assertEqual([text.replace("\u202f", "") for text in checks[1:]], [str(record[other]["collision_checks"]), str(record[guided]["collision_checks"])])
        both = [json.loads(self.console.run("kinship", "paths", "show", name, "--json")) for name in (other, guided)]
        for a, b in zip(both[0]["waypoints"][0], both[1]["waypoints"][0]):
            self.assertAlmostEqual(a, b, places=6)
        for view in (1, 2):
            self.assertEqual(self.drawn("way", view)["ways"], 1)
            self.assertEqual(self.drawn("arm", view)["objects"], self.drawn("arm")["objects"])
        before = self.browser.text("#beside output")
        self.browser.click("#beside .player button")
        self.browser.wait(f"document.querySelector('#beside output').textContent !== {json.dumps(before)}")

    def test_every_page_is_light_and_quick_while_robots_report(self):
        distribution = json.loads(self.console.run("kinship", "distributions", "list", "--json"))["rows"][0]["id"]
        solved = next(row["report_uuid"] for row in self.rows if row["record"]["outcome"] == "solved")
        paths = ["/", "/robots", "/tasks", "/distributions", "/slow", "/jobs", "/audit", "/clients", "/robots/ur10e", f"/tasks/{TASK}",
                 f"/distributions/{distribution}", f"/paths/{solved}", f"/attempts/{self.failed[0]['report_uuid']}"]
        with Reports(self.give, 10, "ur10e"):
            plain = min(self.paint("/assets/console.css") for _ in range(3))  # the browser's own share, on a machine that other tests use too
            for path in paths:
                with self.subTest(path=path):
                    self.browser.driver.execute_cdp_cmd("Network.clearBrowserCache", {})
                    self.browser.driver.execute_cdp_cmd("Network.setCacheDisabled", {"cacheDisabled": True})
                    self.open(path)
                    if path.count("/") > 1:
                        self.browser.wait("document.querySelector('.figure').children.length")
                    sizes = self.browser.run("return performance.getEntriesByType('resource').concat(performance.getEntriesByType('navigation'))"
                                             ".map(e => [e.name.split('/').pop().split('?')[0], e.encodedBodySize])")
                    size = sum(bytes for name, bytes in sizes if not name.startswith(_3D))
                    self.browser.driver.execute_cdp_cmd("Network.setCacheDisabled", {"cacheDisabled": False})
                    paint = min(self.paint(path) for _ in range(2))
                    for _ in range(4):  # other tests may have held it up
                        if paint - plain >= _MOST_PAINT_MS:
                            paint = min(paint, self.paint(path))
                    print(f"{re.sub('[0-9a-f-]{20,}', 'ID', path):22} {size:7} bytes ({len(sizes)} replies), first paint after {paint:4.0f} ms, of a plain text {plain:.0f} ms")
                    self.assertGreater(size, 10_000)
                    self.assertLess(size, _MOST_BYTES)
                    self.assertLess(paint - plain, _MOST_PAINT_MS)
                    self.browser.check_console(self)

    def give(self, attempts: "list[dict]") -> None:
        file = self.console.server.folder / "load.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in attempts))
        self.console.run("kinship", "paths", "import", str(file))

    def paint(self, path: str) -> float:
        self.browser.driver.get("about:blank")  # until what a page before drew in 3D is gone
        self.browser.driver.get(f"http://{self.console.host}{path}")
        return self.browser.wait("(performance.getEntriesByName('first-contentful-paint')[0] || {}).startTime")


class Pictures(unittest.TestCase):
    def test_the_script_makes_those_of_the_handbook(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, drawings.__file__, folder], check=True, timeout=300)
            made = sorted(file.name for file in pathlib.Path(folder).iterdir())
            kept = {file.name: file.stat().st_size for file in (drawings.ROOT / "docs" / "drawings").glob("console_*.webp")}
            self.assertEqual(made, sorted(kept))
            self.assertLess(sum(kept.values()), 400_000)
            handbook = (drawings.ROOT / "docs" / "console.md").read_text()
            for name in made:
                self.assertIn(f"](drawings/{name})", handbook)


if __name__ == "__main__":
    unittest.main()
