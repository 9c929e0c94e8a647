"""kinship.plan without a server: paths that keep what they promise, and planning that can be interrupted."""
import json
import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import kinship

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
START = np.array([-0.9, -1.4, 1.9, -2.07, -1.57, 0])
GOAL = np.array([0.9, -1.4, 1.9, -2.07, -1.57, 0])


def post(radius=0.05) -> kinship.Scene:
    """It stands between START and GOAL of a UR10e."""
    scene = kinship.Scene()
    scene.add_cylinder("post", [0.75, 0, 0.5, 0, 0, 0, 1], radius, 1.0)
    return scene


def around(q, digest) -> kinship.Distribution:
    """One component around q, as if a server had fitted it."""
    return kinship.Distribution.from_json(json.dumps({
        "id": "ab" * 32, "revision": 3, "store_epoch": "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55", "task": "sweep",
        "robot": digest, "T_task_base": None, "profile": "default",
        "selection": {"sources": [], "weighting": "sources", "since_ms": 0}, "engines": "test", "state": "ready", "reason": "",
        "sources": [], "configurations": 500, "weights": [1.0], "means": [list(q)],
        "covariances": [np.diag([0.5] * len(q)).tolist()], "limits": [[-6, 6]] * len(q), "cuts": None, "k_curve": None,
        "held_out_score": None, "recommended_share": 0.75, "guided_share": 0.75, "evidence": "none", "guided": None,
        "control": None, "recent": [], "fitted_ms": 1, "transfer_time_s": 0, "fit_time_s": 0, "fit": None,
        "filters": ""}))


