"""What the walks share: packages once, people who leave at the end, and what is told of each."""
import unittest

from installed_machine import InstalledMachine, Packages, Person, Walk, can_make_machines

SKIPPED = 77


class WalkTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.packages = Packages()
        cls.addClassCleanup(cls.packages.close)

    def setUp(self):
        self.walk = Walk(self.id().rsplit(".", 1)[-1].removeprefix("test_"))
        self.addCleanup(lambda: print(self.walk.told()))

    def machine(self, *packages: str) -> InstalledMachine:
        return self.enterContext(InstalledMachine(self.packages, *packages))

    def person(self, machine: InstalledMachine) -> Person:
        person = Person(machine, self.walk)
        self.addCleanup(person.leave)
        return person


def main() -> None:
    """Of each walk's file."""
    if not can_make_machines():
        print("SKIPPED: no namespaces and overlays may be made here")
        raise SystemExit(SKIPPED)
    unittest.main(module="__main__")
