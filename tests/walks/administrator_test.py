"""An administrator with two hosts: a secured server on one, a robot's computer on the other; a copy that is put back at the end."""
import json
import re
import shutil

import walk


class Administrator(walk.WalkTest):
    def test_two_hosts_from_packages_to_a_copy_put_back(self):
        hall, cell = self.machine("kinship-server", "kinship-client", "kinship-doc"), self.machine("kinship-client", "kinship-doc")
        hall.connect(cell, "10.77.0.1", "10.77.0.2")
        admin, robot = self.person(hall), self.person(cell)

        admin.run("kinshipd secure init security")
        admin.run("kinshipd secure add arm_7 --security security --role robot --out arm_7")
        admin.run("kinshipd secure add desk --security security --role admin --out desk")
        self.carry(admin, robot, "arm_7")
        server = admin.serve("kinshipd --interface eth0 --security security --store fleet.db --backup-folder .")

        robot.export(KINSHIP_SERVER="10.77.0.1", KINSHIP_SECURITY="arm_7")
        robot.run('/usr/share/doc/kinship/docs/tutorial/problems.py "-0.7 0 0.1 0 0 0 1" > problems.jsonl')
        told = robot.run("kinship-plan problems.jsonl --robot ur10e --task load_machine --report --output first.jsonl")
        self.assertRegex(told, r"24 acknowledged, 0 pending, 0 refused")
        robot.run("kinship-plan problems.jsonl --robot ur10e --task load_machine --guidance require --output guided.jsonl")
        self.assertTrue(any(json.loads(line)["guidance"] for line in robot.read("guided.jsonl").splitlines()))

        admin.export(KINSHIP_SERVER="10.77.0.1", KINSHIP_SECURITY="desk")
        self.assertRegex(admin.run("kinship status"), r"(?m)^writable +yes")
        self.assertRegex(admin.run("kinship status --clients"), "arm_7")
        admin.run("kinship backup night.db")
        self.assertRegex(admin.run("kinshipd check --store night.db"), r"(?m)^sound$")
        admin.run("kinship tasks reset load_machine --yes")
        self.assertEqual(self.paths(admin), 0)

        admin.stop(server)
        admin.run("kinshipd restore --store fleet.db night.db")
        admin.serve("kinshipd --interface eth0 --security security --store fleet.db --backup-folder .")
        self.assertEqual(self.paths(admin), 24, "what the copy had is served again")
        self.assertLessEqual(self.walk.commands, 18)

    def carry(self, admin, robot, folder: str) -> None:
        """A stick: between two machines that know nothing of each other yet."""
        shutil.copytree(admin.machine.home() / folder, robot.machine.home() / folder)

    def paths(self, admin) -> int:
        told = admin.run("kinship tasks show load_machine")
        return int(re.search(r"^experience +(\d+) paths", told, re.M)[1])


if __name__ == "__main__":
    walk.main()
