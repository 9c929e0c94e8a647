"""A study from end to end: its files, learning sets, server, queries and report."""
import contextlib
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any

import kinship

from kinship_results.formats import in_format

from . import peers
from .cells import Cell, DistributionRequest, QueryPlan, run_queries, uniform_cell, uniform_cells, uniform_name
from .files import QueryLog, compress_file, to_line, write_whole
from .learning import LearningSet, Server, renamed, running_kinshipd
from .parallel import Progress
from .side_studies import RequestedCell, SideStudy, find_side_study, side_studies
from .study import QUICK_INSTANCES, RunOptions, Study

OTHER_ROBOTS = "others"  # as a source of a tuning run: all robots but the one that plans, together
_PYTHON = "/usr/bin/python3"  # Debian's, for which the packages are


@dataclasses.dataclass(frozen=True)
class TuningOptions:
    """What is tried on tuning instances; None: as the study has it."""

    profile: str = "default"
    overshoot: float | None = None
    share: float = 1.0  # of guided samples
    guide: str | None = None  # None: what the server finds by rehearsal
    instances: int = 30
    seeds: int = 2
    robots: Sequence[str] = ()  # that plan, by label; none: all
    sources: Sequence[str] = ()  # or OTHER_ROBOTS; none: each robot by itself


class StudyRun:
    """A study in its folder. Raises FileExistsError if the folder is there and `resumes` is not set."""

    def __init__(self, study: Study, *, resumes: bool) -> None:
        self.study, self.options = study, study.options
        learning = f"-{self.options.learning}" if self.options.learning else ""
        self.folder = self.options.folder / (study.name + learning + ("-quick" if self.options.quick else ""))
        self._learning_sets: list[list[str]] = []
        self._resumes = resumes

    def begin(self) -> None:
        """Makes the folder."""
        if not self._resumes and self.folder.exists():
            raise FileExistsError(f"'{self.folder}' is there already: go on with --resume, or name another folder")
        for name in ("learning", "store"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)

    def record(self) -> list[list[str]]:
        """Learning sets by robot; what is missing of them is planned."""
        progress = Progress(f"{self.study.name}: learning sets", len(self.study.fleet) * self.study.learning_instances)
        sets = [LearningSet(self.study, robot, self.folder / "learning").record(self.options.threads, progress.advance)
                for robot in range(len(self.study.fleet))]
        progress.finish()
        return sets

    @contextlib.contextmanager
    def learned(self, shortened: dict[str, int]) -> Iterator[Server]:
        """The run's kinshipd with all learning sets; and with their first attempts under other tasks."""
        sets = self.record()
        with running_kinshipd(self.options, self.folder / "store" / "experience.db"), \
                kinship.Client(domain=self.options.domain, has_outbox=False, timeout=120) as client:
            server = Server(client, self.study)
            for lines in sets:
                server.report(lines)
            for task, count in shortened.items():
                for lines in sets:
                    server.report(renamed(lines, task, count))
            yield server

    def test_plan(self) -> QueryPlan:
        if self.options.quick:
            return QueryPlan("test", QUICK_INSTANCES, 1, self.options.threads)
        return QueryPlan("test", self.study.description["test_instances"], self.study.description["test_seeds"], self.options.threads)

    def plan(self, stage: str, cells: Sequence[Cell], plan: QueryPlan, log: QueryLog) -> None:
        progress = Progress(f"{self.study.name}: {stage}", len(cells) * plan.instances * plan.seeds)
        run_queries(self.study, cells, plan, log, progress.advance)
        progress.finish()

    @contextlib.contextmanager
    def logged(self, name: str, side: str = "") -> Iterator[QueryLog]:
        """The log of this name, compressed in the end, and a line in runs.jsonl of what was planned."""
        begin, clock = time.time(), time.monotonic()
        with contextlib.closing(QueryLog(self.folder / (name + ".jsonl"))) as log:
            known = len(log.rows)
            yield log
            planned = len(log.rows) - known
        record = {"begun_s": int(begin), "commit": _commit(), "machine": _machine(), "study": self.study.name} | (
            {"side": side} if side else {}) | {"planned": planned, "duration_s": time.monotonic() - clock}
        with (self.folder / "runs.jsonl").open("a", encoding="utf-8") as runs:
            runs.write(json.dumps(in_format("study-run", record), separators=(",", ":")) + "\n")
        compress_file(self.folder / (name + ".jsonl"))

    def analyse(self, *words: str) -> None:
        """Raises RuntimeError that says how to have it done."""
        known = self.study.description
        first = ("study", "purpose", "family")
        told = {name: known[name] for name in first if name in known} | {"uniform": uniform_name(known["overshoot"])} | {
            name: value for name, value in known.items() if name not in first + ("robots",)} | {
            "learning_instances": self.study.learning_instances,
            "side_studies": [{"name": name, "purpose": side.purpose} for name, side in side_studies(self.study).items()],
            "robots": known["robots"]}
        write_whole(self.folder / "study.json", (to_line(in_format("study", told)) + "\n").encode())
        analyse(self.options, self.folder, *words)


