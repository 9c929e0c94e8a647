#!/usr/bin/python3
"""Comparisons of result files, and the test of Wilcoxon that they and studies share."""
import itertools
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

RESULTS = pathlib.Path(__file__).resolve().parents[4] / "client" / "results"
sys.dont_write_bytecode = True
sys.path.insert(0, str(RESULTS))

from kinship_results import page_figures, run_files  # noqa: E402: after the path
from kinship_results.comparison import Comparison, document, worth  # noqa: E402
from kinship_results.comparison_table import duration_text, table  # noqa: E402
from kinship_results.wilcoxon import MAX_EXACT_PAIRS, wilcoxon  # noqa: E402

INFINITY = math.inf


def attempt(name: str, solved: bool, checks: int, time_s: float, **more: object) -> dict:
    return {"name": name, "solved": solved, "collision_checks": checks, "planning_time_s": time_s} | more


def guided(name: str, solved: bool, checks: int, time_s: float, share: float = 0.9) -> dict:
    return attempt(name, solved, checks, time_s, guidance={"distribution_id": "00", "share": share, "guide": "ways"})


def measured(results: list[dict], **by_name: tuple[float, float, float]) -> list[dict]:
    """With path length, hand's length in m and least clearance in m; others as lines of unsolved problems have them."""
    names = ("path_length", "hand_length_m", "least_clearance_m")
    return [each | dict(zip(names, by_name.get(each["name"], (None,) * 3))) for each in results]


UNIFORM = [attempt("a", True, 1000, 1), attempt("b", True, 3000, 3), attempt("c", False, 60000, 50)]
GUIDED = [guided("c", True, 2000, 2), guided("a", True, 500, 0.5), guided("b", True, 1500, 1.5)]
COLLIDING = attempt("d", False, 1, 0, not_planned="start_collides", reason="collides")


class Comparisons(unittest.TestCase):
    def test_pairs_by_name_in_whatever_order(self):
        compared = Comparison(UNIFORM, GUIDED)
        self.assertEqual((compared.pairs, compared.uniform.solved, compared.guided.solved), (3, 2, 3))
        self.assertEqual((compared.checks_test.rank_sum_plus, compared.checks_test.p), (6, 0.25))  # uniform is worse in every pair

    def test_means_are_capped_and_medians_rank_unsolved_worst(self):
        compared = Comparison(UNIFORM, GUIDED)
        self.assertAlmostEqual(compared.uniform.mean_checks, 64000 / 3)
        self.assertEqual(compared.uniform.median_checks, 3000)
        self.assertAlmostEqual(compared.ratio("mean_checks"), 16)
        self.assertEqual(compared.ratio("median_time_s"), 2)

    def test_an_unsolved_attempt_with_few_checks_still_ranks_worst(self):
        compared = Comparison([attempt("a", False, 10, 0.1)], [guided("a", True, 5000, 5)])
        self.assertEqual((compared.checks_test.rank_sum_plus, compared.uniform.median_checks), (1, INFINITY))
        both = Comparison([attempt("a", False, 60000, 9)], [guided("a", False, 60001, 8)])
        self.assertEqual((both.checks_test.dropped, both.checks_test.p), (1, 1))

    def test_a_distribution_with_share_zero_is_no_guidance(self):
        self.assertEqual(Comparison(UNIFORM, GUIDED[:2] + [guided("b", True, 1, 1, share=0)]).guided.with_guidance, 2)

    def test_what_one_side_answered_or_began_no_search_for_is_left_out(self):
        uniform = UNIFORM + [COLLIDING, attempt("e", True, 7, 1), attempt("f", True, 1, 1)]
        theirs = GUIDED + [COLLIDING, attempt("e", False, 0, 0, not_planned="error", reason="broken"), guided("g", True, 1, 1)]
        compared = Comparison(uniform, theirs)
        self.assertEqual((compared.pairs, compared.unpaired, compared.checks_test.p), (3, 2, 0.25))
        self.assertIn("\n2 problems could not be planned and are left out (start collides: 1, error: 1).\n  d: collides\n  e: broken\n",
                      table(compared, []))
        self.assertEqual(document(compared)["not_planned"], {"start_collides": 1, "error": 1})

    def test_refuses_what_cannot_be_compared(self):
        for uniform, theirs, why in ((UNIFORM[:1] * 2, GUIDED, "'a' occurs more than once"), ([], [], "no problem was answered by both"),
                                     ([attempt("x", True, 1, 1)], GUIDED, "no problem was answered by both"),
                                     ([COLLIDING], [COLLIDING], r"no problem could be planned \(start collides: 1\)")):
            with self.assertRaisesRegex(ValueError, why):
                Comparison(uniform, theirs)


