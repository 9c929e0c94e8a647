"""Robots, worlds and samplers as numpy sees them."""
import json
import os
import pathlib
import tempfile
import threading
import unittest

import numpy as np

import kinship

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
NAMES = ("panda", "iiwa14", "ur10e", "sawyer")


def random_configurations(robot, count, seed):
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (count, robot.dof))


def pose_at(x, y, z):
    return [x, y, z, 0, 0, 0, 1]


class Kinematics(unittest.TestCase):
    def test_ik_of_fk_comes_back_to_the_pose(self):
        for name in NAMES:
            robot = kinship.Robot(MODELS / name)
            for frame in ("tip", "transfer"):
                for pose in robot.fk(random_configurations(robot, 20, 1), frame=frame):
                    solutions = robot.ik(pose, frame=frame, seed=3)
                    self.assertGreater(len(solutions), 0, name)
                    again = robot.fk(solutions, frame=frame)
                    np.testing.assert_allclose(again, np.broadcast_to(pose, again.shape), atol=1e-5)
                    self.assertTrue(((solutions >= robot.lower) & (solutions <= robot.upper)).all())

    def test_ik_finds_the_configuration_itself_again(self):
        robot = kinship.Robot(MODELS / "ur10e")  # six joints: finitely many
        for q in random_configurations(robot, 50, 2):
            solutions = robot.ik(robot.fk(q), max_solutions=0, min_distance=0.01)
            apart = np.abs(np.mod(solutions - q + np.pi, 2 * np.pi) - np.pi).max(axis=1)
            self.assertLess(apart.min(), 1e-4)

    def test_one_configuration_has_one_pose_and_rows_have_as_many(self):
        robot = kinship.Robot(MODELS / "panda")
        many = random_configurations(robot, 5, 3)
        self.assertEqual(robot.fk(many[0]).shape, (4, 4))
        np.testing.assert_array_equal(robot.fk(many)[2], robot.fk(many[2]))
        np.testing.assert_array_equal(robot.fk(np.asfortranarray(many)), robot.fk(many))
        np.testing.assert_array_equal(robot.fk(many[::2]), robot.fk(many)[::2])
        self.assertEqual(robot.fk(np.zeros((0, 7))).shape, (0, 4, 4))

    def test_frames_are_tip_transfer_and_links(self):
        robot = kinship.Robot(MODELS / "panda")
        q = random_configurations(robot, 1, 4)[0]
        np.testing.assert_allclose(robot.fk(q, frame="transfer"), robot.fk(q) @ robot.T_tip_transfer, atol=1e-12)
        np.testing.assert_array_equal(robot.fk(q, frame=robot.link_names[0]), np.eye(4))
        with self.assertRaisesRegex(kinship.NotFound, "'panda' has no link 'nose'; frames: tip, transfer, panda_link0"):
            robot.fk(q, frame="nose")
        with self.assertRaisesRegex(ValueError, "frame 'nose', must be tip or transfer"):
            robot.ik(np.eye(4), frame="nose")

    def test_a_pose_may_be_seven_numbers(self):
        robot = kinship.Robot(MODELS / "ur10e")
        matrix = np.array([[0, -1, 0, 0.5], [1, 0, 0, 0.2], [0, 0, 1, 0.4], [0, 0, 0, 1.0]])
        numbers = [0.5, 0.2, 0.4, 0, 0, np.sqrt(0.5), np.sqrt(0.5)]
        for reached in robot.fk(robot.ik(numbers)):
            np.testing.assert_allclose(reached, matrix, atol=1e-5)
        self.assertEqual(robot.ik(pose_at(5, 0, 0)).shape, (0, 6))

    def test_what_is_no_pose_or_configuration_is_refused(self):
        robot = kinship.Robot(MODELS / "panda")
        with self.assertRaisesRegex(kinship.InvalidInput, r"shape \(6,\): panda has 7 joints"):
            robot.fk(np.zeros(6))
        with self.assertRaisesRegex(kinship.InvalidInput, "no rotation"):
            robot.ik(2 * np.eye(4))
        with self.assertRaisesRegex(kinship.InvalidInput, r"pose: shape \(3, 3\)"):
            robot.ik(np.eye(3))


