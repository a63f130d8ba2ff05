"""What is given where a model belongs."""

from __future__ import annotations

import os
from typing import Any

from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph


def check_model(given: Any) -> None:
    """Refuse what is no model: the name of a file, a text, an element.

    Raises
    ------
    UsageError
        HB-S130.

    Examples
    --------
    >>> check_model("ball.toml")
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-S130 at model: 'ball.toml' is not a model
      try: read it first: hb.load("ball.toml")
    """
    if isinstance(given, Model | FlatGraph):
        return
    shown = repr(given)
    hint = "give a hybond.Model, built or loaded, or what model.flatten() returns"
    if isinstance(given, str | os.PathLike):
        text = str(given)
        file = "\n" not in text and text.lower().endswith((".toml", ".json"))
        call = (
            f'hb.load("{text}")' if file else "hb.load(path) for a file, hb.loads(text) for a text"
        )
        hint = f"read it first: {call}"
    elif isinstance(given, type) and issubclass(given, Model):
        hint = 'make one: hb.Model("oscillator")'
    raise UsageError(
        f"{shown if len(shown) <= 60 else shown[:57] + '...'} is not a model",
        code="HB-S130",
        where="model",
        hint=hint,
    )
