"""Sources of netlists that compute their current from their own voltage, behind coils.

Oracles: the equation of the coil between instants, ``L (i2 - i1)`` being the integral of what is
left of the source by the law inverted by hand; a steady state by hand; energy is taken only.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import simpson, solve_ivp

import hybond as hb

PEAK, COIL = 325.0, 10e-3


def converted(folder: Path, law: str, *rows: str) -> tuple[hb.Result, hb.Conversion]:
    path = folder / "law.cir"
    source = f"V1 in 0 SIN(0 {PEAK} 50)"
    text = ["law", source, f"L1 in a {COIL}", f"B1 a 0 {law}", *rows, ".tran 10u 40m", ".end"]
    path.write_text("\n".join(text) + "\n")
    conversion = hb.read_circuit(path)
    return hb.simulate(conversion.model), conversion


LAWS = {
    "I=v(a)*abs(v(a))/1000": lambda i: math.copysign(math.sqrt(1000.0 * abs(i)), i),
    "I=sgn(v(a))*sqrt(abs(v(a)))": lambda i: math.copysign(i * i, i),
    "I=v(a)/40+sgn(v(a))*sqrt(abs(v(a))/100)": lambda i: math.copysign(
        (10.0 * (-0.1 + math.sqrt(0.01 + abs(i) / 10.0)) / 0.5) ** 2, i
    ),
    "I=v(a)/40+v(a)*abs(v(a))/1000": lambda i: math.copysign(
        (-0.025 + math.sqrt(0.025**2 + 0.004 * abs(i))) / 0.002, i
    ),
    "I=-v(0,a)*abs(v(0,a))/1000": lambda i: math.copysign(math.sqrt(1000.0 * abs(i)), i),
}
"""A law, and the voltage that it has at a current."""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", LAWS)
def test_a_surge_law_behind_a_coil_is_not_refused(tmp_path: Path, law: str) -> None:
    run, conversion = converted(tmp_path, law)

    edges = np.array([0.0, 3e-3, 8e-3, 12e-3, 17e-3, 26e-3, 40e-3])
    for begin, end in pairwise(edges):
        t = np.linspace(begin, end, 8001)
        i = np.asarray(run[conversion.signal("i(L1)")].at(t))
        drop = PEAK * np.sin(100.0 * np.pi * t) - [LAWS[law](x) for x in i.tolist()]
        assert COIL * (i[-1] - i[0]) == pytest.approx(simpson(drop, x=t), abs=2e-6)
    assert float(run[conversion.signal("i(L1)")].at(0.0)) == 0.0
    assert not run.warnings


def test_it_is_a_resistor_that_takes_energy(tmp_path: Path) -> None:
    run, conversion = converted(tmp_path, "I=v(a)/40+(v(a)/200)^5")
    assert conversion.model.elements["B1"].kind == "R"
    t = np.linspace(0.0, 40e-3, 401)
    power = np.asarray(run["B1.e"].at(t)) * np.asarray(run["B1.f"].at(t))
    assert power.min() >= 0.0 and power.max() > 100.0


@pytest.mark.parametrize(
    ("law", "rows"),
    [
        ("I=-v(a)/400", ("R9 a 0 100",)),  # gives energy
        ("I=v(a)/40+1m", ()),  # as well, at no voltage
        ("I=v(in)/400", ("R9 a 0 100",)),  # another node
        ("I=v(a)/40*(1+time)", ()),
        ("V=v(in)/2", ()),
    ],
)
def test_what_is_no_resistor_stays_a_source(tmp_path: Path, law: str, rows: tuple[str]) -> None:
    path = tmp_path / "law.cir"
    head = ["law", "V1 in 0 SIN(0 325 50)", "R1 in a 10"]
    path.write_text("\n".join([*head, f"B1 a 0 {law}", *rows, ".tran 10u 4m", ".end"]) + "\n")
    assert hb.read_circuit(path).model.elements["B1"].kind in ("Se", "Sf")


def test_a_voltage_that_follows_its_own_current(tmp_path: Path) -> None:
    path = tmp_path / "law.cir"
    rows = ["law", "V1 in 0 5", "R1 in a 1", "B1 a 0 V=2*i(B1)+i(B1)^3", ".tran 1u 1m", ".end"]
    path.write_text("\n".join(rows) + "\n")
    conversion = hb.read_circuit(path)
    assert conversion.model.elements["B1"].kind == "R"
    run = hb.simulate(conversion.model)
    (root,) = [r.real for r in np.roots([1.0, 0.0, 3.0, -5.0]) if abs(r.imag) < 1e-12]
    assert float(run[conversion.signal("i(B1)")].at(5e-4)) == pytest.approx(root)


@pytest.mark.slow
def test_a_surge_law_straight_behind_a_coil_runs_through_zero(tmp_path: Path) -> None:
    """Its voltage is a fifth root of the current, which is known to the tolerance."""
    path = tmp_path / "law.cir"
    rows = ["V1 in 0 SIN(0 325 50)", "L1 in a 10m", "B1 a 0 I=(v(a)/200)^5"]
    path.write_text("\n".join(["law", *rows, ".tran 10u 40m", ".end"]) + "\n")
    conversion = hb.read_circuit(path)
    run = hb.simulate(conversion.model)
    current = run[conversion.signal("i(L1)")]

    def rate(t: float, i: np.ndarray) -> np.ndarray:
        return (325.0 * np.sin(100.0 * np.pi * t) - 200.0 * np.abs(i) ** 0.2) / 10e-3

    # before, the voltage is all of the source's
    start = (325.0 * np.sin(100.0 * np.pi * 1e-5) / 200.0) ** 5
    t = np.linspace(1e-5, 9.5e-3, 40)
    meant = solve_ivp(rate, (1e-5, 9.5e-3), [start], "Radau", t, rtol=1e-10, atol=1e-14).y[0]
    assert current.at(t) == pytest.approx(meant, abs=1e-6)
    assert current.at(t + 0.01) == pytest.approx(-meant, abs=1e-6)
    assert current.at(t + 0.03) == pytest.approx(-meant, abs=1e-6)
    # of 290 V at most; by steps that swing it was off by 7 V where the current is zero
    across = 200.0 * np.sign(meant) * np.abs(meant) ** 0.2
    assert run["B1.e"].at(t) == pytest.approx(across, abs=1.5)
    for zero in (0.01, 0.02, 0.03):
        assert abs(float(run["B1.e"].at(zero))) < 1.0


def test_a_measured_node_that_is_mistyped(tmp_path: Path) -> None:
    path = tmp_path / "rc.cir"
    rows = ["V1 in 0 5", "R1 in outp 1k", "C1 outp 0 1u", ".tran 5u 5m", ".meas tran m MAX v(outq)"]
    path.write_text("\n".join(["rc", *rows, ".end"]) + "\n")
    (notice,) = hb.read_circuit(path).warnings
    assert "did you mean 'outp'?" in str(notice)
