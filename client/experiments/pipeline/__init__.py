"""Runs studies: learning sets, a kinshipd, queries, side studies.

Scenes and instances come from kinship-experiments, plans from `import kinship`.
"""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "results"))  # kinship_results
