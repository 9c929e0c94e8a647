"""Attempts and experience files."""
import json
import os
import pathlib
import tempfile
import unittest

import numpy as np

import kinship
from panda_sweeps import attempt, sweep

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"


class Experience(unittest.TestCase):
    def setUp(self):
        self.panda = kinship.Robot(MODELS / "panda")
        self.file = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "experience.jsonl"

    def test_comes_back_as_it_was_written(self):
        scene = kinship.Scene()
        scene.add_box("table", [0, 0, -0.1, 0, 0, 0, 1], [1, 1, 0.1])
        placement = np.eye(4)
        placement[:3, 3] = 1, 2, 3
        solved = attempt(self.panda, "sweep", 1)
        solved.T_task_base, solved.scene = placement, scene
        unsolved = kinship.Attempt("sweep", self.panda, outcome="timeout", planning_time_s=10, collision_checks=99,
                                   processor_time_s=10.5)
        unsolved.search = {"start": [0.5] * 7, "blockers": [{"first": "link5", "second": "table", "count": 3}]}
        kinship.write_experience(self.file, [solved, unsolved], robots=[self.panda])

        (robot,), (first, second) = kinship.read_experience(self.file)
        self.assertEqual((robot.label, robot.digest), ("panda", self.panda.digest))
        np.testing.assert_array_equal(first.waypoints, sweep(1))
        np.testing.assert_allclose(first.T_task_base, placement)
        self.assertEqual((first.report_uuid, first.robot), (solved.report_uuid, self.panda.digest))
        self.assertEqual((first.outcome, first.collision_checks, len(first.scene)), ("solved", 1000, 1))
        self.assertEqual((second.outcome, second.waypoints, second.collision_checks), ("timeout", None, 99))
        self.assertIsNone(second.T_task_base)
        self.assertIsNone(first.search)
        self.assertEqual(second.search["blockers"][0]["second"], "table")
        with self.assertRaisesRegex(kinship.InvalidInput, "search"):
            second.search = {"goals": [[0.0] * 7], "start": [0.0]}
        self.assertEqual((first.processor_time_s, second.processor_time_s), (0, 10.5))

    def test_is_the_json_lines_of_the_format(self):
        made = attempt(self.panda, "sweep", 2)
        kinship.write_experience(self.file, [made], robots=[self.panda])
        robot, line = (json.loads(text) for text in self.file.read_text().splitlines())
        self.assertEqual(robot["robot_description"]["label"], "panda")
        self.assertEqual(line["waypoints"], sweep(2).tolist())
        self.assertEqual(line["record"]["planner"], "birrt")
        self.assertEqual(line["record"]["machine_speed"], 0)
        made.processor_time_s = 0.25
        record = json.loads(made.to_json())["record"]
        self.assertEqual(record["processor_time_s"], 0.25)
        self.assertGreater(record["machine_speed"], 0)
        made.processor_time_s = 0
        self.assertEqual(json.loads(made.to_json()), line)

    def test_labels_of_robots_in_the_file_become_digests(self):
        document = json.loads(attempt(self.panda, "sweep", 3).to_json())
        lines = [json.dumps({**document, "robot": label}) for label in ("panda", "elsewhere")]
        kinship.write_experience(self.file, [], robots=[self.panda])
        with open(self.file, "a") as file:
            file.write("\n".join(lines))
        _, (known, unknown) = kinship.read_experience(self.file)
        self.assertEqual((known.robot, unknown.robot), (self.panda.digest, "elsewhere"))
        with self.assertRaisesRegex(kinship.InvalidInput, "label 'elsewhere'"):
            kinship.write_experience(self.file.with_name("other"), [unknown])
        unknown.robot = self.panda
        self.assertEqual(unknown.robot, self.panda.digest)

    def test_a_broken_line_is_named(self):
        kinship.write_experience(self.file, [attempt(self.panda, "sweep", 4)])
        with open(self.file, "a") as file:
            file.write('{"task": "sweep"}\n')
        with self.assertRaisesRegex(kinship.InvalidInput, "experience.jsonl' line 2: "):
            kinship.read_experience(self.file)
        with self.assertRaisesRegex(kinship.NotFound, "no_such_file"):
            kinship.read_experience(self.file.with_name("no_such_file"))

    def test_a_file_that_cannot_be_written_is_an_error(self):
        with self.assertRaisesRegex(OSError, "no_such_folder"):
            kinship.write_experience(self.file.parent / "no_such_folder" / "file", [])


class Attempts(unittest.TestCase):
    def setUp(self):
        self.panda = kinship.Robot(MODELS / "panda")

    def test_have_a_uuid_each_and_refuse_what_they_are_not(self):
        first, second = (kinship.Attempt("sweep", self.panda, sweep(1)) for _ in range(2))
        self.assertNotEqual(first.report_uuid, second.report_uuid)
        with self.assertRaises(AttributeError):
            kinship.Attempt("sweep", self.panda, colour="red")
        with self.assertRaisesRegex(ValueError, "'done' is not one of solved, timeout, failed"):
            first.outcome = "done"
        with self.assertRaisesRegex(ValueError, "waypoints"):
            first.waypoints = np.zeros((1, 7))
        with self.assertRaises(ValueError):
            kinship.Attempt.from_json("{}")


if __name__ == "__main__":
    unittest.main()