class Tables(unittest.TestCase):
    def test_every_figure_is_in_its_column(self):
        paths = (measured(UNIFORM, a=(4, 1, 0.001), b=(6, 3, 0.003)), measured(GUIDED, a=(2, 0.5, 0.04), b=(4, 1.5, 0.01), c=(50, 9, 0.09)))
        self.assertEqual(table(Comparison(*paths), []), """\
3 problems, each planned with both

                                uniform     guided    ratio          p
  solved                            2/3        3/3
  collision checks, mean         21 333      1 333    16.00     0.2500
  collision checks, median        3 000      1 500     2.00
  planning time, mean            18.0 s     1.33 s    13.50     0.2500
  planning time, median          3.00 s     1.50 s     2.00
  path length, mean                5.00       3.00     1.67
  path length, median              5.00       3.00     1.67
  hand's length, mean            2.00 m     1.00 m     2.00
  hand's length, median          2.00 m     1.00 m     2.00
  least clearance, mean          2.0 mm    25.0 mm     0.08
  least clearance, median        2.0 mm    25.0 mm     0.08

ratio: uniform / guided. p: two-sided Wilcoxon signed-rank test, unsolved ranked worst (exact, 3 pairs that differ).
An unsolved attempt counts in a mean with what it had used when it gave up: that mean is a lower bound. In a median it is worse \
than all that are solved.
Lengths and clearance are of the 2 problems that both solved.
""")

    def test_paths_are_compared_where_both_were_measured(self):
        told = measured(UNIFORM, a=(4, 1, 0.001), b=(6, 3, 0.003))
        compared = Comparison(told, measured(GUIDED, a=(2, 2, 0.1), c=(50, 9, 0.09)))
        self.assertEqual([compared.uniform.mean_length, compared.guided.mean_hand_m, compared.guided.median_clearance_m], [4, 2, 0.1])
        one = Comparison(told, GUIDED)
        self.assertRegex(table(one, []), r"least clearance, mean +- +- +-\n")
        self.assertIsNone(document(one)["guided"]["mean_clearance_m"])

    def test_times_have_the_unit_that_fits_them_and_halves_round_up(self):
        told = table(Comparison([attempt("a", True, 1810, 0.00042), attempt("b", True, 1811, 0.00044)],
                                [guided("a", True, 10, 2e-6), guided("b", True, 11, 4e-6)]), [])
        self.assertIn("  collision checks, median        1 811         11", told)
        self.assertIn("  planning time, mean            430 µs    3.00 µs   143.33", told)
        self.assertEqual([duration_text(value) for value in (0, 0.9996, 0.0123, 5e-8)], ["0 s", "1.00 s", "12.3 ms", "0.05 µs"])

    def test_what_else_was_compared_has_a_line_below(self):
        compared = Comparison(UNIFORM, GUIDED)
        told = table(compared, [("retreat alone", Comparison(UNIFORM, UNIFORM)), ("mixture alone", compared)])
        self.assertTrue(told.startswith(table(compared, [])), "above, as without")
        self.assertIn("  mixture alone             3/3    1 333    16.00     1.33 s    13.50        -        -          -\n", told)
        self.assertIn("  retreat alone             2/3   21 333     1.00     18.0 s     1.00        -        -          -\n", told)

    def test_the_worth_of_experience_is_against_the_best_without_it(self):
        retreat = [attempt(name, True, 1600, 1, guidance={"distribution_id": None, "share": 0.5, "guide": "retreat"}) for name in "abc"]
        compared, alone = Comparison(UNIFORM, GUIDED), Comparison(UNIFORM, retreat)
        self.assertEqual((compared.uses_experience, alone.uses_experience, alone.guided.with_guidance), (True, False, 3))
        also = [("retreat alone", alone)]
        self.assertAlmostEqual(worth(compared, also, "mean_checks"), 1600 / (4000 / 3))
        self.assertAlmostEqual(worth(compared, also, "mean_time_s"), 1 / (4 / 3))
        self.assertTrue(math.isnan(worth(alone, [], "mean_checks")))
        said = "Worth of experience, the best without it (uniform, the retreat) / the best with it: 1.20 by checks, 0.75 by time."
        self.assertTrue(table(compared, also).endswith(f"\n\n{said}\n"))
        told = document(compared, also)["worth"]
        self.assertAlmostEqual(told["by_checks"], 1.2)
        self.assertAlmostEqual(told["by_time"], 0.75)
        self.assertIsNone(document(compared)["worth"])
        self.assertNotIn("Worth", table(compared, [("ways alone", compared)]))

    def test_what_needs_no_experience_is_not_credited_to_it(self):
        by_itself = "Nothing that guided used experience: what was saved needs no fleet and no server."
        part = "Part of the ratio may be the retreat's, which needs no experience"

        def guided_by(guide: str) -> Comparison:
            return Comparison(UNIFORM, [attempt(name, True, 1600, 1, guidance={"distribution_id": "00", "share": 0.5, "guide": guide})
                                        for name in "abc"])

        retreat, both = guided_by("retreat"), guided_by("retreat+ways")
        self.assertIn(by_itself, table(retreat, []))
        self.assertFalse(page_figures.page_figures(UNIFORM, UNIFORM, retreat, [])["uses_experience"])
        self.assertIn(part, table(both, []))
        self.assertNotIn(part, table(both, [("retreat alone", retreat)]))
        for told in (table(guided_by("ways"), []), table(Comparison(UNIFORM, UNIFORM), [])):
            self.assertNotIn(by_itself, told)
            self.assertNotIn(part, told)
        older = Comparison(UNIFORM, [attempt(name, True, 9, 1, guidance={"distribution_id": "00", "share": 0.5}) for name in "abc"])
        self.assertTrue(older.uses_experience)

    def test_what_is_to_be_known_of_the_run_is_said(self):
        self.assertIn("Only 0 of the 3 guided attempts had guided", table(Comparison(UNIFORM, UNIFORM), []))
        self.assertNotIn("proven", table(Comparison(UNIFORM, GUIDED), []))
        proven = [each | {"proven": each["solved"]} for each in UNIFORM]
        self.assertIn("Of 2 pairs of paths one is proven", table(Comparison(proven, GUIDED), []))

    def test_infinity_is_unsolved_in_the_table_and_null_in_json(self):
        compared = Comparison([attempt("a", False, 60000, 9)], [guided("a", True, 1000, 1)])
        self.assertRegex(table(compared, []), r"checks, median +unsolved +1 000 +inf")
        unmeasured = {f"{which}_{what}": None for what in ("length", "hand_m", "clearance_m") for which in ("mean", "median")}
        exact = {"p": 1, "pairs": 1, "dropped": 0, "rank_sum_plus": 1, "rank_sum_minus": 0, "method": "exact"}
        self.assertEqual(document(compared, [("say \"alone\"", compared)]), {
            "format": "kinship.comparison/1", "pairs": 1,
            "uniform": {"solved": 0, "with_guidance": 0, "mean_checks": 60000, "median_checks": None, "mean_time_s": 9,
                        "median_time_s": None} | unmeasured,
            "guided": {"solved": 1, "with_guidance": 1, "mean_checks": 1000, "median_checks": 1000, "mean_time_s": 1, "median_time_s": 1}
                      | unmeasured,
            "ratio": {"mean_checks": 60, "median_checks": None, "mean_time": 9, "median_time": None},
            "wilcoxon_checks": exact, "wilcoxon_time": exact, "unpaired": 0, "not_planned": {},
            "worth": None,
            "also": [{"name": "say \"alone\""} | {name: document(compared)[name] for name in ("pairs", "uniform", "guided", "ratio")}]})


