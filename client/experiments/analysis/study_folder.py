"""The files of a study: its description, results, distributions and runs."""
import dataclasses
import io
import json
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import zstandard

from kinship_results.formats import checked


@dataclasses.dataclass(frozen=True)
class Cell:
    """The queries of one robot with one guidance: instances x seeds."""

    robot: str
    guidance: str
    instances: tuple[str, ...]  # ascending
    checks: np.ndarray  # collision checks; of an unsolved query the limit
    cpu_s: np.ndarray  # time of the planning thread
    solved: np.ndarray
    lengths: np.ndarray  # of paths, joint units; NaN if unsolved
    gated: np.ndarray | None = None  # 1 where the gate sent a guided query to uniform planning; NaN: not recorded
    shares: np.ndarray | None = None  # of guided samples; NaN: not recorded
    hand_lengths: np.ndarray | None = None  # the hand's ways, m; NaN: unsolved or not recorded, as below
    clearances: np.ndarray | None = None  # the least on each path, m

    def solved_text(self) -> str:
        return f"{int(self.solved.sum())}/{self.solved.size}"


Cells = dict[tuple[str, str], Cell]  # by robot and guidance, in the order of the file


class StudyFolder:
    """Reads what a run wrote. A file may be there as it is or compressed (.zst).

    Raises FileNotFoundError or ValueError that names the file.
    """

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder = folder
        # Name, robots, settings and side studies, as the program had them (pipeline/runs.py).
        self.study: dict[str, Any] = checked(json.loads((folder / "study.json").read_text(encoding="utf-8")), "study")
        self.robots: list[str] = [robot["label"] for robot in self.study["robots"]]
        self.labels: dict[str, str] = {robot["digest"]: robot["label"] for robot in self.study["robots"]}

    def has(self, name: str) -> bool:
        return any((self.folder / file).exists() for file in (name, name + ".zst"))

    def lines(self, name: str, *formats: str) -> Iterator[dict[str, Any]]:
        """The JSON documents of a file, one a line, of these formats; of queries if none is named."""
        file = self.folder / name
        if not file.exists() and self.has(name):
            file = self.folder / (name + ".zst")
        with file.open("rb") as stream:
            raw = zstandard.ZstdDecompressor().stream_reader(stream) if file.suffix == ".zst" else stream
            number = 0
            try:
                with io.TextIOWrapper(raw, encoding="utf-8") as text:
                    for number, line in enumerate(text, 1):
                        yield checked(json.loads(line), *(formats or ("study-query",)))
            except ValueError as error:
                raise ValueError(f"'{file}' line {number}: {error}") from error
            except zstandard.ZstdError as error:
                raise ValueError(f"'{file}': {error}") from error

    def cells(self, name: str) -> Cells:
        """The results in a log. A query that is there twice counts as it was answered last."""
        grouped: dict[tuple[str, str], dict[tuple[str, int], dict[str, Any]]] = {}
        for row in self.lines(name):
            queries = grouped.setdefault((row["robot"], row["guidance"]), {})
            queries[row["instance"], row["seed"]] = row
        return {key: self._cell(key, queries) for key, queries in grouped.items()}

    def _cell(self, key: tuple[str, str], queries: dict[tuple[str, int], dict[str, Any]]) -> Cell:
        instances = sorted({instance for instance, _ in queries})
        seeds = sorted({seed for _, seed in queries})
        if len(queries) != len(instances) * len(seeds):
            raise ValueError(f"'{self.folder}': {key[0]} guided by '{key[1]}' lacks queries: go on with --resume")
        limit = self.study["max_checks"]

        def table(value_of: Any) -> np.ndarray:
            return np.array([[value_of(queries[instance, seed]) for seed in seeds] for instance in instances])

        return Cell(*key, tuple(instances),
                    checks=table(lambda row: float(row["checks"] if row["solved"] else limit)),
                    cpu_s=table(lambda row: row["cpu_s"]),
                    solved=table(lambda row: row["solved"]),
                    lengths=table(lambda row: row["length"] if row["solved"] else np.nan),
                    gated=table(lambda row: float(row.get("gate_fired", np.nan))),
                    shares=table(lambda row: float(row.get("guided_share", np.nan))),
                    hand_lengths=table(lambda row: np.float64(row.get("hand_length"))),
                    clearances=table(lambda row: np.float64(row.get("clearance"))))
