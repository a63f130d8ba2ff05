"""Carriers that time alone moves: each edge is where the clock says, however many there are.

What one of them compares is looked for once, not again at each event of the others: 300 took 12 ms
an event.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.engine import Engine
from hybond.engine.guards import guard_shape
from hybond.engine.guards.locator import Locator

UNTIL = 0.5


def carriers(periods: list[float], duty: float, form: str) -> hb.Model:
    """Return machines that are on for a part of their period, beside a filter of the first four."""
    m = hb.Model("carriers")
    level = " + ".join(
        f"(if A{k}.state == 'on' then 1 else 0)" for k in range(min(len(periods), 4))
    )
    m.add(s=hb.Se(level), j=hb.One(), r=hb.R(1.0), c=hb.C(0.5))
    m.bond("s -> j", "j -> r", "j -> c")
    for k, p in enumerate(periods):
        if form == "mod":
            on = f"mod(time/(1 s), {p!r}) < {duty * p!r}"
        elif form == "floor":
            on = f"time/(1 s)/{p!r} - floor(time/(1 s)/{p!r}) < {duty!r}"
        else:  # the same by a triangle
            on = f"acos(cos(2*3.141592653589793*time/(1 s)/{p!r} - {math.pi * duty!r})) < " + repr(
                math.pi * duty
            )
        rules = [f"off -> on when {on}", f"on -> off when not ({on})"]
        states: dict[str, list[str]] = {"off": [], "on": []}
        m.machine(f"A{k}", states=states, start="on", rules=rules)
    return m


def edges(periods: list[float], duty: float) -> list[float]:
    """Return the instants at which one of them switches."""
    found = set()
    for p in periods:
        for n in range(int(UNTIL / p) + 2):
            found |= {n * p, (n + duty) * p}
    return sorted(t for t in found if 1e-9 < t < UNTIL)


@pytest.mark.parametrize("form", ["mod", "floor", "triangle"])
@pytest.mark.parametrize("duty", [0.5, 0.03, 0.91])
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
def test_edges_are_where_the_clocks_say(form: str, duty: float, solver: str) -> None:
    periods = [0.0731, 0.1137, 0.0519, 0.1931]
    run = hb.simulate(carriers(periods, duty, form), UNTIL, solver=solver)
    # where a triangle begins at its level, rounding is told from it at the first moment
    found = [e.t for e in run.events if e.cause != "start" and e.t > 1e-9]
    assert found == pytest.approx(edges(periods, duty), abs=1e-8 if form == "triangle" else 1e-12)
    # what the filter holds, by the exponential between edges
    q, t = 0.0, 0.0
    for end in [*edges(periods, duty), UNTIL]:
        middle = 0.5 * (t + end)
        level = float(sum(math.fmod(middle, p) < duty * p for p in periods))
        q = 0.5 * level + (q - 0.5 * level) * math.exp(-(end - t) / 0.5)
        t = end
    assert run.final["c.q"] == pytest.approx(q, abs=3e-8)


@pytest.mark.parametrize("many", [6, 12])
def test_what_one_compares_is_not_sampled_for_the_others(
    many: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    periods = [0.05 + 0.0137 * k % 0.07 + 0.0011 * k for k in range(many)]
    asked = 0
    test_here = guard_shape.test_here

    def counted(e: Engine, g: Locator, k: int) -> bool:
        nonlocal asked
        asked += 1
        return test_here(e, g, k)

    monkeypatch.setattr(guard_shape, "test_here", counted)
    run = hb.simulate(carriers(periods, 0.5, "mod"), 0.2, engine="python")
    assert len(run.events) > 4 * many
    # some blocks of nine samples for each, whatever the others do
    assert asked < 9 * 30 * len(run.events)
