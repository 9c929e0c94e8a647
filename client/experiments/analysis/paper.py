"""The paper's figures under the names of our robots.

Source: Lehner, Roa and Albu-Schaeffer, Kinematic Transfer Learning of Sampling Distributions for
Manipulator Motion Planning (ICRA 2022), tables 1 and 2: means and standard deviations.
"""
import csv
import pathlib

PaperCell = dict[str, float]  # by column: time_s, checks, length_deg and the deviation of each


def _read() -> dict[tuple[str, str, str], PaperCell]:
    with pathlib.Path(__file__).with_name("paper.csv").open(encoding="utf-8", newline="") as stream:
        return {(row.pop("study"), row.pop("robot"), row.pop("guidance")):
                {column: float(value) for column, value in row.items()} for row in csv.DictReader(stream)}


_CELLS = _read()


def paper_cell(study: str, robot: str, guidance: str) -> PaperCell | None:
    """What the paper has for one robot and guidance ("uniform", or the robot whose experience it is)."""
    return _CELLS.get((study, robot, guidance))


def paper_ratios(study: str, column: str, own: bool | None) -> list[float]:
    """Ratios of means, uniform to guided, of the paper's pairs; `own` None: of all."""
    return [_CELLS[study, robot, "uniform"][column] / cell[column]
            for (known, robot, guidance), cell in _CELLS.items()
            if known == study and guidance != "uniform" and own in (None, robot == guidance)]
