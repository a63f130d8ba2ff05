"""Implicit steps: Radau IIA, its slopes, and when it is taken."""
