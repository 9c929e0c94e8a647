"""RESULTS.md of a study and its figures; calibration and tuning as text, for the choice of constants and options."""
import json
from collections.abc import Sequence

from kinship_results.formats import checked

from . import markdown, tables
from .bars import write_bars
from .clouds import POSTURES, write_clouds
from .statistics import RESAMPLES, Comparison, compare, mean_of_comparisons
from .study_folder import Cells, StudyFolder

_NO_PEERS = ("OMPL's own experience planners, Lightning and Thunder, are not among the side studies: recalled paths "
             "are joined to start and goal by straight lines in joint space, which do not keep to the constraint.\n\n")

_TUNING_WIDTHS = (-14, -14, 9, 9, 9, 7, 17, 7, 6, 8, 9)
_TUNING_HEAD = ("robot", "experience", "uniform", "f = 1", "guided", "ratio", "95 %", "median", "time", "p", "solved")


def write_report(study: StudyFolder) -> None:
    """Writes RESULTS.md, checks.svg, time.svg and clouds.png into the folder of the study."""
    cells = study.cells("test.jsonl")
    distributions = list(study.lines("distributions.jsonl", "distribution"))
    write_bars(study, cells, lambda cell: cell.checks, "collision checks, mean", study.folder / "checks.svg")
    write_bars(study, cells, lambda cell: cell.cpu_s, "planning time, mean, s", study.folder / "time.svg")
    write_clouds(study, distributions, study.folder / "clouds.png")
    (study.folder / "RESULTS.md").write_text(results_text(study), encoding="utf-8")


def results_text(study: StudyFolder) -> str:
    """The whole of RESULTS.md."""
    cells = study.cells("test.jsonl")
    distributions = list(study.lines("distributions.jsonl", "distribution"))
    pairs = tables.compare_pairs(study, cells)
    text = (f"# Study {study.study['study']}: {study.study['purpose']}\n\n"
            "Made by `client/experiments/analyse.py` from the results in this folder; not to be edited. "
            "How to read it: [client/experiments](../../README.md).\n\n" + _protocol_text(study, cells) +
            tables.runs_table(study))
    text += "## What guidance was worth\n\n" + _how_measured(study)
    text += tables.summary_table(study, pairs)
    text += "![Mean collision checks by robot and guidance](checks.svg)\n\n"
    text += ("Pair by pair: checks (mean, median, 95 % quantile over queries), ratios uniform to guided, the share of "
             "queries that took more than twice the checks of the uniform query of the same instance and seed, and how "
             "many guided queries the gate sent to uniform planning (older rows do not say).\n\n")
    text += markdown.table(tables.PAIR_HEAD, tables.pair_rows(pairs)) + tables.significance_text(pairs)
    text += ("The paths of the queries that both solved: mean and median of their length in joint units, of the end effector's (the "
             "hand's) in m, and of their least clearance in mm (older rows have the first only).\n\n")
    text += markdown.table(tables.PATH_HEAD, tables.path_rows(pairs))
    text += "For each robot the other one whose experience helped least and most, and what the transfer left of it:\n\n"
    text += tables.loss_table(study, pairs, distributions)
    text += _side_studies_text(study, cells)
    text += "## Checks, time and paths\n\n![Mean planning time by robot and guidance](time.svg)\n\n"
    text += tables.paper_tables(study, cells)
    if study.has("calibration.jsonl"):
        text += "## Calibration\n\nUniform planning of the calibration instances beside the paper's mean checks.\n\n"
        text += tables.calibration_table(study, study.cells("calibration.jsonl"))
    text += "## Transfer and fit\n\nWhat the server made of the learning sets.\n\n"
    text += tables.distribution_table(study, distributions)
    text += (f"`clouds.png`, written beside this file, shows the transfer frame of samples and the arm in {POSTURES} of "
             "them, in the scene of the first test instance.\n")
    return markdown.wrapped(text)