class Program(unittest.TestCase):
    def test_files_that_are_missing_or_broken_are_named(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        good, bad = folder / "good.jsonl", folder / "bad.jsonl"
        good.write_text("".join(json.dumps(each) + "\n" for each in UNIFORM))
        bad.write_text(json.dumps(UNIFORM[0]) + '\n{"name": "b"}\n')

        def run(guided_file: pathlib.Path, *others: str, **more: list[str]) -> subprocess.CompletedProcess:
            words = {"files": [str(good), str(guided_file), *others]} | more
            return subprocess.run([sys.executable, "-B", RESULTS / "compare.py", json.dumps(words)], capture_output=True, text=True)

        also = json.loads(run(good, f"again={good}", str(good), json=["true"]).stdout)["also"]
        self.assertEqual([each["name"] for each in also], ["again", "good"])
        for wrong in ("=file", "name="):
            done = run(good, wrong)
            self.assertEqual((done.returncode, done.stderr), (2, f"results compare: '{wrong}' is not NAME=FILE\n"))
        newer = folder / "newer.jsonl"
        newer.write_text(json.dumps({"format": "kinship.result/2"} | UNIFORM[0]) + "\n")
        for code, file, why in ((3, folder / "none", "none'"), (1, bad, "bad.jsonl line 2: solved: is missing"),
                                (1, newer, "format: 'kinship.result/2' is newer than 'kinship.result/1'")):
            done = run(file)
            self.assertEqual(done.returncode, code)
            self.assertIn(why, done.stderr)


class PageFigures(unittest.TestCase):
    def test_the_typical_instance_is_the_first_nearest_the_median_ratio(self):
        paths = [[{**each, "waypoints": [[0], [1]]} for each in side] for side in (UNIFORM[:2], GUIDED[1:])]
        figures = page_figures.page_figures(*paths, Comparison(*paths), [])
        self.assertEqual(figures["typical"], {"problem": "a", "uniform_checks": 1000, "guided_checks": 500, "ratio": 2, "median_ratio": 2,
                                              "candidates": 2})
        self.assertEqual((figures["cheaper_guided"], figures["guides"]), (2, [{"guide": "ways", "queries": 2}]))
        self.assertEqual(figures["uniform_checks"]["mean"], 2000)
        self.assertIsNone(page_figures.find_typical(UNIFORM, GUIDED))


class RunFiles(unittest.TestCase):
    """Files as deploy/quickstart leaves them."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name in ("panda", "ur10e"):
            (self.folder / "models" / name).mkdir(parents=True)
            (self.folder / f"{name}.problems.jsonl").touch()
        self.write("panda", 700, 900)
        self.write("ur10e-uniform", 4000, 6000)
        self.write("ur10e-guided", 1000, 3000)
        (self.folder / "distribution.json").touch()
        self.words = {"run": [str(self.folder)], "models": [str(self.folder / "models")]}

    def write(self, name: str, *checks: int) -> str:
        """The results of problems p0, p1, ..., a microsecond a check."""
        file = self.folder / f"{name}.results.jsonl"
        file.write_text("".join(json.dumps(guided(f"p{i}", True, count, 1e-6 * count) | {"waypoints": [[0], [1]]}) + "\n"
                                for i, count in enumerate(checks)))
        return str(file)

    def test_are_found_by_their_names(self):
        for name in ("advice.json", "ur10e-guided.searches.jsonl"):
            (self.folder / name).touch()
        run = run_files.find_run(self.words)
        self.assertEqual({name: pathlib.Path(file).name for name, file in run["files"].items() if file}, {
            "model": "ur10e", "problems": "ur10e.problems.jsonl", "uniform": "ur10e-uniform.results.jsonl",
            "guided": "ur10e-guided.results.jsonl", "distribution": "distribution.json", "advice": "advice.json",
            "guided-searches": "ur10e-guided.searches.jsonl"})
        self.assertEqual([pathlib.Path(file).name for file in run["teachers"][0]], ["panda", "panda.problems.jsonl", "panda.results.jsonl"])
        self.assertEqual((len(run["teachers"]), run["also"]), (1, []))
        (self.folder / "panda.results.jsonl").unlink()
        self.assertEqual(run_files.find_run(self.words)["teachers"], [])

    def test_a_page_has_the_figures_of_the_terminal(self):
        described = run_files.described(run_files.find_run(self.words))
        figures = described["figures"]
        self.assertEqual((figures["uniform_checks"]["mean"], figures["guided_checks"]["mean"]), (5000, 2000))
        self.assertEqual((figures["uniform_time_s"]["mean"], figures["guided_time_s"]["mean"]), (0.005, 0.002))
        self.assertEqual((figures["comparison"]["ratio"]["mean_checks"], figures["comparison"]["pairs"], figures["cheaper_guided"]), (2.5, 2, 2))
        self.assertEqual(figures["table"]["rows"][1], ("collision checks, mean", "5 000", "2 000", "2.50", "0.5000"))
        self.assertEqual((figures["guides"], figures["also"]), ([{"guide": "ways", "queries": 2}], []))
        # ratios 4 and 2: the median is 3, the first of equals is shown
        self.assertEqual((described["shown"], figures["typical"]["median_ratio"], figures["typical"]["candidates"]), ("p0", 3, 2))
        self.assertEqual(figures["typical"]["uniform_checks"], 4000)

    def test_each_guide_alone_stands_beside_them(self):
        self.write("ur10e-retreat", 8000, 12000)
        self.write("ur10e-mixture", 1000, 1000)
        run = run_files.find_run(self.words)
        self.assertEqual(len(run["teachers"]), 1)
        mixture, retreat = run_files.described(run)["figures"]["also"]
        self.assertEqual((mixture[0], mixture[3]), ("mixture alone", "5.00"))
        self.assertEqual(list(retreat), ["retreat alone", "2/2", "10 000", "0.50", "10.0 ms", "0.50", "-", "-", "-"])

    def test_results_beside_them_may_have_any_name(self):
        self.words["also"] = ["with my option=" + self.write("tuned", 500, 1500)]
        also = run_files.described(run_files.find_run(self.words))["figures"]["also"]
        self.assertEqual([(row[0], row[3]) for row in also], [("with my option", "5.00")])
        self.words["also"] = ["gone=" + str(self.folder / "gone.jsonl")]
        with self.assertRaisesRegex(run_files.IncompleteRun, "of 'gone': there is no"):
            run_files.find_run(self.words)

    def test_all_that_is_missing_is_named_at_once(self):
        for name in ("distribution.json", "ur10e.problems.jsonl"):
            (self.folder / name).unlink()
        with self.assertRaises(run_files.IncompleteRun) as caught:
            run_files.find_run(self.words)
        for words in ("--distribution, or call it distribution.json", "--problems, or call it ROBOT.problems.jsonl"):
            self.assertIn(words, str(caught.exception))
        self.assertNotIn("--uniform", str(caught.exception))
        with self.assertRaisesRegex(run_files.IncompleteRun, "is no folder"):
            run_files.find_run({"run": [str(self.folder / "none")]})

    def test_a_run_of_several_robots_asks_which(self):
        self.write("sawyer-uniform", 1)
        self.write("sawyer-guided", 1)
        with self.assertRaisesRegex(ValueError, re.escape("say --robot (sawyer, ur10e)")):
            run_files.find_run(self.words)
        self.assertIn("ur10e", run_files.find_run(self.words | {"robot": ["ur10e"]})["files"]["uniform"])

    def test_may_have_any_name(self):
        old = {"problems": "ur10e.problems.jsonl", "uniform": "ur10e-uniform.results.jsonl", "guided": "ur10e-guided.results.jsonl",
               "distribution": "distribution.json"}
        words = {name: [str((self.folder / file).rename(self.folder / name))] for name, file in old.items()}
        teacher = [str(self.folder / name) for name in ("models/panda", "panda.problems.jsonl", "panda.results.jsonl")]
        words |= {"model": [str(self.folder / "models" / "ur10e")], "teacher": [",".join(teacher)]}
        run = run_files.find_run(words)
        self.assertEqual((run["teachers"], run["files"]["guided"]), ([teacher], words["guided"][0]))
        self.assertEqual(run_files.described(run)["figures"]["uniform_checks"]["mean"], 5000)
        with self.assertRaisesRegex(ValueError, "is not MODEL,PROBLEMS,RESULTS"):
            run_files.find_run(words | {"teacher": ["model,problems"]})


def of_differences(differences: list[float]):
    return wilcoxon(differences, [0.0] * len(differences))


class Wilcoxon(unittest.TestCase):
    def test_published_values(self):
        # Hollander and Wolfe, Nonparametric Statistical Methods, table 3.1: T+ = 40, one-sided 0.0195.
        test = wilcoxon([1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30], [0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29])
        self.assertEqual((test.rank_sum_plus, test.rank_sum_minus, test.p), (40, 5, 0.0390625))
        # Fisher, The Design of Experiments, section 17; W = 24.
        test = of_differences([6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75])
        self.assertEqual((test.rank_sum_minus, test.p, test.method), (24, 0.041259765625, "exact"))

    def test_equals_enumeration_of_all_signs_also_with_shared_ranks(self):
        generator = random.Random(41)
        for count in range(1, 11):
            differences = [generator.choice((-1, 1, 1)) * generator.randint(1, 6) for _ in range(count)]
            sizes = sorted(map(abs, differences))
            ranks = [(sizes.index(abs(each)) + 1 + count - sizes[::-1].index(abs(each))) / 2 for each in differences]
            middle = sum(ranks) / 2
            observed = abs(sum(rank for rank, each in zip(ranks, differences) if each > 0) - middle)
            as_far = sum(abs(sum(itertools.compress(ranks, signs)) - middle) >= observed - 1e-9
                         for signs in itertools.product((0, 1), repeat=count))
            self.assertAlmostEqual(of_differences(differences).p, min(1.0, as_far / 2**count), delta=1e-12)

    def test_the_normal_approximation_meets_the_exact_value_at_the_border_and_corrects_for_ties(self):
        generator = random.Random(41)
        differences = [generator.gauss(0.12, 1) for _ in range(MAX_EXACT_PAIRS)]
        exact, approximate = of_differences(differences), of_differences(differences + [1e-9])  # the smallest rank hardly matters
        self.assertEqual((exact.method, approximate.method), ("exact", "normal_approximation"))
        self.assertAlmostEqual(approximate.p, exact.p, delta=0.01 * exact.p + 1e-4)
        # 300 differences of equal size, 180 positive: every rank is 150.5, a sign test.
        z = (300 * 150.5 / 2 - 120 * 150.5 - 0.5) / math.sqrt(300 * 150.5**2 / 4)
        self.assertAlmostEqual(of_differences([1.0] * 180 + [-1.0] * 120).p, math.erfc(z / math.sqrt(2)), delta=1e-12)

    def test_unsolved_is_worse_than_any_solved_and_equal_to_unsolved(self):
        test = wilcoxon([INFINITY, 5, INFINITY, 900], [100, INFINITY, INFINITY, 100])
        self.assertEqual((test.dropped, test.pairs), (1, 3))
        self.assertEqual((test.rank_sum_plus, test.rank_sum_minus), (3.5, 2.5))  # 800 has rank 1, the infinite ones share 2 and 3

    def test_no_difference_is_no_evidence(self):
        self.assertEqual([wilcoxon([1, INFINITY], [1, INFINITY]).p, wilcoxon([], []).p, of_differences([7]).p], [1, 1, 1])

    def test_refuses_what_cannot_be_ranked(self):
        for first, second in (([1, 2], [1]), ([math.nan], [1])):
            with self.assertRaises(ValueError):
                wilcoxon(first, second)


if __name__ == "__main__":
    unittest.main()
