"""Builds and runs benchmarks and reports what they say; deploy/bench calls it and tells the options.

A benchmark prints one JSON object a line on standard output, a figure each (tests/bench/figure.hpp).
"""
import argparse
import collections
import datetime
import json
import os
import pathlib
import platform
import shutil
import signal
import statistics
import subprocess
import sys
import time

import report

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "bench"

Bench = collections.namedtuple("Bench", "name program arguments title repeats minutes is_long alone")


def bench(name, program, title, arguments=(), repeats=3, minutes=5, is_long=False, alone=""):
    """minutes: after which a run has failed; alone: why rows have no reference, where some have none."""
    return Bench(name, program, list(arguments), title, repeats, minutes, is_long, alone)


NO_REFERENCES = "--no-references"
EXPERIMENTS, PUBLIC_SETS = "kinship-experiments", "public_sets_bench"  # programs that know no NO_REFERENCES
LINE_DOWN = "against the line down in the same run"
TO_UNIFORM = "each is a ratio to uniform planning in the same run"
GROWING_PART = "sizes, and times of which the part that grows stands beside the pair alone"

BENCHES = [
    bench("em", "fit_bench", "EM, N = 72 160, d = 7, CPU time", ["em"]),
    bench("fit", "fit_bench", "Fits, N = 72 160, d = 7, CPU time, and samples", ["fit"], repeats=1,
          alone="a mixture is drawn from and fitted; no package chooses K by a prior as this does"),
    bench("scores", "fit_bench", "Held-out paths of bundles, mean log density, and fits", ["scores"], repeats=1),
    bench("inverse", "inverse_bench", "Inverse kinematics, L = 8, d = 0.2, reachable poses, one thread"),
    bench("transfer", "transfer_bench", "Transfer between the five cobots, two threads",
          alone="the parts of the first row"),
    bench("cold-fetch", "cold_fetch_bench", "Distributions that have to be made, over DDS",
          alone="made anew stands beside where there is both"),
    bench("cached-fetch", "cached_fetch_bench", "Distributions from memory, over DDS",
          alone="the load that the rows below it have beside them"),
    bench("durable-report", "report_bench", "Durable reports of 8 KB"),
    bench("postgres", "postgres_bench", "Durable reports of 8 KB into PostgreSQL", repeats=1,
          alone="PostgreSQL's own rate is the reference of the first rows"),
    bench("fleet", "fleet_bench", "Several servers over one PostgreSQL database, over DDS", repeats=1,
          alone="against one server of the same run, or a wait that a person feels"),
    bench("site", "site_bench", "A site that catches up, with the memory on its processors and disk", ["shared"], repeats=1,
          alone=LINE_DOWN),
    bench("site-apart", "site_bench", "A site that catches up, with the memory apart", ["apart"], repeats=1,
          alone=LINE_DOWN),
    bench("secured", "secured_bench", "Security: fetches, reports, 100 clients after a restart", repeats=1,
          alone="against no security in the same run"),
    bench("collision", "collision_bench", "Collision checks, 12 boxes and a held box, one thread", ["boxes"]),
    bench("collision-meshes", "collision_bench", "A Panda of meshes among boxes, meshes and a camera's points, one thread", ["meshes"], repeats=1),
    bench("planning", "planning_bench", "Uniform BiRRT in a shelf cell", ["free"], repeats=1),
    bench("planning-upright", "planning_bench", "Uniform CBiRRT2 carrying a container upright", ["upright"], repeats=1),
    bench("constrained", "constrained_bench", "First paths along constraints beside OMPL's constrained spaces, processor time", repeats=1, minutes=15),
    bench("proof", "proof_bench", "Edges proven, beside steps and FCL's continuous collision", ["edges"], repeats=1),
    bench("proof-planning", "proof_bench", "Plans with proven edges, beside steps of 0.05", ["planning"], repeats=1),
    bench("recall", "recall_bench", "Recalled paths in the studies' furniture, CPU time of everything", ["furniture", "ur10e", "panda"], repeats=1,
          alone=TO_UNIFORM),
    bench("recall-kitting", "recall_bench", "Recalled paths in the study of kitting, CPU time of everything", ["kitting", "ur10e", "panda"], repeats=1,
          alone=TO_UNIFORM),
    bench("dear", "recall_bench", "Recalled paths in the dear studies, one robot a kind, CPU time of everything", ["dear", "iiwa14_lift", "sara_like"],
          repeats=1, minutes=60, is_long=True,
          alone=TO_UNIFORM),
    bench("recall-planner", "recall_planner_bench", "RecallPlanner beside OMPL's Lightning and RRTConnect in shelves, processor time", repeats=1),
    bench("order", EXPERIMENTS, "Orders: 100 queries one after another from an empty store, CPU time of plans",
          ["order", "--out", "order", "--models", str(ROOT / "robots" / "models"), "--figures"], repeats=1,
          alone="each is a share of uniform planning's time"),
    bench("season", "season_bench", "400 queries of a client that chooses by evidence, checks drawn", repeats=1,
          alone="each is a share of uniform planning's checks, or a time that nobody else's stands beside"),
    bench("command", "command_bench", "One-shot commands against a local server"),
    bench("store", "large_store_bench", "A store of 50 000 paths of 10 robots and tasks", ["50000", "10"], repeats=1,
          alone=GROWING_PART),
    bench("large-store", "large_store_bench", "A store of 1 000 000 paths of 200 robots and tasks", ["1000000", "200"],
          repeats=1, minutes=60, is_long=True,
          alone=GROWING_PART),
    bench("large-postgres", "large_postgres_bench", "A PostgreSQL database of 10 000 000 paths of 1000 robots and tasks",
          ["10000000", "1000"], repeats=1, minutes=90, is_long=True,
          alone=GROWING_PART),
    bench("many-clients", "many_clients_bench", "1000 clients", repeats=1, minutes=10, is_long=True,
          alone="waits that people feel, and memory"),
    bench("soak", "soak_bench", "20 minutes of reports, fits, fetches and short-lived clients", repeats=1, minutes=30, is_long=True,
          alone="growth from one third to the next"),
]


