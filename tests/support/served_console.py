"""A kinshipd with a console, for tests in Python, and attempts for it."""
import http.client
import json
import os
import pathlib
import re
import socket
import subprocess
import threading
import time
import uuid

import numpy as np

from browser import BrowserTest
from kinshipd_process import Kinshipd

MODELS = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"]) / "robots" / "models"
TASK = "shelf:1"
MACHINE = "<img src=x> & \"2\""  # what a page must not take for HTML
READY = {"panda": np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785]), "ur10e": np.array([0, -1.2, 1.8, -2.2, -1.57, 0])}


def attempt(robot: str, seed: int, task: str = TASK, **record) -> dict:
    """A line of an experience file: the hand sweeps in front of the robot, a little different for every seed."""
    waypoints = np.tile(READY[robot], (4, 1))
    waypoints[:, 0] += -0.9 + 0.6 * np.arange(4)
    waypoints += np.random.default_rng(seed).uniform(-0.1, 0.1, waypoints.shape)
    known = {"outcome": "solved", "planner": "birrt", "planner_options": "", "planning_time_s": 0.5, "collision_checks": 1000,
             "time_limit_s": 10, **record}
    return {"report_uuid": str(uuid.UUID(int=seed + 1000 * sum((robot + task).encode()))), "task": task, "robot": robot, "machine": MACHINE,
            "T_task_base": [0, 0, 0, 0, 0, 0, 1], "waypoints": waypoints.tolist() if known["outcome"] == "solved" else None,
            "record": known, "scene": None}


class Reports:
    """A robot that reports so many attempts a second, while its `with` lasts."""

    def __init__(self, give, a_second: int, robot: str = "panda"):
        self._give, self._a_second, self._robot = give, a_second, robot
        self._end, self._thread = threading.Event(), threading.Thread(target=self._run)

    def _run(self) -> None:
        first = 0
        while not self._end.wait(1 - time.monotonic() % 1):
            self._give([attempt(self._robot, first + i, task="load") for i in range(self._a_second)])
            first += self._a_second

    def __enter__(self) -> "Reports":
        self._thread.start()
        return self

    def __exit__(self, *exception) -> None:
        self._end.set()
        self._thread.join()


class ServedConsole:
    """A kinshipd with a console, and what a browser would know of it."""

    def __init__(self, *options: str):
        self.server = Kinshipd()
        self.serve(*options)

    def serve(self, *options: str) -> None:
        self.server.start("--console", "127.0.0.1:0", "--rehearsal-cpu", "0", *options)
        self.link = self.kinship("console").strip()
        self.host, self.token = re.fullmatch(r"http://([^/]+)/\?token=(\w+)", self.link).groups()
        self.cookie = f"kinship-console-{self.host.split(':')[1]}={self.token}"

    def close(self) -> None:
        self.server.__exit__(None, None, None)

    def kinship(self, *words: str) -> str:
        program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinship"
        done = subprocess.run([program, "--domain", str(self.server.domain), "--timeout", "30", *words], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr}")
        return done.stdout

    def rows(self, *words: str) -> list:
        return json.loads(self.kinship(*words, "--json"))["rows"]

    def give(self, attempts: "list[dict]") -> None:
        file = self.server.folder / "given.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in attempts))
        self.kinship("paths", "import", str(file))

    def ask(self, path: str, method: str = "GET", body: "str | None" = None, **fields: str) -> http.client.HTTPResponse:
        """A request with the cookie, unless it has another; names of fields with _ for -."""
        connection = http.client.HTTPConnection(self.host, timeout=30)
        named = {name.replace("_", "-"): value for name, value in {"Cookie": self.cookie, **fields}.items()}
        connection.request(method, path, body, {name: value for name, value in named.items() if value})
        reply = connection.getresponse()
        reply.text = reply.read().decode()
        connection.close()
        return reply

    def stream(self) -> socket.socket:
        """A listener to the events, who does not read."""
        address, port = self.host.split(":")
        listener = socket.create_connection((address, int(port)), timeout=30)
        listener.sendall(f"GET /api/events HTTP/1.1\r\nHost: {self.host}\r\nCookie: {self.cookie}\r\n\r\n".encode())
        return listener


class ConsoleTest(BrowserTest):
    """Tests of pages of a console, which has let the browser in; classes set `console` before their setUpClass() calls this one."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser.driver.get(cls.console.link)
        cls.browser.wait("document.querySelector('main[data-ready]')")

    def open(self, path: str) -> None:
        self.browser.driver.get(f"http://{self.console.host}{path}")
        self.ready()

    def ready(self) -> None:
        self.browser.wait("document.querySelector('main').dataset.ready === location.pathname")
        self.assertEqual(self.browser.elements("main > .page > [role=alert]"), [], self.browser.text("main"))
