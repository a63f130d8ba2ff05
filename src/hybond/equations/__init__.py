"""What follows: the junction structure, loops, dependent storage and state equations of a mode."""
