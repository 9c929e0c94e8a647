"""Bars of what queries cost."""
import pathlib
from collections.abc import Callable

import matplotlib
import numpy as np

from .statistics import mean_estimate
from .study_folder import Cell, Cells, StudyFolder

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402: after the choice of how to draw

COLOURS = ("#8a97a5", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
_BAR = 0.8  # of the width of a group is bars


def write_bars(study: StudyFolder, cells: Cells, quantity: Callable[[Cell], np.ndarray], unit: str,
               file: pathlib.Path) -> None:
    """A group of bars per robot, uniform and by each robot's experience, with 95 % intervals; its own experience is marked.

    Equal results, equal bytes.
    """
    guidances = [study.study["uniform"], *study.robots]
    width = _BAR / len(guidances)
    style = {"svg.hashsalt": "kinship", "svg.fonttype": "none", "font.family": "sans-serif",
             "axes.spines.top": False, "axes.spines.right": False}
    with matplotlib.rc_context(style):
        figure, axes = pyplot.subplots(figsize=(1.6 + 1.6 * len(study.robots), 3.8), layout="constrained")
        for index, guidance in enumerate(guidances):
            shown = [(place, mean_estimate(quantity(cells[robot, guidance])))
                     for place, robot in enumerate(study.robots) if (robot, guidance) in cells]
            means = np.array([estimate.value for _, estimate in shown])
            errors = [means - [estimate.low for _, estimate in shown], [estimate.high for _, estimate in shown] - means]
            axes.bar([place + (index - (len(guidances) - 1) / 2) * width for place, _ in shown], means, 0.88 * width,
                     yerr=errors, color=COLOURS[index % len(COLOURS)], ecolor="#1c2733", error_kw={"elinewidth": 0.9},
                     label=guidance if index == 0 else f"by {guidance}")
            for place, estimate in shown:
                if guidance == study.robots[place]:
                    axes.annotate("own", (place + (index - (len(guidances) - 1) / 2) * width, estimate.high), (0, 2),
                                  textcoords="offset points", ha="center", va="bottom", fontsize=7, color="#1c2733")
        axes.set_title(f"{study.study['study']}: a query of each robot, guided by whose experience", fontsize=10, loc="left")
        axes.set_xticks(range(len(study.robots)), study.robots)
        axes.tick_params(axis="x", length=0)
        axes.set_ylabel(unit)
        axes.set_axisbelow(True)
        axes.grid(axis="y", color="#e0e5ea")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=min(len(guidances), 6), frameon=False)
        figure.savefig(file, metadata={"Date": None})
        pyplot.close(figure)