class OfAUr10e(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = kinship.Robot(MODELS / "ur10e")
        cls.problem = kinship.Problem("around", START, GOAL, scene=post(), seed=5)


class Paths(OfAUr10e):
    def test_go_from_start_to_goal_and_touch_nothing(self):
        plan = kinship.plan(self.robot, self.problem)
        self.assertTrue(plan.solved, plan.reason)
        np.testing.assert_array_equal(plan.waypoints[0], START)
        np.testing.assert_array_equal(plan.waypoints[-1], GOAL)
        self.assertEqual((plan.sampling_mode, plan.planner, plan.found_by), ("uniform", "BiRRT", "search"))
        steps = [np.linspace(a, b, 2 + int(np.linalg.norm(b - a) / 0.05))
                 for a, b in zip(plan.waypoints, plan.waypoints[1:])]
        self.assertTrue(kinship.World.of_problem(self.robot, self.problem).free(np.concatenate(steps)).all())
        self.assertFalse(kinship.World.of_problem(self.robot, self.problem).free(np.linspace(START, GOAL, 40)).all())

    def test_and_what_leads_to_them_say_what_they_are(self):
        self.assertRegex(repr(kinship.plan(self.robot, self.problem)),
                         r"<kinship.Plan 'around' solved, \d+ waypoints, \d+ checks>")
        self.assertRegex(repr(kinship.plan(self.robot, self.problem, max_checks=1)), "'around' not solved: .+, 1 checks>")
        self.assertEqual(repr(self.problem), "<kinship.Problem 'around' among 1 obstacles>")
        self.assertEqual(repr(post()), "<kinship.Scene of 1 obstacles>")
        self.assertIn("retreat", repr(kinship.Guidance.alone(self.robot)))
        self.assertRegex(kinship.__version__, r"^\d+\.\d+\.\d+$")

    def test_are_measured_however_they_were_planned(self):
        problem = kinship.Problem("around", START, GOAL, scene=post(0.33), seed=5)
        for how in ({}, {"resolution": 0.05}):
            plan = kinship.plan(self.robot, problem, **how)
            self.assertAlmostEqual(plan.path_length, np.linalg.norm(np.diff(plan.waypoints, axis=0), axis=1).sum())
            hands = [self.robot.fk(q, frame="transfer")[:3, 3] for q in (START, GOAL)]
            self.assertGreater(plan.hand_length, np.linalg.norm(hands[1] - hands[0]))
            self.assertLess(plan.least_clearance, 0.1)
            wider = kinship.Problem("wider", START, GOAL, scene=post(0.331 + 1.02 * plan.least_clearance))
            steps = [np.linspace(a, b, 2 + int(np.linalg.norm(b - a) / 0.05)) for a, b in zip(plan.waypoints, plan.waypoints[1:])]
            self.assertFalse(kinship.World.of_problem(self.robot, wider).free(np.concatenate(steps)).all())
        far = kinship.plan(self.robot, kinship.Problem("open", START, GOAL))
        self.assertEqual(far.least_clearance, 0.1)
        reported = json.loads(kinship.plan(self.robot, problem).attempt("around").to_json())["record"]
        self.assertAlmostEqual(reported["hand_length_m"], kinship.plan(self.robot, problem).hand_length)
        self.assertGreater(reported["least_clearance_m"], 0)
        none = kinship.plan(self.robot, self.problem, max_checks=1)
        self.assertEqual((none.path_length, none.hand_length, none.least_clearance), (None, None, None))

    def test_retreat_without_experience(self):
        alone = kinship.Guidance.alone(self.robot)
        self.assertEqual((alone.guide, alone.guided_part, alone.distribution_id), ("retreat", 1, None))
        plan = kinship.plan(self.robot, self.problem, alone)
        self.assertTrue(plan.solved, plan.reason)
        self.assertEqual((plan.sampling_mode, plan.guide), ("guided", "retreat"))
        self.assertGreater(plan.tracks_followed, 0)
        with self.assertRaisesRegex(kinship.errors.InvalidInput, "guide 'ways' needs the experience"):
            kinship.Guidance.alone(self.robot, "ways")
        self.assertIsNone(alone.recall(self.problem, lambda qs: self.fail("nothing is there to be tried")))
        with self.assertRaisesRegex(kinship.errors.InvalidInput, "step is 0, must be from"):
            alone.recall(self.problem, lambda qs: [True] * len(qs), step=0)
        with self.assertRaisesRegex(kinship.errors.InvalidInput, "problem 'five': start has 5 joints"):
            alone.recall(kinship.Problem("five", START[:5], GOAL[:5]), lambda qs: [True] * len(qs))

    def test_are_the_same_for_equal_seeds_alone(self):
        first, again, other = (kinship.plan(self.robot, self.problem, seed=seed) for seed in (5, 5, 6))
        np.testing.assert_array_equal(first.waypoints, again.waypoints)
        self.assertEqual(first.collision_checks, again.collision_checks)
        self.assertNotEqual(first.collision_checks, other.collision_checks)

    def test_depend_on_how_far_trees_grow(self):
        usual, said, plain = (kinship.plan(self.robot, self.problem, **options) for options in ({}, {"overshoot": 1.5}, {"overshoot": 1}))
        np.testing.assert_array_equal(said.waypoints, usual.waypoints)
        self.assertNotEqual(plain.collision_checks, usual.collision_checks)

    def test_far_from_all_that_is_known_are_planned_uniformly_unless_no_gate_doubts_it(self):
        far = around(GOAL + 3, self.robot.digest)
        gated, trusted = (kinship.plan(self.robot, self.problem, far, sampling_mode="guided", gate_distance=distance)
                          for distance in (1.0, float("inf")))
        self.assertEqual([plan.gate_fired for plan in (gated, trusted)], [True, False])

    def test_lead_to_a_pose_of_the_hand(self):
        pose = self.robot.fk(GOAL, frame="transfer")
        plan = kinship.plan(self.robot, kinship.Problem("hand", START, goal_pose=pose, scene=post()))
        self.assertTrue(plan.solved, plan.reason)
        np.testing.assert_allclose(self.robot.fk(plan.waypoints[-1], frame="transfer"), pose, atol=1e-5)

    def test_that_are_none_say_why(self):
        plan = kinship.plan(self.robot, kinship.Problem("inside", START, GOAL, scene=post(0.8)))
        self.assertFalse(plan.solved)
        self.assertIsNone(plan.waypoints)
        self.assertRegex(plan.reason, "touches 'post'|'post' touches")
        plan = kinship.plan(self.robot, self.problem, max_checks=20)
        self.assertRegex(plan.reason, "not solved within 20 collision checks")

    def test_of_problems_that_do_not_fit_are_refused(self):
        with self.assertRaisesRegex(kinship.InvalidInput, "'short'.*2"):
            kinship.plan(self.robot, kinship.Problem("short", [0, 0], [1, 1]))
        with self.assertRaisesRegex(kinship.InvalidInput, "give goal or goal_pose"):
            kinship.Problem("none", START)
        with self.assertRaisesRegex(kinship.InvalidInput, "'nimble' is no planner"):
            kinship.plan(self.robot, self.problem, planner="nimble")

    def test_are_proven_or_by_steps(self):
        self.assertTrue(kinship.plan(self.robot, self.problem, clearance=0.005).proven)
        self.assertFalse(kinship.plan(self.robot, self.problem, resolution=0.05).proven)
        with self.assertRaisesRegex(kinship.InvalidInput, "not both"):
            kinship.plan(self.robot, self.problem, clearance=0.001, resolution=0.05)
        for resolution in (0, -1, 2, float("nan")):
            with self.assertRaisesRegex(kinship.InvalidInput, "resolution is .*, must be from 1e-04 to 1"):
                kinship.plan(self.robot, self.problem, resolution=resolution)


class Folders(OfAUr10e):
    def test_say_how_far_a_start_may_be_beyond_a_limit(self):
        start = np.array(START)
        start[0] = self.robot.upper[0] + 0.02
        problem = kinship.Problem("beyond", start, [*(self.robot.upper[:1] - 0.1), *START[1:]])
        with tempfile.TemporaryDirectory() as folder:
            chain = (MODELS / "ur10e" / "chain.toml").read_text()
            pathlib.Path(folder, "chain.toml").write_text(
                f'urdf = "{MODELS / "ur10e" / "robot.urdf"}"\nlimit_slack = 0.05\n{chain}')
            robot = kinship.Robot(folder)
        self.assertEqual(robot.digest, self.robot.digest)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertTrue(kinship.plan(robot, problem).solved)
            with self.assertRaisesRegex(kinship.InvalidInput, "is outside"):
                kinship.plan(robot, problem, limit_slack=0.01)
            with self.assertRaisesRegex(kinship.InvalidInput, "is outside"):
                kinship.plan(self.robot, problem)


class Scenes(unittest.TestCase):
    def test_refuse_what_cannot_be_where_it_is_added(self):
        scene = post()
        name = "post"
        with self.assertRaisesRegex(kinship.InvalidInput, "object 'post': the scene has one of this name"):
            scene.add_sphere(name, [0, 0, 0], 1)
        pose = [0, 0, 0, 0, 0, 0, 1]
        with self.assertRaisesRegex(kinship.InvalidInput, "object 'b': box extent of -1 m is not between 0 and 1000 m"):
            scene.add_box("b", pose, [1, -1, 1])
        with self.assertRaisesRegex(kinship.InvalidInput, "object 'c': cylinder length of 2000 m is not"):
            scene.add_cylinder("c", pose, 1, 2000)
        with self.assertRaisesRegex(kinship.InvalidInput, "object 'm': scale must be"):
            scene.add_mesh("m", "m.stl", pose, [1, 0, 1])
        with self.assertRaisesRegex(kinship.InvalidInput, "its name is empty"):
            scene.add_sphere("", [0, 0, 0], 1)
        self.assertEqual(len(scene), 1)


class Doubts(OfAUr10e):
    def test_name_the_distance_of_a_goal_in_millimetres(self):
        plan = kinship.plan(self.robot, kinship.Problem("mm", START, goal_pose=[420, -150, 190, 1, 0, 0, 0]))
        self.assertRegex(plan.reason, "goal out of reach: .* it is 485 m away from the robot's base, .*probably millimetres")

    def test_are_warned_of_when_solids_cannot_be_meant(self):
        scene = kinship.Scene()
        scene.add_box("far", [900, 0, 0, 0, 0, 0, 1], [1, 1, 1])
        with self.assertWarnsRegex(kinship.GeometryDoubt, "problem 'mm': 'far' is 900 m away from the robot's base"):
            plan = kinship.plan(self.robot, kinship.Problem("mm", START, GOAL, scene=scene))
        self.assertTrue(plan.solved, plan.reason)

    def test_are_none_of_a_scene_that_is_meant(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertTrue(kinship.plan(self.robot, self.problem).solved)


class Guided(OfAUr10e):
    def test_by_a_distribution_it_draws_from_it(self):
        plan = kinship.plan(self.robot, self.problem, around((START + GOAL) / 2, self.robot.digest))
        self.assertTrue(plan.solved, plan.reason)
        self.assertEqual((plan.sampling_mode, plan.guide), ("guided", "mixture"))
        self.assertGreater(plan.share, 0)
        attempt = plan.attempt("sweep", machine="cell 3")
        self.assertEqual((attempt.sampling_mode, attempt.outcome, attempt.task, attempt.machine),
                         ("guided", "solved", "sweep", "cell 3"))
        self.assertEqual((attempt.collision_checks, attempt.share), (plan.collision_checks, plan.share))
        self.assertEqual(len(attempt.scene), 1)
        np.testing.assert_array_equal(attempt.waypoints, plan.waypoints)

    def test_as_control_it_plans_as_without_guidance(self):
        distribution = around(START, self.robot.digest)
        plan, without = (kinship.plan(self.robot, self.problem, distribution, sampling_mode="control"),
                         kinship.plan(self.robot, self.problem))
        self.assertEqual(plan.sampling_mode, "control")
        np.testing.assert_array_equal(plan.waypoints, without.waypoints)

    def test_by_another_robots_distribution_it_is_refused(self):
        with self.assertRaisesRegex(kinship.InvalidInput, "cdcdcdcdcdcd.*not for 'ur10e'"):
            kinship.plan(self.robot, self.problem, around(START, "cd" * 32))


class Interrupted(OfAUr10e):
    """The goal is free but walled in: only the limits would end the search."""

    def setUp(self):
        scene = kinship.Scene()
        hand = self.robot.fk(GOAL, frame="transfer")[:3, 3]
        for axis in range(3):
            for side in (-1, 1):
                size = np.full(3, 1.6)
                size[axis] = 0.02
                center = hand + 0.8 * side * np.eye(3)[axis]
                scene.add_box(f"wall {axis} {side}", [*center, 0, 0, 0, 1], size)
        allowed = [(f"wall {axis} {side}", link) for axis in range(3) for side in (-1, 1)
                   for link in self.robot.link_names if "wrist_3" not in link]
        self.problem = kinship.Problem("walled in", START - [1.5, 0, 0, 0, 0, 0], GOAL, scene=scene,
                                       allowed_collisions=allowed, time_limit_s=60)

    def plan(self):
        return kinship.plan(self.robot, self.problem, max_checks=10**9)

    def test_by_control_c_it_ends_at_once(self):
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        begin = time.monotonic()
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            self.plan()
        self.assertLess(time.monotonic() - begin, 20)
        timer.join()


class Threads(OfAUr10e):
    def test_plan_at_the_same_time(self):
        expected = kinship.plan(self.robot, self.problem).waypoints
        answers = [None] * 4

        def run(index):
            answers[index] = kinship.plan(self.robot, self.problem).waypoints

        threads = [threading.Thread(target=run, args=(index,)) for index in range(len(answers))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)


if __name__ == "__main__":
    unittest.main()
