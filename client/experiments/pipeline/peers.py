"""Experience planners of OMPL with the robot's own learning set, each in a process of its own in case OMPL's databases crash."""
import dataclasses
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from typing import Any

from .cells import QueryPlan, cell_name, row_of
from .files import Key, QueryLog
from .parallel import for_each
from .study import Study

NAME = "peers"
PURPOSE = ("experience planners of OMPL 1.5 with the robot's own learning set. They plan from scratch in a second thread: both threads "
           "ask by turns until one has a path, and the checks of both count, or those of the thread that has it")
# By name, as kinship-experiments --peer has them: as they come, and with a range tuned by hand.
PEERS = {"Lightning": "lightning", "Thunder": "thunder", "Lightning, range 0.5": "lightning:0.5", "Thunder, range 0.5": "thunder:0.5"}


@dataclasses.dataclass(frozen=True)
class Half:
    """What half of a peer costs by itself, until it has a path or gives up."""

    solved: bool
    checks: int
    cpu_s: float = 0.0
    length: float = 0.0


def both_threads(recall: Half, scratch: Half, max_checks: int) -> Half:
    """Two threads ask by turns, and the query ends when one has a path; max_checks: of both together, more is unsolved."""
    winner, other = _by_turns(recall, scratch)
    checks = winner.checks + min(other.checks, winner.checks)
    spent = 1.0 if other.checks <= winner.checks else winner.checks / other.checks
    solved = winner.solved and checks <= max_checks
    return Half(solved, checks if solved else max_checks, winner.cpu_s + spent * other.cpu_s, winner.length)


def faster_thread(recall: Half, scratch: Half, max_checks: int) -> Half:
    """The same, but only the checks of the thread that has the path: as if the other were free."""
    winner, _ = _by_turns(recall, scratch)
    return winner if winner.solved else dataclasses.replace(winner, checks=max_checks)


def _by_turns(recall: Half, scratch: Half) -> tuple[Half, Half]:
    recalled = recall.solved and (not scratch.solved or recall.checks <= scratch.checks)
    return (recall, scratch) if recalled else (scratch, recall)


def variants_of(peer: str) -> list[str]:
    """What one peer's queries are results of: both threads, the faster one, and of Lightning's also its planning from scratch."""
    variants = [f"{peer}: both threads", f"{peer}: the faster thread alone"]
    if peer.startswith("Lightning"):
        variants.append("RRTConnect of OMPL" + peer.removeprefix("Lightning"))
    return variants


class _Batch:
    """One robot and one peer, over as many processes as it takes."""

    def __init__(self, study: Study, robot: int, peer: str, log: QueryLog) -> None:
        self._study, self._label, self._peer, self._log = study, study.fleet[robot].label, peer, log
        self._limit = study.description["max_checks"]

    def run(self, lessons: str, queries: dict[tuple[str, int], str]) -> str:
        """queries: lines of problems by instance and seed. Returns what became of it, for people."""
        text = f"{self._label}, {self._peer}: "
        open_ones = self._open(queries)
        if not open_ones:
            return text + "nothing to do"
        crashes = 0
        while open_ones:
            learned, end = self._run_process(lessons, [(each, queries[each]) for each in open_ones])
            if not learned:
                return text + f"no results, its process ended while learning ({end})"
            text += learned if crashes == 0 else ""
            open_ones = self._open(queries)
            if open_ones:
                crashes += 1
                text += f"; {open_ones[0][0]} ended the process ({end})"
                lost = Half(False, self._limit)
                self._add(open_ones.pop(0), lost, lost)
        return text

    def _key(self, query: tuple[str, int], variant: str) -> Key:
        return self._label, cell_name(self._label, variant), *query

    def _open(self, queries: dict[tuple[str, int], str]) -> list[tuple[str, int]]:
        return [query for query in queries
                if not all(self._log.has(self._key(query, variant), None) for variant in variants_of(self._peer))]

    def _add(self, query: tuple[str, int], recall: Half, scratch: Half) -> None:
        values = (both_threads(recall, scratch, self._limit), faster_thread(recall, scratch, self._limit), scratch)
        for variant, value in zip(variants_of(self._peer), values):
            self._log.add(row_of(self._key(query, variant), solved=value.solved, checks=value.checks, cpu_s=value.cpu_s,
                                 length=value.length if value.solved else 0))

    def _run_process(self, lessons: str, queries: Sequence[tuple[tuple[str, int], str]]) -> tuple[str, str]:
        """Returns what it told of the learning set, "" if nothing, and how it ended."""
        command = self._study.command("--problems", self._label, "--peer", PEERS[self._peer])
        with tempfile.TemporaryFile("w+") as asked:
            asked.write(lessons + "\n" + "".join(line + "\n" for _, line in queries))
            asked.seek(0)
            process = subprocess.Popen(command, stdin=asked, stdout=subprocess.PIPE, text=True)
        with process:
            # OMPL prints, too; what a crash cut off is no line.
            lines = (json.loads(line) for line in process.stdout if line.startswith("{") and line.endswith("\n"))
            learned = next(lines, {}).get("learned", "")
            for (query, _), halves in zip(queries, lines):
                self._add(query, Half(**halves["recall"]), Half(**halves["scratch"]))
        return learned, f"signal {-process.returncode}" if process.returncode < 0 else f"exit code {process.returncode}"


def run_peers(study: Study, learning_sets: Sequence[Sequence[str]], plan: QueryPlan, log: QueryLog) -> None:
    """Plans what is not in the log yet: each robot with each peer, which learns nothing from queries.

    The query under way when a process crashes counts as unsolved, and the next process goes on after it; a peer that crashes while
    learning has no results. learning_sets: by robot, a line for each learning instance in order.
    """
    lessons, queries = [], []
    for robot, lines in enumerate(learning_sets):
        instances = study.instances(robot, "learning", len(lines))
        waypoints = [json.loads(line).get("waypoints") for line in lines]
        lessons.append("".join(json.dumps({"problem": json.loads(instance.line), "waypoints": path}) + "\n"
                               for instance, path in zip(instances, waypoints) if path))
        queries.append({(instance.name, seed): _with_seed(json.loads(instance.line), seed)
                        for instance in study.instances(robot, plan.which, plan.instances) for seed in range(plan.seeds)})

    def work(robot_and_peer: tuple[int, str]) -> None:
        robot, peer = robot_and_peer
        text = _Batch(study, robot, peer, log).run(lessons[robot], queries[robot])
        print(f"{study.name}: peers: {text}", file=sys.stderr, flush=True)

    for_each(plan.threads, [(robot, peer) for robot in range(len(study.fleet)) for peer in PEERS], work)


def _with_seed(problem: dict[str, Any], seed: int) -> str:
    return json.dumps(problem | {"seed": (problem["seed"] + seed) % 2**64})
