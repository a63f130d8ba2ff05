"""Signals of a run, what is measured of them, and where its energy went."""
