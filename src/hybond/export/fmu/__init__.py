"""Functional mock-up units (FMI 2.0 and 3.0): the exported C in the clothes of a standard."""
