"""`paths export --mcap` of a real kinshipd, read by a reader of our own, compared with the programs' own kinematics."""
import json
import unittest
import uuid
import xml.etree.ElementTree

import numpy as np

from kinshipd_process import MODELS, Kinshipd
from mcap_reader import Mcap

READY = {"panda": [0, -0.785, 0, -2.356, 0, 1.571, 0.785], "ur10e": [0, -1.2, 1.8, -2.2, -1.57, 0]}
PLACEMENT = [0.4, -0.2, 0.1, 0, 0, 0.6, 0.8]
SCENE = {"boxes": [{"name": "table", "pose": [0.6, 0, -0.2, 0, 0, 0, 1], "size": [0.8, 1.2, 0.05]}],
         "cylinders": [{"name": "pole", "pose": [1, 1, 0.5, 0, 0, 0, 1], "radius": 0.05, "length": 1}],
         "spheres": [{"name": "ball", "center": [1, -1, 0.5], "radius": 0.1}],
         "capsules": [{"name": "pill", "pose": [-1, 1, 0.5, 0, 0, 0, 1], "radius": 0.1, "length": 0.4}],
         "held": [{"name": "can", "shape": {"cylinder": [0.03, 0.1]}, "T_transfer_object": [0, 0, 0.05, 0, 0, 0, 1]}],
         "allowed_collisions": []}
REST, CHANGE = 500_000_000, 1_000_000  # ns


def attempt(robot: str, number: int, **changes) -> dict:
    """A line of an experience file: a sweep of the first joint, bent, a little different for every number."""
    waypoints = np.tile(READY[robot], (4, 1)) + np.outer([0, 1, 1, 2], [0.4, 0.1, 0, 0, 0.3, -0.2, 0.1][:len(READY[robot])])
    waypoints[:, 1] += 0.01 * number
    return {"report_uuid": str(uuid.UUID(int=number + 1)), "task": "sweep", "robot": robot, "machine": "test", "T_task_base": None,
            "waypoints": waypoints.tolist(), "scene": None,
            "record": {"outcome": "solved", "planner": "birrt", "planning_time_s": 0.5, "collision_checks": 1000}, **changes}


def matrix(position, orientation) -> np.ndarray:
    """Of a position and a quaternion x y z w."""
    x, y, z, w = orientation
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    T[:3, 3] = position
    return T


def values(members: dict, names: str) -> list:
    return [members[name] for name in names]


