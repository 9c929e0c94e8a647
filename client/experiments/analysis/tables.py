"""The tables of a report."""
import datetime
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from . import markdown, paper
from .markdown import NOTHING, p_text, percent
from .statistics import TAIL, Comparison, compare, holm, mean_of_comparisons, mean_of_ratios
from .study_folder import Cell, Cells, StudyFolder

TAIL_HEAD = f"{100 * TAIL:.0f} %"
TAIL_LIMIT = 1  # a pair whose tail ratio is below has a longer tail than uniform planning


def source_of(cell: Cell) -> str:
    """Whose experience guided a cell; of a side study's cell, named "<source>|<variant>", as well."""
    return cell.guidance.partition("|")[0]


def kind_of(comparison: Comparison, robots: Sequence[str]) -> str:
    """Own experience, another robot's, or what else the cell is named after."""
    source = source_of(comparison.guided)
    if source == comparison.guided.robot:
        return "own"
    return "another robot's" if source in robots else source


def gated_text(pairs: Iterable[Comparison]) -> str:
    """How many guided queries the gate sent to uniform planning; nothing where rows do not say."""
    gated = [pair.guided.gated for pair in pairs]
    if any(each is None or np.isnan(each).any() for each in gated):
        return NOTHING
    return f"{int(sum(each.sum() for each in gated))}/{sum(each.size for each in gated)}"


def compare_pairs(study: StudyFolder, cells: Cells) -> list[Comparison]:
    """Every robot guided by every robot's experience against its uniform planning."""
    uniform = study.study["uniform"]
    return [compare(cells[robot, uniform], cells[robot, source])
            for robot in study.robots for source in study.robots
            if (robot, uniform) in cells and (robot, source) in cells]


def runs_table(study: StudyFolder) -> str:
    rows = []
    for run in study.lines("runs.jsonl", "study-run"):
        begun = run.get("begun_s")
        time = datetime.datetime.fromtimestamp(begun, datetime.timezone.utc) if begun else None
        rows.append([run.get("side") or "test set", run["commit"], f"{time:%Y-%m-%d %H:%M}" if time else NOTHING,
                     *(f"{run[key]:.0f}" if key in run else NOTHING for key in ("planned", "duration_s")),
                     run.get("machine", NOTHING)])
    return markdown.table(["what", "<commit", "<begun, UTC", "queries", "s", "<machine"], rows)


def calibration_table(study: StudyFolder, cells: Cells) -> str:
    """Uniform planning of the calibration instances, beside the paper's where the paper has the study."""
    rows, ours, theirs = [], [], []
    for robot in study.robots:
        cell = cells.get((robot, "uniform"))
        if cell is None:
            continue
        known = paper.paper_cell(study.study["study"], robot, "uniform")
        wanted = known["checks"] if known else None
        mean = cell.checks.mean()
        rows.append([robot, f"{mean:.0f}", f"{cell.checks.std(ddof=1) if cell.checks.size > 1 else 0:.0f}",
                     f"{np.median(cell.checks):.0f}", f"{np.quantile(cell.checks, TAIL):.0f}",
                     f"{wanted:.0f}" if wanted else NOTHING, f"{mean / wanted:.2f}" if wanted else NOTHING,
                     cell.solved_text()])
        if wanted:
            ours.append(mean)
            theirs.append(wanted)
    if ours:
        rows.append(["mean over the robots", f"{np.mean(ours):.0f}", "", "", "", f"{np.mean(theirs):.0f}",
                     f"{sum(ours) / sum(theirs):.2f}", ""])
    return markdown.table(["robot", "mean checks", "deviation", "median", TAIL_HEAD, "the paper's", "of it", "solved"],
                          rows)


def summary_table(study: StudyFolder, pairs: Sequence[Comparison]) -> str:
    """Geometric means of the ratios over own and over transferred experience, with the paper's."""
    rows = []
    for name, own in (("own", True), ("another robot's", False), ("all", None)):
        chosen = [pair for pair in pairs if own in (None, kind_of(pair, study.robots) == "own")]
        if not chosen:
            continue
        least = min(chosen, key=lambda pair: pair.checks.value)
        rows.append([name, str(len(chosen)),
                     str(mean_of_comparisons(chosen, "checks")), _paper_mean(study, "checks", own),
                     *_tail_cells(chosen),
                     f"{least.checks.value:.2f} ({least.guided.robot} from {source_of(least.guided)})",
                     str(mean_of_comparisons(chosen, "cpu_s")), _paper_mean(study, "time_s", own)])
    return markdown.table(["experience", "pairs", "checks", "the paper's", *_TAIL_COLUMNS, "least", "time",
                           "the paper's"], rows)


