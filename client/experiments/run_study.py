#!/usr/bin/python3
"""Runs studies and orders. kinship-experiments starts it, which has read and checked the command line.

    run_study.py OPTIONS      one JSON document: by name a list of words for each option, for "studies", "name" and "program"

Exit codes: 0 done, 1 failed, 3 a file, folder, robot or side study does not exist, 4 its kinshipd did not start.
"""
import json
import pathlib
import sys
import warnings

PACKAGES = "python3-numpy python3-zstandard"
Words = dict[str, list[str]]


def main() -> int:
    """Does what the words say. Returns the exit code."""
    words: Words = json.loads(sys.argv[1])
    program = pathlib.Path(words["program"][0])
    sys.path.append(str(program.parent.parent / "python"))
    try:
        from pipeline import runs
    except ModuleNotFoundError as error:
        print(f"kinship-experiments: {error}; deploy/build makes kinship; on Debian: apt-get install {PACKAGES}", file=sys.stderr)
        return 1
    warnings.simplefilter("ignore")  # of geometry: scenes are frozen
    try:
        run_all(words, options_of(words, program), runs)
    except (FileNotFoundError, LookupError) as error:
        return fail(error, 3)
    except ConnectionError as error:
        return fail(error, 4)
    except (OSError, RuntimeError, ValueError) as error:
        return fail(error, 1)
    return 0


def fail(error: Exception, code: int) -> int:
    print(f"kinship-experiments: {error}", file=sys.stderr)
    return code


def value(words: Words, name: str, usual: str = "") -> str:
    return words.get(name, [usual])[0]


def options_of(words: Words, program: pathlib.Path) -> "study.RunOptions":  # noqa: F821: imported once the packages are there
    from pipeline import study

    return study.RunOptions(
        folder=pathlib.Path(words["out"][0]), models=pathlib.Path(words["models"][0]), program=program,
        kinshipd=pathlib.Path(value(words, "kinshipd", str(program.with_name("kinshipd")))),
        analysis=pathlib.Path(value(words, "analysis", str(pathlib.Path(__file__).with_name("analyse.py")))),
        domain=int(words["domain"][0]), threads=int(value(words, "threads", "1")), learning=int(value(words, "learning", "0")),
        resume="resume" in words, quick="quick" in words)


def run_all(words: Words, options: "study.RunOptions", runs: "module") -> None:  # noqa: F821
    """Every study that is named, then the report of the family if they are one."""
    from pipeline.study import Study

    if words["name"] == ["order"]:
        run_orders(words, [Study(name, options) for name in words["studies"]])
        return
    for name in words["studies"]:
        run_one(words, Study(name, options), runs)
    asked = {"calibration", "tuning", "quick", "learning"} & words.keys()
    if words["name"] != words["studies"] and not asked:
        family = words["name"][0]
        runs.analyse(options, options.folder, f"--family={family}")
        print(f"{family}: {options.folder / (family + '.md')}", file=sys.stderr)


def run_orders(words: Words, studies: "list[study.Study]") -> None:  # noqa: F821
    """The table goes to standard output."""
    from analysis import order_table
    from pipeline import order

    rows = order.run_orders(studies, order.OrderOptions(
        robots=words["robot"], seeds=[int(seed) for seed in words["seed"]], queries=int(words["queries"][0]), ask=int(words["ask"][0]),
        pause_s=float(words["pause"][0]), rehearsed="rehearsed" in words))
    orders = order_table.orders_of(rows)
    print(order_table.figures(orders) if "figures" in words else order_table.order_table(orders), end="")


def run_one(words: Words, study: "study.Study", runs: "module") -> None:  # noqa: F821
    if "study" in words:
        for side in words["study"]:
            runs.run_side_study(study, side)
    elif "report" in words:
        runs.report_study(runs.StudyRun(study, resumes=True))
    elif "calibration" in words:
        runs.calibrate_study(study, int(words["calibration"][0]))
    elif "tuning" in words:
        overshoot = value(words, "overshoot")
        runs.tune_study(study, runs.TuningOptions(
            profile=words["profile"][0], overshoot=float(overshoot) if overshoot else None, share=float(value(words, "share", "1")),
            guide=value(words, "guide") or None, instances=int(value(words, "instances", "30")), seeds=int(value(words, "seeds", "2")),
            robots=words.get("robots", []), sources=words.get("sources", [])))
    else:
        runs.run_study(study)


if __name__ == "__main__":
    sys.exit(main())
