"""Tasks and distributions in space, of a real kinshipd, in a browser: what is drawn, brushed and picked, on pages and in the console."""
import json
import unittest
import urllib.parse
import uuid

import numpy as np
from selenium.webdriver.common.keys import Keys

from browser import pixels_of, share_drawn
from kinshipd_process import MODELS
from served_console import ConsoleTest, ServedConsole

TASK = "load:store"
READY = {"panda": np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785]), "ur10e": np.array([0, -1.2, 1.8, -2.2, -1.57, 0])}
BASES = {"panda": [0, 0, 0, 0, 0, 0, 1], "ur10e": [-0.2, 0.3, 0.1, 0, 0, 0, 1]}
COUNTS = {"panda": 30, "ur10e": 20}
PICKED = (194, 24, 138)  # of the style, light
BLOCKING = (194, 53, 43)


def scene(height: float) -> dict:
    """A shelf and a table; equal ones are one scene."""
    return {"boxes": [{"name": "shelf", "size": [0.3, 0.8, 0.02], "pose": [0.9, 0, height, 0, 0, 0, 1]},
                      {"name": "table", "size": [0.8, 1.2, 0.04], "pose": [0.6, 0, -0.2, 0, 0, 0, 1]}],
            "spheres": [{"name": "ball", "radius": 0.05, "center": [0.9, 0, height + 0.1]}], "held": [], "allowed_collisions": []}


def attempt(robot: str, number: int, **changes) -> dict:
    """The hand sweeps in front of the robot, a little different for every number; from 25 on in another scene."""
    waypoints = np.tile(READY[robot], (4, 1))
    waypoints[:, 0] += -0.9 + 0.6 * np.arange(4)
    waypoints += np.random.default_rng(number).uniform(-0.1, 0.1, waypoints.shape)
    record = {"outcome": "solved", "planner": "birrt", "planning_time_s": 0.1 * (number + 1), "collision_checks": 100 * (number + 1)}
    return {"report_uuid": str(uuid.UUID(int=(number + 1) << 96 | sum(robot.encode()))), "task": TASK, "robot": robot, "machine": "test",
            "T_task_base": BASES[robot], "waypoints": waypoints.tolist(), "record": record, "scene": scene(0.6 if number < 25 else 0.9), **changes}


def raised() -> dict:
    """A path far above all others."""
    waypoints = [[-1.2 + 0.8 * i, 0, 0, -0.2, 0, 1.5, 0.785] for i in range(4)]
    return attempt("panda", COUNTS["panda"] - 1, waypoints=waypoints, scene=scene(0.9))


