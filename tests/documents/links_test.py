"""Every link of every Markdown file that stays in the repository leads to something."""
import os
import pathlib
import unittest
import urllib.parse

from markdown import Document, documents

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])


class Links(unittest.TestCase):
    def test_lead_to_files_and_headings_that_exist(self):
        dead, looked_at = [], 0
        for path in documents(SOURCE):
            for line, target in Document(path).links():
                if urllib.parse.urlsplit(target).scheme:
                    continue
                looked_at += 1
                name, _, anchor = urllib.parse.unquote(target).partition("#")
                file = (path.parent / name).resolve() if name else path
                if not file.exists():
                    dead.append(f"{path.relative_to(SOURCE)}:{line}: there is no {target}")
                elif anchor and anchor not in Document(file).anchors():
                    dead.append(f"{path.relative_to(SOURCE)}:{line}: no heading makes #{anchor} in {name or 'it'}")
        self.assertGreater(looked_at, 100)
        if dead:
            self.fail("\n" + "\n".join(dead))


if __name__ == "__main__":
    unittest.main()
