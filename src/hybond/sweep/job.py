"""`Job`: everything that says what a sweep computes, as plain data; its key is made of that."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hybond._version import __version__
from hybond.files import dumps, loads
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.runs.ends import Until
from hybond.sweep.plan import Plan


@dataclass(frozen=True)
class Job:
    """What a sweep computes.

    Parameters
    ----------
    model : Model
    plan : Plan
    collect : tuple of str
        Collectors, as written.
    until : float
        When members end at the latest, s.
    ends : tuple of str
        Conditions that end them before.
    options : mapping
        Of `hybond.simulate`.
    fixed : mapping
        Parameters that are the same for all members.
    runs : str
        ``netcdf``, ``zarr`` or empty: in which form full runs are kept.
    """

    model: Model
    plan: Plan
    collect: tuple[str, ...]
    until: float
    options: Mapping[str, Any] = field(default_factory=dict)
    fixed: Mapping[str, Any] = field(default_factory=dict)
    runs: str = ""
    ends: tuple[str, ...] = ()

    @property
    def whole_until(self) -> Until:
        """What ends a member, as `hybond.simulate` takes it."""
        return [*self.ends, self.until] if self.ends else self.until

    def to_dict(self, graph: FlatGraph) -> dict[str, Any]:
        """Return it as plain data; `graph` is that of one of its members.

        Raises
        ------
        FileError
            HB-F110 for a model that no file can hold, as one with functions of Python.
        """
        return {
            "hybond": __version__,
            "model": dumps(self.model, inline=True),
            "plan": self.plan.to_dict(),
            "drawn": self.plan.digest(),
            "units": {path: _digest(file) for path, file in _files(graph)},
            "collect": list(self.collect),
            "until": self.until,
            "ends": list(self.ends),
            "options": dict(self.options),
            "fixed": dict(self.fixed),
            "runs": self.runs,
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Job:
        """Return the job that `to_dict` has told of."""
        return Job(
            loads(data["model"]),
            Plan.from_dict(data["plan"]),
            tuple(data["collect"]),
            data["until"],
            data["options"],
            data["fixed"],
            data["runs"],
            tuple(data["ends"]),
        )


def _files(graph: FlatGraph) -> list[tuple[str, Path]]:
    """Return the functional mock-up units that a model runs, by the path of their blocks."""
    blocks = [(s.path, s.block.description) for s in graph.samples if s.block is not None]
    return [(path, Path(about.path)) for path, about in blocks if about is not None]


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16]


def key_of(data: Mapping[str, Any]) -> str:
    """Return the key of a job: equal for equal content, else different.

    Examples
    --------
    >>> key_of({"a": 1}) == key_of({"a": 1}), len(key_of({"a": 2}))
    (True, 32)
    """
    text = json.dumps(data, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:32]
