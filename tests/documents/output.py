"""Whether a program's output is what a document shows: the words count, the numbers do not.

Numbers, times, digests and UUIDs of a run differ from those of the run that was written down, and so does which one of
several is the best. `...` alone on a line of the document stands for any lines, at the end of a line for the rest of it.
"""
import re

REST = "..."
PATTERNS = (
    (r"\b[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}\b", "UUID"),
    (r"\b\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?(\.\d+)?( ?UTC|Z)?", "TIME"),
    (r"\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)[0-9a-f]{6,}\b", "#"),  # a digest may be all digits
    (r"(?<![\w.])\d{1,3}( \d{3})+(?![\w.])", "#"),
    (r"(?<![\w.])[-+]?(\d+(\.\d*)?|\.\d+)(e[-+]?\d+)?(?![\w])", "#"),
    (r"(?<![\w.])[-+]?\d+(\.\d+)?(us|ms|s|min|m|h|d|kB|MB|x|%)(?!\w)", "#"),
    (r"# ?(us|µs|ms|s|min|h)\b", "# TIME"),
    (r"#\*", "#"),  # the best of a row
    (r"\s+chosen$", ""),  # the guide that a rehearsal found best
    (r"-{3,}|─+", "---"),
    (r"\s+", " "),
)


def normalised(line: str) -> str:
    """The line with what differs from run to run taken out."""
    for pattern, word in PATTERNS:
        line = re.sub(pattern, word, line)
    return line.strip()


def line_matches(expected: str, actual: str) -> bool:
    """One line of a document against one of the output."""
    if expected.rstrip().endswith(REST):
        return normalised(actual).startswith(normalised(expected.rstrip()[:-len(REST)]))
    return normalised(expected) == normalised(actual)


def match(expected: "list[str]", actual: "list[str]") -> "list[int | None] | None":
    """Which line of the output each line of the document is; None for `...`.

    :return: None if the output is not what the document shows.
    """
    if not expected:
        return None if actual else []
    if expected[0].strip() == REST:
        for skipped in range(len(actual) + 1):
            rest = match(expected[1:], actual[skipped:])
            if rest is not None:
                return [None] + [i if i is None else i + skipped for i in rest]
        return None
    if not actual or not line_matches(expected[0], actual[0]):
        return None
    rest = match(expected[1:], actual[1:])
    return None if rest is None else [0] + [i if i is None else i + 1 for i in rest]
