"""What a document about PostgreSQL finds on its hosts: the programs, run as somebody whom PostgreSQL serves, and free ports."""
import os
import pathlib
import shutil
import socket
import subprocess

# Of the newest version that is installed: 15 in Debian 12, 17 in Debian 13.
PROGRAMS = max(pathlib.Path("/usr/lib/postgresql").glob("*/bin"), key=lambda folder: int(folder.parent.name), default=pathlib.Path("/"))
NAMES = ["initdb", "pg_basebackup", "pg_ctl", "psql", "openssl"]
DOCUMENT_PORTS = (5433, 5434)


class PostgresHosts:
    """The programs begin as the user who runs the tests, or, because PostgreSQL refuses root, as user postgres."""

    def __init__(self, home: pathlib.Path, folder: pathlib.Path):
        """:param folder: where the clusters are going to be, within `home`."""
        self.programs = home / "postgres"
        self._folder = folder
        self._ports = _free_ports(len(DOCUMENT_PORTS))
        self.programs.mkdir()
        for name in NAMES:
            self._write_program(name)
        if os.geteuid() == 0:
            home.chmod(0o755)
            folder.chmod(0o777)

    def _write_program(self, name: str) -> None:
        program = shutil.which(name, path=f"{PROGRAMS}:/usr/bin")
        if program is None:
            return
        before = "setpriv --reuid=postgres --regid=postgres --init-groups " if os.geteuid() == 0 else ""
        file = self.programs / name
        file.write_text(f'#!/bin/sh\nexec {before}"{program}" "$@"\n', encoding="utf-8")
        file.chmod(0o755)

    def placed(self, text: str) -> str:
        """With the ports of this run in place of those of the document."""
        for named, port in zip(DOCUMENT_PORTS, self._ports):
            text = text.replace(str(named), str(port))
        return text

    def shown(self, line: str) -> str:
        """The other way round."""
        for named, port in zip(DOCUMENT_PORTS, self._ports):
            line = line.replace(str(port), str(named))
        return line

    def close(self) -> None:
        """Ends what still runs."""
        for file in self._folder.glob("*/postmaster.pid"):
            subprocess.run([self.programs / "pg_ctl", "stop", f"--pgdata={file.parent}", "--mode=immediate"],
                           stdout=subprocess.DEVNULL, check=False)


def _free_ports(count: int) -> "list[int]":
    """Below those that the system gives away by itself; two runs at once begin at different ones."""
    ports = []
    for port in range(15000 + os.getpid() % 8000, 32000):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        ports.append(port)
        if len(ports) == count:
            return ports
    raise RuntimeError("no free port of this machine for PostgreSQL")
