"""Uniform against guided planning over the same problems: two result files of kinship-plan, paired by name."""
import collections
import dataclasses
import json
import math
import os
import statistics
import sys
from collections.abc import Sequence
from typing import Any

from .formats import checked, in_format
from .wilcoxon import Wilcoxon, wilcoxon

Result = dict[str, Any]  # a line of a result file
MEASURES = {"length": "path_length", "hand_m": "hand_length_m", "clearance_m": "least_clearance_m"}  # of a path, and as lines name them
_NEEDED = {"name": str, "solved": bool, "collision_checks": int, "planning_time_s": (int, float)}


def read_results(file: str) -> list[Result]:
    """Raises FileNotFoundError, or ValueError with the number of a line that is no result."""
    results = []
    with open(file, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            try:
                result = checked(json.loads(line), "result")
                for name, kind in _NEEDED.items():
                    if not isinstance(result, dict) or name not in result:
                        raise ValueError(f"{name}: is missing")
                    if not isinstance(result[name], kind):
                        raise ValueError(f"{name}: {json.dumps(result[name])} is of another kind")
            except ValueError as error:
                raise ValueError(f"{file} line {number}: {error}") from error
            results.append(result)
    return results


@dataclasses.dataclass(frozen=True)
class Figures:
    """What one planner did on the problems that both answered.

    Means count an unsolved attempt with what it had used when it gave up (a lower bound); medians count it as worse than any solved
    one, so a median is infinite if half are unsolved. Measures of paths are over the problems that both solved, NaN if none tells.
    """

    solved: int
    with_guidance: int  # attempts with guided samples
    mean_checks: float
    median_checks: float
    mean_time_s: float
    median_time_s: float
    mean_length: float  # joint units
    median_length: float
    mean_hand_m: float  # the hand's way
    median_hand_m: float
    mean_clearance_m: float  # the least on a path
    median_clearance_m: float


class Comparison:
    """A problem that a side began no search for is no pair. Raises ValueError if a name is there twice, or there is no pair."""

    def __init__(self, uniform: Sequence[Result], guided: Sequence[Result]) -> None:
        ours, theirs = _by_name(uniform, "uniform"), _by_name(guided, "guided")
        both = [(ours[name], theirs[name]) for name in sorted(ours.keys() & theirs.keys())]
        self.unpaired = len(ours.keys() ^ theirs.keys())
        self.not_planned = [first if first.get("not_planned") else second for first, second in both
                            if first.get("not_planned") or second.get("not_planned")]
        planned = [pair for pair in both if not any(each.get("not_planned") for each in pair)]
        self.pairs = len(planned)
        if not planned:
            raise ValueError(f"no problem could be planned ({self.reasons()})" if both else "no problem was answered by both sides")
        # Pairs of paths of which one is proven, the other is not.
        self.proven_by_one = sum(first["solved"] and second["solved"] and first.get("proven", False) != second.get("proven", False)
                                 for first, second in planned)
        sides = [[pair[side] for pair in planned] for side in (0, 1)]
        solved = [pair for pair in planned if all(each["solved"] for each in pair)]
        self.both_solved = len(solved)
        self.uniform, self.guided = (_figures(results, _measured(solved, side)) for side, results in enumerate(sides))
        self.uses_experience = any(map(_uses_experience, sides[1]))
        self.retreats = any("retreat" in _guides(result) for result in sides[1])
        self.checks_test, self.time_test = (wilcoxon(*(_ranked(side, what) for side in sides))
                                            for what in ("collision_checks", "planning_time_s"))

    def counts(self) -> dict[str, int]:
        """Of what was not planned, by reason."""
        return dict(collections.Counter(each["not_planned"] for each in self.not_planned))

    def reasons(self) -> str:
        """The most frequent one first."""
        ordered = sorted(self.counts().items(), key=lambda each: -each[1])
        return ", ".join(f"{reason.replace('_', ' ')}: {count}" for reason, count in ordered)

    def ratio(self, what: str) -> float:
        """Uniform / guided of a figure; NaN if both are infinite."""
        first, second = getattr(self.uniform, what), getattr(self.guided, what)
        if second == 0:
            return math.nan if first == 0 else math.inf
        return first / second

    def ratios(self) -> dict[str, float]:
        return {name: self.ratio(what) for name, what in (("mean_checks", "mean_checks"), ("median_checks", "median_checks"),
                                                          ("mean_time", "mean_time_s"), ("median_time", "median_time_s"))}


def _by_name(results: Sequence[Result], side: str) -> dict[str, Result]:
    named: dict[str, Result] = {}
    for result in results:
        if result["name"] in named:
            raise ValueError(f"{side} results: '{result['name']}' occurs more than once")
        named[result["name"]] = result
    return named


def _ranked(results: Sequence[Result], what: str) -> list[float]:
    """Unsolved is worst."""
    return [result[what] if result["solved"] else math.inf for result in results]


def _draws(result: Result) -> bool:
    guidance = result.get("guidance") or {}
    return guidance.get("share", 0) > 0 or result.get("found_by") == "recalled"


def _guides(result: Result) -> list[str]:
    """What guided it; of an older result with guidance, the mixture."""
    guidance = result.get("guidance") or {}
    return (guidance.get("guide") or ("mixture" if guidance.get("distribution_id") else "none")).split("+")


def _uses_experience(result: Result) -> bool:
    return any(part not in ("none", "retreat") for part in _guides(result))


def _measured(pairs: Sequence[tuple[Result, Result]], side: int) -> dict[str, float]:
    """Means and medians of one side's paths, of the pairs of which both tell."""
    figures = {}
    for name, what in MEASURES.items():
        values = [pair[side][what] for pair in pairs if all(each.get(what) is not None for each in pair)]
        figures[f"mean_{name}"], figures[f"median_{name}"] = ((statistics.fmean(values), statistics.median(values)) if values
                                                              else (math.nan, math.nan))
    return figures


def _figures(results: Sequence[Result], measured: dict[str, float]) -> Figures:
    def mean(what: str) -> float:
        return sum(result[what] for result in results) / len(results)

    return Figures(sum(result["solved"] for result in results), sum(map(_draws, results)), mean("collision_checks"),
                   statistics.median(_ranked(results, "collision_checks")), mean("planning_time_s"),
                   statistics.median(_ranked(results, "planning_time_s")), **measured)


def worth(comparison: Comparison, also: Sequence[tuple[str, Comparison]], what: str) -> float:
    """Of experience: a figure of the best without it (uniform, retreat alone) / that of the best with it; NaN if none was planned with it."""
    each = [comparison] + [other for _, other in also]
    without = [comparison.uniform] + [one.guided for one in each if not one.uses_experience]
    used = [getattr(one.guided, what) for one in each if one.uses_experience]
    return min(getattr(one, what) for one in without) / min(used) if used and min(used) > 0 else math.nan


def worths(comparison: Comparison, also: Sequence[tuple[str, Comparison]]) -> dict[str, float] | None:
    """By checks and by time, if something without experience was compared besides uniform planning."""
    if all(each.uses_experience for _, each in also):
        return None
    return _finite({"by_checks": worth(comparison, also, "mean_checks"), "by_time": worth(comparison, also, "mean_time_s")})


def document(comparison: Comparison, also: Sequence[tuple[str, Comparison]] = ()) -> dict[str, Any]:
    """For programs; infinite and undefined numbers are None. also: named comparisons of uniform planning with something else."""
    told: dict[str, Any] = _pair(comparison) | {
        "wilcoxon_checks": _test(comparison.checks_test), "wilcoxon_time": _test(comparison.time_test), "unpaired": comparison.unpaired,
        "not_planned": comparison.counts(), "worth": worths(comparison, also)}
    return in_format("comparison", told) | ({"also": [{"name": name} | _pair(each) for name, each in also]} if also else {})


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in values.items()}


