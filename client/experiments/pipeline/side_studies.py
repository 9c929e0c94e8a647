"""Further cells over the test instances: what the main tables do not tell."""
import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from . import peers
from .cells import ALL, NOBODY, OTHERS, UNIFORM, DistributionRequest, cell_name
from .study import Study


@dataclasses.dataclass(frozen=True)
class RequestedCell:
    """A guided cell before its distribution was fetched; a uniform one if its request is None."""

    robot: int
    name: str
    request: DistributionRequest | None
    share: float = 1.0  # of guided samples
    guide: str | None = "mixture"  # None: what the server finds by rehearsal
    options: dict[str, Any] = dataclasses.field(default_factory=dict)  # of kinship.plan, where not the study's
    oracle_deviation: float | None = None


@dataclasses.dataclass(frozen=True)
class SideStudy:
    """purpose: for people; shortened: learning sets handed over once more, by task their first so many attempts."""

    purpose: str
    cells: Callable[[Study], Sequence[RequestedCell]]
    shortened: Callable[[Study], dict[str, int]] = lambda study: {}


def _pairs(study: Study, variant: str, profile: str = "default", *, task: str = "", **more: Any) -> list[RequestedCell]:
    """One cell per pair of robots, all with one profile."""
    more = {"share": study.description["guided_share"]} | more
    return [RequestedCell(target, cell_name(source.label, variant), DistributionRequest(task or study.name, target, (index,), profile), **more)
            for target in range(len(study.fleet)) for index, source in enumerate(study.fleet)]


def _each(study: Study, name: Callable[[int], str], request: Callable[[int], DistributionRequest | None], **more: Any) -> list[RequestedCell]:
    """One cell per robot."""
    return [RequestedCell(robot, name(robot), request(robot), **more) for robot in range(len(study.fleet))]


def _pooled(study: Study) -> list[RequestedCell]:
    everyone = tuple(range(len(study.fleet)))
    cells = []
    for target in everyone:
        others = tuple(source for source in everyone if source != target)
        cells += [RequestedCell(target, cell_name(name, "pooled"), DistributionRequest(study.name, target, sources), study.description["guided_share"], None)
                  for name, sources in ((OTHERS, others), (ALL, everyone))]
    return cells


def _components(study: Study) -> list[RequestedCell]:
    return [cell for count in ("20", "50", "100", "auto") for cell in _pairs(study, f"K = {count}", f"default,components={count}")]


def _shortened(study: Study) -> dict[str, int]:
    return {f"{study.name}_{count}": count for count in (10, 50, 100) if count < study.description["learning_instances"]}


def _sizes(study: Study) -> list[RequestedCell]:
    return [cell for task, count in _shortened(study).items() for cell in _pairs(study, f"{count} instances", task=task, guide=None)]


def _inverse(study: Study) -> list[RequestedCell]:
    return _each(study, lambda robot: cell_name(study.fleet[robot].label, "own through inverse kinematics"),
                 lambda robot: DistributionRequest(study.name, robot, (robot,), "default,take_over=0"), share=study.description["guided_share"])


def _overshoot(study: Study) -> list[RequestedCell]:
    """The ratio is that of uniform sampling as the main tables have it."""
    return [cell for factor in (1.5, 2.0)
            for cell in _each(study, lambda robot: cell_name(UNIFORM, f"uniform, overshoot {factor:g}"), lambda robot: None,
                              options={"overshoot": factor})]


def _guides(study: Study) -> list[RequestedCell]:
    share = study.description["guided_share"]
    cells = _pairs(study, "mixture") + _pairs(study, "stored ways", guide="ways")
    for options, variant in (({"retreat": 0.0}, "straight way of the hand"), ({}, "retreat")):
        cells += _each(study, lambda robot: cell_name(NOBODY, variant), lambda robot: DistributionRequest(study.name, robot, (robot,)), share=share,
                       guide="retreat", options=options)
    return cells


def _oracle(study: Study) -> list[RequestedCell]:
    """No gate doubts an answer."""
    return [cell for deviation in (0.1, 0.3)
            for cell in _each(study, lambda robot: cell_name(NOBODY, f"own answer, {deviation:g} about it"), lambda robot: None,
                              options={"gate_distance": float("inf")}, oracle_deviation=deviation)]


_ALL = {
    "pooled": SideStudy("experience of all other robots, and of all with the robot's own", _pooled),
    "components": SideStudy("20, 50 and 100 components, and as many as held-out paths want", _components),
    # To the letter: neither uniform samples nor overshoot.
    "paper": SideStudy("the profile that does what the paper says and nothing else",
                       lambda study: _pairs(study, "paper", "paper", share=1.0, options={"overshoot": 1})),
    "scenes": SideStudy("without the recorded scenes",
                        lambda study: _pairs(study, "no recorded scenes", "default,avoid_recorded_scene=0")),
    "sizes": SideStudy("learning sets of 10, 50, 100 and more instances", _sizes, _shortened),
    "inverse": SideStudy("own paths through inverse kinematics, like those of other robots", _inverse),
    "overshoot": SideStudy("uniform sampling with overshoot, against uniform sampling without", _overshoot),
    # The same distributions in the hands of another planner.
    "roadmap": SideStudy("Repetition Roadmap over the components, then the trees",
                         lambda study: _pairs(study, "Repetition Roadmap", options={"planner": "roadmap"})),
    "guides": SideStudy("the mixture alone, stored ways of the hand alone, and what needs no experience", _guides),
    "oracle": SideStudy("samples around a path that answers the query itself", _oracle),
    peers.NAME: SideStudy(peers.PURPOSE, lambda study: []),
}


def side_studies(study: Study) -> dict[str, SideStudy]:
    """Those of a study, by name. Along a constraint none is of peers: OMPL's databases of experience know the plain space only."""
    return {name: side for name, side in _ALL.items() if name != peers.NAME or not study.description["is_constrained"]}


def find_side_study(study: Study, name: str) -> SideStudy:
    """Raises LookupError that names the side studies there are."""
    known = side_studies(study)
    if name not in known:
        raise LookupError(f"study '{study.name}' has no side study '{name}'; there are {', '.join(known)}")
    return known[name]
