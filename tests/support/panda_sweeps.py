"""Paths of a Panda as those of panda_experience.hpp: its hand sweeps from left to right in front of it."""
import numpy as np

import kinship

READY = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785])


def sweep(seed: int) -> np.ndarray:
    """(4, 7), a little different for every seed."""
    waypoints = np.tile(READY, (4, 1))
    waypoints[:, 0] += -0.9 + 0.6 * np.arange(4)
    waypoints[:, 3] += 0.2 * (-1.0) ** np.arange(4)
    return waypoints + np.random.default_rng(seed).uniform(-0.1, 0.1, waypoints.shape)


def attempt(panda: kinship.Robot, task: str, seed: int) -> kinship.Attempt:
    """That sweep as the report of a planner."""
    return kinship.Attempt(task, panda, sweep(seed), planner="birrt", machine="test", planning_time_s=0.5,
                           collision_checks=1000, time_limit_s=10)
