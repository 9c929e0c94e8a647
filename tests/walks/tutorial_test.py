"""docs/tutorial.md with the packages alone: their programs, its files from kinship-doc."""
import shutil
import subprocess

import walk
from installed_machine import SOURCE

DOCUMENTS = "/usr/share/doc/kinship"
RUN = f"""
import pathlib, sys
from document_run import DocumentRun
from markdown import Document

with DocumentRun(Document(pathlib.Path("{DOCUMENTS}/docs/tutorial.md")), with_packages=True) as run:
    run.run()
sys.exit("\\n\\n".join(run.failures) or 0)
"""


class Tutorial(walk.WalkTest):
    def test_leads_through_with_what_is_installed(self):
        machine = self.machine("kinship-server", "kinship-client", "kinship-doc")
        given = machine.home() / "given"
        given.mkdir()
        for module in [*(SOURCE / "tests" / "documents").glob("*.py"), SOURCE / "tests" / "support" / "kinshipd_process.py"]:
            shutil.copy(module, given)
        (given / "tutorial.py").write_text(RUN)
        done = subprocess.run(machine.command(f"KINSHIP_SOURCE_DIR={DOCUMENTS} KINSHIP_BIN_DIR=/usr/bin python3 -B given/tutorial.py"),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    walk.main()
