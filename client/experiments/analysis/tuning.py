"""What guidance was worth on tuning instances, for who chooses options."""
import json

from .statistics import Comparison, compare, mean_of_comparisons
from .study_folder import StudyFolder

_WIDTHS = (-14, -14, 9, 9, 9, 7, 17, 7, 6, 8, 9)
_HEAD = ("robot", "experience", "uniform", "f = 1", "guided", "ratio", "95 %", "median", "time", "p", "solved")


def _line(cells: tuple[str, ...]) -> str:
    padded = [cell.ljust(-width) if width < 0 else cell.rjust(width) for cell, width in zip(cells, _WIDTHS)]
    return " ".join(padded).rstrip() + "\n"


def tuning_text(study: StudyFolder) -> str:
    """A line for each pair of the last tuning run, then the geometric means."""
    run = json.loads((study.folder / "tuning.json").read_text(encoding="utf-8"))
    cells = study.cells("tuning.jsonl")
    text = _line(_HEAD)
    groups: dict[str, list[Comparison]] = {"own": [], "transferred": []}
    for pair in run["pairs"]:
        robot = pair["robot"]
        comparison = compare(cells[robot, run["uniform"]], cells[robot, pair["guidance"]])
        ratio = comparison.checks
        text += _line((robot, pair["source"], f"{comparison.uniform.checks.mean():.0f}",
                       f"{cells[robot, 'uniform'].checks.mean():.0f}", f"{comparison.guided.checks.mean():.0f}",
                       f"{ratio.value:.2f}", f"[{ratio.low:.2f}, {ratio.high:.2f}]", f"{comparison.median_ratio:.2f}",
                       f"{comparison.time.value:.2f}", f"{comparison.p_checks:.1g}", comparison.guided.solved_text()))
        groups["own" if pair["source"] == robot else "transferred"].append(comparison)
    for name, comparisons in groups.items():
        if comparisons:
            least = min(each.checks.value for each in comparisons)
            text += (f"{name:<12} checks {mean_of_comparisons(comparisons, 'checks')}, least {least:.2f}, "
                     f"time {mean_of_comparisons(comparisons, 'cpu_s').value:.2f}, {len(comparisons)} pairs\n")
    return text
