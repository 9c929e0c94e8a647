"""The Debian packages that deploy/package makes of this build: what is in them, and what lintian says."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
sys.path.append(str(SOURCE / "tests" / "documents"))
from markdown import Document  # noqa: E402

FILES = {
    "kinship-server": ["usr/bin/kinshipd", "usr/share/man/man8/kinshipd.8.gz", "etc/kinship/kinshipd.toml", "usr/lib/kinship/backup",
                       "usr/lib/sysusers.d/kinship.conf", "usr/lib/systemd/system/kinshipd.service",
                       "usr/lib/systemd/system/kinship-backup.service", "usr/lib/systemd/system/kinship-backup.timer",
                       "usr/share/doc/kinship-server/kinship.json", "usr/share/doc/kinship-server/kinship.rules.yml"],
    "kinship-client": ["usr/bin/kinship", "usr/share/man/man1/kinship.1.gz", "usr/bin/kinship-plan", "usr/share/kinship/robots/panda/robot.urdf",
                       "usr/share/kinship/results/compare.py", "usr/share/kinship/results/kinship_results/comparison.py",
                       "usr/share/kinship/schemas/problem-1.schema.json"],
    "kinship-doc": ["usr/share/doc/kinship/README.md", "usr/share/doc/kinship/docs/tutorial.md", "usr/share/doc/kinship/docs/tutorial/problems.py",
                    "usr/share/doc/kinship/docs/tutorial/my_arm/robot.urdf", "usr/share/doc/kinship/examples/CMakeLists.txt",
                    "usr/share/doc/kinship/client/examples/01_report_a_path.cpp", "usr/share/doc/kinship/robots/models/ur10e"],
    "libkinship-dev": [r"usr/lib/(\S+/)?cmake/Kinship/KinshipConfig.cmake", r"usr/include/kinship-\S+/kinship/client.hpp",
                       "usr/include/kinship.h", r"usr/lib/(\S+/)?libkinship.so.*", r"usr/lib/(\S+/)?pkgconfig/kinship.pc"],
    "python3-kinship": [r"usr/lib/python3/dist-packages/kinship/\S+\.so", r"usr/lib/python3/dist-packages/kinship/__init__.py"],
}


def run(*command, **options) -> str:
    ran = subprocess.run(command, capture_output=True, text=True, **options)
    if ran.returncode != 0:
        raise AssertionError(f"{command}: exit code {ran.returncode}\n{ran.stdout}{ran.stderr}")
    return ran.stdout


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="kinship-packages-")))
        cls.packages = {file.name.split("_")[0]: file for file in pathlib.Path(os.environ["KINSHIP_PACKAGES_DIR"]).glob("*.deb")}

    def field(self, name: str, field: str) -> str:
        return run("dpkg-deb", "--field", self.packages[name], field).strip()

    def test_are_five_of_this_version(self):
        self.assertEqual(set(self.packages), set(FILES))
        version = re.search(r"^project\(kinship VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(), re.M).group(1)
        for package in (SOURCE / "client" / "ros2").glob("*/package.xml"):  # of colcon
            self.assertIn(f"<version>{version}</version>", package.read_text(), package)
        architecture = run("dpkg", "--print-architecture").strip()
        for name in FILES:
            self.assertEqual(self.field(name, "Version"), version)
            self.assertEqual(self.field(name, "Architecture"), "all" if name == "kinship-doc" else architecture)

    def test_have_their_files_which_belong_to_root(self):
        for name, wanted in FILES.items():
            rows = [row.split(maxsplit=5) for row in run("dpkg-deb", "--contents", self.packages[name]).splitlines()]
            paths = [row[5].removeprefix("./") for row in rows]
            for path in [*wanted, rf"usr/share/doc/{name}/copyright", rf"usr/share/doc/{name}/changelog.gz"]:
                self.assertTrue(any(re.fullmatch(path, each.split(" -> ")[0]) for each in paths), f"{name}: {path}")
            self.assertEqual({row[1] for row in rows}, {"root/root"}, name)
            writable = [row[5] for row in rows if row[0][0] != "l" and (row[0][5] == "w" or row[0][8] == "w" or "s" in row[0])]
            self.assertEqual(writable, [], name)
            here = [path for path in paths if str(SOURCE) in path or "/build/" in path]
            self.assertEqual(here, [], name)

    def test_need_what_their_programs_are_linked_with(self):
        for name, library in {"kinship-server": "libsqlite3-0", "kinship-client": "libompl", "libkinship-dev": "libddsc",
                              "python3-kinship": "libddsc"}.items():
            self.assertIn(library, self.field(name, "Depends"), name)
            self.assertIn("libc6", self.field(name, "Depends"), name)

    def test_module_needs_the_python_that_loads_it(self):
        module = re.search(r"\.cpython-3(\d+)-", run("dpkg-deb", "--contents", self.packages["python3-kinship"]))
        wanted = f"python3 (>= 3.{module[1]}), python3 (<< 3.{int(module[1]) + 1})"
        self.assertIn(wanted, self.field("python3-kinship", "Depends"))

    def test_links_of_the_documents_lead_to_what_is_installed(self):
        root = self.folder / "installed"
        for name in ("kinship-doc", "kinship-client"):
            run("dpkg-deb", "--extract", self.packages[name], root)
        documents = root / "usr/share/doc/kinship"
        for_users = [documents / "README.md", *(documents / "docs").glob("*.md"), documents / "client" / "examples" / "README.md"]
        dead = [f"{path.relative_to(documents)}: {target}" for path in for_users for _, target in Document(path).links()
                if not urllib.parse.urlsplit(target).scheme and not (path.parent / target.partition("#")[0]).exists()]
        self.assertEqual(dead, [])
        self.assertEqual([link for link in documents.rglob("*") if not link.exists()], [])
        self.assertTrue((documents / "examples" / "CMakeLists.txt").is_file())
        self.assertTrue((documents / "robots/models/ur10e/robot.urdf").is_file())

    def test_keep_what_an_administrator_changes(self):
        root = self.folder / "control"
        run("dpkg-deb", "--control", self.packages["kinship-server"], root)
        self.assertEqual((root / "conffiles").read_text().split(), ["/etc/kinship/kinshipd.toml"])

    def test_bring_their_scripts(self):
        for name, scripts in {"kinship-server": {"postinst", "prerm", "postrm"}, "kinship-client": set(), "kinship-doc": set(),
                              "libkinship-dev": set(), "python3-kinship": {"postinst", "prerm"}}.items():
            root = self.folder / f"scripts-of-{name}"
            run("dpkg-deb", "--control", self.packages[name], root)
            found = [file for file in root.iterdir() if file.name in ("preinst", "postinst", "prerm", "postrm")]
            self.assertEqual({file.name for file in found}, scripts, name)
            for file in found:
                self.assertEqual(file.stat().st_mode & 0o777, 0o755, file)
                run("sh", "-n", file)

    def test_units_name_what_is_installed(self):
        paths = {row.split()[5].removeprefix(".") for name in ("kinship-server", "kinship-client")
                 for row in run("dpkg-deb", "--contents", self.packages[name]).splitlines()}
        for unit in (SOURCE / "deploy" / "systemd").glob("*.service"):
            for program in re.findall(r"^ExecStart=(\S+)", unit.read_text(), re.M):
                self.assertIn(program, paths, unit.name)

    def test_lintian_finds_no_error(self):
        run("lintian", "--allow-root", "--fail-on", "error", *self.packages.values())


if __name__ == "__main__":
    unittest.main()
