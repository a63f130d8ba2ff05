"""Comparators that read a voltage behind an ESR, held against a carrier or a reference with kinks.

No storage stands behind that voltage: how fast it moves was found by differences of all that is
compared, with steps that reached over corners of the carrier.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

Field = Callable[[float, Any], list[float]]


def filter_of(
    m: hb.Model, sizes: dict[str, float], turned: bool, start: tuple[float, float]
) -> None:
    """Add a coil, a capacitor with its ESR and a load behind the node ``n``."""
    way = -1.0 if turned else 1.0
    m.add(n=hb.Zero(), j=hb.One(), o=hb.Zero(), c=hb.One(), R=hb.R(sizes["R"]))
    m.add(esr=hb.R(sizes["r"]), L=hb.I(sizes["L"], f=way * start[0]))
    m.add(C=hb.C(sizes["C"], e=way * start[1]))
    m.bond("n -> j -> o", "o -> R", "o -> c", "c -> esr")
    m.bond(*(("L -> j", "C -> c") if turned else ("j -> L", "c -> C")))


def output_of(sizes: dict[str, float], x: Any) -> float:
    """Return the voltage at the load: of the coil's current and the capacitor's voltage."""
    return float((x[0] + x[1] / sizes["r"]) / (1 / sizes["R"] + 1 / sizes["r"]))


STRANGE = {"R": 3.28, "r": 0.16, "L": 1.3e-4, "C": 1e-4, "T": 3e-5, "ki": 43.0, "kp": 0.004}
SLOW = {"R": 5.0, "r": 0.3, "L": 2e-3, "C": 6e-5, "T": 4e-4, "ki": 8.0, "kp": 0.004}


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("diode", [False, True])
@pytest.mark.parametrize("sizes", [STRANGE, SLOW])
def test_pwm_of_a_pi_controller_does_not_slide_along_its_carrier(
    sizes: dict[str, float], diode: bool, turned: bool, solver: str
) -> None:
    T, ki, kp = sizes["T"], sizes["ki"], sizes["kp"]
    start, until = (4.0, 12.7), 12.7 * T
    m = hb.Model("voltage mode", domain="electrical")
    filter_of(m, sizes, turned, start)
    m.add(V=hb.Se(36.0), hi=hb.One(), d=hb.One(law="diode") if diode else hb.One())
    m.bond("V -> hi -> n", "d -> n")
    m.signal(error="14 - o.e", sum=hb.Integral(f"{ki}*error", start=0.4))
    m.signal(asked=f"sum + {kp}*error", carrier=f"abs(2*mod(time, {T})/{T} - 1)")
    m.machine(
        "Q",
        states={"on": ["hi"], "off": [] if diode else ["d"]},
        start="on",
        rules=["on -> off when asked < carrier", "off -> on when asked > carrier"],
    )
    t = np.linspace(0, until, 151)
    expected, switches = pwm(sizes, start, t)
    run = hb.simulate(m, until=until, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    assert "sliding" not in str(run.events)
    found = np.array([e.t for e in run.events][1:])
    assert len(found) == len(switches)
    assert np.allclose(found, switches, rtol=0, atol=1e-7 * until)
    way = -1.0 if turned else 1.0
    for name, column, sign in (("L.f", 0, 1.0), ("C.e", 1, way), ("sum", 2, 1.0)):
        off = np.abs(run[name].at(list(t)) - sign * expected[:, column])
        assert off.max() < 1e-7 * np.abs(expected[:, column]).max(), name


def pwm(
    sizes: dict[str, float], start: tuple[float, float], t: np.ndarray
) -> tuple[np.ndarray, list[float]]:
    """Return states at times, and when the switch changes: half a period after the other."""
    half, ki, kp = sizes["T"] / 2, sizes["ki"], sizes["kp"]
    x, begin, switches, out = np.array([*start, 0.4]), 0.0, [], np.zeros((len(t), 3))
    # the carrier is 1 at the start: off
    on, k = False, 0
    while begin < t[-1]:
        sign = 1.0 if k % 2 else -1.0

        def above(s: float, x: Any, sign: float = sign, begin: float = k * half) -> float:
            carrier = (0.0 if sign > 0 else 1.0) + sign * (s - begin) / half
            return float(x[2] + kp * (14 - output_of(sizes, x)) - carrier)

        above.terminal = True  # type: ignore[attr-defined]
        end = min((k + 1) * half, t[-1])
        fields = [field_of(sizes, u, ki) for u in (0.0, 36.0)]
        while begin < end:
            above.direction = -1 if on else 1  # type: ignore[attr-defined]
            s = solve_ivp(
                fields[int(on)], (begin, end), x, "DOP853", rtol=1e-11, atol=1e-12,
                events=above, dense_output=True, max_step=half / 10,
            )  # fmt: skip
            here = (t >= begin) & (t <= s.t[-1])
            out[here] = s.sol(t[here]).T
            begin, x = s.t[-1], s.y[:, -1]
            if s.status == 1:
                on = not on
                switches.append(begin)
        k += 1
    return out, switches


def field_of(sizes: dict[str, float], source: float, ki: float) -> Field:
    def field(_: float, x: Any) -> list[float]:
        v = output_of(sizes, x)
        return [(source - v) / sizes["L"], (v - x[1]) / sizes["r"] / sizes["C"], ki * (14 - v)]

    return field


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("tau", "humps"), [(1e-3, 2.5), (1e-4, 4.3), (0.02, 1.7)])
def test_sliding_along_a_rectified_reference(
    tau: float, humps: float, turned: bool, solver: str
) -> None:
    V, R = 100.0, 10.0
    sizes = {"R": R, "r": 1.0, "L": R * tau, "C": tau / R}
    until, k, lam, ref = 10 * tau, 1 / R, 0.5 / R / tau, 40.0
    w = np.pi * humps / until
    m = hb.Model("sliding mode", domain="electrical")
    start = (2.0, 30.0)
    filter_of(m, sizes, turned, start)
    m.add(V=hb.Se(V), hi=hb.One(), lo=hb.One())
    m.bond("n -> lo", "V -> hi -> n")
    m.signal(error=f"{ref} + 4*abs(sin({w!r}*time)) - o.e", sum=hb.Integral(f"{lam!r}*error"))
    m.signal(S=f"sum + {k!r}*error + {ref / R!r} - j.f")
    m.machine(
        "Q",
        states={"on": ["hi"], "off": ["lo"]},
        start="on",
        rules=["on -> off when S < 0", "off -> on when S > 0"],
    )
    run = hb.simulate(m, until=until, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()

    hump = [1.0]

    def asked(t: float) -> tuple[float, float]:
        return ref + 4 * hump[0] * np.sin(w * t), 4 * w * hump[0] * np.cos(w * t)

    def S(t: float, x: Any) -> float:
        return float(x[2] + k * (asked(t)[0] - output_of(sizes, x)) + ref / R - x[0])

    def rates(t: float, x: Any, u: float) -> list[float]:
        v = output_of(sizes, x)
        return [
            (u * V - v) / sizes["L"],
            (v - x[1]) / sizes["r"] / sizes["C"],
            lam * (asked(t)[0] - v),
        ]

    def moves(t: float, x: Any, u: float) -> float:
        d = rates(t, x, u)
        return float(d[2] + k * (asked(t)[1] - output_of(sizes, d)) - d[0])

    def along(t: float, x: Any) -> list[float]:
        low, high = moves(t, x, 0.0), moves(t, x, 1.0)
        assert low > 0 > high
        return rates(t, x, low / (low - high))

    S.terminal = True  # type: ignore[attr-defined]
    how: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-12, "dense_output": True}
    x, t = [*start, 0.0], 0.0
    bends = [i * np.pi / w for i in range(1, 6) if i * np.pi / w < until]
    on = solve_ivp(lambda t, x: rates(t, x, 1.0), (0, bends[0]), x, "DOP853", events=S, **how)
    assert on.status == 1
    pieces = [on]
    for number, end in enumerate([*bends, until]):
        hump[0] = -1.0 if number % 2 else 1.0
        t, x = pieces[-1].t[-1], pieces[-1].y[:, -1]
        pieces.append(solve_ivp(along, (t, end), x, "DOP853", **how))
    for s in pieces:
        at = np.linspace(s.t[0], s.t[-1], 32)[1:-1]
        for name, row, size in (("L.f", 0, 5.0), ("sum", 2, 5.0)):
            assert np.allclose(run[name].at(list(at)), s.sol(at)[row], rtol=0, atol=1e-6 * size), (
                name
            )
    assert len(run.events) <= 2 + len(bends)
