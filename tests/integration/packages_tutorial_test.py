"""docs/tutorial.md with the Debian packages alone: their programs, its files from kinship-doc.

They are installed by dpkg, which looks for what they depend on, over this machine's system, in a mount namespace where sources and
build are hidden. Needs root and a kernel with overlayfs.
"""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
BUILD = pathlib.Path(os.environ["KINSHIP_BIN_DIR"]).parent
PACKAGES = ["kinship-server", "kinship-client", "kinship-doc"]
DOCUMENTS = "/usr/share/doc/kinship"
# $1: an empty folder; the root of the new system is in it, and what it gets in memory.
OVERLAY = """
mount -t tmpfs tmpfs "$1" && mkdir "$1/upper" "$1/work" "$1/root" &&
  mount -t overlay -o "lowerdir=/,upperdir=$1/upper,workdir=$1/work" overlay "$1/root"
"""
# Then: a folder that becomes /tmp/given, and those to be hidden. None of the services that run here is told of what is installed.
INSTALL = f"""
set -e
{OVERLAY}
root=$1/root given=$2
shift 2
mount --rbind /dev "$root/dev"
mount -t proc proc "$root/proc"
for hidden in /tmp /run "$@"; do
  mkdir -p "$root$hidden"
  mount -t tmpfs tmpfs "$root$hidden"
done
cp -r "$given" "$root/tmp/given"
chroot "$root" sh -c 'dpkg --install /tmp/given/*.deb'
exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 KINSHIP_SOURCE_DIR={DOCUMENTS} KINSHIP_BIN_DIR=/usr/bin \\
  PYTHONPATH=/tmp/given python3 -B /tmp/given/tutorial.py
"""
RUN = f"""
import pathlib, sys
from document_run import DocumentRun
from markdown import Document

with DocumentRun(Document(pathlib.Path("{DOCUMENTS}/docs/tutorial.md")), with_packages=True) as run:
    run.run()
sys.exit("\\n\\n".join(run.failures) or 0)
"""


def in_namespace(script: str, *arguments, **options) -> subprocess.CompletedProcess:
    """In a mount namespace and one of processes, which end with it."""
    return subprocess.run(["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", script, "sh", *arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


class Tutorial(unittest.TestCase):
    def test_leads_through_with_what_is_installed(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="kinship-installed-")))
        given, space = folder / "given", folder / "space"
        space.mkdir()
        subprocess.run([SOURCE / "deploy" / "package", "--from", BUILD, "--into", given, *PACKAGES], check=True,
                       stdout=subprocess.DEVNULL,
                       env=os.environ | {"DPKG_DEB_COMPRESSOR_TYPE": "gzip", "DPKG_DEB_COMPRESSOR_LEVEL": "1"})
        shutil.rmtree(given / "stage")
        for module in [*(SOURCE / "tests" / "documents").glob("*.py"), SOURCE / "tests" / "support" / "kinshipd_process.py"]:
            shutil.copy(module, given)
        (given / "tutorial.py").write_text(RUN)
        done = in_namespace(INSTALL, space, given, SOURCE, BUILD)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as space:
        if os.geteuid() != 0 or in_namespace(OVERLAY, space).returncode != 0:
            print("SKIPPED: no overlay may be mounted here")
            raise SystemExit(77)
    unittest.main()
