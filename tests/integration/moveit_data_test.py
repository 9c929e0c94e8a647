"""Paths out to MoveIt as YAML, and in from its warehouses: a real kinshipd, PyYAML, and databases by a writer of the tests."""
import json
import os
import pathlib
import subprocess
import unittest
import uuid
import xml.etree.ElementTree

import numpy as np
import yaml

from cdr_writer import cdr
from kinshipd_process import Kinshipd
from warehouse import Warehouse

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
READY = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
ONE = {"w": 1}


def sweep(number: int) -> np.ndarray:
    """A bent path, waypoints by joints, a little different for every number."""
    waypoints = np.tile(READY, (4, 1)) + np.outer([0, 1, 1.5, 2], [0.4, 0.1, 0, 0, 0.3, -0.2, 0.1])
    waypoints[:, 1] += 0.01 * number
    return waypoints


def trajectory(waypoints: np.ndarray, joints=JOINTS, **changes) -> dict:
    points = [{"positions": list(q), "velocities": [0] * len(q), "time_from_start": {"sec": i}} for i, q in enumerate(waypoints)]
    return {"joint_trajectory": {"header": {"frame_id": "panda_link0"}, "joint_names": list(joints), "points": points}, **changes}


def box(name: str, x: float, frame: str = "panda_link0") -> dict:
    return {"header": {"frame_id": frame}, "id": name, "pose": {"position": {"x": x, "z": 0.1}, "orientation": ONE},
            "primitives": [{"type": 1, "dimensions": [0.1, 0.2, 0.3]}], "primitive_poses": [{"orientation": ONE}]}


SCENE = {"name": "shelf", "robot_model_name": "panda",
         "fixed_frame_transforms": [{"header": {"frame_id": "panda_link0"}, "child_frame_id": "cell",
                                     "transform": {"translation": {"y": 0.5}, "rotation": ONE}}],
         "link_padding": [{"link_name": "panda_link1"}], "object_colors": [{"id": "board", "color": {"r": 1}}],
         "allowed_collision_matrix": {"entry_names": ["board", "block"],
                                      "entry_values": [{"enabled": [False, True]}, {"enabled": [True, False]}]},
         "world": {"collision_objects": [box("board", 0.7), box("block", 0.8, "cell"),
                                         {"header": {"frame_id": "panda_link0"}, "id": "wedge", "pose": {"orientation": ONE},
                                          "meshes": [{"triangles": [{"vertex_indices": t} for t in
                                                                    ([0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3])],
                                                      "vertices": [{"x": 1}, {"x": 1.1}, {"x": 1, "y": 0.1}, {"x": 1, "z": 0.1}]}],
                                          "mesh_poses": [{"orientation": ONE}]}]}}
REQUEST = {"planner_id": "RRTConnect", "group_name": "panda_arm", "allowed_planning_time": 5,
           "start_state": {"joint_state": {"name": JOINTS, "position": list(READY)}},
           "goal_constraints": [{"joint_constraints": [{"joint_name": "panda_joint1", "position": 1, "weight": 1}]}]}


