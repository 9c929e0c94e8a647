#!/usr/bin/python3
"""Tables and figures of a study, from the results that kinship-experiments left in its folder.

    analyse.py client/experiments/results/cobots     RESULTS.md, checks.svg, time.svg, clouds.png in that folder
    analyse.py FOLDER --calibration                  calibration beside the paper's figures, on standard output
    analyse.py FOLDER --tuning                       what guidance was worth in the last tuning run, likewise
    analyse.py FOLDER --family=furniture             furniture.md in that folder, over the studies of the family in it
    analyse.py FOLDER --transferability              transferability.md in that folder, over the studies with predictions in it

Needs python3-numpy, python3-scipy, python3-matplotlib and python3-zstandard of Debian.
Exit codes: 0 done, 1 failed (a package or a file is missing, or a file holds something else), 2 wrong usage.
"""
import argparse
import pathlib
import sys

PACKAGES = "python3-numpy python3-scipy python3-matplotlib python3-zstandard"


def main() -> int:
    """Does what the command line says. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of one study: it holds study.json; of --family: of several")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--calibration", action="store_true", help="calibration only")
    what.add_argument("--tuning", action="store_true", help="the last tuning run only")
    what.add_argument("--family", help="the studies of this family that the folder holds")
    what.add_argument("--transferability", action="store_true", help="what predicts the worth of a source, over all studies")
    arguments = parser.parse_args()
    sys.dont_write_bytecode = True  # nothing is left in the source tree
    try:
        from analysis import family, report, study_folder, transferability
    except ModuleNotFoundError as error:
        print(f"analyse.py: {error}; on Debian: apt-get install {PACKAGES}", file=sys.stderr)
        return 1
    try:
        if arguments.family:
            family.write_family(arguments.folder, arguments.family)
            return 0
        if arguments.transferability:
            transferability.write_transferability(arguments.folder)
            return 0
        folder = study_folder.StudyFolder(arguments.folder)
        if arguments.calibration:
            print(report.calibration_text(folder), end="")
        elif arguments.tuning:
            print(report.tuning_text(folder), end="")
        else:
            report.write_report(folder)
    except (OSError, ValueError) as error:
        print(f"analyse.py: {error}", file=sys.stderr)
        return 1
    except KeyError as error:
        print(f"analyse.py: '{arguments.folder}' has a file that lacks {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
