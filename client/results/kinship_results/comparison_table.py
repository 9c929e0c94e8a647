"""A comparison as an aligned table for people, with what its figures mean below."""
import math
from collections.abc import Callable, Sequence

from .comparison import Comparison, worths

Also = Sequence[tuple[str, Comparison]]  # what else was compared with uniform planning, by name
_HEAD = ("", "uniform", "guided", "ratio", "p")
_ALSO_HEAD = ("", "solved", "checks", "ratio", "time", "ratio", "length", "hand's", "clearance")
_FIRST_TOLD = 3  # of what was not planned


def count_text(value: float) -> str:
    """12345 as "12 345", a half as one more (the page does); what is infinite as "unsolved"."""
    return f"{math.floor(value + 0.5):,}".replace(",", " ") if math.isfinite(value) else "unsolved"


def duration_text(seconds: float) -> str:
    """Three digits in the unit that fits, as the other programs have it."""
    if not math.isfinite(seconds):
        return "unsolved"
    if seconds == 0:
        return "0 s"
    factor, unit = next(((factor, unit) for factor, unit in ((1, "s"), (1e-3, "ms")) if seconds >= 0.9995 * factor), (1e-6, "µs"))
    value = seconds / factor
    return f"{value:.{0 if value >= 99.95 else 1 if value >= 9.995 else 2}f} {unit}"


def ratio_text(ratio: float) -> str:
    """Uniform / guided; both unsolved says nothing."""
    return "-" if math.isnan(ratio) else f"{ratio:.2f}"


def length_text(value: float) -> str:
    """Of a path, joint units. What nobody measured is "-", here and below."""
    return "-" if math.isnan(value) else f"{value:.2f}"


def metres_text(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f} m"


def millimetres_text(value_m: float) -> str:
    return "-" if math.isnan(value_m) else f"{1000 * value_m:.1f} mm"


def p_text(p: float) -> str:
    return f"{p:.1e}" if p < 1e-3 else f"{p:.4f}"


def rows(comparison: Comparison) -> list[tuple[str, ...]]:
    """The lines below the head; what says nothing is empty."""
    uniform, guided = comparison.uniform, comparison.guided

    def row(name: str, what: str, text_of: Callable[[float], str], p: str = "") -> tuple[str, ...]:
        return name, text_of(getattr(uniform, what)), text_of(getattr(guided, what)), ratio_text(comparison.ratio(what)), p

    return [("solved", f"{uniform.solved}/{comparison.pairs}", f"{guided.solved}/{comparison.pairs}", "", ""),
            row("collision checks, mean", "mean_checks", count_text, p_text(comparison.checks_test.p)),
            row("collision checks, median", "median_checks", count_text),
            row("planning time, mean", "mean_time_s", duration_text, p_text(comparison.time_test.p)),
            row("planning time, median", "median_time_s", duration_text),
            row("path length, mean", "mean_length", length_text),
            row("path length, median", "median_length", length_text),
            row("hand's length, mean", "mean_hand_m", metres_text),
            row("hand's length, median", "median_hand_m", metres_text),
            row("least clearance, mean", "mean_clearance_m", millimetres_text),
            row("least clearance, median", "median_clearance_m", millimetres_text)]


def also_rows(also: Also) -> list[tuple[str, ...]]:
    """Means, and ratios of the first two."""
    return [(name, f"{each.guided.solved}/{each.pairs}", count_text(each.guided.mean_checks), ratio_text(each.ratio("mean_checks")),
             duration_text(each.guided.mean_time_s), ratio_text(each.ratio("mean_time_s")), length_text(each.guided.mean_length),
             metres_text(each.guided.mean_hand_m), millimetres_text(each.guided.mean_clearance_m)) for name, each in also]


def worth_text(comparison: Comparison, also: Also) -> str:
    """Empty unless something without experience, such as the retreat, was compared too."""
    told = worths(comparison, also)
    if told is None:
        return ""
    by_checks, by_time = (ratio_text(math.nan if value is None else value) for value in told.values())
    return f"Worth of experience, the best without it (uniform, the retreat) / the best with it: {by_checks} by checks, {by_time} by time."


def notes(comparison: Comparison, also: Also = ()) -> list[str]:
    """What the figures mean, and what is to be known of this run."""
    uniform, guided, pairs = comparison.uniform, comparison.guided, comparison.pairs
    guides_by_itself = guided.with_guidance > 0 and not comparison.uses_experience
    test = comparison.checks_test
    method = "exact" if test.method == "exact" else "normal approximation, corrected for ties and continuity"
    told = {
        f"ratio: uniform / guided. p: two-sided Wilcoxon signed-rank test, unsolved ranked worst ({method}, {test.pairs} pairs that "
        "differ).": True,
        "An unsolved attempt counts in a mean with what it had used when it gave up: that mean is a lower bound. In a median it is worse "
        "than all that are solved.": min(uniform.solved, guided.solved) < pairs,
        f"Lengths and clearance are of the {comparison.both_solved} problems that both solved.": comparison.both_solved < pairs,
        "Nothing that guided used experience: what was saved needs no fleet and no server.": guides_by_itself,
        "Part of the ratio may be the retreat's, which needs no experience: compare a run with kinship-plan --guide retreat, too.":
            comparison.retreats and comparison.uses_experience and all(each.uses_experience for _, each in also),
        f"Only {guided.with_guidance} of the {pairs} guided attempts had guided samples.": guided.with_guidance < pairs,
        f"{uniform.with_guidance} of the uniform attempts had guided samples.": uniform.with_guidance > 0,
        f"Of {comparison.proven_by_one} pairs of paths one is proven and the other is not (--resolution): they are not asked the same, in "
        "checks or in time.": comparison.proven_by_one > 0,
        f"{comparison.unpaired} problems were answered by one side only and left out.": comparison.unpaired > 0,
        f"{len(comparison.not_planned)} problems could not be planned and are left out ({comparison.reasons()}).":
            bool(comparison.not_planned)}
    return [note for note, is_so in told.items() if is_so]


def _first_not_planned(comparison: Comparison) -> list[str]:
    lines = []
    for result in comparison.not_planned[:_FIRST_TOLD]:
        name, reason = result["name"], result.get("reason", "")
        lines.append("  " + (reason if reason.startswith(f"{name}:") else f"{name}: {reason}"))
    more = len(comparison.not_planned) - len(lines)
    return lines + ([f"  and {more} more"] if more > 0 else [])


def table(comparison: Comparison, also: Also) -> str:
    def line(cells: Sequence[str], widths: Sequence[int]) -> str:
        return "  " + cells[0].ljust(widths[0]) + "".join(cell.rjust(width) for cell, width in zip(cells[1:], widths[1:]))

    def row(cells: Sequence[str]) -> str:
        return line(cells, (26, 11, 11, 9, 11)).rstrip()

    lines = [f"{comparison.pairs} problems, each planned with both", "", row(_HEAD), *map(row, rows(comparison)), "",
             *notes(comparison, also), *_first_not_planned(comparison)]
    if also:
        lines += ["", "The same problems, means and the ratio of uniform planning to each:", "",
                  *(line(cells, (20, 9, 9, 9, 11, 9, 9, 9, 11)) for cells in (_ALSO_HEAD, *also_rows(also)))]
        if said := worth_text(comparison, also):
            lines += ["", said]
    return "\n".join(lines) + "\n"
