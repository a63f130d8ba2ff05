"""Time-stepping: the theta-scheme of Moreau and Jean on the same graph."""
