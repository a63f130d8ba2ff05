"""A source that is a staircase of a motion, right onto a capacitor or a mass: no jump is lost.

The oracle is the conservation of charge and momentum: what has flowed into a storage is what it
holds, with the impulse of each jump, and each jump is an event.
"""

import numpy as np
import pytest

import hybond as hb

SEEDS = (1, 4, 6, 40, 42, 46)


def values_of(seed):
    rng = np.random.default_rng(seed)
    ranges = {"st": (0.05, 0.3), "w": (1, 4), "C": (0.1, 1), "R": (0.3, 2), "L": (0.1, 0.5)}
    return {name: float(rng.uniform(*ends)) for name, ends in ranges.items()}


def converter(seed, turned=False):
    """A staircase of x on a capacitor, which a coil and a resistor follow; x feels the coil."""
    m = hb.Model("stairs", domain="electrical", parameters=values_of(seed))
    m.add(V=hb.Se("st*floor(x/st + 0.5)"), n=hb.Zero(), c=hb.C("C"), i=hb.One())
    m.add(r=hb.R("R"), l=hb.I("L"))
    if turned:
        m.bond("i -> l", "i -> r", "n -> i", "V -> n", "c -> n")
    else:
        m.bond("V -> n", "n -> c", "n -> i", "i -> r", "i -> l")
    m.signal(x=hb.Integral("sin(w*time) - 0.3*l.f"), flowed=hb.Integral("c.f"))
    return m


def conveyor(seed):
    """The same of speeds: a mass that a drive takes along by steps, a spring and a damper on it."""
    m = hb.Model("stairs", domain="translational", parameters=values_of(seed))
    m.add(V=hb.Sf("st*floor(x/st + 0.5)"), n=hb.One(), c=hb.I("C"), i=hb.Zero())
    m.add(r=hb.G("R"), l=hb.C("L"))
    m.bond("V -> n", "n -> c", "n -> i", "i -> r", "i -> l")
    m.signal(x=hb.Integral("sin(w*time) - 0.3*l.e"), flowed=hb.Integral("c.e"))
    return m


def check(run, stored, step):
    held = run[stored].y
    assert run.status == "ok"
    # a flow counts along its arrow, what is stored into the element
    flowed = float(run["flowed"].y[-1])
    assert min(abs(flowed - float(held[-1])), abs(flowed + float(held[-1]))) < 1e-6 * step
    jumps = int(np.sum(np.abs(np.diff(held)) > 0.5 * step))
    assert jumps == len(run.events) - 1 > 5
    assert all(event.cause == "law" for event in list(run.events)[1:])
    assert run.audit().holds()


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau", "exact"])
@pytest.mark.parametrize("seed", SEEDS)
def test_no_charge_is_lost(seed, solver):
    given = values_of(seed)
    run = hb.simulate(converter(seed), until=5.0, solver=solver)
    check(run, "c.q", given["st"] * given["C"])


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_no_charge_is_lost_with_bonds_turned(solver):
    given = values_of(4)
    run = hb.simulate(converter(4, turned=True), until=5.0, solver=solver)
    check(run, "c.q", given["st"] * given["C"])


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("seed", (1, 4, 6))
def test_no_momentum_is_lost(seed, solver):
    given = values_of(seed)
    run = hb.simulate(conveyor(seed), until=5.0, solver=solver)
    check(run, "c.p", given["st"] * given["C"])
