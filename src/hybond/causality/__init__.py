"""Which way: causal strokes for one mode, and their change from one mode to the next."""
