"""What calibration instances cost, for who calibrates."""
from . import tables
from .study_folder import StudyFolder


def calibration_text(study: StudyFolder) -> str:
    return tables.calibration_table(study, study.cells("calibration.jsonl"))