class Loading(unittest.TestCase):
    def test_a_urdf_file_takes_what_it_does_not_say(self):
        transfer = np.eye(4)
        transfer[:3, 3] = 0, 0, 0.1
        folder = kinship.Robot(MODELS / "panda")
        robot = kinship.Robot(MODELS / "panda" / "robot.urdf", base=folder.link_names[0], tip="panda_link8",
                              label="mine", transfer=transfer)
        self.assertEqual((robot.label, robot.dof), ("mine", 7))
        np.testing.assert_allclose(robot.T_tip_transfer, transfer)

    def test_messages_name_arguments_of_python(self):
        urdf = MODELS / "panda" / "robot.urdf"
        for wrong, words in (({}, "needs base=LINK and tip=LINK"), ({"base": "panda_link0", "tip": "nose"}, "nose"),
                             ({"axes": ["x", "loop"], "base": "panda_link0", "tip": "panda_link8"}, "^axes: ")):
            with self.assertRaisesRegex(kinship.Error, words) as raised:
                kinship.Robot(urdf, **wrong)
            self.assertNotIn("--", str(raised.exception))

    def test_what_is_not_there_is_an_error(self):
        with self.assertRaisesRegex(kinship.NotFound, "no_such_folder"):
            kinship.Robot("no_such_folder")
        with self.assertRaisesRegex(LookupError, "no_such_folder"):
            kinship.Robot(pathlib.Path("no_such_folder"))