class Recording(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start()
        cls.folder = cls.server.folder
        cls.kinship = cls.server.kinship_bytes
        cls.server.register(*READY)
        cls.attempts = [attempt("panda", 0, T_task_base=PLACEMENT, scene=SCENE), attempt("ur10e", 1), attempt("panda", 2, task="other")]
        cls.attempts += [attempt("ur10e", number) for number in range(3, 40)]
        failed = attempt("panda", 50, waypoints=None)
        failed["record"] = {**failed["record"], "outcome": "failed"}
        cls.server.give([*cls.attempts, failed])
        done = cls.server.run_kinship("paths", "export", "--mcap", str(cls.folder / "all.mcap"))
        assert done.returncode == 0, done.stderr
        cls.said = done.stderr.decode()
        cls.recording = Mcap((cls.folder / "all.mcap").read_bytes())
        cls.facts = {facts["report_uuid"]: facts for name, facts in cls.recording.metadata if name == "path"}

    def span(self, given: dict) -> "tuple[int, int]":
        facts = self.facts[given["report_uuid"]]
        return int(facts["start_ns"]), int(facts["end_ns"])

    def last(self, topic: str, time: int) -> dict:
        """What a viewer has of a topic at a time."""
        return [message for message in self.recording.on(topic) if message.time <= time][-1].value

    def frames(self, time: int) -> "dict[str, np.ndarray]":
        """The frames of the last messages, in the task frame."""
        parents = {}
        for topic in ("/fixed_transforms", "/transforms"):
            for each in self.last(topic, time)["transforms"]:
                self.assertNotIn(each["child_frame_id"], parents)
                parents[each["child_frame_id"]] = each["parent_frame_id"], matrix(values(each["translation"], "xyz"),
                                                                                  values(each["rotation"], "xyzw"))

        def pose(frame: str) -> np.ndarray:
            if frame == "task":
                return np.eye(4)
            parent, T_parent_frame = parents[frame]
            return pose(parent) @ T_parent_frame
        return {frame: pose(frame) for frame in parents}

    def expected_frames(self, given: dict, q: np.ndarray) -> "dict[str, np.ndarray]":
        robot = given["robot"]
        placement = given["T_task_base"] or [0, 0, 0, 0, 0, 0, 1]
        answer = json.loads(self.kinship("robots", "frames", str(MODELS / robot), "--json", "--q", " ".join(map(repr, map(float, q))),
                                         "--placement", " ".join(map(str, placement))))
        self.assertEqual(answer["frame"], "task")
        frames = {f"{robot}/{each['link']}": matrix(each["pose"][:3], each["pose"][3:]) for each in answer["links"]}
        frames[f"{robot}:transfer"] = matrix(answer["transfer"][:3], answer["transfer"][3:])
        return frames

    def waypoint_times(self, given: dict) -> "list[float]":
        """Seconds from the start, by the URDF's velocity limits."""
        urdf = xml.etree.ElementTree.parse(MODELS / given["robot"] / "robot.urdf")
        speeds = [float(joint.find("limit").get("velocity")) for joint in urdf.iter("joint")
                  if joint.get("type") == "revolute"]
        self.assertEqual(len(speeds), len(given["waypoints"][0]))
        steps = np.abs(np.diff(given["waypoints"], axis=0)) / speeds
        return [0, *np.cumsum(steps.max(axis=1))]

    def test_paths_follow_each_other(self):
        self.assertEqual(list(self.facts), [given["report_uuid"] for given in self.attempts])
        self.assertIn("40 paths, ", self.said)
        self.assertIn("; 1 attempt without a path left out", self.said)
        free = 1_000_000_000
        for given in self.attempts:
            start, end = self.span(given)
            self.assertEqual(start, free)
            self.assertAlmostEqual((end - start) / 1e9, self.waypoint_times(given)[-1], delta=1e-8)
            free = end + REST + CHANGE
        times = [message.time for message in self.recording.messages]
        self.assertEqual(times, sorted(times))
        self.assertGreater(len(self.recording.chunks), 1)

    def test_frames_are_those_of_forward_kinematics(self):
        for given in self.attempts[:3]:
            start, end = self.span(given)
            times = self.waypoint_times(given)
            in_path = [message.time for message in self.recording.on("/transforms") if start <= message.time <= end]
            self.assertLessEqual(max(np.diff(in_path)), 1e9 / 30 + 1)
            for waypoint in times:
                self.assertLessEqual(min(abs(np.array(in_path) - start - waypoint * 1e9)), 1)
            for time in [*in_path[::7], end, end + REST]:
                q = [np.interp((time - start) / 1e9, times, joint) for joint in np.transpose(given["waypoints"])]
                frames, expected = self.frames(time), self.expected_frames(given, np.array(q))
                self.assertEqual(set(frames), set(expected))
                for name, T_task_frame in frames.items():
                    np.testing.assert_allclose(T_task_frame, expected[name], atol=1e-7, err_msg=name)

    def test_the_hand_has_left_a_line(self):
        given = self.attempts[0]
        start, end = self.span(given)
        (hand,) = self.last("/hand", end)["entities"]
        line = [values(point, "xyz") for point in hand["lines"][0]["points"]]
        in_path = [message.time for message in self.recording.on("/transforms") if start <= message.time <= end]
        self.assertEqual(len(line), len(in_path))
        for point, time in list(zip(line, in_path))[::5]:
            np.testing.assert_allclose(point, self.frames(time)["panda:transfer"][:3, 3], atol=1e-7)
        self.assertEqual(hand["texts"][0]["text"], f"panda, sweep, {given['report_uuid']}")
        told = {pair["key"]: pair["value"] for pair in hand["metadata"]}
        self.assertEqual((told["planner"], told["collision_checks"], told["report_uuid"]), ("birrt", "1000", given["report_uuid"]))

    def test_scenes_and_robots_are_drawn(self):
        start, end = self.span(self.attempts[0])
        update = self.last("/scene", end)
        self.assertEqual(update["deletions"], [{"timestamp": {"sec": start // 10**9, "nsec": start % 10**9}, "type": 1, "id": ""}])
        scene = {entity["id"]: entity for entity in update["entities"]}
        self.assertEqual({name: entity["frame_id"] for name, entity in scene.items()},
                         {"table": "task", "pole": "task", "ball": "task", "pill": "task", "held can": "panda:transfer"})
        self.assertEqual(values(scene["table"]["cubes"][0]["size"], "xyz"), [0.8, 1.2, 0.05])
        self.assertEqual(values(scene["table"]["cubes"][0]["pose"]["position"], "xyz"), [0.6, 0, -0.2])
        self.assertEqual(values(scene["pole"]["cylinders"][0]["size"], "xyz"), [0.1, 0.1, 1])
        self.assertEqual(values(scene["ball"]["spheres"][0]["size"], "xyz"), [0.2, 0.2, 0.2])
        self.assertEqual(sorted(sphere["pose"]["position"]["z"] for sphere in scene["pill"]["spheres"]), [0.3, 0.7])
        self.assertEqual(values(scene["pill"]["cylinders"][0]["size"], "xyz"), [0.2, 0.2, 0.4])
        self.assertEqual(self.last("/scene", self.span(self.attempts[1])[0])["entities"], [])
        links = self.last("/robot", end)["entities"]
        urdf = xml.etree.ElementTree.parse(MODELS / "panda" / "robot.urdf")
        solid = {f"panda/{link.get('name')}" for link in urdf.iter("link") if link.find("collision") is not None}
        self.assertEqual({entity["frame_id"] for entity in links}, solid)
        self.assertTrue(all(entity["frame_locked"] for entity in links))
        self.assertLessEqual(solid, set(self.frames(end)))

    def test_schemas_name_every_member(self):
        schemas = {self.recording.channel_of(number)[1]: self.recording.schema_of(self.recording.channel_of(number)[0])
                   for number in self.recording.channels}
        self.assertEqual({topic: name for topic, (name, _, _) in schemas.items()},
                         {"/transforms": "foxglove.FrameTransforms", "/fixed_transforms": "foxglove.FrameTransforms",
                          "/robot": "foxglove.SceneUpdate", "/scene": "foxglove.SceneUpdate", "/hand": "foxglove.SceneUpdate"})
        kinds = {"number": (int, float), "integer": int, "string": str, "boolean": bool}

        def check(value, schema: dict, place: str) -> None:
            if schema["type"] == "object":
                self.assertEqual(set(value), set(schema["properties"]), place)
                for name, member in value.items():
                    check(member, schema["properties"][name], f"{place}.{name}")
            elif schema["type"] == "array":
                for each in value:
                    check(each, schema["items"], f"{place}[]")
            else:
                self.assertIsInstance(value, kinds[schema["type"]], place)
        for message in self.recording.messages:
            name, encoding, schema = schemas[message.topic]
            self.assertEqual((encoding, schema["title"]), ("jsonschema", name))
            check(message.value, schema, message.topic)

    def test_metadata_tells_the_program_and_the_time(self):
        name, facts = self.recording.metadata[0]
        version = self.kinship("--version").decode().strip()
        self.assertEqual((name, facts["program"], self.recording.library), ("kinship", version, version))
        self.assertIn("velocity limit", facts["times"])

    def chosen(self, *words: str) -> "list[str]":
        recording = Mcap(self.kinship("paths", "export", *words, "--mcap", "-"))
        return [facts["report_uuid"] for name, facts in recording.metadata if name == "path"]

    def test_paths_are_chosen(self):
        given = [each["report_uuid"] for each in self.attempts]
        self.assertEqual(self.chosen("--task", "other"), [given[2]])
        self.assertEqual(self.chosen("--robot", "panda"), [given[0], given[2]])
        self.assertEqual(self.chosen(given[5], given[0]), [given[5], given[0]])
        self.assertEqual(self.chosen("--limit", "2"), given[:-3:-1])
        lines = [json.loads(line) for line in self.kinship("paths", "export", given[1], given[2]).splitlines()]
        self.assertEqual([line.get("report_uuid") or line["robot_description"]["label"] for line in lines],
                         ["ur10e", given[1], "panda", given[2]])
        self.assertEqual(self.kinship("paths", "export", "--mcap", "-"), (self.folder / "all.mcap").read_bytes(), "equal bytes")

    def test_without_a_path_the_file_stays(self):
        kept = self.folder / "kept.mcap"
        kept.write_text("mine")
        for words in (("--task", "nothing"), (str(uuid.UUID(int=999)),)):
            done = self.server.run_kinship("paths", "export", *words, "--mcap", str(kept))
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertEqual(kept.read_text(), "mine")
            self.assertFalse((self.folder / "kept.mcap.part").exists())

    def test_options_that_exclude_each_other_are_refused(self):
        file = self.folder / "refused.mcap"
        for words in (("--output", str(self.folder / "refused.jsonl")), (self.attempts[0]["report_uuid"], "--task", "sweep"),
                      (self.attempts[0]["report_uuid"], "--limit", "1"), ("--limit", "0")):
            self.assertEqual(self.server.run_kinship("paths", "export", *words, "--mcap", str(file)).returncode, 2, words)
            self.assertFalse(file.exists())


if __name__ == "__main__":
    unittest.main()
