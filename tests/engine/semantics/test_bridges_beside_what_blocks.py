"""A rectifier bridge whose source crosses zero, beside diodes that block a large voltage.

The current leaves two diodes for two others at that instant. How large it and its rate are is no
matter of what other diodes block, nor of the unit of time. Oracles are closed forms.
"""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

PARTS = {"d1": ("s1", "p"), "d2": ("s2", "p"), "d3": ("", "s1"), "d4": ("", "s2")}


def made(parts: dict[str, Any], bonds: list[str], rng: np.random.Generator) -> hb.Model:
    names = list(parts)
    rng.shuffle(names)
    rng.shuffle(bonds)
    m = hb.Model("bridge", domain="electrical")
    for name in names:
        m.add(**{name: parts[name]})
    m.bond(*bonds)
    return m


@pytest.mark.parametrize("blocks", ["", "x", "p", "xp"])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_bridge_commutates_beside_diodes_that_block(blocks: str, solver: str) -> None:
    for order in (0, 2, 3, 5, 29, 97):
        rng = np.random.default_rng(order)
        amplitude, w = (float(v) for v in 10 ** rng.uniform(-3, 3, 2))
        phase, i = float(rng.uniform(0, 6)), float(10 ** rng.uniform(-3, 3))
        l = amplitude / w / i * float(10 ** rng.uniform(-1, 1))
        end = 20 * math.pi / w
        turned = order % 2 == 1
        parts: dict[str, Any] = {name: hb.One(law="diode") for name in PARTS}
        parts |= {name: hb.Zero() for name in ("s1", "s2", "p", "x")}
        parts |= {name: hb.One() for name in ("loop", "choke", "switch")}
        parts |= {"V": hb.Se(f"{amplitude!r}*sin({w!r}*time + {phase!r})")}
        parts |= {"L": hb.I(l, f=-i if turned else i)}
        bonds = ["s1 -> loop", "loop -> s2", "loop -> V", "p -> choke", "choke -> x", "x -> switch"]
        bonds.append("L -> choke" if turned else "choke -> L")
        for k, at in enumerate(blocks):
            parts |= {
                f"b{k}": hb.One(law="diode"),
                f"o{k}": hb.Zero(),
                f"U{k}": hb.Se(2 * amplitude),
            }
            bonds += [f"{at} -> b{k}", f"b{k} -> o{k}", f"U{k} -> o{k}"]
        for name, (start, stop) in PARTS.items():
            bonds += [f"{start} -> {name}"] if start else []
            bonds.append(f"{name} -> {stop}")
        m = made(parts, bonds, rng)
        never = f"on -> off when time > {1e9 / w!r}"
        m.machine("S", states={"on": ["switch"], "off": []}, start="on", rules=[never])
        run = hb.simulate(m, until=end, solver=solver)
        # L i' = |u|, and the mean of |sin| is 2/pi
        assert run["choke.f"].at(end) == pytest.approx(i + 40 * amplitude / w / l, rel=1e-6)
        assert len(run.events) - 1 == 20
        assert run.audit().holds()


@pytest.mark.parametrize("load", ["choke", "constant current"])
@pytest.mark.parametrize("w", [1e-6, 1e-5, 1e-3, 1.0, 1e6])
def test_a_six_pulse_bridge_commutates_however_slow_its_source_is(load: str, w: float) -> None:
    for order in range(4):
        rng = np.random.default_rng(order)
        amplitude, i = (float(v) for v in 10 ** rng.uniform(-3, 3, 2))
        phase, end = float(rng.uniform(0, 6)), 4 * math.pi / w
        l = amplitude / w / i * float(10 ** rng.uniform(-1, 1))
        parts: dict[str, Any] = {name: hb.Zero() for name in ("p", "n", "star")}
        parts |= {"dc": hb.One(), "L": hb.I(l, f=i) if load == "choke" else hb.Sf(i)}
        bonds = ["p -> dc", "dc -> L", "dc -> n"]
        shift = {k: phase - 2 * math.pi / 3 * n for n, k in enumerate("abc")}
        for k in "abc":
            source = hb.Se(f"{amplitude!r}*sin({w!r}*time + {shift[k]!r})")
            parts |= {f"V{k}": source, k: hb.Zero(), f"i{k}": hb.One()}
            parts |= {f"u{k}": hb.One(law="diode"), f"l{k}": hb.One(law="diode")}
            bonds += [f"V{k} -> i{k}", f"star -> i{k}", f"i{k} -> {k}", f"{k} -> u{k}"]
            bonds += [f"u{k} -> p", f"n -> l{k}", f"l{k} -> {k}"]
        run = hb.simulate(made(parts, bonds, rng), until=end)
        t = np.sort(rng.uniform(0, end, 60))
        phases = np.array([amplitude * np.sin(w * t + shift[k]) for k in "abc"])
        dc = run["p.e"].at(list(t)) - run["n.e"].at(list(t))
        assert np.max(np.abs(dc - np.ptp(phases, axis=0))) < 1e-5 * amplitude
        if load == "choke":
            want = i + 3 * math.sqrt(3) * amplitude / math.pi * end / l
            assert run["dc.f"].at(end) == pytest.approx(want, rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_bridge_into_a_resistor_that_bends_commutates_beside_a_diode(solver: str) -> None:
    for order in (3, 5, 11, 29):
        rng = np.random.default_rng(order)
        amplitude, w = (float(v) for v in 10 ** rng.uniform(-3, 3, 2))
        phase, i = float(rng.uniform(0, 6)), float(10 ** rng.uniform(-3, 3))
        l, bend = amplitude / w / i, 0.3 * amplitude / i**2
        end = 4 * math.pi / w
        parts: dict[str, Any] = {name: hb.One(law="diode") for name in (*PARTS, "b")}
        parts |= {name: hb.Zero() for name in ("s1", "s2", "p", "o")}
        parts |= {"loop": hb.One(), "choke": hb.One(), "L": hb.I(l, f=i)}
        parts |= {"V": hb.Se(f"{amplitude!r}*sin({w!r}*time + {phase!r})")}
        parts |= {"U": hb.Se(2 * amplitude), "R": hb.R({"e": f"{bend!r}*f*abs(f)"})}
        bonds = ["s1 -> loop", "loop -> s2", "loop -> V", "p -> choke", "choke -> L"]
        bonds += ["choke -> R", "p -> b", "b -> o", "U -> o"]
        for name, (start, stop) in PARTS.items():
            bonds += [f"{start} -> {name}"] if start else []
            bonds.append(f"{name} -> {stop}")
        run = hb.simulate(made(parts, bonds, rng), until=end, solver=solver)

        def rate(s: float, y: Any, phase: float = phase) -> Any:
            # in units of amplitude, i and 1/w: y' = |u| - 0.3 y |y|
            return abs(np.sin(s + phase)) - 0.3 * y * np.abs(y)

        known = solve_ivp(rate, (0, 4 * np.pi), [1.0], rtol=1e-10, atol=1e-12, max_step=0.01)
        assert run["choke.f"].at(end) / i == pytest.approx(known.y[0, -1], rel=1e-5)
        assert run.audit().holds()
