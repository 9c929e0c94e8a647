"""The commands of one document, run in order, and what is wrong with them.

They run in one shell, in a folder that looks like the repository after `deploy/build`, with a DDS domain of their own. A comment
before a block says what else is to be known of it; README.md has the list.
"""
import difflib
import json
import os
import pathlib
import re
import shutil
import tempfile

from kinshipd_process import reserve_domain
from markdown import Command, Document
from output import match, normalised
from postgres_hosts import PostgresHosts
from terminal import Terminal

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
WITH_INSTALLED_PROGRAMS = {"fleet.md", "operations.md", "reference.md"}  # which are in the PATH from the start
WITH_PACKAGES_TOO = {"tutorial.md"}  # which walk_tutorial runs once more
DOMAINS = 4  # that a document may name as KINSHIP_DOMAIN; most name none, which is 0
LANGUAGES_WITHOUT_COMMANDS = {"text", "json", "toml", "cpp", "c", "python", "cmake", "xml", "yaml"}

NOT_RUN = re.compile(r"not run in the tests: \S+ \S+")
EXIT_CODE = re.compile(r"exit code (\d+)")
FIRST_LINE = "the first line of: "
BESIDE = "in a terminal of its own"
IN_THAT_TERMINAL = "in that terminal"  # the one before: Control-C
WITH_SOURCES, WITH_PACKAGES = "with the sources", "with the packages"  # for one reader or the other


def memory_root() -> "str | None":
    """A folder in memory, as tests/support/temporary_directory.hpp has it: with 1 GB of room, unless TMPDIR says where to go."""
    memory = pathlib.Path("/dev/shm")
    has_room = memory.is_dir() and shutil.disk_usage(memory).free >= 1 << 30 and os.access(memory, os.W_OK)
    return str(memory) if has_room and "TMPDIR" not in os.environ else None


