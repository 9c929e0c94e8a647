"""kinshipd as a process for tests in Python: what reserved_domain.hpp and server_process.hpp are for those in C++."""
import json
import os
import pathlib
import socket
import subprocess
import tempfile

FIRST, LAST = 70, 101  # of reserved_domain.hpp
SOURCE = pathlib.Path(os.environ.get("KINSHIP_SOURCE_DIR", "."))
MODELS = SOURCE / "robots" / "models"


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("0.0.0.0", port))
        except OSError:
            return False
    return True


def reserve_domain() -> "tuple[int, socket.socket]":
    """A DDS domain that is nobody else's while the socket is open: the same claim as the tests' in C++."""
    count = LAST - FIRST + 1
    for i in range(count):
        domain = FIRST + (os.getpid() + i) % count
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            claim.bind(f"\0kinship-test-domain-{domain}")
        except OSError:
            claim.close()
            continue
        claim.listen()
        if _is_free(7400 + 250 * domain + 10) and _is_free(7400 + 250 * domain + 11):
            return domain, claim
        claim.close()
    raise RuntimeError(f"all domains from {FIRST} to {LAST} are taken")


class Kinshipd:
    """A server with an empty store in a folder of its own, once start() is called."""

    def __init__(self):
        self.domain, self._claim = reserve_domain()
        self._folder = tempfile.TemporaryDirectory(prefix="kinship-python-")
        self.folder = pathlib.Path(self._folder.name)
        self._process = None

    def start(self, *arguments: str) -> None:
        """Returns when it serves."""
        program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinshipd"
        with open(self.folder / "log", "ab") as log:
            self._process = subprocess.Popen(
                [program, "--store", self.folder / "store.db", "--domain", str(self.domain), *arguments],
                stdout=subprocess.PIPE, stderr=log, text=True)
        ready = self._process.stdout.readline()
        if not ready.startswith("ready "):
            raise RuntimeError(f"kinshipd: {ready}{(self.folder / 'log').read_text()}")

    @property
    def pid(self) -> int:
        return self._process.pid

    def log(self) -> str:
        """What it has said so far."""
        return (self.folder / "log").read_text()

    def stop(self) -> None:
        """Ends it, if it runs."""
        if self._process:
            self._process.terminate()
            self._process.wait()
            self._process.stdout.close()
            self._process = None

    def run_kinship(self, *words: str) -> subprocess.CompletedProcess:
        """The admin program on this server, whatever its exit code; outputs are bytes."""
        program = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]) / "kinship"
        return subprocess.run([program, "--domain", str(self.domain), "--timeout", "30", *words], capture_output=True)

    def kinship_bytes(self, *words: str) -> bytes:
        """What it writes; it must succeed."""
        done = self.run_kinship(*words)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr.decode()}")
        return done.stdout

    def kinship(self, *words: str) -> str:
        return self.kinship_bytes(*words).decode()

    def register(self, *models: str) -> None:
        """Registers robots of robots/models."""
        for model in models:
            self.kinship("robots", "register", str(MODELS / model))

    def give(self, attempts: "list[dict]") -> None:
        """Imports lines of an experience file."""
        file = self.folder / "given.jsonl"
        file.write_text("".join(json.dumps(each) + "\n" for each in attempts))
        self.kinship("paths", "import", str(file))

    def __enter__(self) -> "Kinshipd":
        return self

    def __exit__(self, *exception) -> None:
        self.stop()
        self._claim.close()
        self._folder.cleanup()
