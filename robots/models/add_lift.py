#!/usr/bin/python3
"""Writes robots/models/NAME_lift: the arm of robots/models/NAME on a lift of our own.

    /usr/bin/python3 robots/models/add_lift.py panda iiwa14
"""
import pathlib
import re
import sys

MODELS = pathlib.Path(__file__).resolve().parent

# z up, x to the front; the arm stands 0.3 m above the floor when the lift is down.
LIFT = """
  <!-- The lift: a foot and a column behind the arm, and a plate that carries the arm up by 0.6 m. -->
  <link name="lift_foot">
    <collision><origin xyz="-0.15 0 0.06"/><geometry><box size="0.6 0.5 0.12"/></geometry></collision>
    <collision><origin xyz="-0.38 0 0.56"/><geometry><box size="0.12 0.2 0.88"/></geometry></collision>
  </link>
  <link name="lift_plate">
    <collision><origin xyz="-0.12 0 -0.04"/><geometry><box size="0.4 0.24 0.08"/></geometry></collision>
  </link>
  <joint name="lift_joint" type="prismatic">
    <parent link="lift_foot"/>
    <child link="lift_plate"/>
    <origin xyz="0 0 0.3"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.6" velocity="0.1" effort="1000"/>
  </joint>
  <joint name="lift_mount" type="fixed">
    <parent link="lift_plate"/>
    <child link="{base}"/>
    <origin xyz="0 0 0"/>
  </joint>
"""

SOURCE = """# Where the numbers of this arm on a lift are from

- The arm and its gripper: [../{name}](../{name}/SOURCE.md), unchanged, under the licence of its sources.
- The lift: of our own, no product: a foot of 0.6 x 0.5 m, a column of 1 m behind the arm, 0.6 m of travel. Written by
  `../add_lift.py`.
- `never_colliding`: that of the arm, and foot and plate with the arm's first moving link, which turns on the plate before the column.
"""


def add_lift(name: str) -> None:
    """Raises OSError if there is no such model."""
    chain = (MODELS / name / "chain.toml").read_text()
    base = re.search(r'^base = "(.*)"', chain, re.M).group(1)
    urdf = (MODELS / name / "robot.urdf").read_text()
    first = re.search(r'<parent link="%s"/>\s*<child link="(.*)"/>' % base, urdf).group(1)
    folder = MODELS / f"{name}_lift"
    folder.mkdir(exist_ok=True)
    urdf = urdf.replace(f'<robot name="{name}">\n', f'<robot name="{name}_lift">\n{LIFT.format(base=base)}', 1)
    (folder / "robot.urdf").write_text(urdf.replace("See SOURCE.md.", "On a lift; see SOURCE.md.", 1))
    chain = chain.replace(f'label = "{name}"', f'label = "{name}_lift"', 1).replace(f'base = "{base}"', 'base = "lift_foot"', 1)
    (folder / "chain.toml").write_text(
        chain.replace("never_colliding = [\n", f'never_colliding = [\n  ["lift_foot", "{first}"],\n  ["lift_plate", "{first}"],\n', 1))
    (folder / "SOURCE.md").write_text(SOURCE.format(name=name))


for model in sys.argv[1:]:
    add_lift(model)