class Space(ConsoleTest):
    @classmethod
    def setUpClass(cls):
        cls.console = ServedConsole()
        cls.addClassCleanup(cls.console.close)
        cls.server = cls.console.server
        cls.folder = cls.server.folder
        cls.server.register(*READY)
        cls.given = [attempt(robot, i) for robot, n in COUNTS.items() for i in range(n)]
        cls.given[COUNTS["panda"] - 1] = cls.raised = raised()
        gone, unsolved = attempt("panda", 100), attempt("ur10e", 101, waypoints=None)
        unsolved["record"] = {**unsolved["record"], "outcome": "timeout"}
        cls.server.give([*cls.given, gone, unsolved])
        cls.server.kinship("paths", "retire", gone["report_uuid"], "--yes")
        query = ("--task", TASK, "--robot", "ur10e", "--placement", "-0.2 1.3 0.1 0 0 0 1", "--wait", "100")
        cls.kept = [json.loads(cls.server.kinship("distributions", "fetch", *query, "--profile", profile, "--json"))
                    for profile in ("default", "default,components=3")]
        cls.server.kinship("tasks", "plot", TASK, "--output", str(cls.folder / "task.html"))
        cls.server.kinship("distributions", "plot", cls.kept[1]["id"], "--output", str(cls.folder / "distribution.html"))
        super().setUpClass()

    def count(self, layer: str) -> dict:
        return self.browser.run("return shown.count(arguments[0])", layer)

    def segments(self) -> "list[int]":
        """Of each group of a colour."""
        return [int(self.count(f"group-{i}")["segments"]) for i in range(8)]

    def keys(self) -> "list[str]":
        """What the colours mean, as the legend has it."""
        return self.browser.run("return [...document.querySelectorAll('[data-layer^=group]')].filter(b => !b.hidden).map(b => b.textContent)")

    def rows(self) -> "list[str]":
        """Paths in the table."""
        return self.browser.run("return [...document.querySelectorAll('#space-paths tbody tr')].filter(row => !row.hidden).map(row => row.dataset.path)")

    def picked(self) -> "list[str]":
        return self.browser.run("return [...document.querySelectorAll('#space-paths [aria-current=true]')].map(row => row.dataset.path)")

    def brush(self, end: str, value: int) -> None:
        self.browser.run("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))",
                         self.browser.element(f"[data-end={end}]"), value)
        self.browser.settle()

    def uuids(self, robot: "str | None" = None) -> "list[str]":
        return [each["report_uuid"] for each in self.given if robot in (None, each["robot"])]

    def test_all_paths_in_use_are_drawn_once(self):
        data = self.load("task.html")["space"]
        self.assertEqual(data["in_use"], 50)
        self.assertEqual(sorted(path["uuid"] for path in data["paths"]), sorted(self.uuids()))
        self.assertEqual(sorted(self.rows()), sorted(self.uuids()))
        self.assertEqual(sum(self.segments()), sum(len(path["hand"]) // 3 - 1 for path in data["paths"]))
        self.assertEqual((self.count("starts")["points"], self.count("goals")["points"]), (50, 50))
        self.assertEqual(self.count("arms")["ways"], 2)
        self.assertEqual(self.count("scene")["objects"], 3)
        self.assertEqual(self.keys(), ["panda", "ur10e"])
        self.assertEqual([(each["paths"], each["objects"][0]["pose"][2]) for each in data["scenes"]], [(45, 0.6), (5, 0.9)])
        self.assertIn("50 paths in use", self.browser.text("#space-text"))
        self.assertGreater(share_drawn(self.browser.picture("#space canvas")), 0.03)

    def test_a_way_begins_and_ends_where_the_hand_does(self):
        data = self.load("task.html")["space"]
        for given in (self.given[3], self.given[40]):
            drawn = next(path for path in data["paths"] if path["uuid"] == given["report_uuid"])["hand"]
            for q, place in ((given["waypoints"][0], drawn[:3]), (given["waypoints"][-1], drawn[-3:])):
                answer = json.loads(self.server.kinship("robots", "fk", str(MODELS / given["robot"]), "--q", " ".join(map(repr, q)), "--json"))
                np.testing.assert_allclose(np.array(place) / 1000, np.array(answer["transfer"][:3]) + given["T_task_base"][:3], atol=6e-4)

    def test_robots_are_brushed_by_buttons(self):
        self.load("task.html")
        both = self.browser.picture("#space canvas")
        self.browser.click("[data-robot=panda]")
        self.assertEqual(sorted(self.rows()), sorted(self.uuids("ur10e")))
        self.assertEqual(self.count("starts")["points"], 20)
        self.assertEqual(self.keys(), ["ur10e"])
        self.assertEqual(self.count("arms")["ways"], 1)
        self.assertGreater(np.mean(self.browser.picture("#space canvas") != both), 0.005)
        self.browser.click("[data-robot=ur10e]")
        self.assertEqual((self.rows(), sum(self.segments())), ([], 0))
        self.assertIn("0 of 50", self.browser.text("#space-shown"))
        self.browser.click("[data-robot=panda]")
        self.assertEqual(sorted(self.rows()), sorted(self.uuids("panda")))

    def test_time_is_brushed_by_two_sliders(self):
        data = self.load("task.html")["space"]
        order = [path["uuid"] for path in data["paths"]]
        self.brush("from", 40)
        self.assertEqual(sorted(self.rows()), sorted(order[40:]))
        self.brush("to", 44)
        self.assertEqual(sorted(self.rows()), sorted(order[40:45]))
        self.assertEqual(self.count("goals")["points"], 5)
        self.brush("to", 10)
        self.assertEqual(self.rows(), [order[10]], "the other end gives way")
        self.assertIn("path 11 of 50", self.browser.text("#space-time output"))

    def test_colours_tell_robot_age_and_cost(self):
        self.load("task.html")
        whole = sum(self.segments())
        pictures = [self.browser.picture("#space canvas")]
        for color in ("age", "cost"):
            self.browser.click(f"[data-color={color}]")
            self.assertEqual(sum(self.segments()), whole)
            pictures.append(self.browser.picture("#space canvas"))
            self.assertGreater(np.mean(pictures[-1] != pictures[-2]), 0.002)
        bounds = [int("".join(filter(str.isdigit, text))) for text in self.keys()]
        self.assertEqual(bounds, [500, 900, 1300, 1700, 2200, 3000], "sixths of what was planned")
        self.browser.click("[data-color=robot]")
        self.assertEqual(self.keys(), ["panda", "ur10e"])

    def test_a_row_that_is_picked_is_marked_in_the_picture(self):
        data = self.load("task.html")["space"]
        first = self.rows()[2]
        self.browser.click(f"tr[data-path='{first}'] button")
        self.assertEqual(self.picked(), [first])
        self.assertEqual(self.count("picked")["ways"], 1)
        self.assertGreater(pixels_of(self.browser.picture("#space canvas"), PICKED, 60), 150)
        self.assertIn(f"kinship paths plot {first}", self.browser.text("#space-picked"))
        self.browser.press(f"tr[data-path='{first}'] button", Keys.ARROW_DOWN)
        following = self.rows()[3]
        self.assertEqual(self.picked(), [following])
        self.assertEqual(self.browser.run("return document.activeElement.closest('tr').dataset.path"), following)
        known = {path["uuid"]: path for path in data["paths"]}
        for given in (self.given[5], self.given[27]):
            self.browser.click(f"tr[data-path='{given['report_uuid']}'] button")
            self.assertEqual(self.browser.run("return document.querySelector('#space-scene').value"), str(known[given["report_uuid"]]["scene"]))
        self.assertEqual(known[self.given[27]["report_uuid"]]["scene"], 1)
        self.browser.click("[data-robot=panda]")
        self.assertEqual((self.picked(), self.count("picked")["ways"]), ([], 0), "what is brushed away is not picked")

    # Pixels between a place and a line in the picture.
    FROM_LINE = """const {width, height} = document.querySelector('#space canvas').getBoundingClientRect(), [place, line] = arguments;
      const at = (p) => { const v = new THREE.Vector3(...p).project(shown.drawing.camera); return [v.x * width / 2, v.y * height / 2]; };
      const here = at(place);
      let least = Infinity;
      for (let k = 3; k < line.length; k += 3)
        for (let part = 0; part <= 1; part += 0.01) {
          const there = at([0, 1, 2].map((i) => line[k - 3 + i] + part * (line[k + i] - line[k - 3 + i])));
          least = Math.min(least, Math.hypot(there[0] - here[0], there[1] - here[1]));
        }
      return least;"""

    def click_in_picture(self, place: str, *arguments) -> None:
        """\\param place  JavaScript, which gives a place in the picture, its sides being -1 and 1."""
        self.browser.run("document.querySelector('#space canvas').scrollIntoView({block: 'center', behavior: 'instant'})")
        x, y = self.browser.run(f"const p = {place}, r = document.querySelector('#space canvas').getBoundingClientRect();"
                                "return [r.left + (p.x + 1) / 2 * r.width, r.top + (1 - p.y) / 2 * r.height]", *arguments)
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1})
        self.browser.settle()

    def test_a_path_that_is_picked_in_the_picture_is_marked_in_the_table(self):
        data = self.load("task.html")["space"]
        hand = next(path for path in data["paths"] if path["uuid"] == self.raised["report_uuid"])["hand"]
        middle = 3 * (len(hand) // 6)
        self.click_in_picture("new THREE.Vector3(...arguments[0]).project(shown.drawing.camera)", [n / 1000 for n in hand[middle:middle + 3]])
        self.assertEqual(self.picked(), [self.raised["report_uuid"]])
        row = self.browser.run("const row = document.querySelector('[aria-current=true]'), list = row.closest('.list').getBoundingClientRect(),"
                               "here = row.getBoundingClientRect(); return here.top >= list.top && here.bottom <= list.bottom")
        self.assertTrue(row, "it is seen")
        paths = {path["uuid"]: path["hand"] for path in data["paths"]}
        for given in self.given[:5]:  # in the crowd: the nearest one, which another may be
            place = [n / 1000 for n in paths[given["report_uuid"]][3:6]]
            self.click_in_picture("new THREE.Vector3(...arguments[0]).project(shown.drawing.camera)", place)
            [picked] = self.picked()
            self.assertLess(self.browser.run(self.FROM_LINE, place, [n / 1000 for n in paths[picked]]), 1.5, "pixels from the click")
        self.click_in_picture("{x: -0.95, y: -0.95}")
        self.assertEqual(self.picked(), [], "beside all of them")

    def test_the_table_is_sorted_by_its_heads(self):
        data = self.load("task.html")["space"]
        order = [path["uuid"] for path in data["paths"]]
        self.assertEqual(self.rows(), order[::-1], "the newest first")
        self.browser.click("#space-paths th:nth-child(4) button")
        checks = {path["uuid"]: path["checks"] for path in data["paths"]}
        self.assertEqual([checks[row] for row in self.rows()], sorted(checks.values()))
        self.browser.click("#space-paths th:nth-child(4) button")
        self.assertEqual([checks[row] for row in self.rows()], sorted(checks.values(), reverse=True))

    def test_pages_fit_their_widths_and_the_dark(self):
        for page, canvas in (("task.html", "#space canvas"), ("distribution.html", "#hands canvas")):
            for width in (400, 2560):
                self.browser.resize(width, 900)
                self.load(page)
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width, page)
                self.assertGreater(share_drawn(self.browser.picture(canvas)), 0.02)
            self.browser.prefer("dark")
            self.assertLess(np.median(self.browser.picture(canvas)), 60, page)
            self.browser.prefer("light")

    def test_a_task_in_the_console_leads_to_its_paths(self):
        for width in (800, 1920):
            self.browser.resize(width, 900)
            self.open("/tasks/" + urllib.parse.quote(TASK, safe=""))
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
            self.assertEqual(sorted(self.rows()), sorted(self.uuids()))
            self.assertGreater(share_drawn(self.browser.picture("#space canvas")), 0.03)
        known = self.given[7]["report_uuid"]
        self.browser.click(f"tr[data-path='{known}'] button")
        self.browser.click("#space-open")
        self.browser.wait(f"document.querySelector('main').dataset.ready === '/paths/{known}'")
        self.assertIn(known, self.browser.text("#lead"))
        self.browser.driver.back()
        self.browser.wait("document.querySelector('main').dataset.ready.startsWith('/tasks/') && document.querySelector('#space canvas')")

    def test_poses_that_were_lost_are_drawn_red(self):
        data = self.load("distribution.html")
        lost, sources = data["lost"], {source["label"]: source for source in self.kept[1]["sources"]}
        reasons = ("out_of_reach", "outside_limits", "not_converged", "colliding")
        for searched in lost["sources"]:
            source = sources[searched["label"]]
            self.assertEqual((searched["paths"], searched["poses"]), (source["paths_used"], source["poses"]), "the poses of the fit")
            self.assertEqual(searched["lost"][0], source["out_of_reach"])
            self.assertLess(abs(sum(searched["lost"]) - sum(source[each] for each in reasons)), 0.1 * source["poses"])
        unreached = sum(len(places) // 3 for places in lost["places"][:3])
        self.assertGreater(unreached, 20)
        self.assertEqual(self.count("unreached")["points"], unreached)
        self.assertEqual(self.count("colliding")["points"], len(lost["places"][3]) // 3)
        self.assertEqual(unreached, sum(sum(each["lost"][:3]) for each in lost["sources"]))
        red = pixels_of(self.browser.picture("#hands canvas"), BLOCKING, 40)
        self.browser.click("[data-layer=unreached]")
        self.assertGreater(red, pixels_of(self.browser.picture("#hands canvas"), BLOCKING, 40) + 100)
        for source in lost["sources"]:
            self.assertIn(f"{source['paths']} of {source['label']}", self.browser.text("#lost-text"))

    def test_a_slider_goes_over_the_distributions_that_are_kept(self):
        data = self.load("distribution.html")
        self.assertEqual([each["summary"]["id"] for each in data["kept"]], [each["id"] for each in self.kept])
        self.assertEqual(self.count("samples")["points"], 2000)
        bars = "return [...document.querySelectorAll('#joints svg .mark-rect path')].map(bar => bar.getAttribute('d'))"
        joints = self.browser.run(bars)
        self.browser.run("const slider = document.querySelector('#kept input'); slider.value = 0; slider.dispatchEvent(new Event('input'))")
        self.browser.settle()
        self.assertEqual(self.count("samples")["points"], 500)
        self.assertIn(self.kept[0]["id"][:12], self.browser.text("#kept-text"))
        self.assertNotEqual(self.browser.run(bars), joints, "its joints")
        self.browser.run("const slider = document.querySelector('#kept input'); slider.value = 1; slider.dispatchEvent(new Event('input'))")
        self.browser.settle()
        self.assertEqual(self.count("samples")["points"], 2000)
        self.assertEqual(self.browser.run(bars), joints)

    def test_a_distribution_in_the_console_leads_to_those_kept_beside_it(self):
        for width in (800, 1920):
            self.browser.resize(width, 900)
            self.open(f"/distributions/{self.kept[1]['id']}")
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
            self.assertIn("Red: poses", self.browser.text("#lost-text"))
        self.browser.run("const slider = document.querySelector('#kept input'); slider.value = 0; slider.dispatchEvent(new Event('input'))")
        self.browser.click("#kept-text a")
        self.browser.wait(f"document.querySelector('main').dataset.ready === '/distributions/{self.kept[0]['id']}'")


if __name__ == "__main__":
    unittest.main()
