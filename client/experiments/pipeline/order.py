"""Orders: a robot's queries one after another from an empty store, each reported, beside the same queries planned uniformly."""
import contextlib
import dataclasses
import os
import pathlib
import time
from collections.abc import Iterator, Sequence
from typing import Any

import kinship

from kinship_results.formats import in_format

from .files import LineFile, to_line
from .learning import SHORTCUT_CHECKS, running_kinshipd
from .parallel import Progress
from .study import Instance, Study

_NOTHING_YET = (kinship.NoExperience, kinship.NotReady, kinship.FitFailed)


@dataclasses.dataclass(frozen=True)
class OrderOptions:
    """What is ordered of each study."""

    robots: Sequence[str]  # by label, each with orders of its own
    seeds: Sequence[int]  # 1, 2, ...: an order for each
    queries: int = 100
    ask: int = 10  # guidance is asked for anew after so many reports
    pause_s: float = 0  # from a query to the next
    rehearsed: bool = False  # a rehearsal is waited for whenever guidance is asked for


@dataclasses.dataclass(frozen=True)
class Order:
    """The queries of one robot at a study's task."""

    study: Study
    robot: int
    seed: int

    @property
    def name(self) -> str:
        return f"{self.study.name}-{self.study.fleet[self.robot].label}-{self.seed}"

    def instances(self, queries: int) -> list[Instance]:
        """Seeds share none, nor do they share one with other sets of the study."""
        return self.study.instances(self.robot, "order", self.seed * queries)[-queries:]


class Customer:
    """A robot's program beside its planning: it asks for guidance every so often and reports each attempt."""

    def __init__(self, client: kinship.Client, order: Order, wanted: OrderOptions) -> None:
        self._client, self._wanted, self._reports = client, wanted, 0
        self._task, self._member = order.study.name, order.study.fleet[order.robot]
        self._start = order.study.usual_start(order.robot)
        self.guidance: kinship.Guidance | None = None
        client.register(self._member.robot)

    def ask(self) -> str:
        """Before a query. Returns what the server said, or nothing if it was not asked."""
        if self._reports % self._wanted.ask != 0:
            return ""
        try:
            self.guidance = self._client.guidance(self._task, self._member.robot, T_task_base=self._member.T_task_base, start=self._start,
                                                   rehearsed=self._wanted.rehearsed, deadline=3600 if self._wanted.rehearsed else 30)
        except _NOTHING_YET as error:
            return str(error)
        return self.guidance.message

    def report(self, plan: kinship.Plan) -> None:
        """Returns when the server has the attempt."""
        self._client.report(plan.attempt(self._task, "order"))
        left = self._client.flush()
        if left.pending or left.refused:
            raise ConnectionError(f"the server did not take an attempt: {left.problem}")
        self._reports += 1


def run_orders(studies: Sequence[Study], wanted: OrderOptions) -> list[dict[str, Any]]:
    """Plans each order with a server of its own. Returns a row for each query; order.jsonl has them, too.

    Raises FileExistsError if the folder has one, LookupError for an unknown robot.
    """
    options = studies[0].options
    file = options.folder / "order.jsonl"
    if file.exists():
        raise FileExistsError(f"'{file}' is there already: name another folder")
    orders = [Order(study, study.index_of(label), seed) for study in studies for label in wanted.robots for seed in wanted.seeds]
    options.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    progress = Progress("orders", len(orders) * wanted.queries)
    with contextlib.closing(LineFile(file, [])) as lines:
        for order in orders:
            for row in run_order(order, wanted):
                lines.add(to_line(in_format("order-query", row)))
                rows.append(row)
                progress.advance()
    progress.finish()
    return rows


def run_order(order: Order, wanted: OrderOptions) -> Iterator[dict[str, Any]]:
    """Plans the queries from an empty store; each guided and uniformly in turn, one or the other first."""
    study, member = order.study, order.study.fleet[order.robot]
    options = study.plan_options(shortcut_checks=SHORTCUT_CHECKS)
    folder = study.options.folder / order.name
    folder.mkdir()
    [warm_up] = study.instances(order.robot, "calibration", 1)
    kinship.plan(member.robot, warm_up.problem, **options)
    with running_kinshipd(study.options, folder / "experience.db", tuned=False) as server, \
            kinship.Client(domain=study.options.domain, outbox=folder / "outbox", timeout=120) as client:
        customer = Customer(client, order, wanted)
        for index, instance in enumerate(order.instances(wanted.queries)):
            begin = time.process_time()
            told = customer.ask()
            asked = time.process_time()
            ways = {"uniform": None, "guided": customer.guidance}
            plans = {way: kinship.plan(member.robot, instance.problem, ways[way], **options) for way in sorted(ways, reverse=index % 2 == 0)}
            planned = time.process_time()
            customer.report(plans["guided"])
            line_s = asked - begin + time.process_time() - planned
            yield {"study": study.name, "robot": member.label, "seed": order.seed, "query": index, "instance": instance.name, "told": told,
                   "line_s": line_s, "server_s": processor_time_s(server)} | {way: outcome(plan) for way, plan in plans.items()}
            time.sleep(wanted.pause_s)


def outcome(plan: kinship.Plan) -> dict[str, Any]:
    """Of a query, as its row tells it."""
    return {"solved": plan.solved, "cpu_s": plan.processor_time_s, "checks": plan.collision_checks, "length": plan.path_length or 0.0,
            "hand_length": plan.hand_length, "clearance": plan.least_clearance, "mode": plan.sampling_mode,
            "guide": plan.guide, "found_by": plan.found_by, "recall_tries": plan.recall_tries}


def processor_time_s(process: int) -> float:
    """Of a process so far."""
    fields = pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