def _protocol_text(study: StudyFolder, cells: Cells) -> str:
    values = study.study
    cell = next(iter(cells.values()))
    return (f"{values['learning_instances']} learning instances per robot, planned uniformly with overshoot 1, solved or "
            f"not, and reported to a kinshipd; {cell.checks.shape[0]} test instances, {cell.checks.shape[1]} queries each, "
            "planned uniformly and with the distributions that the server made of one robot's experience. Step "
            f"{values['resolution']:g}, overshoot {values['overshoot']:g}, guided samples {values['guided_share']:g} of "
            f"all; a query ends at its first path or at {values['max_checks']} checks, which an unsolved one counts.\n\n")


def _how_measured(study: StudyFolder) -> str:
    return ("Ratios are means of uniform planning by means of guided planning, geometric means over pairs; likewise of "
            "medians and of 95 % quantiles. *Tail held*: pairs whose 95 % quantile is not above uniform's. In brackets: "
            f"95 % percentile interval of the bootstrap, {RESAMPLES} resamples of the instances with a fixed seed. p: "
            "Wilcoxon's signed-rank test, two-sided, exact, over means of instances; of success McNemar's exact test over "
            "queries.\n\n")


def _side_studies_text(study: StudyFolder, cells: Cells) -> str:
    uniform = study.study["uniform"]
    there = [side for side in study.study["side_studies"] if study.has(side["name"] + ".jsonl")]
    text = ""
    if there:
        text += "## Side studies\n\nFurther cells over the same instances. "
        if all((robot, uniform) in study.cells(side["name"] + ".jsonl") for side in there for robot in study.robots):
            text += "Each has uniform planning of its own, in the same run.\n\n"
        else:
            text += ("Uniform planning is that of the test set, another run under another load: checks can be compared, "
                     "times hardly.\n\n")
    for side in there:
        variants = _variants(study, cells, study.cells(side["name"] + ".jsonl"))
        text += f"### {side['name']}: {side['purpose']}\n\n" + tables.variant_table(variants, study.robots)
        for variant, pairs in variants:
            text += f"<details><summary>{variant}, pair by pair</summary>\n\n"
            text += markdown.table(tables.PAIR_HEAD, tables.pair_rows(pairs)) + "</details>\n\n"
    return text + (_NO_PEERS if study.study["is_constrained"] else "")


def _variants(study: StudyFolder, cells: Cells, further: Cells) -> Sequence[tuple[str, list[Comparison]]]:
    """Each variant of a side study against its own uniform planning, in the order of the file.

    Where a log is older than that, or is of peers, against the uniform planning of the test set.
    """
    uniform = study.study["uniform"]
    variants: dict[str, list[Comparison]] = {}
    for robot in study.robots:
        for (known, guidance), cell in further.items():
            if known == robot and guidance != uniform:
                comparison = compare(further.get((robot, uniform), cells[robot, uniform]), cell)
                variants.setdefault(guidance.partition("|")[2], []).append(comparison)
    for pairs in variants.values():
        order = {source: place for place, source in enumerate(study.robots)}
        pairs.sort(key=lambda pair: (order[pair.guided.robot], order.get(tables.source_of(pair.guided), len(order))))
    return list(variants.items())


def calibration_text(study: StudyFolder) -> str:
    """Checks of calibration instances beside the paper's."""
    return tables.calibration_table(study, study.cells("calibration.jsonl"))


def _tuning_line(cells: tuple[str, ...]) -> str:
    padded = [cell.ljust(-width) if width < 0 else cell.rjust(width) for cell, width in zip(cells, _TUNING_WIDTHS)]
    return " ".join(padded).rstrip() + "\n"


def tuning_text(study: StudyFolder) -> str:
    """A line for each pair of the last tuning run, then the geometric means."""
    run = checked(json.loads((study.folder / "tuning.json").read_text(encoding="utf-8")), "study-tuning")
    cells = study.cells("tuning.jsonl")
    text = _tuning_line(_TUNING_HEAD)
    groups: dict[str, list[Comparison]] = {"own": [], "transferred": []}
    for pair in run["pairs"]:
        robot = pair["robot"]
        comparison = compare(cells[robot, run["uniform"]], cells[robot, pair["guidance"]])
        ratio = comparison.checks
        text += _tuning_line((robot, pair["source"], f"{comparison.uniform.checks.mean():.0f}",
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
