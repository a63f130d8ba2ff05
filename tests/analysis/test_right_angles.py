"""Levers at a right angle: the cosine of a quarter turn is zero where numbers are folded."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.model.expressions import Number, parse, simplify

UNITS = {"TF": "{}", "GY": "({})*(1 [N*s/m])"}
ZERO_AT_90 = ["cos(al)", "sin(2*al)", "cos(al)*sin(al)", "cos(3*al)", "cos(-al)", "cos(al + 2*pi)"]


def lever(modulus: str, kind: str, *, turned: bool = False, al: str = "90 deg") -> hb.Model:
    """Two oscillators, of 1 kg on 0.5 m/N and 2 kg on 0.25 m/N, joined by a lever."""
    bonds = "w -> t -> v" if turned else "v -> t -> w"
    return hb.loads(
        f"""
hybond = 1
domain = "translational"
[parameters]
al = "{al}"
[elements]
a = {{ I = "1 kg", p = "1 N*s" }}
k = {{ C = "0.5 m/N" }}
b = {{ I = "2 kg" }}
h = {{ C = "0.25 m/N" }}
t = {{ {kind} = "{UNITS[kind].format(modulus)}" }}
v = {{ junction = 1 }}
w = {{ junction = 1 }}
[graph]
bonds = ["v -> a", "v -> k", "{bonds}", "w -> b", "w -> h"]
"""
    )


def poles(model: hb.Model) -> np.ndarray:
    found = hb.linearise(model).poles()
    return np.array(sorted(found, key=lambda p: (round(p.imag, 6), round(p.real, 6))))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["TF", "GY"])
@pytest.mark.parametrize("modulus", ZERO_AT_90)
def test_a_lever_at_a_right_angle_has_the_poles_of_one_that_moves_nothing(
    modulus: str, kind: str, turned: bool
) -> None:
    """They were [0.], as its modulus was 6e-17: all others were lost beside it."""
    found = poles(lever(modulus, kind, turned=turned))
    own = math.sqrt(2.0) * 1j
    # a transformer of modulus 0 holds the speed on one side and leaves the other alone
    expected = [-own, 0.0, own] if kind == "TF" else [-own, -own, own, own]
    assert len(found) == len(expected)
    assert np.allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("al", ["60 deg", "1 rad", "89.9 deg"])
def test_other_angles_move_the_load(al: str) -> None:
    """Speeds are tied, f2 = f1/m: an oscillator of both masses and springs."""
    model = lever("cos(al)", "TF", al=al)
    m = math.cos({"60 deg": math.pi / 3, "1 rad": 1.0, "89.9 deg": math.radians(89.9)}[al])
    # side 2 sees f2 = m*f1: masses and stiffnesses add up with m squared
    omega = math.sqrt((2.0 + 4.0 * m * m) / (1.0 + 2.0 * m * m))
    assert max(abs(poles(model).imag)) == pytest.approx(omega, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("sin(pi)", 0.0),
        ("cos(pi/2)", 0.0),
        ("cos(3*pi/2)", 0.0),
        ("cos(pi/3)", 0.5),
        ("sin(pi/6)", 0.5),
        ("sin(-5*pi/6)", -0.5),
        ("tan(pi/4)", 1.0),
        ("tan(3*pi/4)", -1.0),
        ("tan(pi)", 0.0),
        ("sin(7*pi/4) + sqrt(0.5)", 0.0),
        ("cos(pi)", -1.0),
    ],
)
def test_a_known_part_of_a_turn_is_folded_exactly(text: str, value: float) -> None:
    found = simplify(parse(text.replace("pi", repr(math.pi))))
    assert isinstance(found, Number)
    assert found.value == value


@pytest.mark.parametrize("x", [1.0, math.pi / 12, math.pi / 2 + 1e-12, 1e-300, 0.3, 2e6 * math.pi])
def test_other_angles_are_what_they_are(x: float) -> None:
    for name in ("sin", "cos", "tan"):
        found = simplify(parse(f"{name}({x!r})"))
        assert isinstance(found, Number)
        assert found.value == getattr(math, name)(x)


@pytest.mark.parametrize("start", ["90 deg", "60 deg"])
def test_an_angle_that_is_set_is_that_of_a_model_written_so(start: str) -> None:
    """Parameters are slots: what is structural at a right angle holds there alone."""
    model = lever("cos(al)", "TF", al=start)
    angles = [math.pi / 3, math.pi / 2, 1.0]
    many = hb.ensemble(model, 1.0, sets={"al": angles}, outputs=["a.p", "b.p", "k.q"])
    for n, angle in enumerate(angles):
        alone = hb.simulate(lever("cos(al)", "TF", al=f"{angle!r} rad"), until=1.0)
        for name in ("a.p", "b.p", "k.q"):
            assert many.final[name][n] == alone[name].at(1.0)
    assert many.final["b.p"][1] == 0.0
    assert abs(many.final["b.p"][0]) > 0.1


@pytest.mark.parametrize("law", ["cos(al)*f*(2 [N*s/m])", "f*(2 [N*s/m])*sin(2*al)"])
def test_a_law_at_a_right_angle_carries_nothing(law: str) -> None:
    model = lever("1", "TF")
    model.add(r=hb.R({"e": law}))
    model.bond("v -> r")
    run = hb.simulate(model, until=1.0)
    assert run["r.e"].at(0.5) == 0.0
