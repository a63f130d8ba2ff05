"""A storage that takes over a signal at events and holds it: no contact, though put together."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

GAP = math.log(7 / 6)
"""Between two triggers of `x' = x - 2 held` with a threshold of a fifth of x: 1.2 e^t = 1.4."""


def triggered(dual: bool) -> hb.Model:
    """Return a loop whose feedback is sampled when it is a fifth of x off (P. Tabuada 2007)."""
    m = hb.Model("triggered")
    if dual:
        m.add(held=hb.I(1, f=1), z=hb.One(), sw=hb.Zero(), src=hb.Sf("x"))
    else:
        m.add(held=hb.C(1, e=1), z=hb.Zero(), sw=hb.One(), src=hb.Se("x"))
    m.bond("src -> sw -> z -> held")
    held = "held.f" if dual else "held.e"
    m.signal(x=hb.Integral(f"x - 2*{held}", start=1))
    m.machine(
        "trigger",
        states={"waits": [], "takes": ["sw"]},
        start="waits",
        rules=[
            f"waits -> takes when abs(x - {held}) > 0.2*abs(x)",
            'takes -> waits when pre(trigger.state == "takes")',
        ],
    )
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("dual", [False, True])
def test_events_go_on_after_a_sample_was_taken(dual: bool, solver: str) -> None:
    run = hb.simulate(triggered(dual), until=2, solver=solver)
    many = int(2 / GAP)
    np.testing.assert_allclose(run.events.t[1:], GAP * np.arange(1, many + 1), rtol=1e-7)
    # 2 - e^t of itself from one sample to the next: 2 - 7/6
    held = run["held.f" if dual else "held.e"].at(GAP * (np.arange(many) + 0.5))
    np.testing.assert_allclose(held, (5 / 6) ** np.arange(many), rtol=1e-7)
    assert not run.accumulations


@pytest.mark.parametrize("height", [1.0, 1e-3])
def test_what_is_put_on_its_contact_stays_there_until_it_is_lifted(height: float) -> None:
    """The same rules with a weight: falling back at once, the lump rests, and is then lifted."""
    m = hb.Model("lump", domain="translational")
    m.add(mass=hb.I(2.0), v=hb.One(), floor=hb.Zero(), still=hb.Sf(0))
    m.add(weight=hb.Se("if time < 1 then -20 else 10*(time - 1) - 20"))
    m.bond("weight -> v -> mass", "still -> floor -> v")
    m.signal(h=hb.Integral("v.f", start=height))
    m.machine(
        "contact",
        states={"off": [], "on": ["floor"]},
        start="off",
        rules=[
            "off -> on when h <= 0 and v.f < 0",
            'on -> off when pre(contact.state == "on")',
        ],
    )
    run = hb.simulate(m, until=4)
    fall = math.sqrt(2 * height / 10)
    assert run.events[1].t == pytest.approx(fall, rel=1e-9)
    assert abs(run["h"].at(2.9)) < 1e-12
    assert run["h"].at(4.0) == pytest.approx(5 / 6, rel=1e-7)  # 5 N/s/kg from t = 3 on


@pytest.mark.parametrize(("inflow", "out"), [(1.0, (0.6, 0.6)), (1.0, (0.75, 0.5))])
@pytest.mark.parametrize("start", [(0.3, 0.5), (0.1, 0.7)])
def test_tanks_that_share_too_little_water_run_dry_together(
    start: tuple[float, float], inflow: float, out: tuple[float, float]
) -> None:
    """The hose goes to a tank when it is empty: ever faster (K. H. Johansson and others 1999)."""
    m = hb.Model("tanks")
    m.signal(
        x1=hb.Integral(f'(if hose.state == "one" then {inflow} else 0) - {out[0]}', start=start[0]),
        x2=hb.Integral(f'(if hose.state == "two" then {inflow} else 0) - {out[1]}', start=start[1]),
    )
    m.machine(
        "hose",
        states={"one": [], "two": []},
        start="two",
        rules=["one -> two when x2 <= 0", "two -> one when x1 <= 0"],
    )
    run = hb.simulate(m, until=8, on_error="return")
    assert run.status == "accumulation", run.error
    (found,) = run.accumulations
    assert found.t == pytest.approx(sum(start) / (sum(out) - inflow), rel=1e-8)