def _pair(comparison: Comparison) -> dict[str, Any]:
    return {"pairs": comparison.pairs, "uniform": _finite(dataclasses.asdict(comparison.uniform)),
            "guided": _finite(dataclasses.asdict(comparison.guided)), "ratio": _finite(comparison.ratios())}


def _test(test: Wilcoxon) -> dict[str, Any]:
    return dataclasses.asdict(test)


def parse_named(text: str) -> tuple[str, str]:
    """Name and file of "NAME=FILE", or of a file that has its name by the beginning of its own. Raises ValueError if one is empty."""
    name, has_name, file = text.partition("=")
    if not has_name:
        return os.path.basename(text).partition(".")[0] or text, text
    if not name or not file:
        raise ValueError(f"'{text}' is not NAME=FILE")
    return name, file


def named(file: str, uniform: Sequence[Result], guided: Sequence[Result]) -> Comparison:
    """A comparison; errors begin with the file."""
    try:
        return Comparison(uniform, guided)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error


def compare_also(uniform: Sequence[Result], beside: Sequence[tuple[str, str]]) -> list[tuple[str, Comparison]]:
    """Other results over the same problems, each compared with uniform planning. beside: names and files."""
    return [(name, named(file, uniform, read_results(file))) for name, file in beside]


def fail(message: str, code: int) -> int:
    """Tells people why the program fails. Returns the code."""
    print(message, file=sys.stderr)
    return code
