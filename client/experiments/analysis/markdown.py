"""Markdown as text."""
from collections.abc import Iterable, Sequence

NOTHING = "–"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, numbers to the right: every column but the first, and others whose head begins with "<"."""
    left = [index == 0 or name.startswith("<") for index, name in enumerate(head)]
    lines = [_row([name.removeprefix("<") for name in head]), _row(["---" if is_left else "---:" for is_left in left])]
    return "\n".join(lines + [_row(row) for row in rows]) + "\n\n"


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def p_text(p: float) -> str:
    return f"{p:.1e}" if p < 0.001 else f"{p:.3f}"


def percent(part: float, whole: float) -> str:
    return f"{100 * part / whole:.0f} %" if whole else NOTHING
