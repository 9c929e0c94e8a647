"""Every command of README.md and docs/ runs, in the order of its document, and prints what the document shows.

KINSHIP_WRITE_DOCUMENTS=1 puts the output of this run into the documents; what stands for `...` stays.
"""
import os
import pathlib
import unittest

from document_run import SOURCE, DocumentRun
from markdown import Document

IS_WRITTEN = os.environ.get("KINSHIP_WRITE_DOCUMENTS") == "1"
DOCUMENTS = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


class Commands(unittest.TestCase):
    """A test per document, below."""

    def run_document(self, path: pathlib.Path) -> None:
        with DocumentRun(Document(path), IS_WRITTEN) as run:
            run.run()
        if IS_WRITTEN:
            run.write()
        if run.failures:
            self.fail("\n\n" + "\n\n".join(run.failures))


def _test_of(path):
    return lambda self: self.run_document(path)


for _path in DOCUMENTS:
    setattr(Commands, "test_" + "_".join(_path.relative_to(SOURCE).with_suffix("").parts).lower(), _test_of(_path))

if __name__ == "__main__":
    unittest.main()