class MoveItData(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Kinshipd()
        cls.addClassCleanup(cls.server.__exit__, None, None, None)
        cls.server.start()
        cls.folder = cls.server.folder
        cls.kinship("robots", "register", str(MODELS / "panda"))

    @classmethod
    def run_kinship(cls, *words) -> subprocess.CompletedProcess:
        program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinship"
        return subprocess.run([program, "--domain", str(cls.server.domain), "--timeout", "30", *map(str, words)],
                              capture_output=True, text=True)

    @classmethod
    def kinship(cls, *words) -> str:
        done = cls.run_kinship(*words)
        if done.returncode != 0:
            raise AssertionError(f"{words}: exit {done.returncode}\n{done.stderr}")
        return done.stdout

    def stored(self, task: str) -> "list[dict]":
        """The attempts of a task, oldest first."""
        lines = [json.loads(line) for line in self.kinship("paths", "export", "--task", task).splitlines()]
        return [line for line in lines if "report_uuid" in line]

    def import_warehouse(self, name: str, *words) -> subprocess.CompletedProcess:
        return self.run_kinship("paths", "import", "--moveit-warehouse", self.folder / name, "--robot", "panda", "--json", *words)

    def import_paths(self, task: str, count: int, outcome: str = "solved", **changes) -> None:
        file = self.folder / f"{task}.jsonl"
        file.write_text("".join(json.dumps(
            {"report_uuid": str(uuid.uuid5(uuid.NAMESPACE_OID, f"{task}{number}")), "task": task, "robot": "panda", "machine": "test",
             "T_task_base": None, "waypoints": sweep(number).tolist(), "scene": None,
             "record": {"outcome": outcome, "planner": "birrt", "planning_time_s": 0.5, "collision_checks": 1000}, **changes}) + "\n"
            for number in range(count)))
        self.kinship("paths", "import", str(file))

    # Out

    def check_trajectory(self, message: dict, waypoints: np.ndarray) -> None:
        limits = {joint.get("name"): float(joint.find("limit").get("velocity"))
                  for joint in xml.etree.ElementTree.parse(MODELS / "panda" / "robot.urdf").iter("joint") if joint.find("limit") is not None}
        joints = message["joint_trajectory"]
        self.assertEqual(joints["joint_names"], JOINTS)
        self.assertEqual(message["multi_dof_joint_trajectory"]["points"], [])
        positions = [point["positions"] for point in joints["points"]]
        self.assertTrue(all(type(value) is float for q in positions for value in q), positions)
        np.testing.assert_array_equal(positions, waypoints)
        times = [point["time_from_start"]["sec"] + 1e-9 * point["time_from_start"]["nanosec"] for point in joints["points"]]
        speeds = np.abs(np.diff(waypoints, axis=0)) / np.diff(times)[:, None] / [limits[name] for name in JOINTS]
        np.testing.assert_allclose(speeds.max(axis=1), 1, atol=1e-6)  # the slowest joint at its limit

    def test_a_file_has_display_trajectories(self):
        self.import_paths("shown", 2)
        file = self.folder / "shown.yaml"
        done = self.run_kinship("paths", "export", "--task", "shown", "--moveit", file)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a URDF has no limits of acceleration", done.stderr)
        self.assertIn("a URDF has no limits of acceleration", file.read_text())
        documents = list(yaml.safe_load_all(file.read_text()))
        self.assertEqual(len(documents), 2)
        for number, document in enumerate(documents):
            self.assertEqual(document["model_id"], "panda")
            (message,) = document["trajectory"]
            self.check_trajectory(message, sweep(number))
            start = document["trajectory_start"]["joint_state"]
            state = dict(zip(start["name"], start["position"]))
            np.testing.assert_array_equal([state[name] for name in JOINTS], sweep(number)[0])
            self.assertGreater(len(state), len(JOINTS), "held joints, too")
        both = self.run_kinship("paths", "export", "--task", "shown", "--moveit", "-")
        self.assertEqual(both.stdout, file.read_text())

    def test_a_folder_has_two_files_of_each_path(self):
        self.import_paths("kept", 3)
        folder = self.folder / "kept"
        done = self.run_kinship("paths", "export", "--task", "kept", "--limit", "2", "--moveit", f"{folder}/")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(list(folder.iterdir())), 4)
        for file in folder.glob("*.trajectory.yaml"):
            message = yaml.safe_load(file.read_text())
            uuids = [str(uuid.uuid5(uuid.NAMESPACE_OID, f"kept{number}")) for number in range(3)]
            self.check_trajectory(message, sweep(uuids.index(file.name.split(".")[0])))
            shown = yaml.safe_load((folder / file.name.replace("trajectory", "display")).read_text())
            self.assertEqual(shown["trajectory"], [message])

    def test_nothing_to_write_is_told(self):
        self.import_paths("none", 1, waypoints=None, outcome="failed")
        done = self.run_kinship("paths", "export", "--task", "none", "--moveit", self.folder / "none.yaml")
        self.assertEqual((done.returncode, "nothing to write" in done.stderr), (3, True), done.stderr)
        self.assertFalse((self.folder / "none.yaml").exists())

    # In

    def make_scene_storage(self, name: str) -> None:
        warehouse = Warehouse(self.folder / name)
        scenes = {"database": "moveit_planning_scenes"}
        names = {"planning_scene_id": "shelf", "motion_request_id": "Motion Plan Request 0"}
        warehouse.insert(**scenes, collection="planning_scene", message="PlanningScene", data=cdr("PlanningScene", {"is_diff": True}),
                         planning_scene_id="shelf")
        warehouse.insert(**scenes, collection="planning_scene", message="PlanningScene", data=cdr("PlanningScene", SCENE),
                         planning_scene_id="shelf")
        warehouse.insert(**scenes, collection="motion_plan_request", message="MotionPlanRequest", data=cdr("MotionPlanRequest", REQUEST),
                         **names)
        mixed = ["finger", *reversed(JOINTS)]
        for number, little in ((0, True), (1, False)):
            waypoints = np.hstack([np.linspace(0, 0.04, 4)[:, None], sweep(number)[:, ::-1]])
            warehouse.insert(**scenes, collection="robot_trajectory", message="RobotTrajectory",
                             data=cdr("RobotTrajectory", trajectory(waypoints, mixed), little), **names)
        warehouse.insert("moveit_robot_states", "robot_states", "RobotState", cdr("RobotState", {}), state_id="ready")
        warehouse.close()

    def test_trajectories_of_planning_scenes_come_with_their_scenes(self):
        self.make_scene_storage("scenes.sqlite")
        done = self.import_warehouse("scenes.sqlite")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout), {"format": "kinship.path-import/1", "robots": 0, "stored": 2, "known": 0, "recorded": 0,
                                                   "refused": 0})
        self.assertIn("left out: 1 x moveit_robot_states/robot_states of moveit_msgs::msg::RobotState", done.stderr)
        self.assertIn("left out: 2 x the motion of joint 'finger', not of the chain", done.stderr)
        attempts = self.stored("shelf")
        for number, attempt in enumerate(attempts):
            np.testing.assert_array_equal(attempt["waypoints"], sweep(number))
            self.assertEqual(attempt["record"]["planner"], "moveit RRTConnect")
            self.assertEqual(attempt["record"]["sampling_mode"], "uniform")
            boxes = {each["name"]: each for each in attempt["scene"]["boxes"]}
            np.testing.assert_allclose(boxes["board"]["pose"][:3], [0.7, 0, 0.1], atol=1e-9)
            np.testing.assert_allclose(boxes["block"]["pose"][:3], [0.8, 0.5, 0.1], atol=1e-9)
            self.assertEqual(boxes["board"]["size"], [0.1, 0.2, 0.3])
            self.assertIn(sorted(["board", "block"]), [sorted(pair) for pair in attempt["scene"]["allowed_collisions"]])
            solids = [each for kind in ("boxes", "cylinders", "spheres", "capsules") for each in attempt["scene"].get(kind, [])]
            self.assertIn("wedge", {each["name"] for each in solids})
        again = json.loads(self.import_warehouse("scenes.sqlite").stdout)
        self.assertEqual((again["stored"], again["known"]), (0, 2))

    def test_task_and_placement_may_be_said(self):
        self.make_scene_storage("placed.sqlite")
        done = self.import_warehouse("placed.sqlite", "--task", "placed", "--placement", "1 2 0 0 0 0 1")
        self.assertEqual(done.returncode, 0, done.stderr)
        for attempt in self.stored("placed"):
            np.testing.assert_allclose(attempt["T_task_base"], [1, 2, 0, 0, 0, 0, 1])
            boxes = {each["name"]: each for each in attempt["scene"]["boxes"]}
            np.testing.assert_allclose(boxes["block"]["pose"][:3], [1.8, 2.5, 0.1], atol=1e-9)

    def test_caches_are_read_and_what_is_no_path_is_named(self):
        warehouse = Warehouse(self.folder / "cache.sqlite")
        cache = {"database": "move_group_trajectory_cache", "collection": "cell@home", "message": "RobotTrajectory"}

        def insert(message: dict, data: bytes = b"") -> None:
            warehouse.insert(**cache, data=data or cdr("RobotTrajectory", message), execution_time_s=3.0, planning_time_s=0.25)
        insert(trajectory(sweep(5)))
        insert(trajectory(np.tile(READY, (3, 1))))
        insert(trajectory(sweep(1)[:, :6], JOINTS[:6]))
        insert(trajectory(sweep(2), multi_dof_joint_trajectory={"joint_names": ["base"], "points": [{"transforms": [{"rotation": ONE}]}]}))
        insert({}, cdr("RobotTrajectory", trajectory(sweep(3)))[:-40])
        insert({}, bytes([0, 7, 0, 0]) + bytes(100))
        insert(trajectory(sweep(4) + [0, 9, 0, 0, 0, 0, 0]))
        insert(trajectory(np.hstack([sweep(7), np.arange(4)[:, None]]), [*JOINTS, "\x1b[31mred"]))
        warehouse.insert("move_group_cartesian_trajectory_cache", "cell@home", "RobotTrajectory", cdr("RobotTrajectory", trajectory(sweep(6))))
        warehouse.close()
        done = self.import_warehouse("cache.sqlite", "--task", "cached")
        self.assertEqual(done.returncode, 1, done.stderr)
        counts = json.loads(done.stdout)
        self.assertEqual((counts["stored"], counts["refused"]), (3, 6), done.stderr)
        self.assertIn("the motion of joint '?[31mred'", done.stderr)
        row = "paths import: move_group_trajectory_cache/cell@home {}: "
        for number, why in ((2, "no motion of the robot's joints"), (3, "joint 'panda_joint7' of the robot is not among them"),
                            (4, "a base that moves"), (5, "the message ends before it"), (6, "is no plain CDR"), (7, "panda_joint2")):
            (line,) = [line for line in done.stderr.splitlines() if line.startswith(row.format(number))]
            self.assertIn(why, line)
        paths = [attempt["waypoints"] for attempt in self.stored("cached")]
        self.assertEqual(sorted(paths), sorted(sweep(number).tolist() for number in (5, 6, 7)))
        self.assertEqual({attempt["record"]["planning_time_s"] for attempt in self.stored("cached")}, {0, 0.25})

    def test_other_files_are_refused_by_name(self):
        (self.folder / "text").write_text("no database, but long enough to be looked at as one " * 20)
        Warehouse(self.folder / "old.sqlite", schema=9).close()
        for name, why in (("text", "not a database"), ("old.sqlite", "schema 9 instead of 10"), ("none", "no such file")):
            done = self.import_warehouse(name, "--task", "other")
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(why, done.stderr)
            self.assertIn(name, done.stderr)
        done = self.run_kinship("paths", "import", "--moveit-warehouse", self.folder / "old.sqlite")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--robot", done.stderr)
        done = self.run_kinship("paths", "import")
        self.assertEqual((done.returncode, "names no file" in done.stderr), (2, True), done.stderr)


if __name__ == "__main__":
    unittest.main()
