"""Energies of storages whose laws push one way, or turn for ever, against SciPy's quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import hybond as hb
from hybond.equations.antiderivative import known_energy
from hybond.model.expressions import compile_expression, parse

LAWS = [
    "5*max(q, 0)^1.5",
    "5*max(q - 2, 0)^1.5 + 3*q",
    "2*max(-3*q - 0.5, 0)^2.2/7",
    "max(q, 0)*4 - max(-q, 0)^0.5",
    "3*max((q - 1)/2, 0)^0.5 + sin(q)",
    "q^3 - max(2*q, 0)",
]


@pytest.mark.parametrize("law", LAWS)
def test_it_is_the_integral_from_zero(law: str) -> None:
    e = parse(law)
    found = known_energy(e, "q")
    assert found is not None
    effort = compile_expression(e, {"q": 0}, pre_offset=0)
    energy = compile_expression(found, {"q": 0}, pre_offset=0)
    for q in (-4.0, -0.3, 0.0, 1e-7, 0.4, 2.5, 31.0):
        bends = [b for b in (2.0, -0.5 / 3.0, 1.0) if min(0.0, q) < b < max(0.0, q)]
        expected, _ = quad(lambda x: effort([x]), 0.0, q, points=bends or None, epsabs=1e-14)
        assert energy([q]) == pytest.approx(expected, rel=1e-8, abs=1e-13)


@pytest.mark.parametrize("law", ["max(q + 1, 0)^1.5", "max(q, 1)", "max(q, 0)^(-1)", "max(q^2, 0)"])
def test_what_pushes_where_nothing_is_stored_is_left_to_points(law: str) -> None:
    assert known_energy(parse(law), "q") is None


def column(many: int) -> hb.Model:
    """Return balls in a row, with contacts of Hertz between them, one of which is fast."""
    m = hb.Model("column")
    for k in range(many):
        m.add(**{f"v{k}": hb.One(), f"m{k}": hb.I(0.1, p=0.05 if k == 0 else 0.0)})
        m.bond(f"v{k} -> m{k}")
    for k in range(many - 1):
        law = "1e6*max(q, 0)^1.5"
        m.add(**{f"j{k}": hb.Zero(), f"c{k}": hb.C({"e": law})})
        m.bond(f"v{k} -> j{k}", f"j{k} -> v{k + 1}", f"j{k} -> c{k}")
    return m


def test_the_energy_of_a_column_of_balls_is_kept() -> None:
    run = hb.simulate(column(8), "10 ms")
    assert run.audit().holds()
    y = np.array([run.segments[-1].y[-1]])
    stored = run.signals.stored(y)[0]
    names = [s.path for s in run.graph.storages]
    own = dict(zip(names, y[0].tolist(), strict=True))
    expected = sum(p**2 / 0.2 for name, p in own.items() if name.startswith("m"))
    expected += sum(0.4e6 * max(q, 0.0) ** 2.5 for n, q in own.items() if n.startswith("c"))
    assert stored == pytest.approx(expected, rel=1e-13)
    assert stored == pytest.approx(0.05**2 / 0.2, rel=1e-8)
