"""What orders took beside uniform planning: a table for people, figures for deploy/bench."""
from __future__ import annotations

import collections
import dataclasses
import itertools
import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .markdown import NOTHING, table

FIRST = 10  # queries that have next to nothing to go by
MAX_TOTAL, MAX_FIRST = 0.5, 1.1  # guided / uniform
WORST, MAX_WORST = 1.25, 10  # a query may take so many times what it takes uniformly, and so many means more
TAIL = 0.95  # quantile

_WAYS = ("guided", "uniform")


@dataclasses.dataclass(frozen=True)
class Order:
    """The rows of order.jsonl of one order, in their order."""

    rows: Sequence[dict[str, Any]]

    @property
    def name(self) -> str:
        return "{study}, {robot}, seed {seed}".format(**self.rows[0])

    def values(self, way: str, quantity: str) -> np.ndarray:
        """Of each query."""
        return np.array([row[way][quantity] for row in self.rows], dtype=float)

    def sides(self, quantity: str, of: Callable[[np.ndarray], float] = np.sum) -> tuple[float, float]:
        """Guided and uniform."""
        guided, uniform = (float(of(self.values(way, quantity))) for way in _WAYS)
        return guided, uniform

    @property
    def worst_ms(self) -> float:
        """How far the worst query went beyond WORST times what it took uniformly."""
        return 1000 * float((self.values("guided", "cpu_s") - WORST * self.values("uniform", "cpu_s")).max())

    @property
    def line_ms(self) -> float:
        """Processor time of the client beside planning, a query."""
        return 1000 * float(np.mean([row["line_s"] for row in self.rows]))

    @property
    def guides(self) -> str:
        """What planned the queries: "61 recalled, 30 uniform, 9 control"; a guided search goes by its guide."""
        counts = collections.Counter(_guide_of(row["guided"]) for row in self.rows)
        return ", ".join(f"{count} {name}" for name, count in counts.most_common())


def orders_of(rows: Sequence[dict[str, Any]]) -> list[Order]:
    """Of the rows of order.jsonl."""
    return [Order(list(group)) for _, group in itertools.groupby(rows, lambda row: (row["study"], row["robot"], row["seed"]))]


def order_table(orders: Sequence[Order]) -> str:
    """Guided / uniform by processor time of planning, milliseconds of each, and what planned the queries."""
    head = ["order", "solved", "total", "first ten", "checks", "worst, ms", "mean, ms", "median, ms", "p95, ms", "recall tries", "line, ms",
            "server, s", "length", "hand's, m", "least clearance, mm", "<planned by"]
    notes = (f"Guided / uniform by processor time of planning: at most {MAX_TOTAL} in total, {MAX_FIRST} for the first ten; *worst*: how far a query "
             f"went beyond {WORST} x uniform, at most {MAX_WORST} means of uniform planning.\n*line*: processor time in which the client asks and "
             "reports, a query; *server*: kinshipd's in all.\n*length*, the hand's, and the least clearance of paths: means and medians of the "
             "queries that both solved.\n")
    return table(head, map(_row, orders)) + notes


def figures(orders: Sequence[Order]) -> str:
    """Lines as tests/bench/figure.hpp has them."""
    return "".join(json.dumps(figure) + "\n" for order in orders for figure in _figures(order))


def _guide_of(guided: dict[str, Any]) -> str:
    if guided["found_by"] == "recalled":
        return "recalled"
    return guided["guide"] if guided["mode"] == "guided" else guided["mode"]


def _tail(values: np.ndarray) -> float:
    return float(np.quantile(values, TAIL))


def _first(values: np.ndarray) -> float:
    return float(values[:FIRST].sum())


def _ratio(sides: tuple[float, float]) -> str:
    guided, uniform = sides
    return f"{guided / uniform:.2f}"


def _both_ms(sides: tuple[float, float]) -> str:
    return " / ".join(f"{1000 * side:.3g}" for side in sides)


def _row(order: Order) -> list[str]:
    solved = " / ".join(f"{side:.0f}" for side in order.sides("solved"))
    return [order.name, solved, _ratio(order.sides("cpu_s")), _ratio(order.sides("cpu_s", _first)), _ratio(order.sides("checks")),
            f"{order.worst_ms:.1f}", _both_ms(order.sides("cpu_s", np.mean)), _both_ms(order.sides("cpu_s", np.median)),
            _both_ms(order.sides("cpu_s", _tail)), f"{order.values('guided', 'recall_tries').sum():.0f}", f"{order.line_ms:.2f}",
            f"{order.rows[-1]['server_s']:.1f}", _paths(order, "length", 2), _paths(order, "hand_length", 2),
            _paths(order, "clearance", 1, 1000), order.guides]


def _paths(order: Order, quantity: str, digits: int, scale: float = 1) -> str:
    """Means, and medians in brackets, over the queries that both solved; nothing where rows do not tell it."""
    told = [[row[way].get(quantity) for way in _WAYS] for row in order.rows if all(row[way]["solved"] for way in _WAYS)]
    sides = np.array([pair for pair in told if None not in pair], dtype=float).T * scale
    return " / ".join(f"{side.mean():.{digits}f} ({np.median(side):.{digits}f})" for side in sides) or NOTHING


def _figures(order: Order) -> list[dict[str, Any]]:
    def beside(name: str, quantity: str, unit: str, scale: float, of: Callable[[np.ndarray], float], budget: float | None = None) -> dict[str, Any]:
        guided, uniform = order.sides(quantity, of)
        figure = {"name": f"{order.name}: {name}", "value": scale * guided, "unit": unit, "better": "lower", "note": "",
                  "reference": {"name": "uniform", "value": scale * uniform}}
        return figure if budget is None else figure | {"ratio_budget": budget}

    total = beside("all queries", "cpu_s", "ms", 1000, np.sum, MAX_TOTAL) | {"note": order.guides}
    return [total, beside("the first ten", "cpu_s", "ms", 1000, _first, MAX_FIRST),
            beside("median", "cpu_s", "ms", 1000, np.median), beside("p95", "cpu_s", "ms", 1000, _tail),
            beside("checks", "checks", "checks", 1, np.sum),
            {"name": f"{order.name}: worst query beyond {WORST} x uniform", "value": order.worst_ms, "unit": "ms", "better": "lower",
             "reference": {"name": "uniform, mean", "value": 1000 * order.sides("cpu_s", np.mean)[1]}, "ratio_budget": MAX_WORST, "note": ""},
            {"name": f"{order.name}: asking and reporting, a query", "value": order.line_ms, "unit": "ms", "better": "lower", "note": ""}]