class Worlds(unittest.TestCase):
    def setUp(self):
        self.robot = kinship.Robot(MODELS / "panda")
        self.ready = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])

    def test_a_robot_alone_touches_itself_only(self):
        world = kinship.World(self.robot)
        self.assertIs(world.free(self.ready), True)
        self.assertIsNone(world.contact(self.ready))

    def test_many_configurations_are_judged_as_one_by_one(self):
        scene = kinship.Scene()
        scene.add_box("table", pose_at(0.5, 0, 0.2), [0.6, 2, 0.4])
        scene.add_sphere("ball", [0.4, 0.3, 0.8], 0.2)
        scene.add_cylinder("post", pose_at(-0.5, 0, 0.5), 0.1, 1)
        scene.add_capsule("rail", pose_at(0, 0.6, 0.5), 0.05, 0.5)
        self.assertEqual(len(scene), 4)
        world = kinship.World(self.robot, scene)
        many = random_configurations(self.robot, 1000, 5)
        free = world.free(many)
        self.assertEqual((free.dtype, free.shape), (np.dtype(bool), (1000,)))
        self.assertTrue(100 < free.sum() < 900, free.sum())
        self.assertEqual(free.tolist(), [world.contact(q) is None for q in many])

    def test_the_placement_moves_the_robot_among_the_obstacles(self):
        scene = kinship.Scene()
        hand = self.robot.fk(self.ready, frame="transfer")[:3, 3]
        scene.add_sphere("ball", hand, 0.05)
        self.assertFalse(kinship.World(self.robot, scene).free(self.ready))
        self.assertEqual(kinship.World(self.robot, scene).contact(self.ready)[1], "ball")
        self.assertTrue(kinship.World(self.robot, scene, T_task_base=pose_at(0, 0, 2)).free(self.ready))

    def test_what_is_nearer_than_the_clearance_is_not_free(self):
        scene = kinship.Scene()
        hand = self.robot.fk(self.ready, frame="transfer")[:3, 3]
        scene.add_box("shelf", pose_at(*(hand - [0, 0, 0.12])), [0.1, 0.1, 0.01])
        world = kinship.World(self.robot, scene)
        clearances = [clearance for clearance in (0, 0.001, 0.01, 0.02, 0.04, 0.06, 0.08, 0.1)
                      if world.free(self.ready, clearance=clearance)]
        self.assertEqual(clearances[:2], [0, 0.001])
        self.assertTrue(2 < len(clearances) < 8, clearances)
        self.assertIsNone(world.contact(self.ready, clearance=clearances[-1]))
        self.assertIn("shelf", world.contact(self.ready, clearance=0.1))
        proof = world.prove([self.ready, self.ready], clearance=0.1)
        self.assertEqual((proof.free, proof.edges, proof.share), (False, 0, 0))
        self.assertIn("shelf", (proof.first, proof.second))
        self.assertTrue(clearances[-1] < proof.clearance <= 0.1, proof.clearance)
        self.assertAlmostEqual(proof.least_clearance, proof.clearance)
        np.testing.assert_allclose(proof.q, self.ready)
        proof = world.prove([self.ready, self.ready + 1e-3, self.ready])
        self.assertEqual((proof.free, proof.edges, proof.q, proof.first), (True, 2, None, None))
        for clearance in (-1, 0.2, float("nan")):
            with self.assertRaisesRegex(kinship.InvalidInput, "clearance is .* must be from"):
                world.free(self.ready, clearance=clearance)

    def test_threads_may_share_one(self):
        world = kinship.World(self.robot)
        many = random_configurations(self.robot, 3000, 6)
        expected, answers = world.free(many).tolist(), []
        threads = [threading.Thread(target=lambda: answers.append(world.free(many).tolist())) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(answers, [expected] * 4)

    def test_of_a_problem_has_its_scene_and_placement(self):
        problem = {"name": "p", "T_task_base": pose_at(0, 0, 1), "start": self.ready.tolist(),
                   "goal": {"configurations": [[0.5] + self.ready.tolist()[1:]]},
                   "scene": {"boxes": [{"name": "wall", "pose": pose_at(0.5, 0, 1.5), "size": [0.2, 0.2, 0.2]}]}}
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "problems.jsonl"
            file.write_text(json.dumps(problem) + "\n\n" + "{}\n")
            with self.assertRaisesRegex(kinship.InvalidInput, "problems.jsonl' line 3: "):
                kinship.read_problems(file)
            file.write_text(json.dumps(problem) + "\n")
            read, = kinship.read_problems(file)
        self.assertEqual((read.name, len(read.scene)), ("p", 1))
        np.testing.assert_array_equal(read.start, self.ready)
        self.assertIsNone(read.T_task_start)
        posed = kinship.Problem.from_json(json.dumps(problem | {"start": {"pose": pose_at(0.4, 0, 1.5)}}))
        self.assertEqual(posed.start.shape, (0,))
        np.testing.assert_array_equal(posed.T_task_start[:3, 3], [0.4, 0, 1.5])
        np.testing.assert_array_equal(kinship.Problem.from_json(posed.to_json()).T_task_start, posed.T_task_start)
        self.assertEqual(read.goal_configurations.shape, (1, 7))
        many = random_configurations(self.robot, 500, 7)
        by_hand = kinship.World(self.robot, read.scene, T_task_base=read.T_task_base)
        of_problem = kinship.World.of_problem(self.robot, read)
        np.testing.assert_array_equal(of_problem.free(many), by_hand.free(many))
        self.assertFalse((of_problem.free(many) == kinship.World(self.robot).free(many)).all())

    def test_what_is_not_finite_is_refused(self):
        with self.assertRaises(ValueError):
            kinship.World(self.robot).free(np.full(7, np.nan))
        with self.assertRaisesRegex(kinship.InvalidInput, "ball"):
            kinship.Scene().add_sphere("ball", [0, 0, 0], np.nan)


class Samplers(unittest.TestCase):
    def test_without_a_distribution_are_uniform_within_the_limits(self):
        robot = kinship.Robot(MODELS / "panda")
        sampler = kinship.Sampler(robot, np.zeros(7), seed=1)
        samples = sampler.sample(20_000)
        self.assertEqual((sampler.share, samples.shape), (0, (20_000, 7)))
        self.assertTrue(((samples >= robot.lower) & (samples <= robot.upper)).all())
        middle = (robot.lower + robot.upper) / 2
        np.testing.assert_array_less(np.abs(samples.mean(axis=0) - middle), 0.02 * (robot.upper - robot.lower))
        again = kinship.Sampler(robot, np.zeros(7), seed=1)
        np.testing.assert_array_equal(np.concatenate([again.sample(50), again.sample(50)]), samples[:100])


if __name__ == "__main__":
    unittest.main()
