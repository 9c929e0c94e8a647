"""What distributions look like: where samples put the transfer frame, and the arm in some of them."""
import pathlib
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from .bars import COLOURS, pyplot
from .study_folder import StudyFolder

SAMPLES = 1500
POSTURES = 5
_VIEWS = {"top": (0, 1), "side": (0, 2)}  # which axes of the task frame are seen


def _pose(numbers: list[float]) -> np.ndarray:
    """4 x 4 transform of a pose as files have it: x y z in m, quaternion x y z w."""
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_quat(numbers[3:]).as_matrix()
    transform[:3, 3] = numbers[:3]
    return transform


def joint_origins(robot: dict[str, Any], q: np.ndarray) -> np.ndarray:
    """Origins of the joints and of the transfer frame in the task frame, m.

    `q` is samples x dof, joint units; the result is samples x (dof + 1) x 3.
    """
    T_task_frame = np.tile(_pose(robot["T_task_base"]), (len(q), 1, 1))
    origins = []
    for joint, values in zip(robot["joints"], q.T, strict=True):
        T_joint_moved = np.tile(np.eye(4), (len(q), 1, 1))
        along = np.outer(values, joint["axis"])
        if joint["type"] == "prismatic":
            T_joint_moved[:, :3, 3] = along
        else:
            T_joint_moved[:, :3, :3] = Rotation.from_rotvec(along).as_matrix()
        T_task_frame = T_task_frame @ _pose(joint["T_previous_joint"]) @ T_joint_moved
        origins.append(T_task_frame[:, :3, 3])
    origins.append((T_task_frame @ _pose(robot["T_last_transfer"]))[:, :3, 3])
    return np.stack(origins, axis=1)


def draw_samples(distribution: dict[str, Any], count: int) -> np.ndarray:
    """Samples of a mixture that lie within the limits, at most `count` x dof. Equal mixture, equal samples."""
    generator = np.random.RandomState(1)
    weights = np.array(distribution["weights"])
    lower, upper = np.array(distribution["limits"]).T
    chosen = generator.multinomial(count, weights / weights.sum())
    samples = np.concatenate([generator.multivariate_normal(mean, covariance, number) for mean, covariance, number
                              in zip(distribution["means"], distribution["covariances"], chosen)])
    samples = samples[((samples >= lower) & (samples <= upper)).all(axis=1)]
    return generator.permutation(samples)


def _outline(box: dict[str, Any], view: tuple[int, int]) -> np.ndarray:
    corners = np.zeros((5, 4))
    corners[:, view] = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * np.array(box["size"])[list(view)] / 2
    corners[:, 3] = 1
    return (corners @ _pose(box["pose"]).T)[:, list(view)]


def write_clouds(study: StudyFolder, distributions: list[dict[str, Any]], file: pathlib.Path) -> None:
    """A picture per target (row) and source (column), seen from above; of spatial scenes also from the side."""
    robots = {robot["digest"]: robot for robot in study.study["robots"]}
    shown = [each for each in distributions if each["robot"] in robots and each.get("weights") and each["sources"]]
    if not shown:
        return
    boxes = [box for robot in robots.values() for box in robot["scene"].get("boxes", [])]
    views = ["top"] if all(box["pose"][2] == 0 for box in boxes) else ["top", "side"]
    columns = len(study.robots)
    rows = -(-len(shown) // columns)
    figure, axes = pyplot.subplots(rows * len(views), columns, squeeze=False, layout="constrained",
                                   figsize=(2.6 * columns, 2.6 * rows * len(views)))
    for place in axes.flat:
        place.set_axis_off()
    for index, distribution in enumerate(shown):
        robot = robots[distribution["robot"]]
        origins = joint_origins(robot, draw_samples(distribution, SAMPLES))
        for number, name in enumerate(views):
            place = axes[index // columns * len(views) + number, index % columns]
            view = _VIEWS[name]
            for box in robot["scene"].get("boxes", []):
                place.fill(*_outline(box, view).T, color="#c9d1d9", alpha=0.7)
            place.plot(*origins[:, -1, list(view)].T, ".", color="#0072b2", markersize=1, alpha=0.45)
            for colour, posture in zip(COLOURS[2:], origins[:POSTURES]):
                place.plot(*posture[:, list(view)].T, color=colour, linewidth=1.5)
            place.set_title(f"{robot['label']} from {distribution['sources'][0]['label']}, {name}", fontsize=7)
            place.set_aspect("equal")
    figure.savefig(file, dpi=110)
    pyplot.close(figure)
