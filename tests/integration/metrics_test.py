"""What a real kinshipd tells Prometheus, read with Prometheus's own parser; what deploy/ makes of it."""
import contextlib
import json
import os
import pathlib
import re
import subprocess
import time
import unittest
import urllib.request
import uuid

from kinshipd_process import Kinshipd
from prometheus_client.parser import text_string_to_metric_families

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
PROMETHEUS = SOURCE / "deploy" / "prometheus"
READY = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
IDENTITY = [0, 0, 0, 0, 0, 0, 1]


def attempt(number: int, arm: str, checks: int, **changes) -> dict:
    """A sweep of the Panda's hand, a little different for every number."""
    waypoints = [[q + 0.3 * step * (joint == 0) + 0.001 * number for joint, q in enumerate(READY)] for step in range(4)]
    return {"report_uuid": str(uuid.uuid4()), "task": "sweep", "robot": "panda", "machine": "test",
            "T_task_base": IDENTITY, "waypoints": waypoints,
            "record": {"outcome": "solved", "planner": "birrt", "planner_options": "", "planning_time_s": 0.5,
                       "collision_checks": checks + number, "projections": 0, "time_limit_s": 10, "sampling_mode": arm,
                       "share": 0.5 if arm == "guided" else 0}} | changes


def listening_sockets(pid: int) -> "list[str]":
    """TCP sockets of a process that somebody could connect to."""
    mine = set()
    for file in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # closed meanwhile
            mine.update(re.findall(r"socket:\[(\d+)\]", os.readlink(file)))
    rows = [row.split() for table in ("tcp", "tcp6") if pathlib.Path(f"/proc/net/{table}").exists()
            for row in pathlib.Path(f"/proc/net/{table}").read_text().splitlines()[1:]]
    return [row[1] for row in rows if row[3] == "0A" and row[9] in mine]


class Page:
    """One scrape. The parser refuses what is no text format 0.0.4."""

    def __init__(self, text: str):
        self.text = text
        self.families = {}
        for family in text_string_to_metric_families(text):
            # The parser takes _total off the names of counters.
            self.families[family.name + ("_total" if family.type == "counter" else "")] = family
        self.samples = [sample for family in self.families.values() for sample in family.samples]

    def value(self, name: str, **labels: str) -> float:
        found = [sample.value for sample in self.samples if sample.name == name and sample.labels == labels]
        if len(found) != 1:
            raise AssertionError(f"{len(found)} samples of {name} {labels}")
        return found[0]


class WithServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Kinshipd())
        cls.server.start("--metrics", "127.0.0.1:0", "--rehearsal-cpu", "0",
                         "--upstream", "postgresql://127.0.0.1:1/nobody_answers")
        cls.url = re.search(r"metrics at (http://\S+/metrics)", cls.server.log()).group(1)
        cls.run_kinship("robots", "register", str(SOURCE / "robots" / "models" / "panda"))

    @classmethod
    def run_kinship(cls, *arguments: str, code: int = 0) -> str:
        ran = subprocess.run([PROGRAMS / "kinship", *arguments, "--domain", str(cls.server.domain)],
                             capture_output=True, text=True, timeout=120)
        if ran.returncode != code:
            raise AssertionError(f"kinship {arguments}: exit code {ran.returncode}\n{ran.stdout}{ran.stderr}")
        return ran.stdout

    @classmethod
    def import_attempts(cls, attempts: "list[dict]", code: int = 0) -> None:
        file = cls.server.folder / f"{uuid.uuid4()}.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in attempts))
        cls.run_kinship("paths", "import", str(file), code=code)

    @classmethod
    def fetch(cls, task: str, code: int = 0) -> None:
        cls.run_kinship("distributions", "fetch", "--task", task, "--robot", "panda", "--placement",
                        " ".join(map(str, IDENTITY)), "--wait", "60", code=code)

    def scrape(self) -> Page:
        with urllib.request.urlopen(self.url, timeout=20) as reply:
            self.assertEqual(reply.headers["Content-Type"], "text/plain; version=0.0.4; charset=utf-8")
            return Page(reply.read().decode())

    def wait_for(self, is_there, between=lambda: None) -> Page:
        """A page that is as it should be in the end: one is kept for 200 ms, and advice is read in the background."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            page = self.scrape()
            if is_there(page):
                return page
            between()
        raise AssertionError(page.text)


class Numbers(WithServer):
    def test_are_those_of_what_happened(self):
        first = self.scrape()
        self.assertEqual(first.value("kinship_report_attempts_total", receipt="stored"), 0)
        self.assertEqual(first.value("kinship_refusals_total", reason="report_refused"), 0)
        self.assertEqual(first.value("kinship_store_paths"), 0)
        self.fetch("sweep", code=3)  # no experience yet
        self.import_attempts([attempt(i, "guided", 100) for i in range(12)]
                             + [attempt(20 + i, "control", 400) for i in range(12)])
        self.import_attempts([attempt(50, "uniform", 400, waypoints=[[9.0] * 7, READY])], code=1)
        for _ in range(3):
            self.fetch("sweep")
        self.server.stop()  # and from the store, by a new process
        self.server.start("--metrics", "127.0.0.1:0", "--rehearsal-cpu", "0")
        before, self.__class__.url = self.url, re.findall(r"metrics at (http://\S+)", self.server.log())[-1]
        self.assertNotEqual(before, self.url)
        self.fetch("sweep")
        self.fetch("sweep")
        page = self.wait_for(lambda page: "kinship_guidance_cost_ratio{" in page.text, lambda: self.fetch("sweep"))
        pair = {"task": "sweep", "robot": "panda"}
        self.assertEqual(page.value("kinship_guidance_attempts_total", mode="guided", **pair), 12)
        self.assertEqual(page.value("kinship_guidance_solved_total", mode="control", **pair), 12)
        self.assertTrue(2 < page.value("kinship_guidance_cost_ratio", **pair) < 6)
        self.assertGreater(page.value("kinship_guidance_cheaper_probability", **pair), 0.9)
        self.assertGreater(page.value("kinship_guidance_share_ratio", **pair), 0)
        self.assertEqual(page.value("kinship_fetch_latency_seconds_count", outcome="store"), 1)
        self.assertGreaterEqual(page.value("kinship_fetch_latency_seconds_count", outcome="memory"), 1)
        self.assertEqual(page.value("kinship_store_paths"), 24)
        self.assertEqual(page.value("kinship_store_writable"), 1)
        self.assertEqual(page.value("kinship_store_damaged"), 0)
        self.assertEqual(page.value("process_start_time_seconds") > 1.6e9, True)


class Counters(WithServer):
    def test_count_each_report_and_fetch_once(self):
        self.fetch("nothing", code=3)
        self.import_attempts([attempt(i, "uniform", 100) for i in range(6)])
        self.import_attempts([attempt(50, "uniform", 400, waypoints=[[9.0] * 7, READY])], code=1)
        self.fetch("sweep")  # is fitted
        self.fetch("sweep")  # from memory
        page = self.wait_for(lambda page: page.value("kinship_cache_hits_total") > 0)
        self.assertEqual(page.value("kinship_report_attempts_total", receipt="stored"), 6)
        self.assertEqual(page.value("kinship_report_attempts_total", receipt="refused"), 1)
        self.assertEqual(page.value("kinship_refusals_total", reason="report_refused"), 1)
        # A client without an answer for 100 ms asks again, and what was answered already counts again.
        for outcome in ("no_experience", "fitted", "memory"):
            self.assertIn(page.value("kinship_fetch_latency_seconds_count", outcome=outcome), (1, 2), outcome)
        for outcome in ("store", "busy"):
            self.assertEqual(page.value("kinship_fetch_latency_seconds_count", outcome=outcome), 0, outcome)
        for name in ("kinship_transfer_duration_seconds", "kinship_fit_duration_seconds"):
            self.assertEqual(page.value(name + "_count"), 1)
        batches = page.value("kinship_receipt_latency_seconds_count")
        self.assertTrue(2 <= batches <= 7, batches)
        self.assertLess(0, page.value("kinship_receipt_latency_seconds_sum"))
        self.assertEqual(page.value("kinship_cache_hits_total"),
                         page.value("kinship_fetch_latency_seconds_count", outcome="memory"))
        self.assertEqual(page.value("kinship_cache_entries"), 1)
        self.assertGreater(page.value("kinship_store_bytes"), 4096)
        # What this process takes is what the system says of it.
        status = pathlib.Path(f"/proc/{self.server.pid}/status").read_text()
        self.assertEqual(page.value("process_threads"), float(re.search(r"Threads:\s+(\d+)", status).group(1)))
        resident = 1024 * int(re.search(r"VmRSS:\s+(\d+)", status).group(1))
        self.assertLess(abs(page.value("process_resident_memory_bytes") / resident - 1), 0.2)

    def test_break_no_convention(self):
        page = self.scrape()
        self.assertGreater(len(page.families), 50)
        series = [(sample.name, tuple(sorted(sample.labels.items()))) for sample in page.samples]
        self.assertEqual(len(series), len(set(series)))
        for name, family in page.families.items():
            self.assertTrue(family.documentation, name)
            self.assertIn(family.type, ("counter", "gauge", "histogram"), name)
            self.assertIsNone(re.search(r"_(ms|us|mb|kb|percent|minutes)(_|$)", name), name)


class Port(WithServer):
    def test_that_is_taken_stops_a_start_before_there_is_a_store(self):
        store = self.server.folder / "second.db"
        with Kinshipd() as other:
            address = self.url.split("/")[2]
            ran = subprocess.run([PROGRAMS / "kinshipd", "--store", store, "--domain", str(other.domain), "--metrics", address],
                                 capture_output=True, text=True, timeout=60)
        self.assertEqual(ran.returncode, 1)
        self.assertIn(f"metrics cannot be served at {address} (--metrics): Address already in use", ran.stderr)
        self.assertFalse(store.exists())

    def test_is_open_only_where_it_was_asked_for(self):
        self.assertEqual(len(listening_sockets(self.server.pid)), 1)
        with Kinshipd() as other:
            other.start()
            self.assertEqual(listening_sockets(other.pid), [])


def names_in(expression: str) -> "set[str]":
    """Metrics that an expression of PromQL asks for."""
    return set(re.findall(r"\b(?:kinship|process)_[a-z0-9_]+", re.sub(r'"[^"]*"', "", expression)))


class Deployed(WithServer):
    """What deploy/ has for Grafana and Prometheus asks for metrics that there are."""

    def known(self) -> "set[str]":
        known = set()
        for name, family in self.scrape().families.items():
            known.update([name + suffix for suffix in ("_bucket", "_sum", "_count")] if family.type == "histogram" else [name])
        return known

    def test_the_dashboard(self):
        dashboard = json.loads((SOURCE / "deploy" / "grafana" / "kinship.json").read_text())
        panels = [panel for panel in dashboard["panels"] if panel["type"] != "row"]
        rows = [panel["title"] for panel in dashboard["panels"] if panel["type"] == "row"]
        self.assertEqual(rows, ["Fleet", "Worth of guidance", "Latency", "Queues and memory", "Store", "Refusals"])
        self.assertEqual(len({panel["id"] for panel in dashboard["panels"]}), len(dashboard["panels"]))
        self.assertEqual(dashboard["templating"]["list"][0]["type"], "datasource")
        asked, known = set(), self.known()
        for panel in panels:
            self.assertTrue(panel["title"] and panel["description"], panel["title"])
            self.assertTrue(panel["targets"], panel["title"])
            self.assertEqual(panel["datasource"], {"type": "prometheus", "uid": "${datasource}"}, panel["title"])
            for target in panel["targets"]:
                names = names_in(target["expr"])
                self.assertTrue(names, target["expr"])
                self.assertEqual(names - known, set(), panel["title"])
                asked |= names
        self.assertGreater(len(asked), 30)

    def test_the_rules(self):
        text = (PROMETHEUS / "kinship.rules.yml").read_text()
        expressions = re.findall(r"^ +expr: (.+)$", text, re.MULTILINE)
        self.assertGreater(len(expressions), 5)
        self.assertEqual(len(expressions), text.count("- alert:"))
        for expression in expressions:
            self.assertTrue(names_in(expression) or "up{" in expression, expression)
            self.assertEqual(names_in(expression) - self.known(), set(), expression)

    def test_the_handbook_names_each_of_them(self):
        text = (SOURCE / "docs" / "operations.md").read_text()
        named = set(re.findall(r"`((?:kinship|process)_[a-z0-9_]+)", text))
        self.assertEqual({name for name in self.scrape().families} - named, set())
        self.assertEqual(named - set(self.scrape().families), set())


if __name__ == "__main__":
    unittest.main()
