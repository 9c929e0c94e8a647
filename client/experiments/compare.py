#!/usr/bin/python3
"""Compares result files of kinship-plan. kinship-experiments starts it, which has read the command line.

    compare.py OPTIONS      one JSON document: by name a list of words for each option

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 a file does not exist.
"""
import json
import sys


def main() -> int:
    """Returns the exit code."""
    from analysis import comparison, comparison_table
    from analysis.comparison import fail

    words: dict[str, list[str]] = json.loads(sys.argv[1])
    try:
        beside = [comparison.parse_also(text) for text in words.get("also", [])]
    except ValueError as error:
        return fail(str(error), 2)
    try:
        uniform, guided = (comparison.read_results(words[side][0]) for side in ("uniform", "guided"))
        compared = comparison.Comparison(uniform, guided)
        also = comparison.compare_also(uniform, beside)
    except FileNotFoundError as error:
        return fail(f"cannot read '{error.filename}': {error.strerror}", 3)
    except (OSError, ValueError) as error:
        return fail(str(error), 1)
    if "json" in words:
        print(json.dumps(comparison.document(compared, also), separators=(",", ":"), ensure_ascii=False))
    else:
        print(comparison_table.table(compared, also), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
