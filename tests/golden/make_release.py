#!/usr/bin/env python3
"""Writes what users have on their disks after a day with this release: once, when it is made.

    KINSHIP_SOURCE_DIR=$PWD KINSHIP_BIN_DIR=$PWD/build/release/bin PYTHONPATH=tests/support \\
      tests/golden/make_release.py tests/golden/releases/0.2.0

A store, an outbox whose reports nobody has acknowledged, an experience file, a robot's folder, problems, results, and
expected.json: how many of each there are. release_test.py gives all of them to the programs of later releases.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

from kinshipd_process import SOURCE, Kinshipd

PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
TASK = "load_machine"
PLACEMENTS = {"my_arm": "-0.35 0 0 0 0 0 1", "ur10e": "-0.7 0 0.1 0 0 0 1"}
REPORTED, WAITING = 4, 3  # of the tutorial's problems


def run(*command) -> str:
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE).stdout


def main(folder: pathlib.Path) -> None:
    folder.mkdir(parents=True)
    tutorial = SOURCE / "docs" / "tutorial"
    shutil.copytree(tutorial / "my_arm", folder / "my_arm")
    lines = run(tutorial / "problems.py", PLACEMENTS["my_arm"]).splitlines(keepends=True)
    (folder / "problems.jsonl").write_text("".join(lines[:REPORTED]))
    (folder / "waiting.jsonl").write_text("".join(lines[REPORTED:REPORTED + WAITING]))
    with Kinshipd() as server:
        server.start()
        plan = [PROGRAMS / "kinship-plan", "--robot", folder / "my_arm", "--task", TASK, "--domain", server.domain, "--report"]
        run(*plan, folder / "problems.jsonl", "--output", folder / "results.jsonl", "--outbox", server.folder / "delivered")
        server.register("ur10e")
        run(PROGRAMS / "kinship", "--domain", server.domain, "distributions", "fetch", "--task", TASK, "--robot", "ur10e",
            "--placement", PLACEMENTS["ur10e"], "--wait", 60)
        (folder / "experience.jsonl").write_text(server.kinship("paths", "export", "--task", TASK))
        expected = {name: len(json.loads(server.kinship(name, "list", "--json"))["rows"])
                    for name in ("robots", "tasks", "paths", "distributions", "attempts")}
        server.stop()
        shutil.copy(server.folder / "store.db", folder / "store.db")
        run(*plan, folder / "waiting.jsonl", "--output", folder / "waited.jsonl", "--outbox", folder / "outbox", "--timeout", 1)
    (folder / "waited.jsonl").unlink()
    version = re.search(r"\d\S*", run(PROGRAMS / "kinship", "--version"))[0]
    (folder / "expected.json").write_text(json.dumps({"release": version, "waiting": WAITING, **expected}, indent=2) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
