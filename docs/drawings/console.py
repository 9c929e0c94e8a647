#!/usr/bin/env python3
"""Makes the pictures of docs/console.md: a kinshipd whose experience the tutorial's robots plan, its console in a browser.

    PYTHONPATH=tests/support KINSHIP_BIN_DIR=build/release/bin docs/drawings/console.py docs/drawings

Needs the packages of deploy/packages-test.txt; takes a minute. WebP files, each the same page as a reader finds it.
"""
import json
import os
import pathlib
import subprocess
import sys

from browser import Browser
from kinshipd_process import Kinshipd
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
TASK = "load_machine"
ROBOTS = {"my_arm": (ROOT / "docs/tutorial/my_arm", "-0.35 0 0 0 0 0 1"), "ur10e": (ROOT / "robots/models/ur10e", "-0.7 0 0.1 0 0 0 1")}
WIDTH = 1100  # of a window, CSS pixels
# Each: file, part of the page that is shown (its height), condition that the page is complete
PICTURES = {
    "fleet": ("/", 700, "[...document.querySelectorAll('.tile')].some(tile => tile.textContent === '561attempts')"),
    "slow": ("/slow", 700, "document.querySelector('table[aria-label=\"Unsolved\"] tbody').rows.length"),
    "failed": ("/attempts/{failed}", 900, "document.querySelector('.figure canvas')"),
    "beside": ("/attempts/{guided}", 720, "document.querySelector('#beside canvas')"),
}
SCROLLED = {"failed": "#player", "beside": "#beside"}  # the parts whose ends are shown


class FilledConsole:
    """A kinshipd with a console, after a robot's uniform work, another one's with its guidance, and a part that cannot be reached."""

    def __init__(self, *options: str):
        self.server = Kinshipd()
        self.server.start("--console", "127.0.0.1:0", *options)
        self.link = self.run("kinship", "console").strip()
        self.host = self.link.split("/")[2]
        self.plan("my_arm", "--guidance", "none")
        self.run("kinship", "robots", "register", str(ROBOTS["ur10e"][0]))
        self.plan("ur10e", "--guidance", "none")
        self.plan("ur10e", "--guidance", "always", "--wait", "100")
        self.plan("ur10e", "--guidance", "none", problems=self.blocked())
        self.plan("ur10e", "--guidance", "none", "--max-checks", "400", "--record-search", "all", problems=self.problems("ur10e")[:6])

    def close(self) -> None:
        self.server.__exit__(None, None, None)

    def run(self, program: str, *words: str) -> str:
        done = subprocess.run([PROGRAMS / program, *words, "--domain", str(self.server.domain), "--timeout", "30"], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{program} {' '.join(words)}: exit {done.returncode}\n{done.stderr}")
        return done.stdout

    def problems(self, robot: str) -> "list[dict]":
        told = subprocess.run([ROOT / "docs/tutorial/problems.py", ROBOTS[robot][1]], capture_output=True, text=True, check=True).stdout
        return [json.loads(line) for line in told.splitlines()]

    def blocked(self) -> "list[dict]":
        """The first parts, with the machine's door closed by a guard."""
        some = self.problems("ur10e")[:3]
        for problem in some:
            problem["scene"]["boxes"].append({"name": "guard door", "pose": [0.21, -0.15, 0.33, 0, 0, 0, 1], "size": [0.02, 0.6, 0.6]})
        return some

    def plan(self, robot: str, *options: str, problems: "list[dict] | None" = None) -> None:
        file = self.server.folder / "problems.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in problems or self.problems(robot)))
        self.run("kinship-plan", str(file), "--robot", str(ROBOTS[robot][0]), "--task", TASK, "--machine", f"cell of the {robot}", "--report",
                 "--outbox", str(self.server.folder / "outbox"), "--output", str(self.server.folder / "results.jsonl"), *options)

    def attempts(self, *words: str) -> "list[dict]":
        """Of the task, the newest first."""
        return json.loads(self.run("kinship", "attempts", "list", "--json", "--limit", "0", "--task", TASK, *words))["rows"]


def main(folder: pathlib.Path) -> None:
    console = FilledConsole()
    try:
        guided = (row["report_uuid"] for row in console.attempts("--outcome", "solved") if row["record"]["sampling_mode"] == "guided")
        names = {"failed": console.attempts("--outcome", "unsolved")[-1]["report_uuid"], "guided": next(guided)}
        with Browser(WIDTH, 900) as browser:
            browser.prefer("light")
            browser.driver.get(console.link)
            browser.wait("document.querySelector('main[data-ready]')")
            for name, (path, height, condition) in PICTURES.items():
                browser.resize(WIDTH, height)
                browser.driver.get(f"http://{console.host}{path.format(**names)}")
                if name == "fleet":
                    browser.wait("document.querySelector('#live').dataset.state === 'live'")
                    for _ in range(20):
                        console.plan("my_arm", "--guidance", "none")
                browser.wait(condition)
                if name in SCROLLED:
                    browser.run("document.querySelector(arguments[0]).scrollIntoView({block: 'end', behavior: 'instant'})", SCROLLED[name])
                browser.settle()
                Image.fromarray(browser.picture()).save(folder / f"console_{name}.webp", quality=80, method=6)
    finally:
        console.close()


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
