"""What the palette offers: kinds of element, ready parts by domain, examples."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from typing import Any

from hybond.library.shelves import SHELVES, names
from hybond.model.kinds import KINDS
from hybond.units import DOMAINS

FIRST = {
    "C": {"C": 1},
    "I": {"I": 1},
    "R": {"R": 1},
    "G": {"G": 1},
    "Se": {"Se": 1},
    "Sf": {"Sf": 1},
    "TF": {"TF": 1},
    "GY": {"GY": 1},
    "0": {"junction": 0},
    "1": {"junction": 1},
}
"""What an element says when it is put down: a number without unit fits any domain."""

_STEMS = {"0": "node", "1": "loop"}


@lru_cache(maxsize=1)
def stock() -> dict[str, Any]:
    """Return all that can be put on the canvas.

    Examples
    --------
    >>> found = stock()
    >>> found["kinds"][0]["kind"], "electrical.diode" in {p["name"] for p in found["parts"]}
    ('C', True)
    """
    kinds = [
        {
            "kind": name,
            "letters": about.symbol,
            "about": about.meaning,
            "stem": _STEMS.get(name, name),
            "element": FIRST[name],
        }
        for name, about in KINDS.items()
    ]
    return {
        "kinds": kinds,
        "parts": [_part(name) for name in names()],
        "domains": [
            {"name": d.name, "effort": d.effort_unit, "flow": d.flow_unit} for d in DOMAINS.values()
        ],
        "laws": ["diode", "thyristor", "unilateral", "coulomb", "relay"],
        "solvers": _solvers(),
    }


def _part(name: str) -> dict[str, Any]:
    file = SHELVES.joinpath(*name.split(".")).with_suffix(".toml")
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return {
        "name": name,
        "title": data.get("title", ""),
        "ports": list(data.get("ports", {})),
        "parameters": {k: str(v) for k, v in data.get("parameters", {}).items()},
        "inputs": list(data.get("inputs", {})),
    }


def _solvers() -> list[dict[str, str]]:
    from hybond.options import SOLVERS, STEPPING

    return [{"name": k, "about": v} for k, v in {**SOLVERS, **STEPPING}.items()]
