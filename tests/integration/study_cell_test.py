"""A study runs through a kinshipd of its own; one of its cells is then repeated with nothing but the files it left, `paths import`
and `kinship-plan`."""
import contextlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from kinshipd_process import Kinshipd, reserve_domain
from schemas import check_text

SOURCE, BIN = (pathlib.Path(os.environ[name]) for name in ("KINSHIP_SOURCE_DIR", "KINSHIP_BIN_DIR"))
EXPERIMENTS, MODELS = SOURCE / "client" / "experiments", SOURCE / "robots" / "models"
sys.path.insert(0, str(EXPERIMENTS))

from pipeline import files, learning, runs, study  # noqa: E402: after the path


def run(program: str, *words: object) -> str:
    """The output of a program that must succeed."""
    done = subprocess.run([BIN / program, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{program}: {done.stderr}")
    return done.stdout


class StudyCell(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.domain, claim = reserve_domain()
        self.enterContext(claim)
        self.out = self.folder / "study"

    def words(self, *more: object) -> list[object]:
        return ["open_table", "--quick", "--out", self.out, "--models", MODELS, "--domain", self.domain, *more]

    def options(self) -> study.RunOptions:
        return study.RunOptions(folder=self.out, models=MODELS, program=BIN / "kinship-experiments", kinshipd=BIN / "kinshipd",
                                analysis=self.folder / "missing.py", domain=self.domain, quick=True)

    def check_files(self, name: str) -> "set[str]":
        """Each document of the run is of its schema. Returns their formats."""
        return {found.removeprefix("kinship.") for file in (self.out / name).rglob("*.json*") if file.suffix != ".zst"
                for found in check_text(file.read_text(), str(file))}

    def results(self, name: str) -> dict[files.Key, dict]:
        with contextlib.closing(files.QueryLog(self.out / name / "test.jsonl")) as log:
            return log.rows

    def repeat_by_hand(self, name: str, target: str, source: str, resolution: float, problem_lines: str) -> None:
        """Plans the cell, and the same robot uniformly, with the files of the study alone: every query has the same checks.

        With the guide that the study's rehearsal chose: another one may choose another guide, as it goes by measured time.
        """
        rows = self.results(name)
        guide, = {row["guide"] for key, row in rows.items() if key[0] == target and key[1] == source}
        problems = self.folder / "problems.jsonl"
        problems.write_text(problem_lines)
        task = name.removesuffix("-quick")
        with Kinshipd() as server:
            server.start()
            run("kinship", "paths", "import", self.out / name / "learning" / f"{source}.jsonl", "--domain", server.domain)

            def plan(*more: str) -> dict[str, int]:
                lines = run("kinship-plan", problems, "--model", MODELS / target, "--domain", server.domain, "--resolution", resolution,
                            "--overshoot", 1, "--max-checks", 200000, "--shortcut-checks", 0, *more).splitlines()
                return {result["name"]: result["collision_checks"] for result in map(json.loads, lines)}

            by_hand = {"uniform": plan("--guidance", "none"),
                       source: plan("--task", task, "--guidance", "require", "--sources", source, "--share", "1", "--control-share", "0",
                                    "--wait", "600", "--guide", guide)}
        measured = {key: row["checks"] for key, row in rows.items() if key[0] == target and key[1] in by_hand}
        self.assertEqual(len(measured), 12)
        if "recall" in guide:  # how many paths are tried follows measured time
            measured = {key: checks for key, checks in measured.items() if key[1] == "uniform"}
        self.assertEqual({key: by_hand[key[1]][key[2]] for key in measured}, measured)

    def test_it_can_be_repeated_by_hand(self):
        run("kinship-experiments", *self.words())
        folder = self.out / "open_table-quick"
        report = (folder / "RESULTS.md").read_text()
        self.assertIn("\n| own | 3 | ", report)
        self.assertIn("\n20 learning instances per robot", report)
        self.assertIn("<svg ", (folder / "checks.svg").read_text())
        self.assertGreater((folder / "clouds.png").stat().st_size, 0)
        self.assertEqual(len(self.results("open_table-quick")), 3 * 4 * 6)
        self.assertEqual(self.check_files("open_table-quick"),
                         {"study/1", "study-run/1", "study-query/1", "distribution/1", "attempt/1", "experience-robot/1"})
        check_text(run("kinship-experiments", *self.words("--describe")), "--describe")
        self.repeat_by_hand("open_table-quick", "planar_7r_c", "planar_5r_b", 0.05,
                            run("kinship-experiments", *self.words("--problems", "planar_7r_c")))
        lines = (folder / "test.jsonl").read_text()
        run("kinship-experiments", *self.words("--resume"))
        self.assertEqual(sorted((folder / "test.jsonl").read_text().splitlines()), sorted(lines.splitlines()), "planned again")

    def test_under_a_constraint_it_can_be_repeated_by_hand(self):
        """Five cobots take too long for a test; two of them do the same work."""
        two = study.Study("open_table_cobots", self.options())
        two.fleet = two.fleet[2:4]
        two.description["learning_instances"] = 8
        messages = self.enterContext(tempfile.TemporaryFile("w+"))
        with contextlib.redirect_stderr(messages):
            runs.run_study(two)
        messages.seek(0)
        self.assertIn(f"to have it done: /usr/bin/python3 {self.folder / 'missing.py'} {self.out}", messages.read())
        results = self.results("open_table_cobots-quick")
        self.assertEqual(len(results), 2 * 3 * 6)
        for row in results.values():
            self.assertTrue(row["solved"], row)
            self.assertGreater(row["projections"], 0, "planned without its constraint")
        instances = two.instances(1, "test", study.QUICK_INSTANCES)
        self.repeat_by_hand("open_table_cobots-quick", "panda", "ur10e", 0.1, "".join(each.line + "\n" for each in instances))

    def test_tuning_and_calibration_end_with_their_tables(self):
        tuned = run("kinship-experiments", *self.words("--tuning", "--instances", 2, "--seeds", 1, "--robots", "planar_5r_a", "--sources",
                                                       "planar_5r_a,others", "--overshoot", 1.5))
        self.assertTrue(tuned.startswith("robot "), tuned)
        self.assertIn("\nplanar_5r_a    others ", tuned)
        self.assertIn("\nown          checks ", tuned)
        self.assertIn("study-tuning/1", {found for folder in self.out.iterdir() for found in self.check_files(folder.name)})
        self.assertIn("| planar_7r_c | ", run("kinship-experiments", *self.words("--resume", "--calibration", 2)))

    def test_side_studies_join_the_report(self):
        """One that needs no server, one of processes, one that fetches."""
        run("kinship-experiments", *self.words())
        run("kinship-experiments", *self.words("--study", "oracle,peers,guides"))
        report = (self.out / "open_table-quick" / "RESULTS.md").read_text()
        for variant in ("own answer, 0.1 about it", "Thunder, range 0.5: both threads", "straight way of the hand"):
            self.assertIn(variant, report)

    def test_a_run_that_is_killed_takes_its_server_along(self):
        store = self.folder / "killed.db"
        text = ("import pathlib, sys, time; sys.path.insert(0, sys.argv[1]); from pipeline import learning, study\n"
                "options = study.RunOptions(*map(pathlib.Path, sys.argv[2:7]), domain=int(sys.argv[7]))\n"
                "with learning.running_kinshipd(options, pathlib.Path(sys.argv[8])): print('serves', flush=True); time.sleep(600)\n")
        options = self.options()
        with subprocess.Popen([sys.executable, "-c", text, EXPERIMENTS, options.folder, options.models, options.program, options.kinshipd,
                               options.analysis, str(options.domain), store], stdout=subprocess.PIPE, text=True) as killed:
            self.assertEqual(killed.stdout.readline(), "serves\n")
            with self.assertRaises(ConnectionError, msg="two servers on one store"), learning.running_kinshipd(options, store):
                pass
            killed.send_signal(signal.SIGKILL)
        for _ in range(200):  # the server needs a moment to end
            with contextlib.suppress(ConnectionError), learning.running_kinshipd(options, store):
                return
            time.sleep(0.05)
        self.fail(store.with_name("killed.db.log").read_text())

    def test_a_folder_is_not_used_again_unasked(self):
        (self.out / "open_table-quick").mkdir(parents=True)
        done = subprocess.run([BIN / "kinship-experiments", *map(str, self.words())], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--resume", done.stderr)

    def test_exit_codes_say_what_is_missing(self):
        for code, words in ((3, ("--study", "none")), (3, ("--kinshipd", self.folder / "none")), (3, ("--problems", "none")),
                            (2, ("--domain", "231"))):
            done = subprocess.run([BIN / "kinship-experiments", *map(str, self.words(*words, "--resume"))], capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stderr)


if __name__ == "__main__":
    unittest.main()
