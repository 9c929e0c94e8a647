"""What users of each release have on their disks, given to the programs of this build: all of it must go on."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from kinshipd_process import SOURCE, Kinshipd

PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
RELEASES = sorted(path for path in (SOURCE / "tests" / "golden" / "releases").iterdir())
TASK = "load_machine"


class Release(unittest.TestCase):
    """Each test for every release."""

    def copies(self):
        for release in RELEASES:
            with self.subTest(release=release.name), tempfile.TemporaryDirectory() as folder:
                copy = pathlib.Path(folder) / release.name
                shutil.copytree(release, copy)
                yield copy, json.loads((copy / "expected.json").read_text())

    def run_program(self, program: str, *words) -> str:
        done = subprocess.run([PROGRAMS / program, *(str(word) for word in words)], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, f"{program} {words}\n{done.stdout}{done.stderr}")
        return done.stdout

    def test_its_store_is_sound_and_says_which_release_wrote_it(self):
        for copy, expected in self.copies():
            self.run_program("kinshipd", "migrate", "--store", copy / "store.db")
            check = json.loads(self.run_program("kinshipd", "check", "--store", copy / "store.db", "--json"))
            self.assertEqual((check["release"], check["problems"]), (expected["release"], 0))

    def test_its_store_is_served_and_its_outbox_is_delivered(self):
        for copy, expected in self.copies():
            with Kinshipd() as server:
                shutil.copy(copy / "store.db", server.folder / "store.db")
                server.start()
                for rows in ("robots", "tasks", "paths", "distributions", "attempts"):
                    self.assertEqual(len(json.loads(server.kinship(rows, "list", "--json"))["rows"]), expected[rows], rows)
                waiting = json.loads(self.run_program("kinship", "outbox", "list", "--outbox", copy / "outbox", "--json"))["rows"]
                self.assertEqual(len(waiting), expected["waiting"])
                told = self.run_program("kinship-plan", "--problems", copy / "problems.jsonl", "--robot", copy / "my_arm", "--task", TASK,
                                        "--domain", server.domain, "--outbox", copy / "outbox", "--guidance", "require", "--report",
                                        "--output", copy / "guided.jsonl")
                guided = len((copy / "guided.jsonl").read_text().splitlines())
                self.assertEqual(len(json.loads(server.kinship("attempts", "list", "--json"))["rows"]),
                                 expected["attempts"] + expected["waiting"] + guided, told)

    def test_its_experience_is_imported_and_its_results_are_compared(self):
        for copy, expected in self.copies():
            with Kinshipd() as server:
                server.start()
                server.kinship("paths", "import", str(copy / "experience.jsonl"))
                self.assertEqual(len(json.loads(server.kinship("paths", "list", "--json"))["rows"]), expected["paths"])
            told = self.run_program("kinship", "results", "compare", copy / "results.jsonl", copy / "results.jsonl")
            self.assertIn("collision checks", told)


if __name__ == "__main__":
    unittest.main()
