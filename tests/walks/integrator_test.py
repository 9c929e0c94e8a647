"""An integrator: an arm of meshes and MoveIt's scenes of his cell; another robot has done the task. He ends with guided trajectories."""
import json
import re

import own_cell
import walk

DOCUMENTS = "/usr/share/doc/kinship"


class Integrator(walk.WalkTest):
    def test_meshes_and_moveit_scenes_to_a_guided_trajectory(self):
        me = self.person(self.machine("kinship-server", "kinship-client", "kinship-doc"))
        urdf = own_cell.write_arm(me)

        me.run(f"kinship robots links {urdf}")
        me.run(f'kinship robots init {urdf} -o arm --base base --tip flange --transfer "0.1 0 0 0 0.70710678 0 0.70710678" '
               "--hold left_finger_joint=0.04 --hold right_finger_joint=0.04")
        checked = me.run("kinship robots check arm")
        self.assertRegex(checked, r"geometry +10 ")
        self.assertNotIn("millimetres", checked)

        me.run(f'{DOCUMENTS}/docs/tutorial/problems.py "-0.7 0 0.1 0 0 0 1" > fleet.problems.jsonl')
        cell = json.loads(me.read("fleet.problems.jsonl").splitlines()[0])
        me.write("scene.yaml", own_cell.scene(cell))
        me.write("requests.yaml", "---\n".join(own_cell.request(start, cell["goal"]["pose"]) for start in self.starts(me)))
        me.run("kinship problems from-moveit arm --scene scene.yaml --request requests.yaml "
               f'--placement "-{own_cell.BEHIND} 0 0 0 0 0 1" --output mine.problems.jsonl')
        self.assertEqual(len(me.read("mine.problems.jsonl").splitlines()), 4)

        me.serve("kinshipd --store fleet.db")
        me.run("kinship-plan fleet.problems.jsonl --robot ur10e --task load_machine --report --output fleet.jsonl")
        told = me.run("kinship-plan mine.problems.jsonl --robot arm --task load_machine --guidance require --rehearsed --report "
                      "--output mine.jsonl")
        self.assertRegex(told, r"planned 4 of 4 problems, 4 solved; [1-4] guided")
        mine = [json.loads(line) for line in me.read("mine.jsonl").splitlines()]
        self.assertTrue(all(result["waypoints"] for result in mine))

        me.run("kinship paths export --task load_machine --robot arm --moveit trajectories.yaml")
        trajectories = me.read("trajectories.yaml")
        self.assertEqual(len(re.findall(r"^ *model_id:", trajectories, re.M)), 4, trajectories[:2000])
        self.assertLessEqual(self.walk.commands, 14)

    def starts(self, me) -> "list[list[float]]":
        """Configurations over four places of the pallet, as his cell's program has them: asked of `kinship robots ik` once each."""
        found = []
        for x, y in ((-0.12, 0.34), (-0.04, 0.42), (0.04, 0.42), (0.12, 0.5)):
            told = me.run(f'kinship robots ik arm --frame transfer --pose "{x + own_cell.BEHIND:.2f} {y} 0.16 1 0 0 0"')
            found.append([float(q) for q in told.splitlines()[1].split()])
        return found


if __name__ == "__main__":
    walk.main()
