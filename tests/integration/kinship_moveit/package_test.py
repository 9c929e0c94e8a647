"""client/ros2/kinship_moveit as colcon builds it: with Debian's ament_cmake, against an installed libkinship and the stubs."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["KINSHIP_SOURCE_DIR"])
PACKAGE = SOURCE / "client/ros2/kinship_moveit"
STUBS = SOURCE / "tests/integration/kinship_moveit/stubs"


def run(*words, **environment):
    done = subprocess.run([str(word) for word in words], env={**os.environ, **environment}, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, words))}:\n{done.stdout}")
    return done.stdout


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kinship-ament-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        run("cmake", "--install", os.environ["KINSHIP_BUILD_DIR"], "--prefix", self.folder / "kinship", "--component", "c")
        for package in ("geometric_shapes", "moveit_core", "rclcpp"):
            config = self.folder / "stubs/share" / package / "cmake" / f"{package}Config.cmake"
            config.parent.mkdir(parents=True)
            config.write_text(f"set({package}_INCLUDE_DIRS {STUBS}/common {STUBS}/jazzy /usr/include/eigen3)\n")

    def configure(self, *options, prefixes=(), **environment):
        prefixes = ";".join(map(str, (self.folder / "stubs", *prefixes)))
        return run("cmake", "-G", "Ninja", "-S", PACKAGE, "-B", self.folder / "build", f"-DCMAKE_PREFIX_PATH={prefixes}",
                   "-DPython3_EXECUTABLE=/usr/bin/python3", f"-DCMAKE_INSTALL_PREFIX={self.folder}/installed", *options,
                   **environment)

    def test_is_configured_with_pkg_config_alone(self):
        pkgconfig = next(self.folder.glob("kinship/lib*/**/pkgconfig"))
        said = self.configure("-DCMAKE_DISABLE_FIND_PACKAGE_Kinship=TRUE", PKG_CONFIG_PATH=str(pkgconfig))
        self.assertIn("Found kinship", said)

    def test_is_built_and_installed_as_a_package_with_plugins(self):
        self.configure(*os.environ["KINSHIP_LAUNCHERS"].split(), prefixes=[self.folder / "kinship"])
        run("cmake", "--build", self.folder / "build", "--target", "install")
        installed = self.folder / "installed"
        index = installed / "share/ament_index/resource_index"
        described = (index / "moveit_core__pluginlib__plugin/kinship_moveit").read_text().strip()
        self.assertTrue((installed / described).is_file(), described)
        self.assertTrue((index / "packages/kinship_moveit").is_file())
        for file in ("lib/libkinship_moveit.so", "share/kinship_moveit/package.xml",
                     "share/kinship_moveit/config/panda_kinship.yaml", "share/kinship_moveit/launch/panda_kinship.launch.py"):
            self.assertTrue((installed / file).is_file(), file)
        needed = run("readelf", "-d", installed / "lib/libkinship_moveit.so")
        self.assertIn("libkinship.so.0", needed)
        for name in ("libompl", "libfcl", "libddsc"):  # none of Debian's beside ROS's
            self.assertNotIn(name, needed)

    def test_every_parameter_is_in_the_yaml(self):
        """A parameter that nobody can find is none, and a line that nothing reads misleads."""
        read = set(re.findall(r'"kinship\.(\w+)"', (PACKAGE / "src/settings.cpp").read_text()))
        documented = set()
        for line in (PACKAGE / "config/panda_kinship.yaml").read_text().splitlines():
            text = line.strip().removeprefix("# ")
            name, colon, _ = text.partition(": ")
            if line.startswith("      ") and colon and name.isidentifier() and name == name.lower():
                documented.add(name)
        self.assertEqual(read, documented)


if __name__ == "__main__":
    unittest.main()
