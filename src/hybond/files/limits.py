"""How large a model file may be: a stranger's file must not exhaust the machine."""

from __future__ import annotations

FILE_BYTES = 16 * 2**20
"""Size of one file."""
ELEMENTS = 200_000
"""Elements in all submodels and files together, each written element counted once."""
FILES = 100
"""Files that one model is made of, the top one included."""
LEVELS = 64
"""Models inside models."""
NESTING = 4 * LEVELS
"""Tables and lists inside one another, in one file."""
INTEGER = 2**63
"""Whole numbers are smaller than this, as TOML promises."""

KEY = 10_000
"""Letters of a key: what changes a file in place reads each of them many times."""