_TAIL_COLUMNS = ["of medians", f"of {TAIL_HEAD}", "tail held"]


def _tail_cells(pairs: Sequence[Comparison]) -> list[str]:
    """Geometric means of the ratios of medians and of tails, and the pairs whose tail is not above uniform's."""
    held = sum(pair.tail_ratio >= TAIL_LIMIT for pair in pairs)
    return [f"{mean_of_ratios(pairs, name):.2f}" for name in ("median_ratio", "tail_ratio")] + [f"{held}/{len(pairs)}"]


def _paper_mean(study: StudyFolder, column: str, own: bool | None) -> str:
    ratios = paper.paper_ratios(study.study["study"], column, own)
    return f"{math.exp(np.log(ratios).mean()):.2f}" if ratios else NOTHING


PAIR_HEAD = ["robot", "<experience of",
             "uniform mean", "uniform median", f"uniform {TAIL_HEAD}", "guided mean", "guided median", f"guided {TAIL_HEAD}",
             "ratio of means", "of medians", f"of {TAIL_HEAD}", "of times", "> 2 x", "gated", "p, checks",
             "p, time", "solved uniform", "solved guided", "p, solved"]


def pair_rows(pairs: Iterable[Comparison]) -> list[list[str]]:
    """The columns of PAIR_HEAD: checks, ratios, tests, success."""
    rows = []
    for pair in pairs:
        source = source_of(pair.guided)
        moments = [f"{value:.0f}" for cell in (pair.uniform, pair.guided)
                   for value in (cell.checks.mean(), np.median(cell.checks), np.quantile(cell.checks, TAIL))]
        rows.append([pair.guided.robot, source + (" (own)" if source == pair.guided.robot else ""), *moments,
                     str(pair.checks), f"{pair.median_ratio:.2f}", f"{pair.tail_ratio:.2f}",
                     f"{pair.time.value:.2f}", f"{100 * pair.much_worse:.1f} %", gated_text([pair]),
                     p_text(pair.p_checks), p_text(pair.p_time), pair.uniform.solved_text(), pair.guided.solved_text(),
                     p_text(pair.p_solved)])
    return rows


PATH_HEAD = ["robot", "<experience of", "paths", "length, uniform", "length, guided", "hand's, uniform", "hand's, guided",
             "clearance, uniform", "clearance, guided"]


def path_rows(pairs: Iterable[Comparison]) -> list[list[str]]:
    """The columns of PATH_HEAD: mean and median over the queries that both solved, of what both rows tell."""
    rows = []
    for pair in pairs:
        both = pair.uniform.solved & pair.guided.solved
        row = [pair.guided.robot, source_of(pair.guided), str(int(both.sum()))]
        for name, scale, digits in (("lengths", 1, 2), ("hand_lengths", 1, 2), ("clearances", 1000, 1)):
            sides = [getattr(cell, name) for cell in (pair.uniform, pair.guided)]
            told = None if any(side is None for side in sides) else both & ~np.isnan(sides[0]) & ~np.isnan(sides[1])
            row += [f"{scale * side[told].mean():.{digits}f}, {scale * np.median(side[told]):.{digits}f}"
                    if told is not None and told.any() else NOTHING for side in sides]
        rows.append(row)
    return rows


def significance_text(pairs: Sequence[Comparison]) -> str:
    """How many of the differences hold when their number is considered."""
    def holding(name: str) -> int:
        return int((holm([getattr(pair, name) for pair in pairs]) < 0.05).sum())

    return (f"After Holm's correction for {len(pairs)} comparisons p < 0.05 for the checks of {holding('p_checks')} "
            f"pairs and the times of {holding('p_time')}.\n\n")


def variant_table(variants: Sequence[tuple[str, Sequence[Comparison]]], robots: Sequence[str]) -> str:
    """Geometric means of each variant of a side study, by whose experience it was."""
    rows = []
    for name, pairs in variants:
        for kind in dict.fromkeys(kind_of(pair, robots) for pair in pairs):
            chosen = [pair for pair in pairs if kind_of(pair, robots) == kind]
            rows.append([name, kind, str(len(chosen)), str(mean_of_comparisons(chosen, "checks")),
                         *_tail_cells(chosen), str(mean_of_comparisons(chosen, "cpu_s"))])
    return markdown.table(["variant", "<experience", "pairs", "checks", *_TAIL_COLUMNS, "time"], rows)


