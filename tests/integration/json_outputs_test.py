"""What every verb with --json prints, and every file of JSON that programs write, is of its schema (proto/json/schemas)."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

from kinshipd_process import MODELS, Kinshipd
from schemas import SCHEMAS, check_text

sys.path.append(str(pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "tests" / "documents"))
from names_test import help_of, tree  # noqa: E402: after the path

BIN = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
PANDA, UR10E = str(MODELS / "panda"), str(MODELS / "ur10e")
READY = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
TURNED = [1.2, -0.4, 0.3, -1.9, 0.2, 1.8, 0.6]
TASK = "reach"


def verbs_with_json() -> "set[str]":
    """As "kinship paths list"; what a verb's own usage names, not that of a noun."""
    verbs = set()
    for words in tree("kinship") + tree("kinshipd"):
        usage = help_of(*words).split("Usage:", 1)[1]
        if not usage.splitlines()[0].endswith(" SUBCOMMAND") and "\n  --json" in usage:
            verbs.add(" ".join(words))
    return verbs


def problem(name: str, start: "list[float]", goal: "list[float]", **more) -> str:
    wall = {"name": "wall", "size": [0.05, 0.4, 0.6], "pose": [0.5, 0.35, 0.5, 0, 0, 0, 1]}
    return json.dumps({"name": name, "start": start, "goal": {"configurations": [goal]}, "scene": {"boxes": [wall]}, "seed": 1} | more) + "\n"


class Outputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start()
        cls.folder = cls.server.folder
        cls.problems = cls.folder / "problems.jsonl"
        held = {"name": "part", "link": "panda_hand", "shape": {"box": [0.02, 0.02, 0.05]}, "T_link_object": [0, 0, 0.1, 0, 0, 0, 1]}
        cls.problems.write_text("".join(problem(f"p{i}", READY, [q + 0.02 * i for q in TURNED]) for i in range(4))
                                + problem("held", READY, TURNED, attached=[held], T_task_base=[0, 0, 0, 0, 0, 0, 1])
                                + problem("far", READY, [9] * 7))

    def setUp(self):
        self.ran = set()

    def run_program(self, program: str, *words: object, code: int = 0) -> str:
        at = [] if program == "kinshipd" else ["--domain", self.server.domain]
        done = subprocess.run([BIN / program, *map(str, (*words, *at))], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, code, f"{program} {words}: {done.stderr}")
        return done.stdout

    def check(self, verb: str, *words: object, code: int = 0) -> str:
        """Of kinship unless the verb names a program. Returns what it printed."""
        program, *verbs = (verb if verb.startswith("kinshipd ") else f"kinship {verb}").split()
        text = self.run_program(program, *verbs, *words, "--json", code=code)
        check_text(text, verb)
        self.ran.add(" ".join((program, *verbs)))
        return text

    def rows(self, verb: str, *words: object) -> "list[dict]":
        rows = json.loads(self.check(verb, *words))["rows"]
        self.assertTrue(rows, f"{verb}: lists nothing, so nothing of a row is checked")
        return rows

    def plan(self, name: str, *words: object) -> pathlib.Path:
        results, searches = self.folder / f"{name}.jsonl", self.folder / f"{name}.searches.jsonl"
        self.run_program("kinship-plan", self.problems, "--robot", PANDA, "--output", results, "--searches", searches, *words)
        self.assertEqual(set(check_text(results.read_text(), name)), {"kinship.result/1"})
        self.assertEqual(set(check_text(searches.read_text(), name)), {"kinship.search/1"})
        return results

    def check_planning(self) -> None:
        uniform = self.plan("uniform", "--guidance", "none", "--task", TASK, "--report", "--record-search", "all", "--outbox",
                            self.folder / "outbox")
        guided = self.plan("guided", "--guidance", "require", "--task", TASK, "--guide", "ways", "--control-share", 0)
        self.check("results compare", uniform, guided)
        compared = json.loads(self.check("results compare", uniform, guided, f"again={uniform}"))
        self.assertIsNotNone(compared["worth"])

    def check_without_server(self) -> None:
        self.check("robots check", PANDA)
        self.check("robots links", PANDA)
        self.check("robots frames", PANDA, "--q", " ".join(map(str, READY)))
        self.check("robots fk", PANDA, "--q", " ".join(map(str, READY)))
        for pose in ("0.4 0.1 0.4 1 0 0 0", "9 0 0 1 0 0 0"):
            self.check("robots ik", PANDA, "--pose", pose)
        self.check("robots suggest-srdf", PANDA, "--samples", 1000)

    def check_listings(self) -> None:
        self.rows("robots list")
        self.rows("tasks list")
        self.rows("distributions list")
        [path, *_] = self.rows("paths list")
        attempts = self.rows("attempts list")
        check_text(self.run_program("kinship", "status", "--clients", "--json"), "status --clients")
        self.check("status")
        self.check("robots show", "panda")
        self.check("tasks show", TASK)
        self.check("tasks experience", TASK)
        self.check("paths show", path["report_uuid"])
        for attempt in attempts:
            self.check("attempts show", attempt["report_uuid"])
        exported = self.run_program("kinship", "paths", "export", "--task", TASK)
        self.assertEqual(set(check_text(exported, "paths export")), {"kinship.attempt/1", "kinship.experience-robot/1"})
        file = self.folder / "exported.jsonl"
        file.write_text(exported)
        self.check("paths import", file)
        self.assertEqual(check_text(self.run_program("kinship", "attempts", "export", attempts[0]["report_uuid"]), "attempts export"),
                         ["kinship.problem/1"])

    def check_distributions(self) -> None:
        self.check("robots register", UR10E)
        of = ("--task", TASK, "--robot", "ur10e", "--placement", "0 0 0 0 0 0 1")
        fetched = json.loads(self.check("distributions fetch", *of))
        self.check("distributions explain", *of)
        self.check("distributions show", fetched["id"])
        self.check("robots compare", "--task", TASK, "--targets", "panda", "--placement", "panda=0 0 0 0 0 0 1")

    def check_upkeep(self) -> None:
        job = json.loads(self.check("backup", "monday.db"))
        self.check("jobs wait", job["id"])
        self.check("jobs cancel", job["id"])
        self.rows("jobs list")
        [backup] = self.rows("backup list")
        self.check("backup download", backup["name"], "--to", self.folder / "fetched.db")
        [distribution, *_] = self.rows("distributions list")
        self.check("distributions evict", distribution["id"])
        self.check("robots rename", "ur10e", "ur10e_2")
        self.check("robots remove", "ur10e_2", "--yes")
        path = self.rows("paths list")[0]["report_uuid"]
        self.check("paths retire", path, "--yes")
        self.check("paths restore", path)
        self.check("tasks reset", TASK, "--yes")
        self.check("tasks rename", TASK, "another")
        self.check("tasks remove", "another", "--yes")
        self.rows("audit")
        self.rows("outbox list", "--outbox", self.set_aside())

    def set_aside(self) -> pathlib.Path:
        """An outbox with a report that waits; each file of it, and of the one that was sent, is a document."""
        outbox = self.folder / "away"
        pending = outbox / "pending"
        pending.mkdir(parents=True)
        for file in sorted((self.folder / "outbox").rglob("*.json")):
            check_text(file.read_text(), str(file))
        sent = sorted((self.folder / "outbox" / "sent").glob("*.json"))
        self.assertTrue(sent)
        (pending / sent[0].name).write_text(sent[0].read_text())
        return outbox

    def check_watch(self) -> None:
        with subprocess.Popen([BIN / "kinship", "watch", "--json", "--domain", str(self.server.domain)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as watch:
            watch.stderr.readline()  # it watches
            self.run_program("kinship", "robots", "register", PANDA)
            line = watch.stdout.readline()
            watch.terminate()
        self.assertEqual(check_text(line, "watch"), ["kinship.event/1"])
        self.ran.add("kinship watch")

    def check_store_and_credentials(self) -> None:
        self.server.stop()
        self.check("kinshipd check", "--store", self.folder / "store.db")
        security = self.folder / "security"
        self.run_program("kinshipd", "secure", "init", security)
        self.run_program("kinshipd", "secure", "add", "arm", "--role", "robot", "--robot", "panda", "--security", security, "--out",
                         self.folder / "arm")
        self.check("kinshipd secure list", "--security", security)

    def test_every_verb_prints_a_document_of_its_schema(self):
        self.check("robots register", PANDA)
        self.check_planning()
        self.check_without_server()
        self.check_distributions()
        self.check_listings()
        self.check_watch()
        self.check_upkeep()
        self.check_store_and_credentials()
        self.assertEqual(verbs_with_json() - self.ran, set(), "verbs with --json that nothing here runs")

    def test_schemas_are_printed_by_the_name_of_their_format(self):
        formats = self.run_program("kinship", "schema").splitlines()
        self.assertEqual(len(formats), len(list(SCHEMAS.iterdir())))
        self.assertIn("kinship.problem/1", formats)
        for name in ("problem", "problem/1", "kinship.problem/1"):
            self.assertEqual(self.run_program("kinship", "schema", name), (SCHEMAS / "problem-1.schema.json").read_text())
        self.run_program("kinship", "schema", "problem/2", code=3)

    def test_what_is_installed_with_the_program_is_found_from_its_place(self):
        prefix = self.folder / "prefix"
        for folder in ("bin", "share/kinship/results", "share/kinship/schemas"):
            (prefix / folder).mkdir(parents=True)
        shutil.copy(BIN / "kinship", prefix / "bin")
        (prefix / "share" / "kinship" / "results" / "compare.py").write_text("print('from here')")
        (prefix / "share" / "kinship" / "schemas" / "own-1.schema.json").write_text("{}")
        for words, told in ((("results", "compare", "a", "b"), "from here\n"), (("schema",), "kinship.own/1\n")):
            self.assertEqual(subprocess.run([prefix / "bin" / "kinship", *words], capture_output=True, text=True).stdout, told)


if __name__ == "__main__":
    unittest.main()
