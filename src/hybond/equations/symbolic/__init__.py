"""Exact rational functions of named atoms, to eliminate a mode with its parameters as letters."""
