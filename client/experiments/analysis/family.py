"""What guidance was worth over the kinds of a family of studies."""
import pathlib
from collections.abc import Sequence

import numpy as np

from . import markdown, tables
from .statistics import Comparison, mean_of_ratios
from .study_folder import StudyFolder

LEAST_CHECKS = 1000  # of uniform planning in the mean: where it costs less there is nothing to save
_EXPERIENCE = ("own", "another robot's")
_HEAD = ["kind", "<experience", "pairs", "uniform", "ratio of means", "of medians", f"of {tables.TAIL_HEAD}",
         "of times", "least", "least tail", "gated"]


def find_kinds(folder: pathlib.Path, family: str) -> list[StudyFolder]:
    """The studies of a family below a folder, by name; those of quick runs and other learning sets are left out.

    Raises ValueError if there is none.
    """
    kinds = [StudyFolder(file.parent) for file in sorted(folder.glob("*/study.json"))]
    kinds = [kind for kind in kinds if kind.study.get("family") == family and kind.has("test.jsonl")
             and kind.folder.name == kind.study["study"]]
    if not kinds:
        raise ValueError(f"'{folder}' has no results of a study of the family '{family}'")
    return kinds


def family_text(kinds: Sequence[StudyFolder], family: str) -> str:
    """A row for each kind and whose experience it was, then the means over those that cost something."""
    rows = []
    counted: dict[str, list[Comparison]] = {experience: [] for experience in _EXPERIENCE}
    for kind in kinds:
        pairs = tables.compare_pairs(kind, kind.cells("test.jsonl"))
        for experience in _EXPERIENCE:
            chosen = [pair for pair in pairs if tables.kind_of(pair, kind.robots) == experience]
            if chosen:
                rows.append(_row(kind.study["study"].removeprefix(family + "_"), experience, chosen))
            counted[experience] += [pair for pair in chosen if pair.uniform.checks.mean() > LEAST_CHECKS]
    rows += [_row("all", experience, chosen) for experience, chosen in counted.items() if chosen]
    return markdown.wrapped(f"# Family {family}\n\nMade by `client/experiments/analyse.py`; not to be edited. Ratios are uniform to "
                            "guided, geometric means over pairs of robots; *uniform*: checks; *least*: the least ratio of means among them, *least tail* "
                            f"that of {tables.TAIL_HEAD} quantiles. *all*: over all kinds, those pairs whose uniform mean is above "
                            f"{LEAST_CHECKS} checks.\n\n" + markdown.table(_HEAD, rows))


def _row(kind: str, experience: str, pairs: Sequence[Comparison]) -> list[str]:
    uniform = np.exp(np.mean([np.log(pair.uniform.checks.mean()) for pair in pairs]))
    return [kind, experience, str(len(pairs)), f"{uniform:.0f}", f"{_mean(pairs, 'checks'):.2f}",
            *(f"{mean_of_ratios(pairs, name):.2f}" for name in ("median_ratio", "tail_ratio")),
            f"{_mean(pairs, 'time'):.2f}", f"{min(pair.checks.value for pair in pairs):.2f}", f"{min(pair.tail_ratio for pair in pairs):.2f}",
            tables.gated_text(pairs)]


def _mean(pairs: Sequence[Comparison], name: str) -> float:
    """Geometric mean; without interval, as instances of different kinds are not the same."""
    return float(np.exp(np.mean([np.log(getattr(pair, name).value) for pair in pairs])))


def write_family(folder: pathlib.Path, family: str) -> None:
    """Writes <family>.md into the folder that holds its studies."""
    text = family_text(find_kinds(folder, family), family)
    (folder / f"{family}.md").write_text(text, encoding="utf-8")
