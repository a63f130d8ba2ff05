"""Rows of a mode, with the laws of storage in them, eliminated."""