class DocumentRun:
    """Use as a context: at its end everything that it started ends, and its folder goes."""

    def __init__(self, document: Document, is_written: bool = False, with_packages: bool = False):
        """:param is_written: another output is no failure, but goes into the document with write().
        :param with_packages: as for a reader who has installed the packages: in an empty folder, with the programs of the system.
        """
        self.document = document
        self.failures = []  # "file:line: what is wrong"
        self._is_written = is_written
        self._skipped = WITH_SOURCES if with_packages else WITH_PACKAGES
        self._outputs = []  # (command, lines to be written)
        self._domains, self._claims = zip(*(reserve_domain() for _ in range(DOMAINS)))
        self._home = tempfile.TemporaryDirectory(prefix="kinship-documents-", dir=memory_root())
        home = pathlib.Path(self._home.name)
        self._folder = home / "kinship"
        self._folder.mkdir()
        if not with_packages:
            self._lay_out()
        self._postgres = PostgresHosts(home, self._folder)
        path = "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
        if document.path.name in WITH_INSTALLED_PROGRAMS:
            path = f"{self._postgres.programs}:{PROGRAMS}:{path}"
        self._terminal = Terminal(self._folder, {
            "PATH": path, "HOME": str(home), "XDG_STATE_HOME": str(home / "state"), "LANG": "C.UTF-8",
            "KINSHIP_DOMAIN": str(self._domains[0])})

    def _lay_out(self) -> None:
        """As a clone after deploy/build, but what the commands write goes here."""
        for entry in SOURCE.iterdir():
            if not entry.name.startswith((".", "build")):
                (self._folder / entry.name).symlink_to(entry)
        (self._folder / "build" / "release").mkdir(parents=True)
        (self._folder / "build" / "release" / "bin").symlink_to(PROGRAMS)

    def run(self) -> None:
        """Until a command fails; those behind it would fail because of it."""
        for block in self.document.blocks:
            if block.language == "console":
                if not self._run_block(block):
                    break
            elif block.mark.startswith(FIRST_LINE):
                self._compare_json(block)
            elif block.language not in LANGUAGES_WITHOUT_COMMANDS:
                self._fail(block.line, f"a block of language '{block.language}': commands belong into console blocks, "
                           f"other texts are {', '.join(sorted(LANGUAGES_WITHOUT_COMMANDS))}")
        for line, text in self.document.indented_code():
            self._fail(line, f"code without a fence, which nobody runs: {text.strip()}")

    def _run_block(self, block) -> bool:
        """:return: false if a command failed."""
        commands = block.commands()
        exit_code = EXIT_CODE.fullmatch(block.mark)
        if block.mark == self._skipped and self.document.path.name in WITH_PACKAGES_TOO:
            return True
        if block.mark == IN_THAT_TERMINAL and block.lines == ["^C"]:
            if code := self._terminal.interrupt():
                self._fail(block.line, f"exit code {code} of what was interrupted")
        elif not commands:
            self._fail(block.line, "a console block without a command: it begins with '$ '")
        elif block.mark == BESIDE:
            for command in commands:
                lines = self._terminal.start(
                    self._placed(command.text), lambda lines, wanted=command.output: match(wanted, self._shown(lines)) is not None)
                self._compare(command, lines)
        elif NOT_RUN.match(block.mark):
            return True
        elif block.mark and not exit_code and block.mark not in (WITH_SOURCES, WITH_PACKAGES):
            self._fail(block.line, f"the comment '{block.mark}' is none of those in tests/documents/README.md")
        else:
            for command in commands:
                wanted = int(exit_code[1]) if exit_code and command is commands[-1] else 0
                code, lines = self._terminal.run(self._placed(command.text))
                if code != wanted:
                    self._fail(command.line, f"$ {command.text}\nexit code {code}, not {wanted}:\n" + "\n".join(lines))
                    return False
                self._compare(command, lines)
        return True

    def _compare_json(self, block) -> None:
        """A document shown in many lines is one line of a command's output."""
        _, lines = self._terminal.run(block.mark[len(FIRST_LINE):])
        if json.loads("\n".join(block.lines)) != json.loads(lines[0]):
            self._fail(block.line, f"this is not {block.mark}, which is\n{lines[0]}")

    def _compare(self, command: Command, lines: "list[str]") -> None:
        shown = self._shown(lines)
        found = match(command.output, shown)
        if found is None and not (self._is_written and "..." not in "".join(command.output)):
            difference = difflib.unified_diff([normalised(line) for line in command.output],
                                              [normalised(line) for line in shown], "document", "output", lineterm="")
            self._fail(command.line, f"$ {command.text}\nprints something else\n" + "\n".join(difference) +
                       "\n\nIn full:\n" + "\n".join(shown))
        elif found is None:
            self._outputs.append((command, shown))
        else:
            fresh = [line if i is None or line.rstrip().endswith("...") else shown[i]
                     for line, i in zip(command.output, found)]
            self._outputs.append((command, fresh))

    def _placed(self, text: str) -> str:
        """A command with the domains and ports of this run in place of those that the document names."""
        text = re.sub(r"\bKINSHIP_DOMAIN=(\d)\b", lambda named: f"KINSHIP_DOMAIN={self._domains[int(named[1])]}", text)
        return self._postgres.placed(text)

    def _shown(self, lines: "list[str]") -> "list[str]":
        """As a reader has them: without this run's folder, domains and ports, and without empty lines at the end."""
        shown = []
        for line in lines:
            line = line.replace(str(self._folder), "/home/you/kinship").replace(self._home.name, "/home/you")
            for number, domain in enumerate(self._domains):
                line = re.sub(rf"\b(domain[ =]){domain}\b", rf"\g<1>{number}", line)
            shown.append(self._postgres.shown(line).rstrip())
        while shown and not shown[-1]:
            shown.pop()
        return shown

    def _fail(self, line: int, text: str) -> None:
        self.failures.append(f"{self.document.path.name}:{line}: {text}")

    def write(self) -> None:
        """This run's outputs into the document."""
        lines = list(self.document.lines)
        for command, output in sorted(self._outputs, key=lambda pair: -pair[0].line):
            first = command.output_line - 1
            lines[first:first + len(command.output)] = output
        self.document.path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def __enter__(self) -> "DocumentRun":
        return self

    def __exit__(self, *exception) -> None:
        codes = self._terminal.close()
        if any(codes):
            self.failures.append(f"{self.document.path.name}: what ran beside ended with {codes}")
        self._postgres.close()
        for claim in self._claims:
            claim.close()
        self._home.cleanup()
