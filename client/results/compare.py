"""Compares result files of kinship-plan: `kinship results compare`, which has read the command line.

    compare.py OPTIONS      one JSON document: by name a list of words for each option

Exit codes: 0 done, 1 failed, 2 wrong usage, 3 a file does not exist.
"""
import json
import sys

from kinship_results import comparison, comparison_table


def main() -> int:
    """Returns the exit code."""
    words: dict[str, list[str]] = json.loads(sys.argv[1])
    first, second, *others = words["files"]
    try:
        beside = [comparison.parse_named(text) for text in others]
    except ValueError as error:
        return comparison.fail(f"results compare: {error}", 2)
    try:
        uniform, guided = comparison.read_results(first), comparison.read_results(second)
        compared = comparison.named(f"{first} and {second}", uniform, guided)
        also = comparison.compare_also(uniform, beside)
    except FileNotFoundError as error:
        return comparison.fail(f"results compare: cannot read '{error.filename}': {error.strerror}", 3)
    except (OSError, ValueError) as error:
        return comparison.fail(f"results compare: {error}", 1)
    if "json" in words:
        print(json.dumps(comparison.document(compared, also), separators=(",", ":"), ensure_ascii=False))
    else:
        print(comparison_table.table(compared, also), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
