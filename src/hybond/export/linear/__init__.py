"""Linear modes as matrices for SciPy and python-control."""
