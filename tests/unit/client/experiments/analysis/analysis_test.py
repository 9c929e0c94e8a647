#!/usr/bin/python3
"""The analysis of studies, with the results of a small one in study/.

expected.json holds what the C++ that did this before had for the same results (commit e4c9d21).
"""
import dataclasses
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
EXPERIMENTS = HERE.parents[4] / "client" / "experiments"
sys.dont_write_bytecode = True
sys.path.insert(0, str(EXPERIMENTS))

from analysis import clouds, family, markdown, report, statistics, tables, transferability  # noqa: E402: after the path
from analysis.study_folder import Cell, StudyFolder  # noqa: E402


def cell(guidance: str, checks: list[list[float]], solved: list[list[bool]] | None = None) -> Cell:
    values = np.array(checks, dtype=float)
    names = tuple(f"task-{index}" for index in range(len(values)))
    return Cell("arm", guidance, names, values, values / 1000,
                np.array(solved) if solved else np.ones(values.shape, dtype=bool), values)


class CopiedStudy(unittest.TestCase):
    """A copy of the small study that a test may change."""

    def setUp(self) -> None:
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name) / "planar"
        shutil.copytree(HERE / "study", self.folder)

    def analyse(self, *arguments: str, python: tuple[str, ...] = ()) -> subprocess.CompletedProcess:
        return subprocess.run([sys.executable, *python, str(EXPERIMENTS / "analyse.py"), *arguments],
                              capture_output=True, text=True, check=False)


class TestNumbers(unittest.TestCase):
    """The same numbers as before. Intervals were drawn with another generator."""

    def assert_estimate(self, ours: statistics.Estimate, expected: dict[str, float]) -> None:
        self.assertAlmostEqual(ours.value, expected["value"], delta=1e-12 * expected["value"])
        noise = 0.1 * (expected["high"] - expected["low"])
        self.assertAlmostEqual(ours.low, expected["low"], delta=noise)
        self.assertAlmostEqual(ours.high, expected["high"], delta=noise)

    def test_every_pair_and_mean(self) -> None:
        expected = json.loads((HERE / "expected.json").read_text())
        study = StudyFolder(HERE / "study")
        cells = study.cells("test.jsonl")
        compared = 0
        for name in ("test", "pooled", "inverse", "peers"):
            further = study.cells(name + ".jsonl")
            for wanted in expected[name]:
                guided = further[wanted["robot"], wanted["guidance"]]
                ours = statistics.compare(cells[wanted["robot"], "uniform"], guided)
                with self.subTest(name, robot=wanted["robot"], guidance=wanted["guidance"]):
                    self.assert_estimate(ours.checks, wanted["checks"])
                    self.assertAlmostEqual(ours.time.value, wanted["time"], delta=1e-12 * wanted["time"])
                    for key in ("median_ratio", "p_checks", "p_time", "p_solved"):
                        self.assertAlmostEqual(getattr(ours, key), wanted[key], delta=1e-9 * wanted[key], msg=key)
                    self.assertEqual(ours.guided.solved_text(), wanted["solved"])
                    for key, value in (("mean", ours.guided.checks.mean()), ("median", np.median(ours.guided.checks)),
                                       ("deviation", ours.guided.checks.std(ddof=1))):
                        self.assertAlmostEqual(value, wanted[key], delta=1e-12 * value, msg=key)
                compared += 1
        self.assertEqual(compared, 9 + 6 + 3 + 6)
        pairs = tables.compare_pairs(study, cells)
        for kind, own in (("own", (True,)), ("transferred", (False,)), ("all", (True, False))):
            chosen = [pair for pair in pairs if (pair.guided.guidance == pair.guided.robot) in own]
            self.assert_estimate(statistics.mean_of_comparisons(chosen, "checks"), expected["means"][kind]["checks"])
            self.assert_estimate(statistics.mean_of_comparisons(chosen, "cpu_s"), expected["means"][kind]["time"])

    def test_committed_reports_are_what_the_committed_results_say(self) -> None:
        studies = sorted(file.parent for file in (EXPERIMENTS / "results").glob("*/test.jsonl.zst"))
        self.assertEqual([folder.name for folder in studies], ["cobots", "planar"])  # the paper's two
        for folder in studies:
            with self.subTest(folder.name):
                committed = (folder / "RESULTS.md").read_text(encoding="utf-8")
                self.assertEqual(report.results_text(StudyFolder(folder)), committed, "run analyse.py")


