"""Sliding along switching surfaces, and switching in a band instead."""
