"""What the audit calls rounding of powers: by the fastest motion and the largest load of a domain.

A bond that rests under a load is judged by the largest flow of its own domain, wherever in the
model that is. The oracle asks each bond for those of its domain, one by one.
"""

import numpy as np
import pytest

import hybond as hb
from hybond.engine.outcome.audit import _Powers


def motors(many: int) -> hb.Model:
    """Return motors that each turn a wheel: two domains, in turn."""
    m = hb.Model("motors")
    for k in range(many):
        m.add(**{f"V{k}": hb.Se("12 V", domain="electrical"), f"i{k}": hb.One(domain="electrical")})
        m.add(**{f"R{k}": hb.R(f"{k + 1} ohm", domain="electrical")})
        m.add(**{f"g{k}": hb.GY("50 mN*m/A"), f"w{k}": hb.One(domain="rotational")})
        m.add(**{f"J{k}": hb.I("1e-4 kg*m^2", domain="rotational")})
        m.bond(f"V{k} -> i{k} -> R{k}", f"i{k} -> g{k} -> w{k} -> J{k}")
    return m


@pytest.mark.parametrize("many", [1, 2, 7])
def test_rounding_is_that_of_the_largest_of_its_domain(many: int) -> None:
    graph = motors(many).flatten()
    powers = _Powers(graph, [])
    bonds = len(graph.bonds)
    rng = np.random.default_rng(many)
    w = rng.normal(size=(2 * bonds, 5))
    most = np.abs(w).max(axis=1)
    e, f = powers._parts(w)
    found = powers._rounding(e, f, most[:, None])
    for place, bond in enumerate(powers.bond):
        same = [
            k for k in range(bonds) if graph.bonds[k].domain.name == graph.bonds[bond].domain.name
        ]
        assert len(same) < bonds
        load = max(most[k] for k in same)
        speed = max(most[bonds + k] for k in same)
        assert found[place].tolist() == (0.1 * (e[place] * speed + load * f[place])).tolist()


@pytest.mark.parametrize("many", [1, 40])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_what_many_motors_do_is_balanced(many: int, solver: str) -> None:
    run = hb.simulate(motors(many), "50 ms", solver=solver)
    assert run.audit().holds()
    for k in range(many):
        # J w' = K (V - K w) / R
        tau = 1e-4 * (k + 1) / 0.05**2
        assert run.final[f"J{k}.f"] == pytest.approx(240.0 * -np.expm1(-0.05 / tau), rel=1e-7)
