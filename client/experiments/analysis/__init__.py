"""What the results of a study say: statistics, tables and figures. Nothing here plans."""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "results"))  # kinship_results
