"""The ways in which a robot plans the instances of a study, and how queries are planned with them."""
import dataclasses
import json
import math
from collections.abc import Callable, Sequence
from typing import Any

import kinship
import numpy as np

from .files import Key, QueryLog
from .parallel import for_each
from .study import Instance, Member, Study

UNIFORM = "uniform"
OTHERS, NOBODY, ALL = "the others", "nobody", "all"  # whose experience: of all but the robot; none; its own, too


@dataclasses.dataclass(frozen=True)
class DistributionRequest:
    """What a distribution is asked for; robots by their places in the fleet."""

    task: str
    target: int
    sources: tuple[int, ...]
    profile: str = "default"


@dataclasses.dataclass(frozen=True)
class Cell:
    """One way in which a robot plans."""

    robot: int
    name: str  # unique among the robot's cells
    options: dict[str, Any]  # of kinship.plan
    guidance: kinship.Guidance | None = None  # None: uniform
    oracle_deviation: float | None = None  # guided by an answer to each query itself, so far about it, joint units

    @property
    def distribution(self) -> str | None:
        return self.guidance.distribution_id if self.guidance else None


@dataclasses.dataclass(frozen=True)
class QueryPlan:
    """Which instances are planned, and how often: under each instance's own seed + 0, + 1, ..."""

    which: str  # calibration, tuning, test
    instances: int
    seeds: int = 1
    threads: int = 1


def uniform_name(overshoot: float) -> str:
    return UNIFORM if overshoot == 1 else f"{UNIFORM} f{overshoot:g}"


def cell_name(sources: str, variant: str) -> str:
    """Of a cell of a side study."""
    return f"{sources}|{variant}"


def uniform_cell(study: Study, robot: int, overshoot: float) -> Cell:
    return Cell(robot, uniform_name(overshoot), study.plan_options(overshoot=overshoot))


def uniform_cells(study: Study, robot: int, overshoot: float) -> list[Cell]:
    """With the overshoot that guided cells have, and plain."""
    return [uniform_cell(study, robot, each) for each in dict.fromkeys((overshoot, 1.0))]


def densified(waypoints: np.ndarray, step: float) -> np.ndarray:
    """Each line of a path, n x dof, cut into the fewest equal parts of at most `step`."""
    points = [waypoints[:1]]
    for begin, end in zip(waypoints, waypoints[1:]):
        parts = max(1, math.ceil((np.linalg.norm(end - begin) - 1e-9) / step))
        points.append(begin + (end - begin) * (np.arange(1, parts + 1) / parts)[:, None])
    return np.concatenate(points)


def oracle(member: Member, problem: kinship.Problem, seed: int, options: dict[str, Any],
           deviation: float) -> kinship.Distribution | None:
    """Samples about an answer to the very query: what bounds the worth of samples. None: it has none."""
    plan = kinship.plan(member.robot, problem, seed=seed, **options | {"shortcut_checks": 1000})
    if plan.waypoints is None:
        return None
    along = densified(plan.waypoints, deviation)
    robot = member.robot
    return kinship.Distribution.from_json(json.dumps(_NO_PROVENANCE | {
        "robot": robot.digest, "configurations": len(along), "limits": list(zip(robot.lower, robot.upper)), "means": along.tolist(),
        "weights": [1 / len(along)] * len(along), "covariances": [(np.eye(robot.dof) * deviation**2).tolist()]}))


_NO_PROVENANCE: dict[str, Any] = {
    "id": "0" * 64, "revision": 0, "store_epoch": "00000000-0000-0000-0000-000000000000", "task": "oracle", "T_task_base": None,
    "profile": "", "filters": "", "selection": {"sources": [], "weighting": "sources", "since_ms": 0}, "sources": [], "engines": "", "cuts": None,
    "k_curve": None, "held_out_score": None, "recommended_share": 1, "guided_share": 1, "evidence": "", "guided": None, "control": None,
    "recent": [], "state": "ready", "reason": "", "fitted_ms": 0, "transfer_time_s": 0, "fit_time_s": 0, "fit": None}


def answer(member: Member, cell: Cell, instance: Instance, seed: int) -> dict[str, Any]:
    """Plans a query. Returns its row of the log."""
    own_seed = (instance.problem.seed + seed) % 2**64
    guidance: kinship.Guidance | kinship.Distribution | None = cell.guidance
    if cell.oracle_deviation is not None:
        guidance = oracle(member, instance.problem, own_seed, cell.options, cell.oracle_deviation)
    plan = kinship.plan(member.robot, instance.problem, guidance, seed=own_seed, sampling_mode="guided" if guidance else "", **cell.options)
    row = row_of((member.label, cell.name, instance.name, seed), solved=plan.solved, checks=plan.collision_checks,
                 cpu_s=plan.processor_time_s, length=plan.path_length or 0.0)
    row |= {"distribution": cell.distribution, "goal_checks": plan.goal_checks, "projections": plan.projections,
            "gate_fired": plan.gate_fired, "guided_share": plan.share, "track_share": plan.track_share, "found_by": plan.found_by,
            "hand_length": plan.hand_length, "clearance": plan.least_clearance}
    return row | {"guide": plan.guide} if guidance else row


def row_of(key: Key, *, solved: bool, checks: int, cpu_s: float, length: float) -> dict[str, Any]:
    """Of a planner that tells no more."""
    return dict(zip(("robot", "guidance", "instance", "seed"), key)) | {
        "distribution": None, "solved": solved, "checks": checks, "goal_checks": 0, "projections": 0, "cpu_s": cpu_s, "length": length}


def run_queries(study: Study, cells: Sequence[Cell], plan: QueryPlan, log: QueryLog, answered: Callable[[], None]) -> None:
    """Plans what is not in the log yet.

    An instance belongs to one thread, which plans it with all cells of the robot in turn, seed after seed: whatever disturbs the
    machine disturbs them alike.
    """
    for robot, member in enumerate(study.fleet):
        own = [cell for cell in cells if cell.robot == robot]
        if not own:
            continue

        def work(instance: Instance, member: Member = member, own: Sequence[Cell] = own) -> None:
            for seed in range(plan.seeds):
                for cell in own:
                    if not log.has((member.label, cell.name, instance.name, seed), cell.distribution):
                        log.add(answer(member, cell, instance, seed))
                    answered()

        for_each(plan.threads, study.instances(robot, plan.which, plan.instances), work)