class TestStatistics(unittest.TestCase):

    def test_interval_narrows_with_more_instances(self) -> None:
        values = np.arange(25.0) % 5  # deviation 1.41, of the mean 0.28
        few = statistics.mean_estimate(values[:, None])
        self.assertAlmostEqual(few.low, 2 - 1.96 * 0.283, delta=0.05)
        self.assertAlmostEqual(few.high, 2 + 1.96 * 0.283, delta=0.05)
        many = statistics.mean_estimate(np.tile(values, 20)[:, None])
        self.assertLess(many.high - many.low, 0.5 * (few.high - few.low))
        equal = statistics.mean_estimate(np.full((3, 2), 7.0))
        self.assertEqual((equal.value, equal.low, equal.high), (7, 7, 7))

    def test_seeds_are_no_replicates(self) -> None:
        table = [[100.0 + 10 * index] for index in range(8)]
        twice = [[value, value] for [value] in table]
        one = statistics.compare(cell("uniform", [[400 + v] for [v] in table]), cell("panda", table))
        two = statistics.compare(cell("uniform", [[400 + v] * 2 for [v] in table]), cell("panda", twice))
        self.assertEqual(one.checks, two.checks)
        self.assertEqual(one.p_checks, two.p_checks)
        self.assertEqual(one.p_checks, 2 / 2**8)

    def test_wilcoxon_drops_equal_pairs(self) -> None:
        first, second = np.array([[5.0], [6], [1], [2], [3]]), np.array([[5.0], [6], [2], [4], [6]])
        self.assertEqual(statistics.wilcoxon_p(first, second), 2 / 2**3)
        self.assertEqual(statistics.wilcoxon_p(first, first), 1)

    def test_mcnemar_is_the_two_sided_binomial_test(self) -> None:
        for first, second, expected in ((0, 0, 1), (3, 3, 1), (5, 0, 2 / 32), (1, 5, 2 * 7 / 64), (5, 1, 2 * 7 / 64)):
            self.assertAlmostEqual(statistics.mcnemar_p(first, second), expected, delta=1e-12)

    def test_holm_by_hand(self) -> None:
        np.testing.assert_allclose(statistics.holm([0.04, 0.01, 0.03]), [0.06, 0.03, 0.06])
        np.testing.assert_allclose(statistics.holm([0.9, 0.8]), [1, 1])

    def test_success_and_tail_are_compared_query_by_query(self) -> None:
        uniform = cell("uniform", [[1000, 10], [20, 30]], [[False, True], [True, True]])
        guided = cell("panda", [[5, 25], [40, 1000]], [[True, True], [True, False]])
        compared = statistics.compare(uniform, guided)
        self.assertEqual(compared.p_solved, 1)
        self.assertEqual(compared.much_worse, 0.5)

    def test_tails_are_compared(self) -> None:
        compared = statistics.compare(cell("uniform", [[value] for value in range(1, 102)]),
                                      cell("panda", [[2 * value] for value in range(1, 102)]))
        self.assertAlmostEqual(compared.tail_ratio, 0.5)
        self.assertAlmostEqual(statistics.mean_of_ratios([compared, compared], "tail_ratio"), 0.5)

    def test_different_instances_are_not_compared(self) -> None:
        with self.assertRaisesRegex(ValueError, "arm guided by 'panda' and 'uniform' have different queries"):
            statistics.compare(cell("uniform", [[1], [2]]), cell("panda", [[1]]))


