#!/usr/bin/python3
"""Draws the distribution that a server has for a robot and a task.

    plot_distribution.py ROBOT TASK PICTURE [--placement "x y z qx qy qz qw"] [--deadline S] [--domain N] [--server HOST]

ROBOT is a model folder, PICTURE a file that matplotlib can write (.png, .svg, .pdf). Left: where the transfer frame is in 2000 samples,
seen from above and from the side. Right: each joint's marginal within its limits, samples and mixture.
Exit codes: 0 done, 1 failed.
"""
import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display is needed
import matplotlib.pyplot as plt  # noqa: E402: after the backend is chosen
import numpy as np  # noqa: E402

import kinship  # noqa: E402

SAMPLES = 2000


def read_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", type=pathlib.Path)
    parser.add_argument("task")
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--placement", type=lambda text: [float(word) for word in text.split()])
    parser.add_argument("--deadline", type=float, default=60)
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--server", default="127.0.0.1")
    return parser.parse_args()


# %% Ask the server. Whoever only fetches needs no outbox.
def fetch(arguments: argparse.Namespace, robot: kinship.Robot) -> kinship.Distribution:
    with kinship.Client(domain=arguments.domain, server=arguments.server, has_outbox=False) as client:
        client.register(robot)
        return client.fetch(arguments.task, robot, T_task_base=arguments.placement, deadline=arguments.deadline)


# %% What it was made of.
def describe(distribution: kinship.Distribution, robot: kinship.Robot) -> None:
    print(f"{len(distribution)} components for {robot.label}, fitted to {distribution.configurations} configurations")
    for source in distribution.provenance["sources"]:
        print(f"  from {source['label']}: {source['paths']} paths, {source['mass']:.0%} of the weight")
    print(f"  guide {distribution.recommended_share:.0%} of a planner's samples: {distribution.evidence}")


# %% Where the hand goes: forward kinematics of all samples at once.
def draw_hand(top, side, robot: kinship.Robot, samples: np.ndarray, density: np.ndarray) -> None:
    x, y, z = robot.fk(samples, frame="transfer")[:, :3, 3].T
    for axes, height, name in ((top, y, "y"), (side, z, "z")):
        axes.scatter(x, height, c=density, s=4, cmap="viridis", rasterized=True)
        axes.plot(0, 0, "k^")  # the base
        axes.set(xlabel="x [m]", ylabel=f"{name} [m]", aspect="equal")
    top.set_title("transfer frame in the robot's base, brighter where denser")


# %% A joint's marginal: that of a mixture is a mixture of normal distributions.
def draw_joint(axes, distribution: kinship.Distribution, robot: kinship.Robot, samples: np.ndarray, joint: int) -> None:
    axes.hist(samples[:, joint], bins=60, density=True, color="0.8")
    q = np.linspace(robot.lower[joint], robot.upper[joint], 400)
    deviation = np.sqrt(distribution.covariances[:, joint, joint])
    scaled = (q[:, None] - distribution.means[:, joint]) / deviation
    axes.plot(q, (np.exp(-scaled**2 / 2) / (deviation * np.sqrt(2 * np.pi))) @ distribution.weights)
    axes.set_xlim(robot.lower[joint], robot.upper[joint])
    axes.set_yticks([])
    axes.tick_params(labelsize=7)
    axes.set_ylabel(robot.joint_names[joint], rotation=0, ha="right", va="center", fontsize=7)


def draw(distribution: kinship.Distribution, robot: kinship.Robot, picture: pathlib.Path) -> None:
    samples = distribution.sample(SAMPLES, seed=1)
    figure = plt.figure(figsize=(11, 7), constrained_layout=True)
    grid = figure.add_gridspec(2 * robot.dof, 2)
    top, side = figure.add_subplot(grid[:robot.dof, 0]), figure.add_subplot(grid[robot.dof:, 0])
    draw_hand(top, side, robot, samples, distribution.log_density(samples))
    for joint in range(robot.dof):
        draw_joint(figure.add_subplot(grid[2 * joint:2 * joint + 2, 1]), distribution, robot, samples, joint)
    figure.axes[-1].set_xlabel("samples and mixture, rad or m")
    figure.suptitle(f"'{distribution.task}' for {robot.label}, revision {distribution.revision}")
    figure.savefig(picture, dpi=100)


def main() -> int:
    arguments = read_arguments()
    try:
        robot = kinship.Robot(arguments.robot)
        distribution = fetch(arguments, robot)
    except kinship.Error as error:
        print(f"plot_distribution.py: {error}", file=sys.stderr)
        return 1
    describe(distribution, robot)
    draw(distribution, robot, arguments.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
