"""Three-phase bridges whose diodes leak, 1e7 times less than they carry, with an earthed star.

Beside 1 milliohm the leaks are what elimination loses; what it may have lost must hide no current.
At each instant that is looked at the network is solved anew, with the currents of the coils.
"""

import math

import numpy as np
import pytest

import hybond as hb
from hybond.model.parts import Part

W, ON = 2 * math.pi * 50, 1e-3
VOLTS, LEAST = 294.97367080197967, 1e-6
COILS = (0.0017456254476732778, 0.0007245669693419015, 0.0032509599328191243)
PHASES = (4.034981344486862, 1.940586242093667, -0.15380886029952823)
UPPER = (16734.510224071622, 6211.226757075058, 3707.3617059704593)
LOWER = (8843.22569069796, 11455.2624721022, 4552.125086468697)
ALIKE = (2e3, 2e3, 2e3)
STAR, RETURN, LOAD, CHOKE = 38709.735161900906, 33731.74486889871, 4.371366014870688, 0.0089346
Leaks = tuple[float, ...]
NODES = ("n", "a0", "a1", "a2", "b0", "b1", "b2", "p", "m", "q")


def branches(upper: Leaks, lower: Leaks) -> list[tuple[str, str, str, float]]:
    """Return the diodes: name, anode, cathode, and what is across each."""
    ups = [(f"u{k}", f"b{k}", "p", upper[k]) for k in range(3)]
    return ups + [(f"d{k}", "m", f"b{k}", lower[k]) for k in range(3)]


def bridge(upper: Leaks, lower: Leaks, *, by_hand: bool, turned: bool) -> hb.Model:
    m = hb.Model("bridge", domain="electrical", parameters={"w": W})
    m.add({name: hb.Zero() for name in NODES})

    def between(one: str, other: str, name: str, part: Part) -> None:
        m.add({f"i{name}": hb.One(), name: part})
        a, b = (other, one) if turned else (one, other)
        m.bond(*([f"{a} -> i{name}"] if a else []), *([f"i{name} -> {b}"] if b else []))
        m.bond(f"i{name} -> {name}")

    for k in range(3):
        m.add({f"i{k}": hb.One(), f"V{k}": hb.Se(f"{VOLTS}*sin(w*time + {PHASES[k]})")})
        m.bond(f"V{k} -> i{k}", f"n -> i{k} -> a{k}")
        between(f"a{k}", f"b{k}", f"L{k}", hb.I(COILS[k]))
    for name, anode, cathode, across in branches(upper, lower):
        m.add({name: hb.One() if by_hand else hb.One(law="diode"), f"on_{name}": hb.R(ON)})
        m.bond(f"{anode} -> {name} -> {cathode}", f"{name} -> on_{name}")
        between(anode, cathode, f"off_{name}", hb.R(across))
        rules = [f"blocks -> conducts when {name}.e > 0", f"conducts -> blocks when {name}.f < 0"]
        states = {"blocks": [], "conducts": [name]}
        if by_hand:
            m.machine(f"M{name}", states=states, start="blocks", rules=rules)
    between("n", "", "star", hb.R(STAR))
    between("m", "", "back", hb.R(RETURN))
    between("p", "q", "load", hb.R(LOAD))
    between("q", "m", "choke", hb.I(CHOKE))
    return m


def potentials(
    t: float, currents: dict[str, float], diodes: list[tuple[str, str, str, float]], on: list[bool]
) -> dict[str, float]:
    """Solve the network of resistors and sources that there is at an instant."""
    at = {name: k for k, name in enumerate(NODES)}
    size = len(NODES) + 3
    a, b = np.zeros((size, size)), np.zeros(size)

    def joined(one: str, other: str, g: float) -> None:
        for x, y, sign in ((one, one, 1), (other, other, 1), (one, other, -1), (other, one, -1)):
            if x and y:
                a[at[x], at[y]] += sign * g

    for (_, anode, cathode, across), conducts in zip(diodes, on, strict=True):
        joined(anode, cathode, 1 / across + (1 / ON if conducts else 0.0))
    joined("n", "", 1 / STAR)
    joined("m", "", 1 / RETURN)
    joined("p", "q", 1 / LOAD)
    coils = [(f"a{k}", f"b{k}", f"L{k}") for k in range(3)] + [("q", "m", "choke")]
    for one, other, name in coils:
        b[at[one]] -= currents[name]
        b[at[other]] += currents[name]
    for k in range(3):
        row = len(NODES) + k
        a[row, at[f"a{k}"]] = a[at[f"a{k}"], row] = 1.0
        a[row, at["n"]] = a[at["n"], row] = -1.0
        b[row] = VOLTS * math.sin(W * t + PHASES[k])
    found = np.linalg.solve(a, b)
    return {name: float(found[k]) for name, k in at.items()}


@pytest.mark.parametrize(
    ("upper", "lower", "by_hand", "turned", "solver"),
    [
        (UPPER, LOWER, False, False, "auto"),
        (UPPER, LOWER, False, True, "radau"),
        (UPPER, LOWER, True, False, "auto"),
        (UPPER[::-1], LOWER[::-1], True, True, "radau"),
        (LOWER, UPPER, False, False, "auto"),
        (ALIKE, ALIKE, False, True, "auto"),
    ],
)
def test_leaks_hide_no_current(
    upper: Leaks, lower: Leaks, by_hand: bool, turned: bool, solver: str
) -> None:
    diodes = branches(upper, lower)
    run = hb.simulate(
        bridge(upper, lower, by_hand=by_hand, turned=turned), until=0.04, solver=solver
    )
    way = -1.0 if turned else 1.0
    for t in np.linspace(5.13e-4, 0.0397, 40):
        currents = {c: way * float(run[f"{c}.f"].at(t)) for c in ("L0", "L1", "L2", "choke")}
        on = [k == 1 for k in [e for e in run.events if e.t <= t][-1].steps[-1].mode]
        v = potentials(t, currents, diodes, on)
        for (name, anode, cathode, _), conducts in zip(diodes, on, strict=True):
            across = v[anode] - v[cathode]
            assert across > -LEAST if conducts else across < LEAST, (t, name)
        for k in range(3):
            found = way * float(run[f"L{k}.e"].at(t))
            assert found == pytest.approx(v[f"a{k}"] - v[f"b{k}"], abs=1e-5), t
    assert len(run.events) < 40
    assert not any("few digits" in warning for warning in run.warnings)
    assert run.audit().power < 1e-12
