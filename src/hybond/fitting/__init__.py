"""Parameters of a model from data, or for a goal: least squares and minima with exact slopes."""
