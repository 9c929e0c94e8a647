"""Markdown as text."""
import re
import textwrap
from collections.abc import Iterable, Sequence

MAX_LINE = 120  # of every document (tests/documents)
NOTHING = "–"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, numbers to the right: every column but the first, and others whose head begins with "<".

    A table wider than a line becomes several, of as many columns as fit; each repeats the first columns that are to the left.
    """
    is_left = [index == 0 or name.startswith("<") for index, name in enumerate(head)]
    columns = list(zip(["---" if left else "---:" for left in is_left],
                       *([cell.replace("|", "\\|") for cell in row] for row in rows)))
    columns = [(name.removeprefix("<"), *column) for name, column in zip(head, columns)]
    keys = is_left.index(False) if False in is_left else len(is_left)
    tables = [columns[:keys]]
    for column in columns[keys:]:
        if len(tables[-1]) > keys and _width([*tables[-1], column]) > MAX_LINE:
            tables.append(columns[:keys])
        tables[-1] = [*tables[-1], column]
    return "".join("\n".join(map(_row, zip(*each))) + "\n\n" for each in tables)


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _width(columns: Sequence[Sequence[str]]) -> int:
    return max(len(_row(row)) for row in zip(*columns))


def wrapped(text: str) -> str:
    """The text with its paragraphs and items of lists broken into lines, but no number; tables and headings stay."""
    return "".join(line if len(line) <= MAX_LINE or line.startswith(("|", "#")) else _filled(line)
                   for line in text.splitlines(keepends=True))


def _filled(line: str) -> str:
    whole = re.sub(r"(?<=\d) (?=\d{3}\b)", "\0", line)
    return textwrap.fill(whole, MAX_LINE, subsequent_indent="  " if line.startswith("- ") else "", break_long_words=False,
                         break_on_hyphens=False).replace("\0", " ") + "\n"


def p_text(p: float) -> str:
    return f"{p:.1e}" if p < 0.001 else f"{p:.3f}"


def percent(part: float, whole: float) -> str:
    return f"{100 * part / whole:.0f} %" if whole else NOTHING
