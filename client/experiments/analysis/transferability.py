"""Which number, known before a robot has planned, says what the experience of another one is worth to it.

Measured gains of every pair of robots of the studies of a folder, beside candidates that a server knows from the transfer alone,
and the worth that `kinship robots compare` predicts by rehearsal.
"""
import dataclasses
import json
import pathlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import special, stats

from kinship_results.formats import checked

from . import markdown
from .study_folder import StudyFolder

PREDICTIONS = "transferability.json"  # of `kinship robots compare --task STUDY --json`
REHEARSAL = "rehearsal"
POOLED = "the others|pooled"  # guidance by the experience of all other robots together
LEAST_PAIRS = 3  # that a correlation is told of


@dataclasses.dataclass(frozen=True)
class Pair:
    """A source's experience and what it was worth to a target."""

    study: str
    target: str
    source: str
    gain: float  # mean checks, uniform to guided
    candidates: dict[str, float]  # by name; greater should mean more worth


def candidate_values(distribution: dict[str, Any], own: np.ndarray | None) -> dict[str, float]:
    """What the transfer of one source says of itself.

    own: configurations x joints of the target's own paths, or None. Scores are nats a joint above those of a uniform density
    between the joint limits.
    """
    source = distribution["sources"][0]
    limits = np.asarray(distribution["limits"])
    volume = np.log(limits[:, 1] - limits[:, 0]).sum()
    poses = max(source["poses"], 1)
    values = {
        "poses solved": source["poses_solved"] / poses,
        "configurations a pose": source["configurations"] / poses,
        "tracks kept": source["tracks_kept"] / source["tracks_tried"] if source["tracks_tried"] else 1.0,
        "free of collisions": 1 - source["colliding"] / poses,
    }
    if distribution["held_out_score"] is not None:
        values["held-out score"] = (distribution["held_out_score"] + volume) / len(limits)
    if own is not None:
        values["overlap with own paths"] = (mean_log_density(distribution, own) + volume) / len(limits)
    return values


def mean_log_density(distribution: dict[str, Any], points: np.ndarray) -> float:
    """Of a Gaussian mixture, in nats a point; points: points x joints. A point that no component knows counts as one of e^-50."""
    logs = np.stack([np.log(weight) + stats.multivariate_normal.logpdf(points, mean, covariance, allow_singular=True)
                     for weight, mean, covariance
                     in zip(distribution["weights"], distribution["means"], distribution["covariances"])])
    return float(np.maximum(special.logsumexp(logs, axis=0), -50).mean())


