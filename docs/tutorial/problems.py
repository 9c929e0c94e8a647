#!/usr/bin/env python3
"""Writes the tutorial's problem file, for one robot: parts are taken from a pallet and put onto a fixture in a machine.

    docs/tutorial/problems.py "-0.35 0 0 0 0 0 1" > my_arm.problems.jsonl

The argument is where the robot's base stands in the task frame: x y z qx qy qz qw. All else is told in the task frame and is the
same for every robot. Lengths in m, quaternions x y z w. A problem is one line.
"""
import json
import sys

DOWN = [1, 0, 0, 0]  # how the transfer frame is turned when its z points down


def box(name, centre, size):
    return {"name": name, "pose": centre + [0, 0, 0, 1], "size": size}


SCENE = {
    "boxes": [
        box("table", [0.15, 0, -0.035], [1.7, 1.5, 0.05]),
        box("machine left", [0.48, 0.17, 0.32], [0.46, 0.02, 0.62]),
        box("machine right", [0.48, -0.47, 0.32], [0.46, 0.02, 0.62]),
        box("machine top", [0.48, -0.15, 0.64], [0.46, 0.66, 0.02]),
        box("machine back", [0.72, -0.15, 0.32], [0.02, 0.66, 0.62]),
        box("door sill", [0.24, -0.15, 0.09], [0.02, 0.62, 0.18]),
        box("door lintel", [0.24, -0.15, 0.58], [0.02, 0.62, 0.1]),
        box("door left", [0.24, 0.1, 0.355], [0.02, 0.12, 0.35]),
        box("door right", [0.24, -0.4, 0.355], [0.02, 0.12, 0.35]),
        box("pallet", [0, 0.42, 0.03], [0.4, 0.3, 0.06]),
    ],
    "cylinders": [{"name": "fixture", "pose": [0.42, -0.15, 0.04, 0, 0, 0, 1], "radius": 0.08, "length": 0.08}],
}


def problems(T_task_base, count=24):
    for i in range(count):
        row, column = i // 4 % 3, i % 4
        yield {
            "name": f"part {i + 1}",
            "T_task_base": T_task_base,
            "start": {"pose": [round(-0.12 + 0.08 * column, 2), round(0.34 + 0.08 * row, 2), 0.16] + DOWN},
            "goal": {"pose": [0.42, -0.15, 0.19] + DOWN},
            "scene": SCENE,
            "seed": i,
        }


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for problem in problems([float(number) for number in sys.argv[1].split()]):
        print(json.dumps(problem))
