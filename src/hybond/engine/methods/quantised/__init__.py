"""Quantised states."""
