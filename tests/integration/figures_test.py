"""The pages of `robots plot` and `paths plot`, of a real kinshipd, in a browser: what is drawn, and where it stands."""
import json
import pathlib
import tempfile
import unittest
import uuid

import numpy as np

from browser import BrowserTest, share_drawn, touches_border
from kinshipd_process import MODELS, Kinshipd
from strict_server import StrictServer, taken_apart

TASK = "reach"
BASE = [0.3, -0.2, 0.5, 0, 0, np.sin(0.4), np.cos(0.4)]
SOLVED = str(uuid.UUID(int=1))
UNSOLVED = str(uuid.UUID(int=2))
SCENE = {"boxes": [{"name": "shelf", "size": [0.2, 0.8, 0.02], "pose": [0.95, -0.2, 0.9, 0, 0, 0, 1]},
                   {"name": "table", "size": [2, 2, 0.1], "pose": [0.3, -0.2, 0.3, 0, 0, 0, 1]}],
         "spheres": [{"name": "ball", "radius": 0.1, "center": [0.8, 0.6, 0.8]}],
         "held": [{"name": "part", "shape": {"box": [0.05, 0.05, 0.1]}, "T_transfer_object": [0, 0, 0.05, 0, 0, 0, 1]}]}
START, GOAL = [0.1, -0.6, 0.2, -2.1, 0.1, 1.6, 0.8], [0.9, -0.2, -0.3, -1.8, 0.2, 1.9, 0.6]


def orange_of(picture: np.ndarray) -> int:
    """Pixels that are more red than anything else of a page is."""
    red, green, blue = (picture[:, :, part].astype(int) for part in range(3))
    return int(((red > 120) & (red - green > 60) & (green - blue > 15)).sum())


def attempts() -> "list[dict]":
    """A solved one among obstacles, and one without a path."""
    record = {"outcome": "solved", "planner": "birrt", "planning_time_s": 0.5, "collision_checks": 1234}
    of = {"task": TASK, "robot": "panda", "machine": "test", "T_task_base": BASE}
    middle = (0.5 * (np.array(START) + GOAL) + 0.1).tolist()
    return [{**of, "report_uuid": SOLVED, "waypoints": [START, middle, GOAL], "record": record, "scene": SCENE},
            {**of, "report_uuid": UNSOLVED, "waypoints": None, "record": {**record, "outcome": "timeout"}, "scene": None}]


def box_stl(size: "list[float]") -> str:
    """A box from the origin to its opposite corner, as twelve triangles."""
    corner = [[size[axis] * (i >> axis & 1) for axis in range(3)] for i in range(8)]
    faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    facets = "".join("facet normal 0 0 0 outer loop " + " ".join("vertex %g %g %g" % tuple(corner[i]) for i in face) + " endloop endfacet\n"
                     for face in faces)
    return f"solid box\n{facets}endsolid box\n"


def meshed_urdf() -> str:
    """Two bars: the first is drawn as it collides, the second is drawn orange, in a mesh of its own."""
    def mesh(name: str) -> str:
        return f"<origin xyz='0.1 -0.02 -0.02'/><geometry><mesh filename='{name}.stl'/></geometry>"
    orange = "<material name='orange'><color rgba='1 0.4 0 1'/></material>"
    joint = "<axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint>"
    return ("<robot name='bars'><link name='base'/>"
            f"<link name='one'><visual>{mesh('bar')}</visual><collision>{mesh('bar')}</collision></link>"
            f"<link name='two'><visual>{mesh('thin')}{orange}</visual><collision>{mesh('bar')}</collision></link>"
            f"<joint name='j1' type='revolute'><parent link='base'/><child link='one'/>{joint}"
            f"<joint name='j2' type='revolute'><parent link='one'/><child link='two'/><origin xyz='0.5 0 0'/>{joint}</robot>")


