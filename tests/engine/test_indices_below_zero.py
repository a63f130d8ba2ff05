"""What allows sliding reads no signals: where it ends, no array is asked below its beginning.

Python takes such an index from the end, Java ends with an exception, and C reads what lies before.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.engine.engine import OK, make_engine
from hybond.engine.run import motion, run_records
from hybond.engine.run.log import make_report
from hybond.engine.tables import answered, tables_of


class Forward(np.ndarray):
    """An array without places counted from its end."""

    def __getitem__(self, place):
        assert not (isinstance(place, int) and place < 0), "below the beginning"
        return super().__getitem__(place)


def relay(push: float, *, turned: bool = False, on: str = "C", first: bool = False) -> hb.Model:
    """A relay of +-push holds what is stored at zero against sin(t), while that is less."""
    m = hb.Model("relay", domain="generic")
    junction, source, storage = (hb.One, hb.Se, hb.C) if on == "C" else (hb.Zero, hb.Sf, hb.I)
    own = "c.e" if on == "C" else "c.f"
    start = {"e" if on == "C" else "f": 0.02}
    parts = {
        "u": source(f"if sw.state == 'up' then {-push} else {push}"),
        "w": source("sin(1*time)"),
        "r": hb.R(1),
        "c": storage(1, **start),
        "i": junction(),
    }
    m.add(**(dict(reversed(parts.items())) if first else parts))
    bonds = ["u -> i", "w -> i", "i -> r", "i -> c"]
    m.bond(*(reversed(bonds) if turned else bonds))
    rules = [f"down -> up when {own} > 0", f"up -> down when {own} < 0"]
    m.machine("sw", states={"up": [], "down": []}, start="up", rules=rules)
    return m


MODELS = [
    (relay(push, turned=turned, on=on, first=first), push, solver)
    for push, turned, on, first, solver in [
        (0.5, False, "C", False, "auto"),
        (0.9, True, "C", True, "rk45"),
        (0.3, False, "I", True, "radau"),
        (0.99, True, "I", False, "auto"),
    ]
]


@pytest.mark.parametrize(("model", "push", "solver"), MODELS)
def test_sliding_ends_where_it_should_and_asks_nothing_below(model, push, solver) -> None:
    m = answered(tables_of(model.flatten(), calling=True, until=1.6, solver=solver))
    for name in ("read_first", "read_slot", "atom_first", "rule_first", "rule_test"):
        setattr(m, name, np.asarray(getattr(m, name)).view(Forward))
    e = make_engine(m)
    assert motion.run_to_end(e, run_records.make_run(e, make_report(e))) == OK
    run = hb.simulate(model, until=1.6, solver=solver)
    (slid,) = run.sliding
    assert slid.t1 == pytest.approx(math.asin(push), abs=1e-9)
