"""A mode made runnable: the NumPy evaluation of the graph's own equations."""
