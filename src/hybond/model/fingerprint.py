"""What tells one flat graph from another: whether what a run remembers means the same there."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from hybond.model.graph import FlatGraph

PARTS = ("nodes", "bonds", "storages", "machines", "integrals", "inputs", "samples", "watches")
"""What a run knows of a graph."""
NOT_PART = ("start", "start_is", "label", "shown", "text", "reads")
"""Where a run of it begins, and how it is written, are not what it is."""


def fingerprint_of(graph: FlatGraph) -> str:
    """Return a text that is the same for graphs whose runs mean the same.

    Examples
    --------
    >>> import hybond as hb
    >>> texts = []
    >>> for mass, momentum in (("1 kg", "0 kg*m/s"), ("1 kg", "2 kg*m/s"), ("2 kg", "0 kg*m/s")):
    ...     m = hb.Model("mass", domain="translational")
    ...     m.add(mass=hb.I(mass, p=momentum), push=hb.Se("1 N"), v=hb.One())
    ...     m.bond("push -> v", "v -> mass")
    ...     texts.append(fingerprint_of(m.flatten()))
    >>> texts[0] == texts[1], texts[0] == texts[2]
    (True, False)
    """
    import hashlib

    digest = hashlib.sha256()
    for name in PARTS:
        part = getattr(graph, name)
        if name == "machines" and graph.ends >= 0:
            part = part[: graph.ends]
        digest.update(repr(_plain(part)).encode())
    digest.update(graph.indeterminate.encode())
    return digest.hexdigest()[:24]


def _plain(value: Any) -> Any:
    """Return a value as tuples of what has the same text in every process."""
    if is_dataclass(value) and not isinstance(value, type):
        own = (f.name for f in fields(value) if f.compare and f.name not in NOT_PART)
        return type(value).__name__, tuple((k, _plain(getattr(value, k))) for k in own)
    if isinstance(value, Mapping):
        return tuple(sorted((str(k), repr(_plain(v))) for k, v in value.items()))
    if isinstance(value, Set):
        return tuple(sorted(repr(_plain(v)) for v in value))
    if isinstance(value, list | tuple):
        return tuple(map(_plain, value))
    if isinstance(value, np.ndarray):
        return value.shape, value.tolist()
    if callable(value):
        return getattr(value, "__qualname__", type(value).__qualname__)
    return float(value) if isinstance(value, np.floating) else value
