"""What the table of a sweep can be looked at as: the methods of `SweepTable` that draw."""

from __future__ import annotations
class Views:
    """Views"""