def _sources(study: StudyFolder, distributions: Iterable[dict[str, Any]]) -> dict[tuple[str, str], dict[str, Any]]:
    """What a transfer left of each source, by target and source; of distributions of one source."""
    return {(study.labels.get(each["robot"], ""), each["sources"][0]["label"]): each["sources"][0]
            for each in distributions if len(each["sources"]) == 1}


def loss_table(study: StudyFolder, pairs: Sequence[Comparison], distributions: Sequence[dict[str, Any]]) -> str:
    """For each robot the other one whose experience helped least, and most, and what was left of it."""
    sources = _sources(study, distributions)
    rows = []
    for robot in study.robots:
        others = [pair for pair in pairs if pair.guided.robot == robot and kind_of(pair, study.robots) != "own"]
        ordered = sorted(others, key=lambda pair: pair.checks.value)
        for what, pair in zip(("least", "most"), ordered[:1] + ordered[-1:]):
            source = sources.get((robot, pair.guided.guidance))
            remains = [] if source is None else [
                percent(source["poses_solved"], source["poses"]),
                f"{source['tracks_kept'] / max(source['paths_used'], 1):.2f}",
                percent(source["random_configurations"], source["configurations"]),
                percent(source["self_collisions"] + source["scene_collisions"], source["filter_checks"])]
            rows.append([robot, f"{pair.guided.guidance} ({what})", f"{pair.checks.value:.2f}",
                         f"{pair.median_ratio:.2f}", *(remains or [NOTHING] * 4)])
    return markdown.table(["robot", "<experience of", "ratio", "of medians", "poses solved", "tracks kept a path",
                           "at random", "filtered"], rows)


def distribution_table(study: StudyFolder, distributions: Iterable[dict[str, Any]]) -> str:
    """What the server made of each source for each target, and how long it took."""
    rows = []
    for each in distributions:
        for source in each["sources"]:
            rows.append([study.labels.get(each["robot"], each["robot"][:8]), source["label"],
                         *(str(source[key]) for key in ("paths_used", "poses", "poses_solved", "tracks_kept",
                                                        "random_configurations")),
                         str(source["self_collisions"] + source["scene_collisions"]), str(source["configurations"]),
                         str(len(each["weights"])) if each.get("weights") else NOTHING,
                         f"{each['transfer_time_s']:.2f}", f"{each['fit_time_s']:.2f}", each["state"]])
    return markdown.table(["for", "<experience of", "paths", "poses", "poses solved", "tracks kept", "at random",
                           "filtered", "configurations", "components", "transfer, s", "fit, s", "<state"], rows)


# Of each quantity of the paper's tables: what it is, how ours is had, the paper's column, digits.
PAPER_QUANTITIES = (
    ("Collision checks to the first path", lambda cell: cell.checks, "checks", ".0f"),
    ("Planning time, s of one thread", lambda cell: cell.cpu_s, "time", ".3g"),
    ("Path length, degrees in joint space", lambda cell: np.degrees(cell.lengths[cell.solved]), "length", ".0f"),
)
_UNITS = {"checks": "", "time": "_s", "length": "_deg"}


def paper_tables(study: StudyFolder, cells: Cells) -> str:
    """Like the paper's tables 1 and 2: a row per guidance, a column per robot."""
    text = ""
    for caption, ours, column, digits in PAPER_QUANTITIES:
        rows = []
        for guidance in [study.study["uniform"], *study.robots]:
            row = [guidance]
            for robot in study.robots:
                cell = cells.get((robot, guidance))
                row.append((NOTHING if cell is None else _moments(ours(cell), digits)) +
                           _paper_text(paper.paper_cell(study.study["study"], robot, guidance), column, digits))
            rows.append(row)
        text += f"{caption}: mean ± deviation, median; in brackets the paper's.\n\n"
        text += markdown.table(["guidance", *study.robots], rows)
    return text


def _moments(values: np.ndarray, digits: str) -> str:
    if values.size == 0:
        return NOTHING
    deviation = values.std(ddof=1) if values.size > 1 else 0.0
    return f"{values.mean():{digits}} ± {deviation:{digits}}, {np.median(values):{digits}}"


def _paper_text(cell: paper.PaperCell | None, column: str, digits: str) -> str:
    if cell is None:
        return ""
    unit = _UNITS[column]
    return f" ({cell[column + unit]:{digits}} ± {cell[column + '_deviation' + unit]:{digits}})"
