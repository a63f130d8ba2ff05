"""Friction in the plane."""
