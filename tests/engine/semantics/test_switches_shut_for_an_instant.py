"""A switch that fills what is stored and opens at the same instant: no impact that comes to rest.

A source behind an ideal switch is what a floor is to a lump: it prescribes what it is tied to, and
may be shut for an instant only. What lies on a floor falls back on it; a capacitor that was filled
stays as it is until the rules say so.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb

SOLVERS = ["auto", "rk45", "radau"]


def shut_once(
    dual: bool,
    turned: bool,
    size: float,
    loss: float,
    source: str,
    rules: list[str],
    filled: float = 0.0,
) -> hb.Model:
    """Return storage with a loss at a source behind a switch; its intake is counted as `taken`."""
    m = hb.Model("shut once")
    if dual:
        m.add(
            still=hb.Sf(source),
            sw=hb.Zero(),
            z=hb.One(),
            held=hb.I(size, f=filled),
            loss=hb.R(loss),
        )
    else:
        m.add(
            still=hb.Se(source),
            sw=hb.One(),
            z=hb.Zero(),
            held=hb.C(size, e=filled),
            loss=hb.G(loss),
        )
    m.bond("still -> sw -> z", "z -> loss", "held -> z" if turned else "z -> held")
    m.signal(taken=hb.Integral("still.e" if dual else "still.f", start=0))
    m.signal(clock=hb.Integral("1", start=0))
    m.machine(
        "m",
        states={"shut": ["sw"], "open": [], "waits": []},
        start="open" if filled else "shut",
        rules=rules,
    )
    return m


def common(dual: bool) -> str:
    return "z.f" if dual else "z.e"


def stairs(
    level: float, after: float, size: float, loss: float
) -> tuple[float, Callable[[float], float]]:
    """Return when what `floor(time)` has brought is above a level, and what is left after it.

    At `n` seconds `size` comes at once, and `n*loss` until the next second.
    """
    n, taken = 0, 0.0
    while taken <= level:
        taken += n * loss + size
        n += 1
    assert taken - size < level
    return float(n), lambda t: n * math.exp(-(t - n) * loss / size) if t < after else math.nan


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("dual", "turned"), [(False, False), (False, True), (True, False)])
@pytest.mark.parametrize(("size", "loss"), [(1.0, 1.0), (0.4, 0.03), (30.0, 7.0)])
@pytest.mark.parametrize(
    ("back", "after"),
    [
        ([], math.inf),
        (["open -> shut when time >= 3.6"], 3.6),
        (["open -> shut when clock >= 3.6"], 3.6),
        (["open -> waits when clock >= 2.5", "waits -> shut when clock >= 3.6"], 3.6),
        (["open -> waits when time >= 2.5", "waits -> shut when clock >= 3.6"], 3.6),
    ],
)
def test_a_switch_that_has_filled_a_capacitor_opens(
    solver: str,
    dual: bool,
    turned: bool,
    size: float,
    loss: float,
    back: list[str],
    after: float,
) -> None:
    """The jump at 2 s brings more than is allowed; what was filled runs out through the loss."""
    level = 1.5 * size + loss
    rules = [f"shut -> open when pre(taken) > {level!r} and pre(clock) < 3", *back]
    m = shut_once(dual, turned, size, loss, "floor(1*time)", rules)
    run = hb.simulate(m, until=3.9, solver=solver)
    opened, left = stairs(level, after, size, loss)
    assert opened == 2.0
    t = np.linspace(2.001, min(after, 3.9) - 1e-3, 50)
    got = run[common(dual)].at(t.tolist())
    np.testing.assert_allclose(got, [left(x) for x in t], rtol=1e-6)
    assert not run.accumulations
    assert run.audit().holds()
    if after < 3.9:
        assert run[common(dual)].at(3.8) == pytest.approx(3.0, rel=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("low", [0.3, 0.9])
@pytest.mark.parametrize("helper", [False, True])
def test_a_capacitor_is_filled_each_time_that_it_is_low(
    solver: str, dual: bool, low: float, helper: bool
) -> None:
    """From 5 down to `low` of it through a loss takes ln(1/low); each filling lasts an instant."""
    c = common(dual)
    rules = ['shut -> open when pre(m.state == "shut")']
    again = f"{c} <= {5 * low!r}"
    rules.append(
        'open -> shut when gate.state == "low"' if helper else f"open -> shut when {again}"
    )
    m = shut_once(dual, False, 2.0, 0.5, "5", rules, filled=5.0)
    if helper:
        m.machine(
            "gate",
            states={"high": [], "low": []},
            start="high",
            rules=[f"high -> low when {again}", f"low -> high when pre({c}) > {5 * low!r}"],
        )
    else:
        m.machine("gate", states={"high": [], "low": []}, start="high", rules=[])
    run = hb.simulate(m, until=12, solver=solver)
    span = 4.0 * math.log(1 / low)
    t = np.arange(1, 240) * 0.05 + 0.01234
    np.testing.assert_allclose(run[c].at(t.tolist()), 5 * np.exp(-np.mod(t, span) / 4.0), rtol=2e-6)
    lost = sum(s.energy.lost for ev in run.events for s in ev.steps if s.energy is not None)
    many = int(12 / span)
    assert lost == pytest.approx(many * 25.0 * (1 - low) ** 2, rel=1e-6)
    assert not run.accumulations


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_body_that_is_stopped_for_an_instant_is_pulled_on(solver: str) -> None:
    """A brake that locks at 1 s and lets go at once: what pulls begins anew from rest."""
    m = hb.Model("stopped", domain="rotational")
    m.add(T=hb.Se(3), w=hb.One(), J=hb.I(2), brake=hb.Zero(), frame=hb.Sf(0))
    m.bond("T -> w -> J", "frame -> brake -> w")
    m.machine(
        "k",
        states={"free": [], "locked": ["brake"], "done": []},
        start="free",
        rules=["free -> locked when time >= 1", 'locked -> done when pre(k.state == "locked")'],
    )
    run = hb.simulate(m, until=3, solver=solver)
    assert run["w.f"].at(0.9) == pytest.approx(1.35, rel=1e-9)
    assert run["w.f"].at(2.5) == pytest.approx(2.25, rel=1e-9)
    assert not run.accumulations
