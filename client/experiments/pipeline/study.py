"""A study as kinship-experiments has it: settings, robots, instances."""
import dataclasses
import json
import pathlib
import subprocess
from typing import Any

import kinship
import numpy as np

from kinship_results.formats import checked

QUICK_LEARNING, QUICK_INSTANCES = 20, 6  # of each robot; a quick run plans test instances once


@dataclasses.dataclass(frozen=True)
class RunOptions:
    """Where and how a study runs."""

    folder: pathlib.Path  # of learning sets, results and the store
    models: pathlib.Path  # of the robots' model folders
    program: pathlib.Path  # kinship-experiments
    kinshipd: pathlib.Path
    analysis: pathlib.Path  # client/experiments/analyse.py
    domain: int
    threads: int = 2
    learning: int = 0  # learning instances of each robot; 0: as the study has it
    resume: bool = False
    quick: bool = False


@dataclasses.dataclass(frozen=True)
class Instance:
    """A query of a robot, as its line in a problem file has it."""

    line: str
    problem: kinship.Problem

    @property
    def name(self) -> str:
        return self.problem.name


@dataclasses.dataclass(frozen=True)
class Member:
    """A robot of a study."""

    label: str
    robot: kinship.Robot
    T_task_base: np.ndarray


class Study:
    """What kinship-experiments tells of a study. Raises ValueError with its message."""

    def __init__(self, name: str, options: RunOptions) -> None:
        self.name = name
        self.options = options
        self.description: dict[str, Any] = checked(json.loads(self._ask("--describe")), "study-description")
        self.description.pop("format", None)  # of that document
        self.fleet = [Member(robot["label"], kinship.Robot(options.models / robot["label"]), _matrix(robot["T_task_base"]))
                      for robot in self.description["robots"]]

    def index_of(self, label: str) -> int:
        """Raises LookupError that names the robots there are."""
        labels = [member.label for member in self.fleet]
        if label not in labels:
            raise LookupError(f"no robot '{label}' in the study; there are {', '.join(labels)}")
        return labels.index(label)

    def usual_start(self, robot: int) -> np.ndarray | None:
        """That of a calibration instance; None if instances begin at poses."""
        [instance] = self.instances(robot, "calibration", 1)
        start = instance.problem.start
        return None if start is None or len(start) == 0 else np.asarray(start)

    def plan_options(self, **changed: Any) -> dict[str, Any]:
        """Of kinship.plan, for every query. By steps, so that a check means the same to all planners; a query ends at its first path."""
        return {name: self.description[name] for name in ("resolution", "max_checks", "max_goals", "overshoot")} | {
            "shortcut_checks": 0} | changed

    @property
    def learning_instances(self) -> int:
        requested = self.options.learning or self.description["learning_instances"]
        return min(QUICK_LEARNING, requested) if self.options.quick else requested

    def instances(self, robot: int, which: str, count: int) -> list[Instance]:
        """The first `count` instances of a set: calibration, learning, tuning or test."""
        text = self._ask("--problems", self.fleet[robot].label, "--set", which, "--count", str(count))
        return [Instance(line, kinship.Problem.from_json(line)) for line in text.splitlines()]

    def command(self, *words: str) -> list[str]:
        """That asks kinship-experiments for something of this study."""
        return [str(self.options.program), self.name, "--out", str(self.options.folder), "--models", str(self.options.models), *words]

    def _ask(self, *words: str) -> str:
        asked = subprocess.run(self.command(*words), capture_output=True, text=True)
        if asked.returncode != 0:
            raise ValueError(asked.stderr.strip())
        return asked.stdout


def _matrix(pose: list[float]) -> np.ndarray:
    """4 x 4 of x y z, and a quaternion x y z w."""
    x, y, z, w = pose[3:] / np.linalg.norm(pose[3:])
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    T[:3, 3] = pose[:3]
    return T
