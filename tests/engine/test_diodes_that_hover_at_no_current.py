"""Valves whose flow dies out in swings: the run goes on where rounding keeps them from closing.

A guard of a law is found as soon as it holds by more than rounding, and the law counts more than
that as zero. Where errors of steps left a flow between the two, and its rate led back, the law
stood, the guard held still, and the run asked it again every few picoseconds for ever.
The oracle is SciPy's integration of the equations written by hand: a fuel injector of two volumes,
a delivery valve and a needle on a spring between two stops.
"""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

UNTIL = 12.0
LIFT, AREA, MASS, PRELOAD, CRACKING = 0.3, 5.0, 0.02, 80.0, 2.0
SIZES = {  # and up to when SciPy follows them in a few seconds
    "as drawn": ((0.6, 0.9, 0.05, 30.0, 0.4), 6.6),
    "a small volume": ((0.675, 0.3618, 0.005988, 11.23, 0.6634), 4.6),
    "a narrow valve": ((0.3815, 1.101, 0.291, 66.58, 0.4029), 11.0),
    "a large volume": ((0.2816, 2.099, 0.4049431, 47.99, 0.4049), 11.0),
}


def injector(sizes: tuple[float, ...], seed: int) -> hb.Model:
    c1, c2, valve, stiffness, damping = sizes
    bonds = [
        "Q -> n1", "n1 -> dv", "dv -> n2", "dv -> pc", "n2 -> nz", "nz -> cyl",
        "n2 -> ar", "ar -> u", "F0 -> u", "seat -> u", "u -> top",
    ]  # fmt: skip
    ends = [("n1", "p1"), ("dv", "rv"), ("n2", "p2"), ("u", "m"), ("u", "k"), ("u", "c")]
    draw = random.Random(seed)
    bonds += [f"{b} -> {a}" if seed and draw.random() < 0.5 else f"{a} -> {b}" for a, b in ends]
    bonds.append("nz -> noz")
    elements: dict[str, Any] = {
        "Q": hb.Sf("if time > 1 and time < 3 then 30*sin(pi*(time - 1)/2)^2 else 0"),
        "n1": hb.Zero(), "p1": hb.C(c1, e=1.0), "dv": hb.One(law="diode"), "pc": hb.Se(CRACKING),
        "rv": hb.R(valve), "n2": hb.Zero(), "p2": hb.C(c2, e=5.0), "nz": hb.One(),
        "noz": hb.G({"f": "if e > 0 then 20*h*e/sqrt(sqrt(e^2 + 0.01)) else 0"}), "cyl": hb.Se(0),
        "ar": hb.TF(1 / AREA), "u": hb.One(), "m": hb.I(MASS), "k": hb.C(1 / stiffness),
        "c": hb.R(damping), "F0": hb.Se(-PRELOAD),
        "seat": hb.Zero(law="unilateral", gap="h"),
        "top": hb.Zero(law="unilateral", gap=f"{LIFT} - h"),
    }  # fmt: skip
    names = list(elements)
    if seed:
        draw.shuffle(names)
        draw.shuffle(bonds)
    m = hb.Model("injector")
    m.add({name: elements[name] for name in names})
    m.bond(*bonds)
    m.signal(h=hb.Integral("u.f"))
    return m


def by_hand(sizes: tuple[float, ...], until: float, ts: np.ndarray) -> np.ndarray:
    """The pressures and the lift at `ts`: the needle is shut, flies, or is open."""
    c1, c2, valve, stiffness, damping = sizes

    def rates(flies: bool) -> Any:
        def of(t: float, x: np.ndarray) -> list[float]:
            p1, p2, h, u = x
            pumped = 30 * np.sin(np.pi * (t - 1) / 2) ** 2 if 1 < t < 3 else 0.0
            delivered = max(p1 - p2 - CRACKING, 0.0) / valve
            sprayed = 20 * h * p2 / np.sqrt(np.sqrt(p2**2 + 0.01)) if p2 > 0 else 0.0
            push = (AREA * p2 - PRELOAD - stiffness * h - damping * u) / MASS
            filled = delivered - sprayed - (AREA * u if flies else 0.0)
            moves = [u, push] if flies else [0.0, 0.0]
            return [(pumped - delivered) / c1, filled / c2, *moves]

        return of

    ends: dict[str, list[tuple[Any, int]]] = {
        "shut": [(lambda t, x: AREA * x[1] - PRELOAD, 1)],
        "flies": [(lambda t, x: x[2], -1), (lambda t, x: x[2] - LIFT, 1)],
        "open": [(lambda t, x: AREA * x[1] - PRELOAD - stiffness * LIFT, -1)],
    }
    out = np.empty((3, len(ts)))
    t, x, mode = 0.0, np.array([1.0, 5.0, 0.0, 0.0]), "shut"
    while t < until:
        events = []
        for end, way in ends[mode]:

            def event(t: float, x: np.ndarray, end: Any = end) -> float:
                return float(end(t, x))

            event.terminal = True  # type: ignore[attr-defined]
            event.direction = way  # type: ignore[attr-defined]
            events.append(event)
        stop = next(b for b in (1.0, 3.0, until) if b > t)
        run = solve_ivp(
            rates(mode == "flies"), (t, stop), x, method="Radau", events=events,
            dense_output=True, rtol=1e-9, atol=1e-11, max_step=0.02,
        )  # fmt: skip
        inside = (ts >= t) & (ts <= run.t[-1])
        if inside.any():
            out[:, inside] = run.sol(ts[inside])[:3]
        t, x = float(run.t[-1]), run.y[:, -1].copy()
        if run.status == 1:
            if mode == "flies":
                x[3] = 0.0
                mode = "shut" if len(run.t_events[0]) else "open"
                x[2] = 0.0 if mode == "shut" else LIFT
                pushed = AREA * x[1] - PRELOAD - stiffness * x[2]
                if (mode == "shut") == (pushed > 0.0):
                    mode = "flies"
            else:
                mode = "flies"
    return out


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("sizes", "until"), SIZES.values(), ids=SIZES)
def test_a_valve_whose_flow_dies_out_lets_time_go_on(
    sizes: tuple[float, ...], until: float
) -> None:
    ts = np.linspace(0.0, until, 202)[1:-1]
    right = by_hand(sizes, until, ts)
    for solver in ("auto", "rk45", "radau"):
        for seed in range(3):
            run = hb.simulate(injector(sizes, seed), UNTIL, solver=solver, max_steps=20000)
            assert run.status == "ok" and run.audit().holds()
            assert run.stats["steps"] < 2000
            for name, values in zip(("n1.e", "n2.e", "h"), right, strict=True):
                off = np.abs(run[name].at(ts.tolist()) - values).max()
                assert off < 1e-6 * np.abs(values).max()


@pytest.mark.parametrize("solver", ["auto", "rk45"])
def test_it_goes_on_from_where_it_hovers(solver: str) -> None:
    sizes, until = SIZES["a small volume"]
    whole = hb.simulate(injector(sizes, 0), until, solver=solver, max_steps=20000)
    first = hb.simulate(injector(sizes, 0), 4.04, solver=solver, max_steps=20000).state()
    second = hb.simulate(injector(sizes, 0), until, solver=solver, start=first, max_steps=20000)
    for name in ("n1.e", "n2.e", "h"):
        assert second[name].at(until) == pytest.approx(whole[name].at(until), rel=1e-7, abs=1e-9)
