#!/usr/bin/python3
"""What an order took, by rows made up."""
import json
import pathlib
import sys
import unittest

EXPERIMENTS = pathlib.Path(__file__).resolve().parents[5] / "client" / "experiments"
sys.dont_write_bytecode = True
sys.path.insert(0, str(EXPERIMENTS))

from analysis import order_table  # noqa: E402: after the path


def row(query: int, guided_ms: float, uniform_ms: float, mode: str, found_by: str = "search", robot: str = "arm") -> dict:
    """Uniform paths are twice as long and half as clear."""
    def side(ms: float, its_mode: str, found: str, length: float) -> dict:
        return {"solved": True, "cpu_s": ms / 1000, "checks": round(100 * ms),
                "length": length, "hand_length": length / 2, "clearance": 0.01 / length, "mode": its_mode, "guide": "ways",
                "found_by": found, "recall_tries": 2 if found == "recalled" else 0}

    return {"study": "box", "robot": robot, "seed": 3, "query": query, "instance": f"box-{query}", "told": "", "line_s": 0.5e-3,
            "server_s": 0.1 * query, "guided": side(guided_ms, mode, found_by, 1 + query),
            "uniform": side(uniform_ms, "uniform", "search", 2 + 2 * query)}


ROWS = [row(query, 11, 10, "uniform") for query in range(10)] + [row(query, 2, 10, "guided", "recalled") for query in range(10, 18)] + [
    row(18, 3, 10, "guided"), row(19, 31, 10, "control")]


class OrderTable(unittest.TestCase):
    def test_a_row_tells_all_of_an_order(self):
        text = order_table.order_table(order_table.orders_of(ROWS))
        rows = [line.removeprefix("| box, arm, seed 3 ") for line in text.splitlines() if line.startswith("| box, arm, seed 3 ")]
        self.assertEqual("".join(rows).replace(" || ", " | "),
                         "| 20 / 20 | 0.80 | 1.10 | 0.80 | 18.5 | 8 / 10 | 11 / 10 | 12 / 10 | 16 | 0.50 | 1.9 | "
                         "10.50 (10.50) / 21.00 (21.00) | 5.25 (5.25) / 10.50 (10.50) | 1.8 (1.0) / 0.9 (0.5) | "
                         "10 uniform, 8 recalled, 1 ways, 1 control |")

    def test_paths_count_where_both_solved_and_are_nothing_where_rows_are_older(self):
        rows = [row(0, 1, 2, "guided"), row(4, 1, 2, "guided"), row(20, 1, 2, "guided")]
        rows[2]["guided"]["solved"] = False
        for way in ("guided", "uniform"):
            del rows[0][way]["clearance"], rows[1][way]["clearance"]
        self.assertIn("| 3.00 (3.00) / 6.00 (6.00) | 1.50 (1.50) / 3.00 (3.00) | – |", order_table.order_table(order_table.orders_of(rows)))

    def test_robots_have_orders_of_their_own(self):
        orders = order_table.orders_of(ROWS + [row(0, 1, 2, "guided", robot="other")])
        self.assertEqual([order.name for order in orders], ["box, arm, seed 3", "box, other, seed 3"])

    def test_figures_have_the_budgets(self):
        figures = [json.loads(line) for line in order_table.figures(order_table.orders_of(ROWS)).splitlines()]
        total, first, worst = figures[0], figures[1], figures[5]
        self.assertAlmostEqual(total["value"], 160)
        self.assertAlmostEqual(total["reference"]["value"], 200)
        self.assertEqual((total["unit"], total["ratio_budget"]), ("ms", 0.5))
        self.assertAlmostEqual(first["value"] / first["reference"]["value"], 1.1)
        self.assertEqual((first["ratio_budget"], worst["ratio_budget"]), (1.1, 10))
        self.assertAlmostEqual(worst["value"], 18.5)
        self.assertAlmostEqual(worst["reference"]["value"], 10)


if __name__ == "__main__":
    unittest.main()
