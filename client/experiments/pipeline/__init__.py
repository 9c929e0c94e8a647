"""Runs studies: learning sets, a kinshipd, queries, side studies.

Scenes and instances come from kinship-experiments, plans from `import kinship`.
"""