class TestFiles(CopiedStudy):

    def write_log(self, *changes: dict) -> StudyFolder:
        row = {"robot": "planar_5r_a", "guidance": "uniform", "instance": "a", "seed": 0, "solved": True, "checks": 7,
               "cpu_s": 0.5, "length": 3.0}
        (self.folder / "log.jsonl").write_text("".join(json.dumps(row | change) + "\n" for change in changes))
        return StudyFolder(self.folder)

    def test_an_unsolved_query_counts_the_limit(self) -> None:
        [read] = self.write_log({"solved": False}, {"instance": "b"}).cells("log.jsonl").values()
        self.assertEqual(read.checks.tolist(), [[200000], [7]])
        self.assertTrue(math.isnan(read.lengths[0, 0]))
        self.assertEqual(read.solved_text(), "1/2")

    def test_a_query_answered_twice_counts_as_the_last_time(self) -> None:
        [read] = self.write_log({}, {"checks": 9}).cells("log.jsonl").values()
        self.assertEqual(read.checks.tolist(), [[9]])

    def test_a_cell_that_lacks_queries_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "planar_5r_a guided by 'uniform' lacks queries: go on with --resume"):
            self.write_log({}, {"seed": 1}, {"instance": "b"}).cells("log.jsonl")

    def test_gated_queries_are_counted_where_every_row_says(self) -> None:
        rows = [{"guidance": guidance, "instance": instance, "gate_fired": guidance == "panda" and instance == "a",
                 "guided_share": 0.5} for guidance in ("uniform", "panda") for instance in ("a", "b", "c")]
        cells = self.write_log(*rows).cells("log.jsonl")
        pair = statistics.compare(cells["planar_5r_a", "uniform"], cells["planar_5r_a", "panda"])
        self.assertEqual(tables.gated_text([pair]), "1/3")
        self.assertEqual(tables.gated_text([pair, pair]), "2/6")
        self.assertEqual(pair.guided.shares.tolist(), [[0.5]] * 3)
        self.assertIn("1/3", tables.pair_rows([pair])[0])
        del rows[4]["gate_fired"]  # a row of before
        cells = self.write_log(*rows).cells("log.jsonl")
        pair = statistics.compare(cells["planar_5r_a", "uniform"], cells["planar_5r_a", "panda"])
        self.assertEqual(tables.gated_text([pair]), "–")

    def test_a_wide_table_becomes_several_with_the_same_keys(self) -> None:
        head = ["robot", "<of", *(f"{index:030}" for index in range(5))]
        text = markdown.table(head, [["arm", "panda", *"12345"], ["bow", "all", *"67890"]])
        self.assertLessEqual(max(map(len, text.splitlines())), markdown.MAX_LINE)
        rows = [line for line in text.splitlines() if line.startswith("| arm | panda | ")]
        self.assertEqual("".join(row.removeprefix("| arm | panda") for row in rows), " | 1 | 2 | 3 | | 4 | 5 |")
        self.assertEqual(text.count("| --- | --- | ---: |"), 2)

    def test_paragraphs_are_wrapped_and_tables_are_not(self) -> None:
        text = markdown.wrapped("# " + "head " * 40 + "\n\n" + "word " * 40 + "\n\n| " + "cell " * 40 + "|\n")
        self.assertEqual([len(line) > markdown.MAX_LINE for line in text.splitlines()], [True, False, False, False, False, True])

    def test_a_damaged_file_is_named(self) -> None:
        twin = self.folder / "test.jsonl.zst"
        content = bytearray(twin.read_bytes())
        content[200:210] = b"\x7f" * 10
        twin.write_bytes(content)
        result = self.analyse(str(self.folder))
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"analyse.py: '{twin}'", result.stderr)
        (self.folder / "test.jsonl").write_text('{"robot": \n')
        self.assertIn("test.jsonl' line 1: ", self.analyse(str(self.folder)).stderr)


