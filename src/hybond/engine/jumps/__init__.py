"""A mode entered: what is stored jumps, and every signal follows."""