def public_sets(options):
    """Plans in problem files of the user's; with `planning` only, as nobody else has them."""
    vamp = ["--vamp", str(options.vamp)] if options.vamp and not options.no_references else []
    return bench("planning-mbm", PUBLIC_SETS, f"Uniform plans with proven edges in the problems of {options.mbm.name}, processor time",
                 [str(options.mbm), *vamp], repeats=1, alone="--vamp names a program to stand beside")


def parse_arguments():
    parser = argparse.ArgumentParser(prog="deploy/bench")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--repeat", type=int, metavar="N")
    parser.add_argument("--long", action="store_true")
    parser.add_argument(NO_REFERENCES, action="store_true")
    parser.add_argument("--eaik", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--mbm", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--vamp", type=pathlib.Path, metavar="PROGRAM")
    parser.add_argument("--write-results", action="store_true")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    known = [b.name for b in BENCHES]
    assert all(name in known for name, _ in report.FIRST), "report.py puts a benchmark first that there is not"
    for name in options.names:
        if name not in known:
            parser.error(f"no benchmark '{name}'; there are: {' '.join(known)}")
    if options.repeat is not None and options.repeat < 1:
        parser.error(f"--repeat {options.repeat}: at least 1")
    if options.eaik and not (options.eaik.is_absolute() and options.eaik.is_dir()):
        parser.error(f"--eaik {options.eaik}: no absolute path of a folder")
    if options.names and (options.all or options.write_results):
        parser.error(f"{' '.join(options.names)}: --all and --write-results are of all benchmarks, so no names")
    if options.mbm and not (options.mbm.is_absolute() and options.mbm.is_dir()):
        parser.error(f"--mbm {options.mbm}: no absolute path of a folder")
    if options.vamp and not (options.mbm and options.vamp.is_absolute() and os.access(options.vamp, os.X_OK)):
        parser.error(f"--vamp {options.vamp}: no absolute path of a program, or no --mbm")
    return options


def run_quietly(command, log):
    """Ends the program with the end of the log if the command fails."""
    with open(log, "w") as stream:
        code = subprocess.call(command, cwd=ROOT, stdout=stream, stderr=subprocess.STDOUT)
    if code != 0:
        print("".join(open(log).readlines()[-30:]), file=sys.stderr)
        sys.exit(f"bench: {' '.join(map(str, command))} failed; see {log}")


def build(benches, eaik):
    """eaik: where EAIK is, or None."""
    programs = sorted({b.program for b in benches})
    print(f"Building {' '.join(programs)}", flush=True)
    run_quietly(["cmake", "--preset", "bench", f"-DKINSHIP_EAIK_ROOT={eaik or ''}"], BUILD / "configure.log")
    run_quietly(["cmake", "--build", BUILD, "--target", *programs], BUILD / "build.log")


def load():
    return round(os.getloadavg()[0], 2)


def git(*arguments):
    result = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return result.stdout.strip() if result.returncode == 0 else ""


def line_after(file, key):
    """What stands behind `key` in a file of /proc or /etc."""
    for line in open(file):
        if line.startswith(key):
            return line[len(key):].strip(" \t:=\"\n")
    return "unknown"


def describe_run():
    results = ":(exclude)tests/bench/RESULTS.md"
    flags = line_after("/proc/cpuinfo", "flags").split()
    widest = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "SSE2")
    memory_kb = line_after("/proc/meminfo", "MemTotal").split()[0]
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": git("rev-parse", "--short=12", "HEAD") or "unknown",
        "is_modified": bool(git("status", "--porcelain", "--", ".", results)),
        "cpu": f'{line_after("/proc/cpuinfo", "model name")} ({widest})',
        "cores": os.cpu_count(),
        "memory_gb": round(int(memory_kb) / 1e6, 1),
        "system": line_after("/etc/os-release", "PRETTY_NAME"),
        "kernel": platform.release(),
        "load_before": load(),
    }


