#!/usr/bin/python3
"""Compares result files of kinship-plan, and writes the figures of a page. kinship-experiments starts it.

    compare.py OPTIONS      one JSON document: "uniform" and "guided", files; "also", a list of [name, file]; "as": table, json or page

Exit codes: 0 done, 1 failed, 3 a file does not exist.
"""
import json
import pathlib
import sys


def main() -> int:
    """Returns the exit code."""
    from analysis import comparison, comparison_table

    options = json.loads(sys.argv[1])
    try:
        uniform, guided = (comparison.read_results(pathlib.Path(options[side])) for side in ("uniform", "guided"))
        compared = named(f"{options['uniform']} and {options['guided']}" if options["as"] == "page" else "", uniform, guided)
        also = [(name, named(file, uniform, comparison.read_results(pathlib.Path(file)))) for name, file in options["also"]]
        if options["as"] == "table":
            print(comparison_table.table(compared, also), end="")
        elif options["as"] == "json":
            print(json.dumps(comparison.document(compared, also), separators=(",", ":"), ensure_ascii=False))
        else:
            from analysis import page_figures

            print(json.dumps(page_figures.page_figures(uniform, guided, compared, also)))
    except FileNotFoundError as error:
        return fail(f"cannot read '{error.filename}': {error.strerror}", 3)
    except (OSError, ValueError) as error:
        return fail(str(error), 1)
    return 0


def named(file: str, uniform: list, guided: list) -> "comparison.Comparison":  # noqa: F821
    """A comparison; errors begin with the file."""
    from analysis import comparison

    try:
        return comparison.Comparison(uniform, guided)
    except ValueError as error:
        raise ValueError(f"{file}: {error}" if file else str(error)) from error


def fail(message: str, code: int) -> int:
    print(f"kinship-experiments: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
