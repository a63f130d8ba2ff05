"""A current finds its diode where the voltages of modulated gyrators leave rounding beside it.

The bridge of a brushless motor hands its current from one phase to the next. What it takes from the
last one goes on through a diode, until it has ended. Oracle: three coils by SciPy, each on the
rail that its switch or its diode puts it on.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

KE, L, R, U = 0.05, 5e-4, 0.3, 24.0


def shape(x: float) -> float:
    """Return the trapezoid of a back voltage."""
    x = x % (2 * math.pi)
    rises = min(x, math.pi - x, key=abs) if x < 3 * math.pi / 2 else x - 2 * math.pi
    return max(-1.0, min(1.0, rises * 6 / math.pi))


def bridge(speed: float, start: float, *, gyrate: bool, back: bool) -> hb.Model:
    """Return a motor on its bridge, that turns evenly; `back` turns the bonds of its coils."""
    m = hb.Model("brushless", domain="electrical", parameters={"ke": KE, "w": speed})
    for i, p in enumerate("abc"):
        x = f"x{p}"
        names = {f"{kind}{p}": hb.One() for kind in ("i", "up", "lo")}
        names |= {f"du{p}": hb.One(law="diode"), f"dl{p}": hb.One(law="diode"), f"n{p}": hb.Zero()}
        coil = hb.I(L, f=0.0)
        two_port = hb.GY(f"ke*s{p}") if gyrate else hb.TF(f"w*ke*(2 + s{p})")
        m.add(names | {f"L{p}": coil, f"R{p}": hb.R(R), f"k{p}": two_port})
        m.bond(f"n{p} -> i{p} -> R{p}", f"i{p} -> k{p}", f"i{p} -> star")
        m.bond(f"L{p} -> i{p}" if back else f"i{p} -> L{p}")
        m.bond(
            f"plus -> up{p} -> n{p} -> lo{p} -> minus", f"minus -> dl{p} -> n{p} -> du{p} -> plus"
        )
        m.bond(f"k{p} -> shaft" if gyrate else f"k{p} -> one")
        m.signal(
            {
                x: f"mod(4*(w*time + {start}) - {i}*2*pi/3, 2*pi)",
                f"s{p}": f"max(-1, min(1, 6/pi*(if {x} < pi/2 then {x} else "
                f"if {x} < 3*pi/2 then pi - {x} else {x} - 2*pi)))",
            }
        )
        m.machine(
            f"M{p}",
            states={"up": [f"up{p}"], "lo": [f"lo{p}"], "off": []},
            start="off",
            rules=[
                f"off -> up when {x} >= pi/6 and {x} < 5*pi/6",
                f"off -> lo when {x} >= 7*pi/6 and {x} < 11*pi/6",
                f"up -> off when {x} >= 5*pi/6 or {x} < pi/6",
                f"lo -> off when {x} >= 11*pi/6 or {x} < 7*pi/6",
            ],
        )
    m.add(
        star=hb.Zero(),
        plus=hb.Zero(),
        minus=hb.Zero(),
        supply=hb.One(),
        V=hb.Se(U),
        ground=hb.Se(0),
    )
    m.bond("minus -> supply -> plus", "V -> supply", "ground -> minus")
    if gyrate:
        m.add(shaft=hb.One(domain="rotational"), turn=hb.Sf("w", domain="rotational"))
        m.bond("turn -> shaft")
    else:
        m.add(one=hb.Zero(), unit=hb.Se(1.0))  # the same voltage to all but a common part
        m.bond("unit -> one")
    return m


def currents(speed: float, start: float, end: float) -> np.ndarray:
    """Return the currents at the end."""
    y = np.zeros(3)
    t = 0.0

    def angles(t: float) -> list[float]:
        return [(4 * (speed * t + start) - i * 2 * math.pi / 3) % (2 * math.pi) for i in range(3)]

    while t < end:
        middle = angles(t + 1e-9)
        rails: list[float | None] = []
        freed = []
        for x, i in zip(middle, y, strict=True):
            up = math.pi / 6 <= x < 5 * math.pi / 6
            low = 7 * math.pi / 6 <= x < 11 * math.pi / 6
            off = None if abs(i) < 1e-9 else (U if i < 0 else 0.0)
            rails.append(U if up else 0.0 if low else off)
            if off is not None and not up and not low:
                freed.append(len(rails) - 1)
        on = [k for k in range(3) if rails[k] is not None]

        def rate(
            t: float, y: np.ndarray, on: list[int] = on, rails: list[float | None] = rails
        ) -> np.ndarray:
            drive = np.zeros(3)
            for k in on:
                drive[k] = (rails[k] or 0.0) - KE * speed * shape(angles(t)[k]) - R * y[k]
            out = np.zeros(3)
            out[on] = (drive[on] - drive[on].mean()) / L
            return out

        to_edge = (math.pi / 3 - (middle[0] - math.pi / 6) % (math.pi / 3)) / (4 * speed)
        stops = []
        for k in freed:

            def gone(t: float, y: np.ndarray, k: int = k) -> float:
                return float(y[k])

            gone.terminal = True  # type: ignore[attr-defined]
            stops.append(gone)
        last = min(end, t + 1e-9 + to_edge)
        way = solve_ivp(rate, (t, last), y, rtol=1e-10, atol=1e-12, events=stops or None)
        t, y = float(way.t[-1]), way.y[:, -1].copy()
        y[np.abs(y) < 1e-9] = 0.0
    return y


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("speed", "start", "gyrate", "back"),
    [
        pytest.param(100.0, 0.2, True, False, id="fast decay"),
        pytest.param(217.0, 1.4369, True, True, id="near the supply, back"),
        pytest.param(225.0, 0.2, True, False, id="nearer"),
        pytest.param(100.0, 0.2, False, True, id="levers, back"),
        pytest.param(217.0, 0.3, False, False, id="levers"),
    ],
)
def test_a_phase_that_is_left_frees_its_current_through_a_diode(
    speed: float, start: float, gyrate: bool, back: bool
) -> None:
    run = hb.simulate(bridge(speed, start, gyrate=gyrate, back=back), 5e-3)
    assert [run[f"R{p}.f"].at(5e-3) for p in "abc"] == pytest.approx(
        currents(speed, start, 5e-3), rel=1e-6, abs=1e-8
    )
    steps = [step.energy for event in run.events for step in event.steps if step.energy]
    assert max(abs(energy.lost) for energy in steps) < 1e-15
    assert not run.warnings