class Failed(Exception):
    pass


def end_group(process):
    """Ends what a benchmark started, too: servers, clients, references."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()


def is_of_time(unit):
    """Whether a unit is of time, or so many a second: such a figure follows the machine."""
    return unit.split(" ")[0] in ("s", "ms", "us", "ns") or unit.endswith("/s")


def run_once(wanted, has_references, scratch):
    """The figures of one run, in order."""
    more = [] if has_references or wanted.program in (EXPERIMENTS, PUBLIC_SETS) else [NO_REFERENCES]
    command = [BUILD / "bin" / wanted.program, *wanted.arguments, *more]
    log = BUILD / f"{wanted.name}.log"
    with open(log, "w") as errors:
        process = subprocess.Popen(command, cwd=scratch, stdout=subprocess.PIPE, stderr=errors, text=True,
                                   start_new_session=True)
        try:
            output, _ = process.communicate(timeout=60 * wanted.minutes)
        except subprocess.TimeoutExpired:
            raise Failed(f"not done after {wanted.minutes} minutes") from None
        finally:
            end_group(process)
    if process.returncode != 0:
        last = log.read_text().strip().splitlines()[-1:]
        raise Failed(f"exit code {process.returncode}; {' '.join(last)}")
    figures = [json.loads(line) for line in output.splitlines()]
    if len({figure["name"] for figure in figures}) < len(figures):
        raise Failed("two figures have one name")
    for figure in figures:
        if "budget" in figure and is_of_time(figure["unit"]):
            raise Failed(f"'{figure['name']}' has a budget that names a machine: make it a ratio")
    return figures


def summary(values):
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


def merge(runs):
    """One figure of the equal ones of several runs: median, least and greatest of the value and of the ratio."""
    merged = []
    for figures in zip(*runs, strict=True):
        figure = dict(figures[-1])
        if any(other["name"] != figure["name"] for other in figures):
            raise Failed(f"'{figure['name']}' is not in every run")
        figure["value"] = summary([f["value"] for f in figures])
        if "reference" in figure:
            figure["reference"] = {"name": figure["reference"]["name"],
                                   "value": statistics.median(f["reference"]["value"] for f in figures)}
            if all(f["reference"]["value"] > 0 for f in figures):
                figure["ratio"] = summary([f["value"] / f["reference"]["value"] for f in figures])
        limits = [("value", figure.get("budget")), ("ratio", figure.get("ratio_budget"))]
        kept = [(figure[of]["median"] <= limit if figure["better"] == "lower" else figure[of]["median"] >= limit)
                for of, limit in limits if limit is not None and of in figure]
        figure["is_kept"] = all(kept) if kept else None
        merged.append(figure)
    return merged


def measure(wanted, options, scratch):
    """A benchmark as the report has it."""
    repeats = options.repeat or wanted.repeats
    result = {"bench": wanted.name, "title": wanted.title, "alone": wanted.alone, "runs": repeats, "load_before": load(), "figures": []}
    start = time.monotonic()
    runs = []
    try:
        for i in range(repeats):
            print(f"{wanted.name}: run {i + 1} of {repeats}", flush=True)
            runs.append(run_once(wanted, not options.no_references, scratch))
        result["figures"] = merge(runs)
    except (Failed, ValueError) as error:
        result["failure"] = str(error)
        print(f"{wanted.name}: FAILED: {error}", file=sys.stderr, flush=True)
    result["seconds"] = round(time.monotonic() - start, 1)
    result["load_after"] = load()
    for figure in result["figures"]:
        print("    " + report.in_a_line(figure), flush=True)
    return result


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that nothing is left running
    options = parse_arguments()
    if options.list:
        for b in BENCHES:
            print(f"{b.name:18}{b.title} ({b.repeats} run{'s' if b.repeats > 1 else ''}{', --long' if b.is_long else ''})")
        return 0
    benches = [b for b in BENCHES if (b.name in options.names if options.names else options.long or not b.is_long)]
    if options.mbm and any(b.name == "planning" for b in benches):
        benches.append(public_sets(options))
    build(benches, options.eaik)
    scratch = BUILD / "scratch"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    document = describe_run()
    start = time.monotonic()
    document["benches"] = [measure(b, options, scratch) for b in benches]
    document["load_after"] = load()
    document["seconds"] = round(time.monotonic() - start)
    shutil.rmtree(scratch)
    (BUILD / "report.json").write_text(json.dumps(document, indent=1) + "\n")
    (BUILD / "report.md").write_text(report.markdown(document))
    (BUILD / "report.html").write_text(report.html(document))
    failed = [b["bench"] for b in document["benches"] if "failure" in b]
    failed += [] if options.no_references else report.faults(document)
    if options.write_results and not failed:
        shutil.copy(BUILD / "report.md", ROOT / "tests" / "bench" / "RESULTS.md")
    print(f"Report: {BUILD}/report.html, report.md, report.json; {document['seconds']} s")
    if failed:
        print(f"bench: failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


sys.exit(main())
