"""The figures of a page that shows what a run did."""
import collections
import dataclasses
import statistics
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import comparison_table
from .comparison import Comparison, Result, document
from .statistics import mean_estimate


def page_figures(uniform: Sequence[Result], guided: Sequence[Result], compared: Comparison,
                 also: Sequence[tuple[str, Comparison]]) -> dict[str, Any]:
    """Members of the page's data. typical: the instance to show; None if none was solved by both."""
    guides = collections.Counter((result.get("guidance") or {}).get("guide", "none") for result in guided)
    figures: dict[str, Any] = {
        "comparison": document(compared), "table": {"rows": comparison_table.rows(compared), "notes": comparison_table.notes(compared)},
        "also": comparison_table.also_rows(also), "worth": comparison_table.worth_text(compared, also),
        "guides": [{"guide": guide, "queries": count} for guide, count in sorted(guides.items(), key=_bits)],
        "cheaper_guided": _count_cheaper(uniform, guided), "typical": find_typical(uniform, guided)}
    for name, results in (("uniform", uniform), ("guided", guided)):
        planned = [result for result in results if not result.get("not_planned")]
        for short, what in (("checks", "collision_checks"), ("time_s", "planning_time_s")):
            estimate = dataclasses.asdict(mean_estimate(np.array([[result[what]] for result in planned], dtype=float)))
            figures[f"{name}_{short}"] = {"mean": estimate["value"], "low": estimate["low"], "high": estimate["high"]}
    return figures


def _bits(guide_and_count: tuple[str, int]) -> int:
    """Of the guide, as the wire has them."""
    return sum({"retreat": 1, "ways": 2, "mixture": 4, "recall": 8}.get(part, 0) for part in guide_and_count[0].split("+"))


def _count_cheaper(uniform: Sequence[Result], guided: Sequence[Result]) -> int:
    """Instances that took fewer checks with guidance; one that is not solved took more than any."""
    def cost(result: Result) -> tuple[bool, int]:
        return not result["solved"], result["collision_checks"]

    others = {result["name"]: result for result in uniform}
    return sum(each["solved"] and each["name"] in others and cost(each) < cost(others[each["name"]]) for each in guided)


def find_typical(uniform: Sequence[Result], guided: Sequence[Result]) -> dict[str, Any] | None:
    """The instance whose ratio of checks, uniform / guided, is nearest the median of the ratios, the first of equals."""
    others = {result["name"]: result for result in guided}
    candidates = []
    for result in uniform:
        other = others.get(result["name"])
        if other and result.get("waypoints") and other.get("waypoints"):
            checks, guided_checks = result["collision_checks"], other["collision_checks"]
            candidates.append({"problem": result["name"], "uniform_checks": checks, "guided_checks": guided_checks,
                               "ratio": checks / max(1, guided_checks)})
    if not candidates:
        return None
    middle = statistics.median(each["ratio"] for each in candidates)
    nearest = min(candidates, key=lambda each: abs(each["ratio"] - middle))
    return nearest | {"median_ratio": middle, "candidates": len(candidates)}
