"""The figures of a page that shows what a run did."""
import collections
import random
import statistics
from collections.abc import Sequence
from typing import Any

from . import comparison_table
from .comparison import Comparison, Result, document

_RESAMPLES = 10_000  # fewer of many instances: at most _MAX_DRAWS
_MAX_DRAWS = 2_000_000


def page_figures(uniform: Sequence[Result], guided: Sequence[Result], compared: Comparison,
                 also: Sequence[tuple[str, Comparison]]) -> dict[str, Any]:
    """Members of the page's data. typical: the instance to show; None if none was solved by both."""
    guides = collections.Counter((result.get("guidance") or {}).get("guide", "none") for result in guided)
    figures: dict[str, Any] = {
        "comparison": document(compared, also),
        "table": {"rows": comparison_table.rows(compared), "notes": comparison_table.notes(compared, also)},
        "uses_experience": compared.uses_experience,
        "also": comparison_table.also_rows(also), "worth": comparison_table.worth_text(compared, also),
        "guides": [{"guide": guide, "queries": count} for guide, count in sorted(guides.items(), key=_bits)],
        "cheaper_guided": _count_cheaper(uniform, guided), "typical": find_typical(uniform, guided)}
    for name, results in (("uniform", uniform), ("guided", guided)):
        planned = [result for result in results if not result.get("not_planned")]
        for short, what in (("checks", "collision_checks"), ("time_s", "planning_time_s")):
            figures[f"{name}_{short}"] = _mean_and_interval([result[what] for result in planned])
    return figures


def _mean_and_interval(values: Sequence[float]) -> dict[str, float]:
    """The mean and the 95 % percentile interval of the bootstrap over instances.

    Source: Efron and Tibshirani, An Introduction to the Bootstrap (1993), section 13.3.
    """
    generator, count = random.Random(1), len(values)
    means = [statistics.fmean(generator.choices(values, k=count)) for _ in range(max(400, min(_RESAMPLES, _MAX_DRAWS // count)))]
    quantiles = statistics.quantiles(means, n=40, method="inclusive")
    return {"mean": statistics.fmean(values), "low": quantiles[0], "high": quantiles[-1]}


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
