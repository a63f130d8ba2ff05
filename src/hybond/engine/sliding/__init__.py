"""Motion along switching surfaces."""