def analyse(options: RunOptions, folder: pathlib.Path, *words: str) -> None:
    """Has tables and figures made. Raises RuntimeError that says how to have it done."""
    command = [_PYTHON, str(options.analysis), str(folder), *words]
    sys.stdout.flush()
    if subprocess.run(command).returncode != 0:
        raise RuntimeError("the results are not analysed; to have it done: " + " ".join(command))


def report_study(run: StudyRun) -> None:
    run.analyse()
    print(f"{run.study.name}: {run.folder / 'RESULTS.md'}", file=sys.stderr, flush=True)


def _try_to_report(run: StudyRun) -> None:
    """The results are there, with or without a report."""
    try:
        report_study(run)
    except RuntimeError as error:
        print(f"{run.study.name}: {error}", file=sys.stderr, flush=True)


def run_study(study: Study) -> None:
    """The frozen study on its test instances: learning sets, distributions, queries, report."""
    run = StudyRun(study, resumes=study.options.resume)
    run.begin()
    with run.learned({}) as server, run.logged("test") as log:
        cells, distributions = [], []
        for target in range(len(study.fleet)):
            cells += uniform_cells(study, target, study.description["overshoot"])
            for source, member in enumerate(study.fleet):
                request = DistributionRequest(study.name, target, (source,))
                if distribution := server.fetch(request):
                    distributions.append(distribution.to_json() + "\n")
                    cells += _guided(server, request, None, study.description["guided_share"],
                                     Cell(target, member.label, study.plan_options()))
        write_whole(run.folder / "distributions.jsonl", "".join(distributions).encode())
        run.plan("test", cells, run.test_plan(), log)
    compress_file(run.folder / "distributions.jsonl")
    _try_to_report(run)


def _guided(server: Server, request: DistributionRequest, guide: str | None, share: float, cell: Cell) -> list[Cell]:
    """The cell with its guidance; none if there is not what the guide needs."""
    guidance = server.guidance(request, guide, share)
    return [dataclasses.replace(cell, guidance=guidance)] if guidance else []


def run_side_study(study: Study, name: str) -> None:
    """Plans the cells of a side study on the test instances of a study that was run before, and writes the report again.

    Uniform cells are planned beside them, so that both had the same load; a server is started only if there is something to fetch.
    """
    side = find_side_study(study, name)
    run = StudyRun(study, resumes=True)
    run.begin()
    with run.logged(name, name) as log:
        if name == peers.NAME:
            peers.run_peers(study, run.record(), run.test_plan(), log)
        else:
            run.plan(name, _side_cells(run, side), run.test_plan(), log)
    _try_to_report(run)


