"""Ratios of uniform to guided planning, their intervals and tests.

Instances are the sample; queries of one instance are not replicates of a test.
"""
from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinship_results.wilcoxon import wilcoxon

if TYPE_CHECKING:
    from .study_folder import Cell

RESAMPLES = 10_000
INTERVAL = (0.025, 0.975)  # of a 95 % interval
TAIL = 0.95  # quantile that stands for the tail


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.2f} [{self.low:.2f}, {self.high:.2f}]"


@dataclasses.dataclass(frozen=True)
class Comparison:
    """Guided against uniform planning of one robot over the same instances and seeds."""

    uniform: Cell
    guided: Cell
    checks: Estimate  # ratio of the means, uniform to guided
    time: Estimate  # of planning times, likewise
    median_ratio: float  # of the medians of checks over queries
    tail_ratio: float  # of the 95 % quantiles of checks over queries
    p_checks: float  # Wilcoxon's, over means of instances
    p_time: float
    p_solved: float  # McNemar's, over queries
    much_worse: float  # share of queries that took more than twice the checks of the uniform one


@functools.cache
def resample_counts(instances: int) -> np.ndarray:
    """How often each instance is in each resample: resamples x instances.

    The legacy generator is used because NumPy promises that its numbers stay the same: equal
    results, equal intervals, and every pair of a study is resampled alike.
    """
    generator = np.random.RandomState(1)
    return generator.multinomial(instances, [1 / instances] * instances, size=RESAMPLES).astype(float)


def interval_of(value: float, resampled: np.ndarray) -> Estimate:
    """Percentile interval of the bootstrap.

    Source: Efron and Tibshirani, An Introduction to the Bootstrap (1993), section 13.3.
    """
    low, high = np.quantile(resampled, INTERVAL)
    return Estimate(float(value), float(low), float(high))


def mean_estimate(values: np.ndarray) -> Estimate:
    """The mean of an instances x seeds table; instances are resampled."""
    means = values.mean(axis=1)
    return interval_of(means.mean(), resample_counts(len(means)) @ means / len(means))


def geometric_mean(pairs: Sequence[tuple[np.ndarray, np.ndarray]]) -> Estimate:
    """Geometric mean over pairs of the ratio of means, uniform to guided.

    Each of a pair is an instances x seeds table; instances are resampled, the same ones for every
    pair, as they are the same.
    """
    uniform = np.column_stack([first.sum(axis=1) for first, _ in pairs])  # instances x pairs
    guided = np.column_stack([second.sum(axis=1) for _, second in pairs])

    def over(counts: np.ndarray) -> np.ndarray:
        return np.exp(np.log((counts @ uniform) / (counts @ guided)).mean(axis=-1))

    return interval_of(over(np.ones(len(uniform))), over(resample_counts(len(uniform))))


def wilcoxon_p(first: np.ndarray, second: np.ndarray) -> float:
    """Two-sided p of the signed-rank test over means of instances; equal pairs are dropped."""
    return wilcoxon(first.mean(axis=1).tolist(), second.mean(axis=1).tolist()).p


def mcnemar_p(first_only: int, second_only: int) -> float:
    """Two-sided exact p of McNemar's test.

    Source: McNemar, Note on the sampling error of the difference between correlated proportions
    (1947); the exact form is a binomial test.
    """
    both = first_only + second_only
    smaller = sum(math.comb(both, count) for count in range(min(first_only, second_only) + 1))
    return min(1.0, 2 * smaller / 2**both)


def holm(p_values: Sequence[float]) -> np.ndarray:
    """p-values adjusted for their number.

    Source: Holm, A simple sequentially rejective multiple test procedure (1979).
    """
    values = np.asarray(p_values)
    order = np.argsort(values)
    adjusted = np.empty(len(values))
    adjusted[order] = np.maximum.accumulate(values[order] * np.arange(len(values), 0, -1))
    return np.minimum(adjusted, 1)


def compare(uniform: Cell, guided: Cell) -> Comparison:
    """Raises ValueError if the two have different instances or seeds."""
    if uniform.instances != guided.instances or uniform.checks.shape != guided.checks.shape:
        raise ValueError(f"{guided.robot} guided by '{guided.guidance}' and '{uniform.guidance}' "
                         "have different queries")
    return Comparison(
        uniform, guided,
        checks=geometric_mean([(uniform.checks, guided.checks)]),
        time=geometric_mean([(uniform.cpu_s, guided.cpu_s)]),
        median_ratio=float(np.median(uniform.checks) / np.median(guided.checks)),
        tail_ratio=float(np.quantile(uniform.checks, TAIL) / np.quantile(guided.checks, TAIL)),
        p_checks=wilcoxon_p(uniform.checks, guided.checks),
        p_time=wilcoxon_p(uniform.cpu_s, guided.cpu_s),
        p_solved=mcnemar_p(int((guided.solved & ~uniform.solved).sum()),
                           int((uniform.solved & ~guided.solved).sum())),
        much_worse=float((guided.checks > 2 * uniform.checks).mean()))


def mean_of_ratios(comparisons: Sequence[Comparison], name: str) -> float:
    """Geometric mean of a ratio that has no interval: "median_ratio" or "tail_ratio"."""
    return float(np.exp(np.log([getattr(each, name) for each in comparisons]).mean()))


def mean_of_comparisons(comparisons: Sequence[Comparison], quantity: str) -> Estimate:
    """Geometric mean of the ratios of a quantity: "checks" or "cpu_s"."""
    return geometric_mean([(getattr(each.uniform, quantity), getattr(each.guided, quantity))
                           for each in comparisons])
