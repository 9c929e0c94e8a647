"""A shell that runs a document's commands one after another, and terminals beside it for those that stay."""
import os
import pathlib
import signal
import subprocess
import threading
from typing import Callable


class Terminal:
    """bash in `folder`; what a command exports or changes holds for the next ones."""

    LIMIT_S = 300  # of one command; a command that waits for ever is ended, and fails
    STARTING_S = 30  # of what stays, until its first lines are there

    def __init__(self, folder: pathlib.Path, environment: "dict[str, str]"):
        self._state = folder.parent / "environment"
        self._script = folder.parent / "command"
        self._end = f"--- end {os.urandom(8).hex()}"
        self._beside = []
        self._shell = subprocess.Popen(
            ["bash", "--noprofile", "--norc"], cwd=folder, env=environment, stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def run(self, command: str) -> "tuple[int, list[str]]":
        """:return: exit code and lines of standard output and error, in the order in which they came."""
        self._script.write_text(command + "\n", encoding="utf-8")
        timer = threading.Timer(self.LIMIT_S, self._kill)
        timer.start()
        try:
            self._shell.stdin.write(f". '{self._script}' </dev/null; printf '\\n%s %d\\n' '{self._end}' $?\n")
            self._shell.stdin.flush()
            lines = []
            for line in self._shell.stdout:
                if line.startswith(self._end):
                    if lines and not lines[-1]:
                        lines.pop()  # the line that our own line feed ended or made
                    return int(line[len(self._end):]), lines
                lines.append(line.rstrip("\n"))
        finally:
            timer.cancel()
        return -1, lines + [f"(the shell ended, perhaps after {self.LIMIT_S} s)"]

    def start(self, command: str, is_enough: "Callable[[list[str]], bool]") -> "list[str]":
        """Starts what stays, in a terminal of its own.

        :return: its first lines, once they are enough; all of them if it ended, or was ended after a while.
        """
        self.run(f"env -0 > '{self._state}'; pwd >> '{self._state}'")
        *variables, folder = self._state.read_text(encoding="utf-8").split("\0")
        process = subprocess.Popen(
            ["bash", "-c", "exec env " + command], cwd=folder.strip(), env=dict(v.split("=", 1) for v in variables),
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        timer = threading.Timer(self.STARTING_S, process.kill)
        timer.start()
        lines = []
        try:
            while not is_enough(lines) and (line := process.stdout.readline()):
                lines.append(line.rstrip("\n"))
        finally:
            timer.cancel()
            rest = threading.Thread(target=process.stdout.read)  # a full pipe would hold the process up
            rest.start()
            self._beside.append((process, rest))
        return lines

    def interrupt(self) -> int:
        """Control-C in the terminal that was begun last. :return: exit code"""
        process, rest = self._beside.pop()
        process.send_signal(signal.SIGINT)
        code = process.wait()
        rest.join()
        process.stdout.close()
        return code

    def close(self) -> "list[int]":
        """Ends everything. :return: exit codes of what was started beside, which Control-C ends."""
        codes = []
        while self._beside:
            codes.append(self.interrupt())
        self._shell.stdin.close()
        self._kill()
        self._shell.wait()
        self._shell.stdout.close()
        return codes

    def _kill(self) -> None:
        try:
            os.killpg(self._shell.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
