"""Finds the files and figures of a run: `kinship results page`, which starts it and then draws them as a page.

    page.py OPTIONS      one JSON document: by name a list of words for each option, for "program" and for "arguments", its own

Exit codes: 0 done, 1 failed, 2 wrong usage or a broken file, 3 a file or folder does not exist.
"""
import json
import subprocess
import sys

from kinship_results import comparison, run_files


def main() -> int:
    """Returns the exit code."""
    words: dict[str, list[str]] = json.loads(sys.argv[1])
    try:
        document = run_files.described(run_files.find_run(words))
    except FileNotFoundError as error:
        return comparison.fail(f"results page: cannot read '{error.filename}': {error.strerror}", 3)
    except run_files.IncompleteRun as error:
        return comparison.fail(f"results page: {error}", 3)
    except ValueError as error:
        return comparison.fail(f"results page: {error}", 2)
    except OSError as error:
        return comparison.fail(f"results page: {error}", 1)
    return subprocess.run([*words["program"], *words["arguments"], "--draws"], input=json.dumps(document), text=True).returncode


if __name__ == "__main__":
    sys.exit(main())
