"""Linear modes, propagated."""
