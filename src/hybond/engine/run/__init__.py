"""A run: segment after segment, where guards hold within a step, what is written down."""
