"""What a function does where its argument is largest, and nowhere else, is not between two stages.

A comparator with a level just below the top of a sine is on for a hundredth of its turn. Where what
it reads was moved by the plant it lay between two stages of a step, and up to all of it was missing
with nothing said. A loop closed around such a function was seen in steps a ten thousandth as long
as those that it needs.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import hybond as hb

END = 20.0
CLOSE = [(1e4, 0.998), (1e6, 0.99998)]
"""How steeply it rises, and where: on for 0.13 and 0.013 rad of a turn."""
FORMS = {
    "tanh": "12*(1 + tanh({k}*(({u} - r.e + 0.5)/1 [V] - {d})))",
    "exp": "12/(1 + exp(-{k}*(({u} - r.e + 0.5)/1 [V] - {d})))",
    "power": "12*(0.5*({u} - r.e + 1.5)/1 [V])^{k}",
}


def given(form: str, k: float, d: float, u: float) -> float:
    """Return what one of them is."""
    if form == "power":
        return 12.0 * (0.5 + 0.5 * u) ** k
    if form == "tanh":
        return 12.0 * (1.0 + math.tanh(k * (u - d)))
    return 12.0 / (1.0 + math.exp(min(-k * (u - d), 700.0)))


def comparator(form: str, k: float, d: float, drive: str) -> hb.Model:
    """A unit cosine, less half a volt that is stored, against a level, into 100 F behind 1 ohm."""
    m = hb.Model("comparator", domain="electrical")
    u = "s"
    if drive == "signal":
        m.signal(s="1 [V]*cos(1*time)")
    elif drive == "source":
        m.add(u=hb.Se("cos(1*time)"), load=hb.R(1.0))
        m.bond("u -> load")
        u = "u.e"
    else:
        m.add(L=hb.I(1.0), u=hb.C(1.0, e=1.0), o=hb.One())
        m.bond("o -> L" if drive == "swings" else "L -> o", "o -> u")
        u = "u.e"
    m.add(r=hb.C(1.0, e=0.5), leak=hb.G(0.0), n=hb.Zero())
    m.bond("n -> r", "n -> leak")
    law = FORMS[form].format(k=k, d=d, u=u)
    m.add(b=hb.Se(law), w=hb.R(1.0), c=hb.C(100.0), j=hb.One())
    m.bond("b -> j -> w", "j -> c")
    return m


@cache
def charge(form: str, k: float, d: float) -> float:
    """Return the integral of what the comparator gives, as it decays until the end."""

    def left(t: float) -> float:
        return given(form, k, d, math.cos(t)) * math.exp((t - END) / 100.0)

    total = 0.0
    for top in range(4):
        middle = top * 2.0 * math.pi
        for part in np.linspace(-0.5, 0.45, 20) if top else np.linspace(0.0, 0.45, 10):
            a = middle + part
            total += quad(left, a, a + 0.05, epsabs=1e-14, epsrel=1e-10, limit=200)[0]
    return total


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("drive", ["signal", "source", "swings", "swings_back"])
@pytest.mark.parametrize(("k", "d"), CLOSE)
@pytest.mark.parametrize("form", FORMS)
def test_a_comparator_is_on_at_each_top(
    form: str, k: float, d: float, drive: str, solver: str
) -> None:
    run = hb.simulate(comparator(form, k, d, drive), END, solver=solver)
    assert run.status == "ok"
    # what swings is as large as the tolerance makes it, which counts k times
    close = 3e-8 * k if drive.startswith("swings") else 1e-5
    assert run.final["c.q"] == pytest.approx(charge(form, k, d), rel=close)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("back", [False, True])
def test_a_diode_conducts_at_each_top(back: bool, solver: str) -> None:
    """By its own effort, which a law's slopes say that it reads; on a bond turned round that is
    less than nothing, and so is its flow."""
    k, d = 1e5, 0.9998
    sign = "-" if back else ""
    m = hb.Model("diode", domain="electrical")
    m.add(V=hb.Se("cos(1*time)"), i=hb.One(), n=hb.Zero(), c=hb.C(100.0))
    m.add(D=hb.R({"f": f"{sign}0.1*(1 + tanh({k}*({sign}e - {d})))"}))
    m.bond("V -> i -> n -> c", "D -> i" if back else "i -> D")

    def rate(t: float, q: np.ndarray) -> list[float]:
        return [0.1 * (1.0 + math.tanh(k * (math.cos(t) - float(q[0]) / 100.0 - d)))]

    right = solve_ivp(rate, (0.0, END), [0.0], "LSODA", rtol=1e-9, atol=1e-13, max_step=4e-3)
    run = hb.simulate(m, END, solver=solver)
    assert run.final["c.q"] == pytest.approx(right.y[0, -1], rel=1e-6)


LOOPS = {
    "follower": (["B1 o 0 V = {}", "V(i,o)"], 1.0),
    "doubles": (["B1 o 0 V = {}", "V(i,m)", "R1 o m 1k", "R2 m 0 1k"], 2.0),
    "turns": (["B1 o 0 V = {}", "-V(m)", "R1 i m 1k", "R2 m o 1k"], -1.0),
}
LIMITS = {
    "tanh": "12*tanh(1e5*({}))",
    "atan": "7.6*atan(2e5*({}))",
    "exp": "24/(1+exp(-2e5*({})))-12",
}


@pytest.mark.parametrize("limit", LIMITS)
@pytest.mark.parametrize("loop", LOOPS)
def test_a_closed_loop_with_limits_takes_no_more_steps_than_its_signal(
    tmp_path, loop: str, limit: str
) -> None:
    (amplifier, reads, *others), gain = LOOPS[loop]
    rows = "\n".join([amplifier.format(LIMITS[limit].format(reads)), *others])
    path = tmp_path / "loop.cir"
    path.write_text(
        f"Loop\nV1 i 0 SIN(0 1 1k)\n{rows}\nR8 o c 1k\nC8 c 0 1u IC=0\n.tran 10u 4m 0 uic\n.end\n"
    )
    deck = hb.read_circuit(path)
    run = hb.simulate(deck.model)
    assert run.status == "ok"
    assert run.stats["steps"] < 1000
    # were points of a solution followed as near as Newton's first step leads, they were millions
    assert len(run.trace.roots) < 100 * run.stats["steps"]
    w = 2e3 * math.pi
    size = gain / math.hypot(1.0, w * 1e-3)
    late = np.linspace(3e-3, 4e-3, 101)
    forced = size * np.sin(w * late - math.atan(w * 1e-3))
    rest = size * math.sin(math.atan(w * 1e-3)) * np.exp(-late / 1e-3)
    # what the gain of some 1e6 leaves
    assert run[deck.signal("v(c)")].at(late) == pytest.approx(forced + rest, abs=1e-5)