def _side_cells(run: StudyRun, side: SideStudy) -> list[Cell]:
    study = run.study
    cells = [uniform_cell(study, robot, study.description["overshoot"]) for robot in range(len(study.fleet))]
    requested = side.cells(study)
    if all(each.request is None for each in requested):
        return cells + [_unguided(study, each) for each in requested]
    with run.learned(side.shortened(study)) as server:
        for each in requested:
            if each.request is None:
                cells.append(_unguided(study, each))
            elif server.fetch(each.request):
                cells += _guided(server, each.request, each.guide, each.share, _unguided(study, each))
    return cells


def _unguided(study: Study, requested: RequestedCell) -> Cell:
    return Cell(requested.robot, requested.name, study.plan_options(**requested.options), oracle_deviation=requested.oracle_deviation)


def tune_study(study: Study, tuning: TuningOptions) -> None:
    """Plans tuning instances, never test instances; what guidance was worth goes to standard output.

    Learning sets, store and results of earlier tries in the folder are used again.
    """
    run = StudyRun(study, resumes=True)
    run.begin()
    overshoot = tuning.overshoot or study.description["overshoot"]
    cells: list[Cell] = []
    pairs: list[dict[str, Any]] = []
    with run.learned({}) as server:
        for target in [study.index_of(label) for label in tuning.robots] or range(len(study.fleet)):
            label = study.fleet[target].label
            cells += uniform_cells(study, target, overshoot)
            for name, sources in _named_sources(study, tuning.sources, target):
                request = DistributionRequest(study.name, target, sources, tuning.profile)
                distribution = server.fetch(request)
                if distribution is None:
                    continue
                # The distribution stands for profile, engines and experience.
                cell_name = (f"{name} {tuning.profile} {distribution.id[:12]} r{distribution.revision} f{overshoot:g} s{tuning.share:g} "
                             f"{tuning.guide or 'rehearsed'}")
                guided = _guided(server, request, tuning.guide, tuning.share,
                                 Cell(target, cell_name, study.plan_options(overshoot=overshoot)))
                cells += guided
                pairs += [{"robot": label, "source": name, "guidance": cell.name} for cell in guided]
        with contextlib.closing(QueryLog(run.folder / "tuning.jsonl")) as log:
            run.plan("tuning", cells, QueryPlan("tuning", tuning.instances, tuning.seeds, study.options.threads), log)
    told = {"uniform": uniform_name(overshoot), "pairs": pairs}
    write_whole(run.folder / "tuning.json", (json.dumps(in_format("study-tuning", told), indent=1) + "\n").encode())
    run.analyse("--tuning")


def _named_sources(study: Study, labels: Sequence[str], target: int) -> list[tuple[str, tuple[int, ...]]]:
    """Experience of one or several robots, by the name that the table of a tuning run gives it."""
    others = tuple(robot for robot in range(len(study.fleet)) if robot != target)
    return [(label, others if label == OTHER_ROBOTS else (study.index_of(label),))
            for label in labels or [member.label for member in study.fleet]]


def calibrate_study(study: Study, instances: int) -> None:
    """Plans calibration instances uniformly; what they cost beside the paper's figures goes to standard output."""
    run = StudyRun(study, resumes=True)
    run.begin()
    with contextlib.closing(QueryLog(run.folder / "calibration.jsonl")) as log:
        cells = [uniform_cell(study, robot, 1) for robot in range(len(study.fleet))]
        run.plan("calibration", cells, QueryPlan("calibration", instances, 1, study.options.threads), log)
    compress_file(run.folder / "calibration.jsonl")
    run.analyse("--calibration")


def _first_line(*command: str) -> str:
    try:
        lines = subprocess.run(command, capture_output=True, text=True).stdout.splitlines()
    except FileNotFoundError:
        return ""
    return lines[0] if lines else ""


def _commit() -> str:
    commit = _first_line("git", "rev-parse", "--short=12", "HEAD")
    changed = "+" if commit and _first_line("git", "status", "--porcelain", "--untracked-files=no") else ""
    return commit + changed or "unknown"


def _machine() -> str:
    lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    names = [line.split(": ", 1)[1] for line in lines if line.startswith("model name") and ": " in line]
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores"