def own_configurations(folder: StudyFolder, robot: str, most: int = 2000) -> np.ndarray | None:
    """Waypoints of a robot's learning set, evenly thinned: waypoints x joints."""
    name = f"learning/{robot}.jsonl"
    if not folder.has(name):
        return None
    rows = [row for line in folder.lines(name, "attempt", "experience-robot") for row in (line.get("waypoints") or [])]
    return np.asarray(rows)[::max(1, len(rows) // most)] if rows else None


def pairs_of(folder: StudyFolder) -> list[Pair]:
    """Every pair of different robots of a study whose gain was measured and whose worth was predicted."""
    predictions = checked(json.loads((folder.folder / PREDICTIONS).read_text(encoding="utf-8")), "robot-comparison")["rows"]
    worths = {(row["target_label"], row["source_label"]): row["worth"] for row in predictions}
    cells = folder.cells("test.jsonl")
    own = {robot: own_configurations(folder, robot) for robot in folder.robots}
    pairs = []
    for distribution in folder.lines("distributions.jsonl", "distribution"):
        if len(distribution["selection"]["sources"]) != 1:
            continue
        target = folder.labels[distribution["robot"]]
        source = folder.labels[distribution["selection"]["sources"][0]]
        worth = worths.get((target, source))
        if target == source or worth is None or (target, source) not in cells:
            continue
        gain = cells[target, folder.study["uniform"]].checks.mean() / cells[target, source].checks.mean()
        pairs.append(Pair(folder.study["study"], target, source, float(gain),
                          candidate_values(distribution, own[target]) | {REHEARSAL: worth}))
    return pairs


def rank_correlation(pairs: Sequence[Pair], name: str) -> float:
    """Spearman's; NaN if there are too few pairs or all are the same."""
    gains = [pair.gain for pair in pairs]
    values = [pair.candidates.get(name, np.nan) for pair in pairs]
    if len(pairs) < LEAST_PAIRS or np.isnan(values).any() or len(set(gains)) == 1 or len(set(values)) == 1:
        return float("nan")
    return float(stats.spearmanr(values, gains).statistic)


def left_out(pairs: Sequence[Pair], names: Sequence[str]) -> list[tuple[str, str, float]]:
    """For each robot: the candidate that is best on the pairs without it, and how that one ranks the pairs with it."""
    rows = []
    for robot in sorted({pair.target for pair in pairs}):
        def has_robot(pair: Pair, robot: str = robot) -> bool:
            return robot in (pair.target, pair.source)
        without = [pair for pair in pairs if not has_robot(pair)]
        best = max(names, key=lambda name: np.nan_to_num(rank_correlation(without, name), nan=-1.0))
        rows.append((robot, best, rank_correlation([pair for pair in pairs if has_robot(pair)], best)))
    return rows


def number(value: float) -> str:
    return markdown.NOTHING if np.isnan(value) else f"{value:.2f}"


PooledGains = dict[tuple[str, str], float]  # by study and target


def pooled_gains(folder: StudyFolder) -> PooledGains:
    """What all other robots together were worth to each robot, where the study has that side study."""
    cells = folder.cells("pooled.jsonl") if folder.has("pooled.jsonl") else {}
    uniform = folder.study["uniform"]
    return {(folder.study["study"], robot): float(cells[robot, uniform].checks.mean() / cells[robot, POOLED].checks.mean())
            for robot in folder.robots if (robot, POOLED) in cells and (robot, uniform) in cells}


def choice_text(pairs: Sequence[Pair], pooled: PooledGains) -> str:
    """What a target gains by one way to choose sources, as a part of its best single source; means over the targets of a study."""
    rows = []
    for study in dict.fromkeys(pair.study for pair in pairs):
        of_study = [pair for pair in pairs if pair.study == study]
        parts: dict[str, list[float]] = {"chosen": [], "pooled": [], "mean": [], "worst": []}
        for target in dict.fromkeys(pair.target for pair in of_study):
            own = [pair for pair in of_study if pair.target == target]
            gains = np.array([pair.gain for pair in own])
            chosen = max(own, key=lambda pair: pair.candidates[REHEARSAL]).gain
            together = pooled.get((study, target), np.nan)
            for name, value in (("chosen", chosen), ("pooled", together), ("mean", gains.mean()), ("worst", gains.min())):
                parts[name].append(value / gains.max())
        rows.append([study] + [number(float(np.mean(values))) for values in parts.values()])
    return markdown.table(["Study", "chosen by rehearsal", "all others together", "one by chance", "the worst one"], rows)


def write_transferability(root: pathlib.Path, log: Callable[[str], None] = print) -> None:
    """transferability.md in a folder of studies. Raises ValueError if none of them has predictions."""
    studies = [StudyFolder(file.parent) for file in sorted(root.glob(f"*/{PREDICTIONS}"))]
    if not studies:
        raise ValueError(f"'{root}' has no study with {PREDICTIONS}: kinship robots compare --task STUDY --json makes it")
    pairs: list[Pair] = []
    pooled: PooledGains = {}
    for study in studies:
        pairs += pairs_of(study)
        pooled |= pooled_gains(study)
        log(f"{study.folder.name}: {len(pairs)} pairs so far")
    (root / "transferability.md").write_text(transferability_text(pairs, pooled), encoding="utf-8")


def transferability_text(pairs: Sequence[Pair], pooled: PooledGains) -> str:
    """The document: candidates by study, held-out robots, choices, and every pair."""
    names = list(dict.fromkeys(name for pair in pairs for name in pair.candidates))
    by_study = {study: [pair for pair in pairs if pair.study == study]
                for study in dict.fromkeys(pair.study for pair in pairs)}

    def correlation_row(name: str) -> list[str]:
        values = [rank_correlation(of_study, name) for of_study in [*by_study.values(), list(pairs)]]
        return [name] + [number(value) for value in values]

    text = ("# What a robot's experience is worth to another one, told before it plans\n\n"
            f"{len(pairs)} pairs of different robots. *Gain*: mean collision checks over the test set, uniform to guided. "
            "*Rehearsal*: the same ratio, predicted by the server, which plans the source's recorded queries again for the "
            "target (`kinship robots compare`). Written by analyse.py --transferability.\n\n"
            "## Rank correlation (Spearman) of candidates with the gain\n\n")
    text += markdown.table(["Candidate", *by_study, "all"], [correlation_row(name) for name in names])
    text += ("## One robot left out\n\nThe candidate that is best on all pairs without a robot, and its rank correlation on the "
             "pairs with it.\n\n")
    text += markdown.table(["Robot", "<candidate", "on its pairs"],
                           [[robot, best, number(value)] for robot, best, value in left_out(pairs, names)])
    text += "## Choosing a source\n\nWhat a target gains, as a part of what the best single source gives; means over targets.\n\n"
    text += choice_text(pairs, pooled)
    text += "## Every pair\n\n"
    text += markdown.table(["Study", "<target", "<source", "gain", "predicted"],
                           [[pair.study, pair.target, pair.source, f"{pair.gain:.2f}", f"{pair.candidates[REHEARSAL]:.2f}"]
                            for pair in pairs])
    return markdown.wrapped(text)