class Figures(BrowserTest):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start()
        cls.folder = cls.server.folder
        cls.kinship = cls.server.kinship
        cls.server.register("panda", "panda_lift")
        cls.server.give(attempts())
        for name, size in (("bar", [0.3, 0.04, 0.04]), ("thin", [0.3, 0.02, 0.02])):
            (cls.folder / f"{name}.stl").write_text(box_stl(size))
        (cls.folder / "bars.urdf").write_text(meshed_urdf())
        cls.kinship("robots", "register", str(cls.folder / "bars.urdf"), "--base", "base", "--tip", "two", "--axes", "x,y,yaw", "--label", "bars")
        cls.kinship("robots", "plot", "bars", "--output", str(cls.folder / "bars.html"))
        for robot in ("panda", "panda_lift"):
            cls.kinship("robots", "plot", robot, "--output", str(cls.folder / f"{robot}.html"))
        cls.kinship("paths", "plot", SOLVED, "--output", str(cls.folder / "path.html"))
        super().setUpClass()

    def count(self, layer: str) -> dict:
        return self.browser.run("return shown.count(arguments[0])", layer)

    def set_slider(self, selector: str, value: float) -> None:
        self.browser.run("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))", self.browser.element(selector), value)
        self.browser.settle()

    def forward(self, robot: str, q: "list[float]") -> dict:
        """What the program's own forward kinematics say."""
        return json.loads(self.kinship("robots", "fk", str(MODELS / robot), "--q", " ".join(map(repr, q)), "--json"))

    def test_a_page_places_links_and_transfer_frame_as_the_program_does(self):
        for robot in ("panda", "panda_lift"):
            data = self.load(f"{robot}.html")["robot"]
            generator = np.random.default_rng(1)
            for _ in range(20):
                q = [generator.uniform(joint["lower"], joint["upper"]) for joint in data["joints"]]
                here = self.browser.run("return kinshipChain.poseOf(kinshipChain.posesOf(kinshipPage.data.robot, arguments[0]).transfer)", q)
                there = self.forward(robot, q)["transfer"]
                np.testing.assert_allclose(here[:3], there[:3], atol=1e-6)
                self.assertAlmostEqual(abs(np.dot(here[3:], there[3:])), 1, places=6)
            frames = json.loads(self.kinship("robots", "frames", str(MODELS / robot), "--q", " ".join(map(repr, q)), "--json"))
            poses = self.browser.run("return kinshipChain.posesOf(kinshipPage.data.robot, arguments[0]).links.map(kinshipChain.originOf)", q)
            known = {link["link"]: link["pose"][:3] for link in frames["links"]}
            for link, origin in zip(data["links"], poses):
                np.testing.assert_allclose(origin, known[link["name"]], atol=1e-6)

    def test_a_robot_is_drawn_and_its_joints_move_it(self):
        data = self.load("panda.html")
        solids = sum(len(link["solids"]) for link in data["robot"]["links"])
        self.assertGreater(solids, 8)
        self.assertEqual(self.count("links")["objects"], solids)
        self.assertEqual(self.count("transfer")["ways"], 3)
        self.assertFalse(data["touches_itself"])
        self.assertEqual(len(self.browser.elements("#joints input")), 7)
        before, pose = self.browser.picture("#robot canvas"), self.browser.text("#pose")
        self.assertGreater(share_drawn(before), 0.02)
        self.set_slider("[data-joint=panda_joint2]", 1.2)
        self.assertGreater(np.mean(self.browser.picture("#robot canvas") != before), 0.01, "moved")
        self.assertNotEqual(self.browser.text("#pose"), pose)
        self.browser.click("#again")
        self.assertEqual(self.browser.text("#pose"), pose)

    def test_meshes_are_drawn_as_the_robot_looks_and_as_it_collides(self):
        data = self.load("bars.html")["robot"]
        self.assertEqual([(mesh["role"], data["links"][mesh["link"]]["name"]) for mesh in data["meshes"]],
                         [("both", "one"), ("collision", "two"), ("visual", "two")])
        self.assertEqual(len(data["contents"]), 2, "a bar is there once")
        for text in data["contents"].values():
            parts = self.browser.run("const {attributes, index} = kinshipSolids.meshGeometry(arguments[0]); return [attributes.position.count, index.count]", text)
            self.assertEqual(parts, [8, 36])
        self.assertEqual(self.count("visual")["meshes"], 2)
        self.assertEqual(self.count("collision")["meshes"], 2)
        self.assertEqual(self.count("links")["objects"], 2, "solids around them, hidden at first")
        pressed = {name: self.browser.element(f"[data-layer={name}]").get_attribute("aria-pressed") for name in ("visual", "collision", "links")}
        self.assertEqual(pressed, {"visual": "true", "collision": "false", "links": "false"})
        picture = self.browser.picture("#robot canvas")
        self.assertGreater(orange_of(picture), 200, "the colour of the URDF")
        self.browser.click("[data-layer=visual]")
        self.assertEqual(orange_of(self.browser.picture("#robot canvas")), 0, "hidden")
        self.browser.click("[data-layer=collision]")
        collision = self.browser.picture("#robot canvas")
        self.assertGreater(share_drawn(collision), 0.01)
        self.set_slider("[data-joint=j2]", 1.5)
        self.assertGreater(np.mean(self.browser.picture("#robot canvas") != collision), 0.005, "moved")
        self.assertIn("2 links by the triangles of their meshes", self.browser.text("#shapes-text"))

    def test_a_path_is_drawn_in_its_scene(self):
        data = self.load("path.html")
        solids = sum(len(link["solids"]) for link in data["robot"]["links"])
        self.assertEqual(self.count("scene")["objects"], 3)
        self.assertEqual(self.count("arm")["objects"], solids)
        self.assertEqual(self.count("held")["objects"], 1)
        for ghost in ("start", "goal"):
            self.assertEqual(self.count(ghost)["objects"], solids + 1)
        self.assertEqual(self.count("way")["ways"], 1)
        self.assertFalse(touches_border(self.browser.picture("#scene canvas")))
        at_start, at_goal = (self.forward("panda", q)["transfer"][:3] for q in (START, GOAL))
        turn, base = 0.8, np.array(BASE[:3])
        for hand, column in ((at_start, data["path"]["hand"][:3]), (at_goal, data["path"]["hand"][-3:])):
            x, y, z = hand
            placed = base + [x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn), z]
            np.testing.assert_allclose(np.array(column) / 1000, placed, atol=1e-3)

    def test_the_arm_goes_along_the_path_and_says_how_near_it_is(self):
        data = self.load("path.html")
        slider = "#player input"
        self.set_slider(slider, 0)
        self.assertIn("at the start", self.browser.text("#player output"))
        first = self.browser.picture("#scene canvas")
        self.set_slider(slider, 1)
        self.assertGreater(np.mean(self.browser.picture("#scene canvas") != first), 0.005, "moved")
        least = data["path"]["obstacle"]["least"]
        self.set_slider(slider, least / 200)
        names = data["path"]["obstacle"]["pairs"][least]
        self.assertIn(f"\u201c{names[0]}\u201d", self.browser.text("#place"))
        self.assertIn(f"\u201c{names[1]}\u201d", self.browser.text("#place"))
        self.set_slider(slider, 0)
        self.browser.click("#player button")
        self.browser.wait("document.querySelector('#player input').value > 0.1")
        self.browser.click("#player button")
        self.assertEqual(len(self.browser.elements("#clearance svg .mark-line path")), 2)
        self.assertEqual(len(self.browser.elements("#clearance svg .mark-symbol path")), 2)

    def test_a_click_on_the_curve_goes_there(self):
        self.load("path.html")
        self.browser.run("document.querySelector('#clearance').scrollIntoView({block: 'center', behavior: 'instant'})")
        plot = self.browser.run("const r = document.querySelector('#clearance svg .mark-group.role-frame').getBoundingClientRect();"
                                "const line = [...document.querySelectorAll('#clearance svg .mark-line path')][0].getBoundingClientRect();"
                                "return [line.left + 0.75 * line.width, r.top + r.height / 2]")
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": plot[0], "y": plot[1], "button": "left", "clickCount": 1})
        self.browser.settle()
        self.assertAlmostEqual(float(self.browser.run("return document.querySelector('#player input').value")), 0.75, delta=0.02)

    def test_pages_fit_their_widths_and_the_dark(self):
        for page, figure in (("panda.html", "#robot"), ("path.html", "#scene")):
            for width in (400, 800, 1920):
                self.browser.resize(width, 900)
                self.load(page)
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width, page)
                self.assertGreater(share_drawn(self.browser.picture(f"{figure} canvas")), 0.02)
            self.browser.prefer("dark")
            self.assertLess(np.median(self.browser.picture(f"{figure} canvas")), 60, page)
            self.browser.prefer("light")

    def test_figures_are_drawn_under_a_strict_content_security_policy(self):
        for page in ("panda.html", "path.html"):
            with tempfile.TemporaryDirectory() as folder, StrictServer(pathlib.Path(folder)) as server:
                taken_apart(self.folder / page, pathlib.Path(folder))
                self.browser.driver.get(f"{server.address}/index.html")
                self.browser.settle()
                self.assertGreater(share_drawn(self.browser.picture("canvas")), 0.02)
                self.browser.check_console(self)

    def test_what_is_not_there_is_code_three(self):
        for words in (("robots", "plot", "nobody"), ("paths", "plot", UNSOLVED), ("paths", "plot", str(uuid.UUID(int=9)))):
            done = self.server.run_kinship(*words, "--output", str(self.folder / "none.html"))
            self.assertEqual(done.returncode, 3, done.stderr.decode())
            self.assertIn(" ".join(words[:2]), done.stderr.decode())
            self.assertFalse((self.folder / "none.html").exists())


if __name__ == "__main__":
    unittest.main()
