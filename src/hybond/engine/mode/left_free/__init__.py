"""What a system leaves free, and least leakage."""
