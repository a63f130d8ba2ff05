"""Linear complementarity problems: the laws of junctions as one of them, and its solution."""
