"""Verbs and options that documents name are in the programs' --help.

Looked at are code spans and commands that begin with a program's name, in every Markdown file, and in those for users also spans that
are an option alone (`--server HOST`), which some program must have. KINSHIP_WRITE_DOCUMENTS=1 writes the table of verbs of docs/reference.md.
"""
import functools
import os
import pathlib
import re
import subprocess
import unittest

from markdown import Document, documents

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
FOLDER_OF_PROGRAMS = pathlib.Path(os.environ["KINSHIP_BIN_DIR"])
PROGRAMS = ("kinship", "kinshipd", "kinship-plan", "kinship-experiments")
IS_WRITTEN = os.environ.get("KINSHIP_WRITE_DOCUMENTS") == "1"
HISTORY = ("CHANGELOG.md",)  # speaks of what was, too
FOR_USERS = ("README.md", "docs/*.md", "deploy/README.md")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
VERB = re.compile(r"[a-z][a-z-]*")


@functools.lru_cache(maxsize=None)
def help_of(*words: str) -> str:
    """What `PROGRAM VERBS --help` says."""
    done = subprocess.run([FOLDER_OF_PROGRAMS / words[0], *words[1:], "--help"], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)} --help: {done.returncode}: {done.stdout}")
    return done.stdout


def verbs_of(*words: str) -> "set[str]":
    """The verbs that its help lists."""
    section = re.search(r"^Subcommands:\n((?:[ \t].*\n|\n)*)", help_of(*words), re.MULTILINE)
    return set(re.findall(r"^  ([a-z][a-z-]*)\b", section[1], re.MULTILINE)) if section else set()


def has_verb(path: "tuple[str, ...]", verb: str) -> bool:
    """Also one that the list hides: then its own help begins with its own usage, not with that of what it belongs to."""
    return verb in verbs_of(*path) or f"Usage: {' '.join(path)} {verb} " in help_of(*path, verb)


def tree(*words: str) -> "list[tuple[str, ...]]":
    """The command and all below it."""
    return [words] + [found for verb in sorted(verbs_of(*words)) for found in tree(*words, verb)]


def table_of_verbs() -> str:
    """Each verb of kinship, with what its help says of it."""
    rows = ["| `kinship` | What it does |", "|---|---|"]
    for words in tree("kinship")[1:]:
        what, usage = help_of(*words).split("Usage:", 1)
        if not usage.splitlines()[0].endswith(" SUBCOMMAND"):
            rows.append(f"| `{' '.join(words[1:])}` | {' '.join(what.split())} |")
    return "\n".join(rows)


def what_is_missing(command: str) -> "list[str]":
    """Verbs and options of a command line that no help names. `a|b` are two verbs."""
    command = re.split(r"\s[|&;]\s|\s#|\$\(", command)[0]
    words, missing = command.replace("\\\n", " ").split(), []
    known = [(words[0],)]
    for word in words[1:]:
        alternatives = word.strip(",.;:").split("|")
        if not all(VERB.fullmatch(verb) for verb in alternatives) or not any(verbs_of(*path) for path in known):
            if word.startswith("--") and len(known[0]) == 1 and verbs_of(*known[0]):
                continue  # an option before the verb; its value may look like one
            break
        for path in known:
            missing += [f"{' '.join(path)} has no '{verb}'" for verb in alternatives if not has_verb(path, verb)]
        if missing:
            return missing
        known = [path + (verb,) for path in known for verb in alternatives]
    above = [path[:length] for path in known for length in range(1, len(path))]
    helps = "".join(help_of(*path) for path in above + [below for path in known for below in tree(*path)])
    return [f"{' '.join(known[0])} has no {option}" for option in OPTION.findall(command) if option not in helps]


def command_lines(document: Document) -> "list[tuple[int, str]]":
    """What is a command line of ours in spans and blocks."""
    texts = document.spans()
    for block in document.blocks:
        texts += [(command.line, command.text) for command in block.commands()] if block.language == "console" else []
    texts += [(line, text.strip()) for line, text in document.indented_code()]
    ours = re.compile(r"^(?:\S*bin/)?(kinship(?:d|-plan|-experiments)?)(?:\s|$)")
    return [(line, ours.sub(r"\1 ", text).strip()) for line, text in texts if ours.match(text)]


class Names(unittest.TestCase):
    def test_of_commands_are_in_their_help(self):
        wrong, looked_at = [], 0
        for path in documents(SOURCE):
            if path.name in HISTORY:
                continue
            for line, command in command_lines(Document(path)):
                looked_at += 1
                wrong += [f"{path.relative_to(SOURCE)}:{line}: {text}" for text in what_is_missing(command)]
        self.assertGreater(looked_at, 100)
        if wrong:
            self.fail("\n" + "\n".join(wrong))

    def test_options_alone_are_some_programs(self):
        every_help = "".join(help_of(*command) for program in PROGRAMS for command in tree(program))
        every_help += "".join(path.read_text(encoding="utf-8") for path in (SOURCE / "deploy").iterdir() if path.is_file())
        wrong = []
        for pattern in FOR_USERS:
            for path in SOURCE.glob(pattern):
                for line, text in Document(path).spans():
                    if text.startswith("--"):
                        wrong += [f"{path.relative_to(SOURCE)}:{line}: no program has {option}"
                                  for option in OPTION.findall(text) if option not in every_help]
        if wrong:
            self.fail("\n" + "\n".join(wrong))

    def test_of_verbs_are_the_table_of_the_reference(self):
        reference = SOURCE / "docs" / "reference.md"
        before, rest = reference.read_text(encoding="utf-8").split("| `kinship` |", 1)
        table, after = ("| `kinship` |" + rest).split("\n\n", 1)
        if IS_WRITTEN:
            reference.write_text(f"{before}{table_of_verbs()}\n\n{after}", encoding="utf-8")
        else:
            self.assertEqual(table, table_of_verbs())


if __name__ == "__main__":
    unittest.main()
