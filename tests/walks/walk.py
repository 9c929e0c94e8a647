"""What the walks share: machines and people until the end of a test, and what is told of each walk."""
import unittest

from installed_machine import InstalledMachine, Person, Walk, can_make_machines

SKIPPED = 77


class WalkTest(unittest.TestCase):
    def setUp(self):
        self.walk = Walk(self.id().rsplit(".", 1)[-1].removeprefix("test_"))
        self.addCleanup(lambda: print(self.walk.told()))

    def machine(self, *packages: str) -> InstalledMachine:
        return self.enterContext(InstalledMachine(*packages))

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
