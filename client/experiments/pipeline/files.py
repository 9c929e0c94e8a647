"""The files of a run: lines that stay when it is interrupted, and their compressed twins."""
import json
import pathlib
import threading
from collections.abc import Iterable
from typing import Any

import zstandard

from kinship_results.formats import checked, in_format

Key = tuple[str, str, str, int]  # robot, guidance, instance, seed: 0, 1, ... is added to the instance's own
_LEVEL = 19  # files are written once
_MAX_BYTES = 1 << 30
_FORMAT = "study-query"
_MEMBERS = ("robot", "guidance", "instance", "seed", "distribution", "solved", "checks", "goal_checks", "projections", "cpu_s", "length")


def write_whole(file: pathlib.Path, content: bytes) -> None:
    """The file has its name once it is whole."""
    part = file.with_name(file.name + ".part")
    part.write_bytes(content)
    part.replace(file)


def compressed_name(file: pathlib.Path) -> pathlib.Path:
    return file.with_name(file.name + ".zst")


def compress_file(file: pathlib.Path) -> None:
    """Writes the twin, which is small enough to keep."""
    write_whole(compressed_name(file), zstandard.ZstdCompressor(level=_LEVEL).compress(file.read_bytes()))


def expand_file(file: pathlib.Path) -> bool:
    """Makes the file of its twin unless it is there. Returns whether it is there now. Raises ValueError for a damaged twin."""
    twin = compressed_name(file)
    if not file.exists() and twin.exists():
        try:
            content = zstandard.ZstdDecompressor().decompress(twin.read_bytes(), max_output_size=_MAX_BYTES)
        except zstandard.ZstdError as error:
            raise ValueError(f"'{twin}': {error}") from error
        write_whole(file, content)
    return file.exists()


class LineFile:
    """Lines that threads add; each is on the disk when add() returns."""

    def __init__(self, file: pathlib.Path, lines: Iterable[str]) -> None:
        write_whole(file, "".join(line + "\n" for line in lines).encode())
        self._stream = file.open("a", encoding="utf-8")

    def add(self, line: str) -> None:
        self._stream.write(line + "\n")
        self._stream.flush()

    def close(self) -> None:
        self._stream.close()


def to_line(row: dict[str, Any]) -> str:
    return json.dumps(row, separators=(",", ":"), ensure_ascii=False)


class QueryLog:
    """Results of queries, one a line. Opening drops a last line that an interruption cut off. Threads may share it.

    Raises ValueError that names the file and the line, if another line is no result.
    """

    def __init__(self, file: pathlib.Path) -> None:
        self.file = file
        self._lock = threading.Lock()
        self.rows: dict[Key, dict[str, Any]] = {}
        if expand_file(file):
            self._read()
        self._lines = LineFile(file, (_line_of(self.rows[key]) for key in sorted(self.rows)))

    def _read(self) -> None:
        lines = self.file.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines, 1):
            try:
                row = checked(json.loads(line), _FORMAT)
                if not isinstance(row, dict) or not row.keys() >= set(_MEMBERS):
                    raise ValueError("is no result of a query")
            except ValueError as error:
                if number == len(lines):
                    return
                raise ValueError(f"'{self.file}' line {number}: {error}") from error
            row.pop("format", None)  # of files
            self.rows[key_of(row)] = row

    def has(self, key: Key, distribution: str | None) -> bool:
        """Raises ValueError if the result is there but of another distribution."""
        with self._lock:
            known = self.rows.get(key)
        if known is None:
            return False
        if known["distribution"] != distribution:
            raise ValueError(f"'{self.file}' holds results of {key[0]} guided by '{key[1]}' with {_name(known['distribution'])}, "
                             f"now it is {_name(distribution)}: use another folder")
        return True

    def add(self, row: dict[str, Any]) -> None:
        with self._lock:
            self._lines.add(_line_of(row))
            self.rows[key_of(row)] = row

    def close(self) -> None:
        self._lines.close()


def _line_of(row: dict[str, Any]) -> str:
    return to_line(in_format(_FORMAT, row))


def key_of(row: dict[str, Any]) -> Key:
    return row["robot"], row["guidance"], row["instance"], row["seed"]


def _name(distribution: str | None) -> str:
    return f"distribution {distribution[:12]}" if distribution else "no distribution"
