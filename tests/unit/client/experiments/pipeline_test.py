"""Running studies: logs that an interruption leaves, learning sets, side studies, planners of OMPL; without a server."""
import json
import os
import pathlib
import sys
import tempfile
import types
import unittest
from unittest import mock

import numpy as np

EXPERIMENTS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "client" / "experiments"
sys.path.insert(0, str(EXPERIMENTS))

from pipeline import cells, files, learning, peers, side_studies, study  # noqa: E402: after the path
from pipeline.peers import Half  # noqa: E402

DIGESTS = ("01" * 32, "02" * 32)


def row(instance: str, distribution: str | None = None) -> dict:
    key = ("arm", "panda" if distribution else "uniform", instance, 1)
    return cells.row_of(key, solved=True, checks=1234, cpu_s=0.1 + 0.2, length=12.25) | {"distribution": distribution}


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = self.folder / "test.jsonl"

    def log(self, *rows: dict) -> files.QueryLog:
        log = files.QueryLog(self.file)
        self.addCleanup(log.close)
        for each in rows:
            log.add(each)
        return log


class QueryLogs(InFolder):
    def test_an_interrupted_run_goes_on_where_it_was(self):
        first, second = row("a"), row("b", DIGESTS[0])
        self.log(first, second).close()
        with self.file.open("a") as stream:
            stream.write('{"robot": "arm", "guid')  # killed while writing
        log = self.log()
        self.assertTrue(log.has(files.key_of(first), None))
        self.assertTrue(log.has(files.key_of(second), DIGESTS[0]))
        self.assertEqual([json.loads(line) for line in self.file.read_text().splitlines()],
                         [{"format": "kinship.study-query/1"} | row for row in (second, first)])  # by key
        log.add(row("c"))
        self.assertEqual(len(self.log().rows), 3)

    def test_results_of_another_distribution_are_not_taken_for_these(self):
        log = self.log(row("a", DIGESTS[0]))
        with self.assertRaisesRegex(ValueError, "use another folder"):
            log.has(files.key_of(row("a", DIGESTS[0])), DIGESTS[1])

    def test_what_is_no_result_is_not_overwritten(self):
        for text in ("notes", '{"robot": "arm"}', "[]"):
            self.file.write_text(f"{text}\n{files.to_line(row('a'))}\n")
            with self.assertRaisesRegex(ValueError, "test.jsonl' line 1"):
                files.QueryLog(self.file)
            self.assertTrue(self.file.read_text().startswith(text))

    def test_goes_on_from_the_compressed_twin_unless_it_is_damaged(self):
        self.log(row("a")).close()
        before = self.file.read_bytes()
        files.compress_file(self.file)
        self.file.unlink()
        self.assertEqual(len(self.log().rows), 1)
        self.assertEqual(self.file.read_bytes(), before)
        twin = files.compressed_name(self.file)
        whole = twin.read_bytes()
        for damaged in (whole[:20] + b"\x7f\x7f\x7f" + whole[23:], b"no zstd", whole[:-4]):
            self.file.unlink(missing_ok=True)
            twin.write_bytes(damaged)
            with self.assertRaisesRegex(ValueError, "test.jsonl.zst"):
                files.QueryLog(self.file)


class LearningSets(unittest.TestCase):
    def test_uuids_are_those_of_the_sets_that_are_kept(self):
        self.assertEqual(learning.uuid_of("planar", "planar_5r_a", 0), "fb1d9053-31e4-8096-b7c6-a01c12ed32d2")

    def test_renamed_attempts_are_others(self):
        lines = [json.dumps({"report_uuid": str(index), "task": "a", "record": {}}) for index in range(3)]
        documents = [json.loads(line) for line in learning.renamed(lines, "a_2", 2)]
        self.assertEqual([document["task"] for document in documents], ["a_2", "a_2"])
        self.assertEqual(len({document["report_uuid"] for document in documents} - {"0", "1"}), 2)

    def test_a_quick_run_learns_from_few_instances(self):
        def learned(**options) -> int:
            known = types.SimpleNamespace(description={"learning_instances": 200}, options=types.SimpleNamespace(
                **{"learning": 0, "quick": False} | options))
            return study.Study.learning_instances.fget(known)

        self.assertEqual(learned(), 200)
        self.assertEqual(learned(quick=True), study.QUICK_LEARNING)
        self.assertEqual(learned(quick=True, learning=5), 5)

    def test_a_path_is_cut_into_equal_parts(self):
        dense = cells.densified(np.array([[0.0, 0.0], [0.3, 0.4], [0.3, 0.45]]), 0.2)
        np.testing.assert_allclose(dense, [[0, 0], [0.1, 0.4 / 3], [0.2, 0.8 / 3], [0.3, 0.4], [0.3, 0.45]])


