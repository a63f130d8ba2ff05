"""A mass that a resistor ``sign(f)`` brakes and a one-way law keeps from turning round.

It comes to rest where the brake would drive it back: the law holds it there. Implicit steps whose
stages lie on either side of the jump ended each before it, ever again.
"""

import math
from typing import Literal

import numpy as np
import pytest

import hybond as hb

SOLVERS = ["auto", "radau", "rk45"]


def braked(m: float, d: float, v: float, force: float, *, turned: bool, gyrator: bool) -> hb.Model:
    """Return it; with a gyrator the law is beside a conductance that is its dual."""
    model = hb.Model("braked")
    model.add(i=hb.I(m, p=m * v), w=hb.One(), d=hb.R(d))
    model.bond("i -> w" if turned else "w -> i", "w -> d")
    way = -1.0 if turned else 1.0
    if turned:
        model.elements["i"] = hb.I(m, p=-m * v)
    if not gyrator:
        model.add(v=hb.One(law="diode"), r=hb.R({"e": f"{force}*sign(f)"}))
        model.bond("w -> v", "r -> w" if way < 0 else "w -> r")
        return model
    # the brake is short-circuited by the diode as soon as its force would turn
    model.add(j=hb.Zero(), r=hb.R({"e": f"{force}*sign(f)"}), t=hb.GY(1.04), v=hb.One(law="diode"))
    model.bond("w -> j", "j -> r", "t.2 -> j", "v -> t.1")
    return model


def rest_of(m: float, d: float, v: float, force: float) -> float:
    """Return when it is at rest: m v' = -force - d v."""
    return m / d * math.log(1.0 + d * v / force)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("gyrator", [False, True], ids=["same", "gyrator"])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("sizes", [(0.67, 0.4, 0.045, 1.04), (0.82, 1.1, 1.37, 1.26)])
@pytest.mark.parametrize("solver", SOLVERS)
def test_it_comes_to_rest_and_stays(
    solver: Literal["auto", "radau", "rk45"],
    sizes: tuple[float, float, float, float],
    turned: bool,
    gyrator: bool,
    rtol: float,
) -> None:
    m, d, v, force = sizes
    model = braked(*sizes, turned=turned, gyrator=gyrator)
    end = rest_of(*sizes)
    run = hb.simulate(model, 2.0 * end, solver=solver, rtol=rtol)
    assert run.status == "ok"
    at = np.linspace(0.0, 2.0 * end, 41)
    moves = (v + force / d) * np.exp(-d / m * at) - force / d
    assert run["w.f"].at(at) == pytest.approx(np.where(at < end, moves, 0.0), abs=100 * rtol * v)


@pytest.mark.parametrize("ratio", [-0.0104, 0.3])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
def test_friction_slips_no_way_but_its_own_where_a_sign_has_no_value(
    turned: bool, ratio: float
) -> None:
    """A capacitor without charge was charged by the friction that lies at it, from nothing."""
    model = hb.Model("charged")
    model.add(n=hb.Zero(), c=hb.C(171.0), k=hb.One(law="coulomb", limit=4.43))
    model.add(t=hb.TF(ratio), w=hb.One(), r=hb.R({"e": "32.6*sign(f)"}), s=hb.Se(0.362))
    model.add(b=hb.R({"e": "328*(f/0.04 + (f/0.04)^3)"}))
    model.bond("k -> n" if turned else "n -> k", "n -> c", "n -> t.1", "t.2 -> w")
    model.bond("w -> r", "w -> b", "s -> w")
    with pytest.raises(hb.NumericsError, match="HB-N301") as said:
        hb.simulate(model, 1e-4)
    assert "r" in str(said.value)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
@pytest.mark.parametrize("solver", SOLVERS)
def test_where_no_law_holds_it_the_sign_is_refused_though_a_diode_switches_each_time(
    solver: Literal["auto", "radau", "rk45"], rtol: float
) -> None:
    """Events of the diode came ever faster, which was told as their accumulation."""
    model = hb.Model("turns")
    model.add(w=hb.One(), i=hb.I(0.67, p=-0.03), r=hb.R({"e": "1.04*sign(f)"}))
    model.add(u=hb.GY(-0.726), v=hb.One(law="diode"), d=hb.R(0.44))
    model.bond("w -> i", "r -> w", "u.2 -> w", "u.1 -> v", "d -> v")
    with pytest.raises(hb.NumericsError, match="HB-N410") as said:
        hb.simulate(model, 1.0, solver=solver, rtol=rtol)
    assert "at r" in str(said.value)
