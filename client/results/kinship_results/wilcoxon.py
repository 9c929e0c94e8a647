"""Wilcoxon's signed-rank test, exact also where ranks are shared."""
import dataclasses
import math
from collections.abc import Sequence

MAX_EXACT_PAIRS = 200


@dataclasses.dataclass(frozen=True)
class Wilcoxon:
    """pairs: that differ; dropped: without a difference; rank_sum_plus: of the pairs whose first value is the greater one."""

    p: float = 1.0  # two-sided; 1 if no pair differs
    pairs: int = 0
    dropped: int = 0
    rank_sum_plus: float = 0.0
    rank_sum_minus: float = 0.0
    method: str = "exact"  # or normal_approximation


def wilcoxon(first: Sequence[float], second: Sequence[float]) -> Wilcoxon:
    """Two-sided test for pairs (first[i], second[i]); equal differences share the mean of their ranks.

    An infinite value is worse than any finite one: such differences are the largest and equal to each other; infinite against
    infinite is no difference. Up to MAX_EXACT_PAIRS p is exact under the permutation of signs; beyond, the normal approximation with
    corrections for ties and continuity. Raises ValueError if the lengths differ or a value is NaN.
    Source: Hollander, Wolfe, Chicken, Nonparametric Statistical Methods (2014), section 3.1.
    """
    if any(math.isnan(value) for value in (*first, *second)):
        raise ValueError("wilcoxon: a value is not a number")
    differences = [a - b for a, b in zip(first, second, strict=True) if a != b]  # inf - inf cannot occur
    ranks = _doubled_ranks([abs(difference) for difference in differences])
    plus = sum(rank for rank, difference in zip(ranks, differences) if difference > 0)
    minus = sum(ranks) - plus
    smaller, is_exact = min(plus, minus), len(ranks) <= MAX_EXACT_PAIRS
    p = 2 * _probability_up_to(ranks, smaller) if is_exact else _approximate_p(ranks, smaller)
    return Wilcoxon(min(1.0, p) if ranks else 1.0, len(ranks), len(first) - len(ranks), plus / 2, minus / 2,
                    "exact" if is_exact else "normal_approximation")


def _doubled_ranks(magnitudes: Sequence[float]) -> list[int]:
    """Twice the rank of each, 1 for the smallest: whole numbers."""
    places: dict[float, list[int]] = {}
    for place, magnitude in enumerate(sorted(magnitudes), 1):
        places.setdefault(magnitude, []).append(place)
    return [places[magnitude][0] + places[magnitude][-1] for magnitude in magnitudes]


def _probability_up_to(ranks: Sequence[int], bound: int) -> float:
    """P(doubled rank sum <= bound) when every sign is a fair coin.

    Digit s of `ways`, of so many bits that none overflows, counts the choices of ranks whose sum is s.
    """
    bits = len(ranks) + 1
    ways = 1
    for rank in ranks:
        ways += ways << rank * bits
    chosen = ways & ((1 << (bound + 1) * bits) - 1)
    return chosen % ((1 << bits) - 1) / 2 ** len(ranks)  # the sum of its digits


def _approximate_p(ranks: Sequence[int], smaller: int) -> float:
    """The variance is the sum of squared ranks over 4, which holds the correction for ties: n (n + 1) (2 n + 1) / 24 - sum(t^3 - t) / 48."""
    distance = max(0.0, sum(ranks) / 4 - smaller / 2 - 0.5)  # 0.5: of continuity
    return math.erfc(distance / math.sqrt(sum(rank * rank for rank in ranks) / 16) / math.sqrt(2))
