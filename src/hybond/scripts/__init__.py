"""Runs by a script: what is done step after step, and the one run that comes of it."""
