"""What each robot of a study learned, and the server that is told of it."""
import contextlib
import ctypes
import hashlib
import json
import pathlib
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence

import kinship
import numpy as np

from .files import LineFile, compress_file, expand_file, to_line, write_whole
from .parallel import for_each
from .cells import DistributionRequest
from .study import Instance, Member, RunOptions, Study

SHORTCUT_CHECKS = 300  # of a path that is learned
_DECIMALS = 6  # of waypoints: far below what the resolution of checks can tell


def uuid_of(task: str, who: str, index: int) -> str:
    """A report's UUID that follows from what is reported: version 8 of RFC 9562."""
    digest = hashlib.sha256()
    for text in (task.encode(), who.encode()):
        digest.update(len(text).to_bytes(8, "little") + text)
    digest.update(index.to_bytes(8, "little"))
    number = bytearray(digest.digest()[:16])
    number[6] = number[6] & 0x0F | 0x80
    number[8] = number[8] & 0x3F | 0x80
    text = number.hex()
    return "-".join((text[:8], text[8:12], text[12:16], text[16:20], text[20:]))


class LearningSet:
    """One attempt per learning instance of a robot, solved or not: planned uniformly with overshoot 1, then shortened.

    The file is an experience file that `kinship paths import` reads; instances that it has are not planned again. Raises ValueError
    that names the file if it holds attempts of something else.
    """

    def __init__(self, study: Study, robot: int, folder: pathlib.Path) -> None:
        self._study, self._member, self._robot = study, study.fleet[robot], robot
        self._file = folder / (self._member.label + ".jsonl")
        self._lines: dict[int, str] = {}
        if expand_file(self._file):
            self._read()

    def _read(self) -> None:
        count = max(100_000, self._study.learning_instances)
        indices = {uuid_of(self._study.name, self._member.label, index): index for index in range(count)}
        for number, line in enumerate(self._file.read_text(encoding="utf-8").splitlines(), 1):
            try:
                document = json.loads(line)
            except ValueError:
                return  # an interruption cut it off
            if "report_uuid" not in document:
                continue
            index = indices.get(document["report_uuid"])
            if index is None or document["robot"] != self._member.robot.digest:
                raise ValueError(f"'{self._file}' line {number} is no attempt of study '{self._study.name}' by robot "
                                 f"'{self._member.label}' as they are now")
            self._lines[index] = line

    def record(self, threads: int, recorded: Callable[[], None]) -> list[str]:
        """Plans what is missing, compresses the file. Returns the lines of the attempts."""
        count = self._study.learning_instances
        instances = self._study.instances(self._robot, "learning", count)
        kinship.write_experience(self._file, [], [self._member.robot])
        head = self._file.read_text(encoding="utf-8").splitlines()
        file = LineFile(self._file, head + [self._lines[index] for index in sorted(self._lines)])

        def plan(index: int) -> None:
            if index not in self._lines:
                line = self._plan(index, instances[index])
                file.add(line)
                self._lines[index] = line
            recorded()

        with contextlib.closing(file):
            for_each(threads, range(count), plan)
        write_whole(self._file, "".join(line + "\n" for line in head + [self._lines[index] for index in sorted(self._lines)]).encode())
        compress_file(self._file)
        return [self._lines[index] for index in range(count)]

    def _plan(self, index: int, instance: Instance) -> str:
        options = self._study.plan_options(overshoot=1, shortcut_checks=SHORTCUT_CHECKS)
        plan = kinship.plan(self._member.robot, instance.problem, **options)
        document = json.loads(plan.attempt(self._study.name, "experiments").to_json())
        document["report_uuid"] = uuid_of(self._study.name, self._member.label, index)
        if plan.waypoints is not None:
            rounded = np.round(plan.waypoints, _DECIMALS)
            document["waypoints"] = rounded.clip(self._member.robot.lower, self._member.robot.upper).tolist()
        return to_line(document)


