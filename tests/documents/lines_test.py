"""No line of a document is longer than 120 characters, a folder's README has at most 60 lines, the changelog 90.

What a program prints in a console block is as long as the program prints it; everything else, tables too, keeps the limit.
"""
import os
import pathlib
import unittest

from markdown import Document, documents

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
MAX_LENGTH = 120
MAX_README_LINES = 60  # but the project's own
MAX_CHANGELOG_LINES = 90


def long_lines(document: Document) -> "list[tuple[int, int]]":
    """(line, length) of each line above the limit that no program prints."""
    printed = {command.output_line + index for block in document.blocks if block.language == "console"
               for command in block.commands() for index in range(len(command.output))}
    return [(number, len(line)) for number, line in enumerate(document.lines, 1)
            if len(line) > MAX_LENGTH and number not in printed]


def max_lines(path: pathlib.Path) -> "int | None":
    """How long a document may be; None: as long as it needs."""
    if path == SOURCE / "CHANGELOG.md":
        return MAX_CHANGELOG_LINES
    return MAX_README_LINES if path.name == "README.md" and path.parent != SOURCE else None


class Lines(unittest.TestCase):
    def test_are_no_longer_than_the_limit(self):
        found = [(path, long_lines(Document(path))) for path in documents(SOURCE)]
        self.assertGreater(len(found), 100)
        wrong = [f"{path.relative_to(SOURCE)}:{line}: {length} characters, above {MAX_LENGTH}"
                 for path, lines in found for line, length in lines]
        if wrong:
            self.fail("\n" + "\n".join(wrong))

    def test_of_a_readme_and_of_the_changelog_are_few(self):
        limited = [(path, max_lines(path), len(Document(path).lines)) for path in documents(SOURCE)
                   if max_lines(path) is not None]
        self.assertGreater(len(limited), 50)
        wrong = [f"{path.relative_to(SOURCE)}: {count} lines, above {limit}"
                 for path, limit, count in limited if count > limit]
        if wrong:
            self.fail("\n" + "\n".join(wrong))


if __name__ == "__main__":
    unittest.main()
