"""What a step may be off by, and what has moved at all."""
