"""A modulus that jumps with time acts in a jump as it is behind it.

Gears are shifted: what ties two bodies afterwards is the new ratio, and so the impulses between
them are those of the new ratio, too. The state goes to the nearest one, in energy, that the new
constraint allows: energy is lost, whatever the ratios. By the old ratio it could be made.
"""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

import hybond as hb

AFTER = 2.0
A, B = 2.0, 3.0
JUMPS = {
    "whole": "1 + floor(time/(1 s) + 0.5)",
    "rule": "if time >= 0.5 then 2 else 1",
    "sign": "1.5 + 0.5*sign(time - 0.5 [s])",
}


def geared(modulus: str, electrical: bool) -> hb.Model:
    """Two bodies, or two capacitors, behind a transformer: consistent at the start."""
    m = hb.Model("geared", domain="electrical" if electrical else "translational")
    if electrical:  # e1 = m e2
        m.add(a=hb.C(f"{A} F", e="1 V"), b=hb.C(f"{B} F", e="1 V"), v=hb.Zero(), w=hb.Zero())
    else:  # f2 = m f1
        m.add(a=hb.I(f"{A} kg", f="1 m/s"), b=hb.I(f"{B} kg", f="1 m/s"), v=hb.One(), w=hb.One())
    m.add(t=hb.TF(modulus))
    m.bond("v -> a", "v -> t.1", "t.2 -> w", "w -> b")
    return m


@pytest.mark.parametrize("electrical", [False, True])
@pytest.mark.parametrize("jump", JUMPS)
def test_what_a_gear_is_shifted_to_ties_bodies_by_its_own_ratio(
    jump: str, electrical: bool
) -> None:
    run = hb.simulate(geared(JUMPS[jump], electrical), "1 s")
    (event,) = run.events[1:]
    energy = event.steps[-1].energy
    assert energy is not None and run.audit().holds()
    assert event.t == pytest.approx(0.5, abs=1e-12)
    if electrical:
        # the charge that leaves a enters b in the ratio of flows, f1 = f2/m
        second = (A * AFTER * 1.0 + B * 1.0) / (A * AFTER**2 + B)
        values = (AFTER * second, second)
        names = ("a.e", "b.e")
    else:
        first = (A * 1.0 + AFTER * B * 1.0) / (A + AFTER**2 * B)
        values = (first, AFTER * first)
        names = ("a.f", "b.f")
    assert [float(run[n].at(1.0)) for n in names] == pytest.approx(values, rel=1e-12)
    left = 0.5 * (A * values[0] ** 2 + B * values[1] ** 2)
    assert energy.lost == pytest.approx(0.5 * (A + B) - left, rel=1e-9)
    assert energy.lost > 0.0 and energy.source == 0.0


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.1, 4.0, -1.0])
def test_no_ratio_makes_energy(ratio: float) -> None:
    run = hb.simulate(geared(f"if time >= 0.5 then {ratio} else 1", False), "1 s")
    energy = run.events[1].steps[-1].energy
    first = (A + ratio * B) / (A + ratio**2 * B)
    assert energy is not None and energy.lost >= 0.0
    assert float(run["a.f"].at(1.0)) == pytest.approx(first, rel=1e-12)


def test_a_gyrator_that_jumps_keeps_to_its_new_modulus() -> None:
    # e2 = r f1: a spring behind it is as much as a mass, q/C2 = r p/m
    m = hb.Model("gyrated", domain="electrical")
    m.add(a=hb.I("2 H", f="1 A"), g=hb.GY("(if time >= 0.5 then 2 else 1)*1 [ohm]"))
    m.add(b=hb.C("3 F", e="1 V"), v=hb.One(), w=hb.Zero())
    m.bond("v -> a", "v -> g.1", "g.2 -> w", "w -> b")
    run = hb.simulate(m, "1 s")
    # p moves by -r nu where q moves by nu
    first = (2.0 + 2.0 * 3.0) / (2.0 + 4.0 * 3.0)
    assert float(run["a.f"].at(1.0)) == pytest.approx(first, rel=1e-12)
    assert float(run["b.e"].at(1.0)) == pytest.approx(2.0 * first, rel=1e-12)
    assert run.audit().holds()


STORED = {
    # the storage at port 1, the two-port, and the storage at port 2
    "TF of capacitors": ("C", "TF", "C"),
    "TF of masses": ("I", "TF", "I"),
    "GY of a capacitor and a mass": ("C", "GY", "I"),
    "GY of a mass and a capacitor": ("I", "GY", "C"),
}


def closed(which: str, modulus: str) -> hb.Model:
    """Two storages apart, which a switch joins by a two-port that reads one of them."""
    one, port, two = STORED[which]
    m = hb.Model("closed")
    # a capacitor gives its effort, a mass its flow: it stands at a 0 or a 1
    m.add(a=hb.C(2.0, q=3.0) if one == "C" else hb.I(2.0, p=3.0), j=_node(one))
    m.add(b=hb.C(1.0, q=0.5) if two == "C" else hb.I(1.0, p=0.5), k=_node(two))
    m.add(t=hb.TF(modulus) if port == "TF" else hb.GY(modulus))
    m.add(s=hb.One() if one == "C" else hb.Zero())
    m.bond("j -> a", "j -> s", "s -> t.1", "t.2 -> k", "k -> b")
    states = {"off": [], "on": ["s"]}
    m.machine("S", states=states, start="off", rules=["off -> on when time >= 0.5"])
    return m


def _node(kind: str) -> hb.Zero | hb.One:
    return hb.Zero() if kind == "C" else hb.One()


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("read", ["a", "b"])
@pytest.mark.parametrize("which", STORED)
def test_a_modulus_of_what_jumps_ties_it_by_what_it_is_then(
    which: str, read: str, solver: str
) -> None:
    one, port, two = STORED[which]
    path = f"{read}.{'q' if (one if read == 'a' else two) == 'C' else 'p'}"
    run = hb.simulate(closed(which, f"1.5 + 0.4*sin({path})"), 1.0, solver=solver)

    def modulus(x: float, y: float) -> float:
        return 1.5 + 0.4 * math.sin(x if read == "a" else y)

    before = modulus(3.0, 0.5)

    def states(nu: float) -> tuple[float, float]:
        """What both store after an impulse, by f2 = m f1, e2 = r f1; e1 = m e2, e1 = r f2."""
        return (3.0 - nu, 0.5 + before * nu) if one == "C" else (3.0 - before * nu, 0.5 + nu)

    def gap(nu: float) -> float:
        """The law behind it: e1 = m e2, e1 = r f2; f2 = m f1, e2 = r f1."""
        x, y = states(nu)
        return x / 2.0 - modulus(x, y) * y if one == "C" else y - modulus(x, y) * x / 2.0

    expected = states(brentq(gap, -4.0, 4.0, xtol=1e-15))
    names = [f"{n}.{'q' if kind == 'C' else 'p'}" for n, kind in (("a", one), ("b", two))]
    assert [float(run[n].at(1.0)) for n in names] == pytest.approx(expected, rel=1e-10)
    assert run.audit().holds()
    (warning,) = run.warnings
    assert f"the modulus of t ({port} 1.5 + 0.4*sin({path})) reads jumps" in warning
