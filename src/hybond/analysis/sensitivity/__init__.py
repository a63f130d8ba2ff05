"""Derivatives of runs by parameters and start values, through every switch."""
