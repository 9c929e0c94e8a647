"""An order through a kinshipd of its own: what was planned, told and reported, as its file and table have it."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from kinshipd_process import reserve_domain
from schemas import check_text

SOURCE, BIN = (pathlib.Path(os.environ[name]) for name in ("KINSHIP_SOURCE_DIR", "KINSHIP_BIN_DIR"))
QUERIES, EVERY = 24, 8


class Orders(unittest.TestCase):
    def setUp(self):
        self.out = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "order"
        self.domain, claim = reserve_domain()
        self.enterContext(claim)

    def order(self, *more: object) -> subprocess.CompletedProcess:
        words = ["order", "--out", self.out, "--models", SOURCE / "robots" / "models", "--domain", self.domain, "--ask", EVERY, "--study",
                 "furniture_cage", *more]
        return subprocess.run([BIN / "kinship-experiments", *map(str, words)], capture_output=True, text=True)

    def rows(self) -> list[dict]:
        return [json.loads(line) for line in (self.out / "order.jsonl").read_text().splitlines()]

    def test_guidance_begins_with_the_second_answer(self):
        done = self.order("--robot", "panda", "--queries", QUERIES)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(check_text((self.out / "order.jsonl").read_text())), {"kinship.order-query/1"})
        rows = self.rows()
        self.assertEqual([row["query"] for row in rows], list(range(QUERIES)))
        self.assertEqual([row["query"] for row in rows if row["told"]], list(range(0, QUERIES, EVERY)))
        self.assertIn("no experience", rows[0]["told"])
        self.assertIn(f"{2 * EVERY} stored ways of the hand", rows[2 * EVERY]["told"], "reports did not arrive, or did so late")
        modes = [row["guided"]["mode"] for row in rows]
        self.assertEqual(modes[:EVERY], ["uniform"] * EVERY)
        self.assertIn("guided", modes[EVERY:])
        for row in rows:
            self.assertEqual(row["uniform"]["mode"], "uniform")
            self.assertGreater(row["line_s"], 0)
            if row["guided"]["mode"] != "guided":
                self.assertEqual(row["guided"]["checks"], row["uniform"]["checks"], "not the same query")
        self.assertIn("\n| furniture_cage, panda, seed 1 | ", "\n" + done.stdout)
        self.assertEqual(self.order("--robot", "panda").returncode, 1, "a folder is used again")

    def test_seeds_have_queries_of_their_own_and_figures_are_of_each(self):
        done = self.order("--seed", "1,2", "--queries", 2, "--figures")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len({row["instance"] for row in self.rows()}), 4)
        figures = {figure["name"]: figure for figure in map(json.loads, done.stdout.splitlines())}
        for seed in (1, 2):
            total = figures[f"furniture_cage, ur10e, seed {seed}: all queries"]
            self.assertEqual(total["ratio_budget"], 0.5)
            self.assertGreater(total["reference"]["value"], 0)

    def test_a_rehearsal_is_waited_for_if_told(self):
        done = self.order("--queries", EVERY + 1, "--rehearsed")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("rehearsed on", self.rows()[EVERY]["told"])

    def test_exit_codes_say_what_is_missing(self):
        for words in (("--robot", "none"), ("--study", "none"), ("--kinshipd", self.out / "none")):
            done = self.order(*words)
            self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(self.order("--ask", 0).returncode, 2)


if __name__ == "__main__":
    unittest.main()