class SideStudies(unittest.TestCase):
    """Of two robots."""

    def setUp(self):
        self.study = mock.Mock(fleet=[types.SimpleNamespace(label="a"), types.SimpleNamespace(label="b")], description={
            "guided_share": 0.9, "learning_instances": 60, "is_constrained": False})
        self.study.name = "task"

    def cells(self, name: str) -> list:
        return list(side_studies.find_side_study(self.study, name).cells(self.study))

    def test_none_is_of_peers_along_a_constraint(self):
        self.assertEqual(len(side_studies.side_studies(self.study)), 11)
        self.study.description["is_constrained"] = True
        with self.assertRaisesRegex(LookupError, "no side study 'peers'; there are pooled, "):
            side_studies.find_side_study(self.study, "peers")

    def test_the_paper_knows_neither_uniform_samples_nor_overshoot(self):
        self.assertEqual({(each.share, each.options["overshoot"], each.request.profile) for each in self.cells("paper")}, {(1.0, 1, "paper")})
        self.assertEqual([each.name for each in self.cells("paper")], ["a|paper", "b|paper"] * 2)

    def test_sizes_are_smaller_than_the_learning_set(self):
        self.assertEqual(side_studies.find_side_study(self.study, "sizes").shortened(self.study), {"task_10": 10, "task_50": 50})
        self.assertEqual({each.request.task for each in self.cells("sizes")}, {"task_10", "task_50"})

    def test_pooled_experience_is_of_the_others_or_of_all(self):
        self.assertEqual([(each.robot, each.request.sources, each.guide) for each in self.cells("pooled")],
                         [(0, (1,), None), (0, (0, 1), None), (1, (0,), None), (1, (0, 1), None)])


class Peers(InFolder):
    MOST = 1000

    def test_two_threads_ask_by_turns_until_one_has_a_path(self):
        both = peers.both_threads(Half(True, 100, 1, 2), Half(True, 400, 1, 2), self.MOST)
        self.assertEqual(both, Half(True, 200, 1.25, 2))  # a quarter of the other's time
        self.assertEqual(peers.faster_thread(Half(True, 100), Half(True, 400), self.MOST).checks, 100)

    def test_what_gave_up_early_costs_what_it_had_spent(self):
        halves = Half(False, 30, 1), Half(True, 400, 1, 2)
        self.assertEqual(peers.both_threads(*halves, self.MOST), Half(True, 430, 2, 2))
        self.assertEqual(peers.faster_thread(*halves, self.MOST).checks, 400)

    def test_the_limit_is_for_both_together(self):
        halves = Half(False, 900), Half(True, 600)
        self.assertEqual(peers.both_threads(*halves, self.MOST), Half(False, self.MOST))
        self.assertTrue(peers.faster_thread(*halves, self.MOST).solved)
        self.assertEqual(peers.faster_thread(Half(False, 900), Half(False, 10), self.MOST), Half(False, self.MOST))

    def test_a_query_that_ends_the_process_is_lost_and_the_next_goes_on(self):
        half = {"solved": True, "checks": 5, "cpu_s": 1, "length": 1}
        told = [json.dumps({"learned": "all"}), json.dumps({"recall": half, "scratch": half})]
        program = self.folder / "peer"
        # Answers the first of its queries, prints like OMPL, and crashes at the second.
        program.write_text("#!/bin/sh\necho 'SPARSdb Debug Output:'\nread lesson; read empty; read query\n"
                           f"echo '{told[0]}'\necho '{told[1]}'\nread query && {{ printf '{{\"rec'; kill -9 $$; }}\nexit 0\n")
        program.chmod(0o755)
        one = types.SimpleNamespace(fleet=[types.SimpleNamespace(label="arm")], description={"max_checks": self.MOST},
                                    command=lambda *words: [str(program)])
        log = self.log()
        text = peers._Batch(one, 0, "Thunder", log).run("lesson\n", {(name, 0): name for name in "abc"})
        self.assertEqual(text, "arm, Thunder: all; b ended the process (signal 9)")
        solved = {key[2]: row["solved"] for key, row in log.rows.items() if key[1] == "arm|Thunder: both threads"}
        self.assertEqual(solved, {"a": True, "b": False, "c": True})


if __name__ == "__main__":
    unittest.main()