class TestProgram(CopiedStudy):

    def test_report_and_figures(self) -> None:
        self.assertEqual(self.analyse(str(self.folder)).returncode, 0)
        files = {name: (self.folder / name).read_bytes() for name in ("RESULTS.md", "checks.svg", "time.svg")}
        text = files["RESULTS.md"].decode()
        for part in ("# Study planar: ", "| test set | eadbaccd3c32 | 2026-11-22 22:36 |", "| pooled | 590c3bb90999 |",
                     "## Calibration", "### pooled: ", "Lightning: both threads, pair by pair", "| planar_7r_c | planar_7r_c (own) |"):
            self.assertTrue(part in text, part)
        svg = xml.etree.ElementTree.fromstring(files["checks.svg"])
        shown = {element.text for element in svg.iter("{http://www.w3.org/2000/svg}text")}
        self.assertLessEqual({"uniform", "by planar_5r_a", "planar_7r_c", "collision checks, mean"}, shown)
        self.assertTrue((self.folder / "clouds.png").read_bytes().startswith(b"\x89PNG"))
        self.assertEqual(self.analyse(str(self.folder)).returncode, 0)
        for name, content in files.items():
            self.assertEqual((self.folder / name).read_bytes(), content, name)

    def test_the_report_counts_what_was_planned_not_what_the_study_wants(self) -> None:
        description = self.folder / "study.json"
        study = json.loads(description.read_text())
        description.write_text(json.dumps(study | {"learning_instances": 20}))
        planned = len(next(iter(StudyFolder(self.folder).cells("test.jsonl").values())).checks)
        text = " ".join(report.results_text(StudyFolder(self.folder)).split())
        self.assertNotEqual(planned, 50)
        self.assertIn("20 learning instances per robot", text)
        self.assertIn(f"{planned} test instances, ", text)

    def test_a_side_study_is_compared_with_its_own_uniform_planning(self) -> None:
        side = list(StudyFolder(self.folder).lines("pooled.jsonl"))
        older = report.results_text(StudyFolder(self.folder))
        uniform = [row | {"checks": 3 * row["checks"]} for row in StudyFolder(self.folder).lines("test.jsonl")
                   if row["guidance"] == "uniform" and row["solved"]]
        (self.folder / "pooled.jsonl").write_text("".join(json.dumps(row) + "\n" for row in side + uniform))
        study = StudyFolder(self.folder)
        [(name, pairs)] = report._variants(study, study.cells("test.jsonl"), study.cells("pooled.jsonl"))
        self.assertEqual(name, "pooled")
        own = study.cells("pooled.jsonl")
        self.assertTrue(all(pair.uniform.checks.mean() == own[pair.guided.robot, "uniform"].checks.mean() for pair in pairs))
        self.assertNotEqual(report.results_text(study), older)

    def test_paths_are_told_of_the_queries_that_both_solved(self) -> None:
        def cell_of(guidance: str, lengths: list[float], **measured: np.ndarray) -> Cell:
            return dataclasses.replace(cell(guidance, [[1.0]] * 3), lengths=np.array(lengths)[:, None],
                                       solved=~np.isnan(lengths)[:, None], **measured)

        clearances = {"clearances": np.array([[0.001], [0.002], [0.006]])}
        uniform = cell_of("uniform", [4, 6, math.nan], hand_lengths=np.array([[1.0], [math.nan], [math.nan]]), **clearances)
        guided = cell_of("panda", [1, 2, 9], hand_lengths=np.array([[0.5], [5.0], [5.0]]), **clearances)
        [row] = tables.path_rows([statistics.compare(uniform, guided)])
        self.assertEqual(row[2:], ["2", "5.00, 5.00", "1.50, 1.50", "1.00, 1.00", "0.50, 0.50", "1.5, 1.5", "1.5, 1.5"])
        [row] = tables.path_rows([statistics.compare(cell_of("uniform", [4, 6, 8]), guided)])
        self.assertEqual(row[5:], ["–"] * 4)
        rows = list(StudyFolder(self.folder).lines("test.jsonl"))
        (self.folder / "test.jsonl").write_text("".join(
            json.dumps(row | ({"hand_length": 1.5, "clearance": 0.02} if row["solved"] else {"hand_length": None, "clearance": None})) + "\n"
            for row in rows))
        text = report.results_text(StudyFolder(self.folder))
        self.assertIn(" | 1.50, 1.50 | 1.50, 1.50 |\n", text)
        self.assertIn(" | 20.0, 20.0 | 20.0, 20.0 |\n", text)

    def test_calibration(self) -> None:
        text = self.analyse(str(self.folder), "--calibration").stdout
        self.assertIn("| planar_7r_c |", text)
        self.assertEqual(text, report.calibration_text(StudyFolder(self.folder)))

    def test_tuning(self) -> None:
        shutil.copy(self.folder / "test.jsonl.zst", self.folder / "tuning.jsonl.zst")
        pairs = [{"robot": "planar_5r_a", "source": source, "guidance": source}
                 for source in ("planar_5r_a", "planar_5r_b")]
        (self.folder / "tuning.json").write_text(json.dumps({"uniform": "uniform", "pairs": pairs}))
        lines = self.analyse(str(self.folder), "--tuning").stdout.splitlines()
        self.assertEqual(lines[0].split()[:3], ["robot", "experience", "uniform"])
        self.assertEqual(len(lines), 5)
        self.assertRegex(lines[3], r"^own +checks [\d.]+ \[[\d.]+, [\d.]+\], least [\d.]+, time [\d.]+, 1 pairs$")
        self.assertEqual("\n".join(lines) + "\n", report.tuning_text(StudyFolder(self.folder)))

    def test_family(self) -> None:
        easy = self.folder.parent / "planar_easy"
        shutil.copytree(self.folder, easy)
        for folder, name in ((self.folder, "planar"), (easy, "planar_easy")):
            study = json.loads((folder / "study.json").read_text()) | {"study": name, "family": "planar"}
            (folder / "study.json").write_text(json.dumps(study))
        rows = list(StudyFolder(easy).lines("test.jsonl"))
        (easy / "test.jsonl").write_text("".join(
            json.dumps(row | {"checks": 1 + row["checks"] % 50, "solved": True}) + "\n" for row in rows))
        shutil.copytree(easy, self.folder.parent / "planar_easy-quick")  # is left out
        self.assertEqual(self.analyse(str(self.folder.parent), "--family=planar").returncode, 0)
        lines = (self.folder.parent / "planar.md").read_text(encoding="utf-8").splitlines()
        shown = [[word.strip() for word in line.split("|")[1:-1]] for line in lines if line.startswith("| ")][2:]
        self.assertEqual([row[:3] for row in shown], [
            ["planar", "own", "3"], ["planar", "another robot's", "6"], ["easy", "own", "3"],
            ["easy", "another robot's", "6"], ["all", "own", "3"], ["all", "another robot's", "6"]])
        self.assertEqual(shown[4][3:], shown[0][3:])  # the easy kind does not count
        self.assertNotEqual(shown[2][3:], shown[0][3:])
        pairs = tables.compare_pairs(StudyFolder(self.folder), StudyFolder(self.folder).cells("test.jsonl"))
        own = [pair for pair in pairs if pair.guided.guidance == pair.guided.robot]
        self.assertEqual(shown[0][4], f"{statistics.mean_of_comparisons(own, 'checks').value:.2f}")
        self.assertIn("no results of a study of the family 'chairs'",
                      self.analyse(str(self.folder.parent), "--family=chairs").stderr)
        self.assertEqual(family.find_kinds(self.folder.parent, "planar")[0].folder, self.folder)

    def test_says_what_to_install(self) -> None:
        result = self.analyse(str(self.folder), python=("-S",))  # without site packages
        self.assertEqual(result.returncode, 1)
        self.assertIn("apt-get install python3-numpy python3-scipy", result.stderr)

    def test_a_folder_of_something_else(self) -> None:
        result = self.analyse(str(self.folder / "missing"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("study.json", result.stderr)


class TestTransferability(CopiedStudy):

    def pair(self, target: str, source: str, gain: float, **candidates: float) -> transferability.Pair:
        return transferability.Pair("planar", target, source, gain, candidates)

    def test_the_candidate_is_chosen_without_the_robot_that_is_left_out(self) -> None:
        # "good" ranks all pairs but those of d, "bad" only those of d.
        names = "abcd"
        pairs = [self.pair(target, source, gain, good=-gain if "d" in (target, source) else gain,
                           bad=gain if "d" in (target, source) else -gain)
                 for gain, (target, source) in enumerate(
                     ((t, s) for t in names for s in names if t != s), 1)]
        rows = {robot: (name, value) for robot, name, value in transferability.left_out(pairs, ["good", "bad"])}
        self.assertEqual(rows["d"], ("good", -1.0))

    def test_density_of_a_mixture_by_hand(self) -> None:
        mixture = {"weights": [0.5, 0.5], "means": [[0.0], [4.0]], "covariances": [[[1.0]], [[1.0]]]}
        at_zero = 0.5 * (1 + math.exp(-8)) / math.sqrt(2 * math.pi)
        self.assertAlmostEqual(transferability.mean_log_density(mixture, np.array([[0.0]])), math.log(at_zero))
        self.assertEqual(transferability.mean_log_density(mixture, np.array([[1e3]])), -50)

    def test_a_folder_with_predictions(self) -> None:
        self.assertIn("has no study with transferability.json", self.analyse(str(self.folder.parent), "--transferability").stderr)
        study = StudyFolder(self.folder)
        rows = [{"target_label": target, "source_label": source, "worth": 2.0 + index}
                for index, (target, source) in enumerate((t, s) for t in study.robots for s in study.robots)]
        (self.folder / transferability.PREDICTIONS).write_text(json.dumps({"rows": rows}))
        result = self.analyse(str(self.folder.parent), "--transferability")
        self.assertEqual(result.returncode, 0, result.stderr)
        text = (self.folder.parent / "transferability.md").read_text()
        self.assertIn("## One robot left out", text)
        self.assertRegex(text, r"\| rehearsal \| +-?[0-9.]+ \|")


class TestClouds(unittest.TestCase):

    def setUp(self) -> None:
        study = StudyFolder(HERE / "study")
        self.robot = study.study["robots"][1]
        self.distribution = next(study.lines("distributions.jsonl"))

    def test_a_stretched_arm_and_a_bent_one(self) -> None:
        q = np.zeros((2, len(self.robot["joints"])))
        q[1, 0] = math.pi / 2
        base = np.array(self.robot["T_task_base"][:3])
        origins = clouds.joint_origins(self.robot, q) - base
        np.testing.assert_allclose(origins[:, 0], 0, atol=1e-12)
        np.testing.assert_allclose(origins[0, -1, 1:], 0, atol=1e-12)
        self.assertAlmostEqual(origins[0, -1, 0], 1.0, delta=0.2)  # arms are 1 m long
        np.testing.assert_allclose(origins[1, -1], origins[0, -1, [1, 0, 2]], atol=1e-12)

    def test_samples_keep_to_the_limits(self) -> None:
        narrow = self.distribution | {"limits": [[-0.5, 0.5]] + self.distribution["limits"][1:]}
        everywhere, within = (clouds.draw_samples(each, 500) for each in (self.distribution, narrow))
        self.assertGreater(len(everywhere), len(within))
        self.assertGreater(len(within), 0)
        self.assertLessEqual(np.abs(within[:, 0]).max(), 0.5)


if __name__ == "__main__":
    unittest.main()