def renamed(lines: Sequence[str], task: str, count: int) -> list[str]:
    """The first `count` attempts under another task, with UUIDs of their own."""
    documents = [json.loads(line) for line in lines[:count]]
    return [to_line(document | {"report_uuid": uuid_of(task, document["report_uuid"], index), "task": task})
            for index, document in enumerate(documents)]


def end_with_parent() -> None:
    """In a child: it ends with the thread that started it, however that ends."""
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)


@contextlib.contextmanager
def running_kinshipd(options: RunOptions, store: pathlib.Path, *, tuned: bool = True) -> Iterator[int]:
    """A kinshipd of the run's own, which serves; its process.

    tuned: it takes the run's threads and does not step back for others; otherwise as users have it. Raises FileNotFoundError without
    the program, ConnectionError if it does not serve.
    """
    if not options.kinshipd.exists():
        raise FileNotFoundError(f"no kinshipd at '{options.kinshipd}': give --kinshipd PATH")
    log = store.with_name(store.name + ".log")
    with log.open("ab") as messages:
        more = ["--workers", str(options.threads), "--fit-niceness", "0"] if tuned else []
        process = subprocess.Popen([options.kinshipd, "--store", store, "--domain", str(options.domain), *more],
                                   stdout=subprocess.PIPE, stderr=messages, preexec_fn=end_with_parent)
    with process:
        try:
            if not process.stdout.readline().startswith(b"ready "):
                raise ConnectionError(f"{options.kinshipd} does not serve: ended with {process.wait()}, see '{log}'")
            yield process.pid
        finally:
            process.terminate()


class Server:
    """The line to the run's kinshipd."""

    def __init__(self, client: kinship.Client, study: Study) -> None:
        self._client, self._study, self._fleet = client, study, study.fleet
        for member in self._fleet:
            client.register(member.robot)

    def report(self, lines: Sequence[str]) -> None:
        """Returns when the server has every attempt, once. Raises ValueError that names the attempt which is refused."""
        for receipt in self._client.deliver([kinship.Attempt.from_json(line) for line in lines]):
            if receipt.status not in ("stored", "duplicate", "recorded"):
                raise ValueError(f"the server did not take attempt {receipt.report_uuid}: {receipt.message}")

    def fetch(self, request: DistributionRequest) -> kinship.Distribution | None:
        """What the server made of the sources' experience; None, and why on standard error, if nothing."""
        member = self._fleet[request.target]
        try:
            distribution = self._client.fetch(request.task, member.robot, **self._asked(request))
        except kinship.FitFailed as error:
            print(f"no distribution for {member.label}: {error}", file=sys.stderr)
            return None
        made = distribution.provenance
        told = " ".join(f"{source['label']} ({source['paths']} paths, {source['poses_solved']} of {source['poses']} poses)"
                        for source in made["sources"])
        print(f"distribution {distribution.id[:12]} for {member.label}: {told}, {distribution.configurations} configurations, "
              f"transfer {made['transfer_time_s']:.3g} s, fit {made['fit_time_s']:.3g} s", file=sys.stderr, flush=True)
        return distribution

    def guidance(self, request: DistributionRequest, guide: str | None, share: float) -> kinship.Guidance | None:
        """guide: missing: what the server finds by rehearsal, which is waited for. None: there is not what the guide needs."""
        member = self._fleet[request.target]
        guidance = self._client.guidance(request.task, member.robot, **self._asked(request), guide=guide or "", share=share, control_share=0,
                                         rehearsed=guide is None, start=self._study.usual_start(request.target))
        parts = guidance.guide.split("+")
        if ("mixture" in parts and guidance.distribution_id is None) or ("ways" in parts and not guidance.ways):
            return None
        return guidance

    def _asked(self, request: DistributionRequest) -> dict[str, object]:
        return {"deadline": 3600, "T_task_base": self._fleet[request.target].T_task_base, "profile": request.profile,
                "sources": [self._fleet[source].robot for source in request.sources]}
