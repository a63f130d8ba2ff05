"""Sources with a table, a polynomial or a modulated sine, as ngspice 39 evaluates them.

Oracles: NumPy's interpolation and polynomials; where dialects could differ (what is beyond the ends
of a table, in what order products come), the numbers that ngspice 39 gave for these rows.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

X, Y = (-1.0, 0.0, 1.0, 2.0), (-5.0, 0.0, 5.0, 6.0)
POINTS = "(-1,-5) (0,0) (1,5) (2,6)"


def run(folder: Path, *rows: str) -> tuple[hb.Result, object]:
    path = folder / "laws.cir"
    path.write_text("\n".join(["laws", *rows, ".tran 1u 1m", ".end"]) + "\n")
    conversion = hb.read_circuit(path)
    return hb.simulate(conversion.model, "1 ms"), conversion


SWEPT = "V1 a 0 PWL(0 -4 1m 4)"


@pytest.mark.parametrize(
    "row",
    [
        f"E1 o 0 TABLE {{v(a)}} = {POINTS}",
        f"E1 o 0 TABLE={{v(a)}} {POINTS}",
        f"e1 o 0 table {{V(a)}} ({POINTS.replace(' ', ', ')})",
        f"G1 0 o TABLE {{v(a)}} = {POINTS}",
        "B1 o 0 V=table(v(a), -1,-5, 0,0, 1,5, 2,6)",
        "E1 o 0 VALUE={table(v(a), -1,-5, 0,0, 1,5, 2,6)}",
    ],
)
def test_a_table_holds_its_ends(tmp_path: Path, row: str) -> None:
    found, conversion = run(tmp_path, SWEPT, row, "R1 o 0 1")
    t = np.linspace(1e-6, 0.999e-3, 37)
    shown = np.asarray(found[conversion.signal("v(o)")].at(t))
    assert shown == pytest.approx(np.interp(-4.0 + 8e3 * t, X, Y), abs=1e-9)


def test_pwl_goes_on_with_the_slopes_at_its_ends(tmp_path: Path) -> None:
    found, conversion = run(tmp_path, SWEPT, "B1 o 0 V=pwl(v(a), -1,-5, 0,0, 1,5, 2,6)", "R1 o 0 1")
    values = [float(found[conversion.signal("v(o)")].at(t)) for t in (0.05e-3, 0.7e-3, 0.95e-3)]
    assert values == pytest.approx([-18.0, 5.6, 7.6], rel=1e-9)  # as ngspice has it


def test_products_of_a_polynomial_come_by_degree(tmp_path: Path) -> None:
    a, b, c = 0.4, 2.0, -3.0
    sources = [f"V1 a 0 {a}", f"V2 b 0 {b}", f"V3 c 0 {c}"]
    rows = [
        "E1 x 0 POLY(2) a 0 b 0 1 2 3 4 5 6 7 8 9 10",
        "E2 y 0 POLY(3) a 0 b 0 c 0 1 2 3 4 5 6 7 8 9 10 11 12",
        "H1 z 0 POLY(2) V1 V2 0 0 0 0 1",
    ]
    loads = ["R1 x 0 1", "R2 y 0 1", "R3 z 0 1", "R4 a 0 1", "R5 b 0 1"]
    found, conversion = run(tmp_path, *sources, *rows, *loads)
    wanted = {
        "x": np.polynomial.polynomial.polyval2d(
            a, b, [[1, 3, 6, 10], [2, 5, 9, 0], [4, 8, 0, 0], [7, 0, 0, 0]]
        ),
        "y": 1 + 2 * a + 3 * b + 4 * c + 5 * a * a + 6 * a * b + 7 * a * c + 8 * b * b + 9 * b * c
        + 10 * c * c + 11 * a**3 + 12 * a * a * b,
        "z": a * b,
    }  # fmt: skip
    for node, value in wanted.items():
        assert float(found[conversion.signal(f"v({node})")].at(5e-4)) == pytest.approx(value)


def test_a_carrier_of_modulated_amplitude(tmp_path: Path) -> None:
    found, conversion = run(tmp_path, "V1 a 0 AM(2 0.5 500 3k 0.1m)", "R1 a 0 1")
    for t in (0.05e-3, 0.25e-3, 0.77e-3):
        s = t - 0.1e-3
        wave = 2 * (0.5 + math.sin(1e3 * math.pi * s)) * math.sin(6e3 * math.pi * s)
        value = float(found[conversion.signal("v(a)")].at(t))
        assert value == pytest.approx(wave if s > 0 else 0.0, rel=1e-9)


@pytest.mark.parametrize(
    ("row", "code", "why"),
    [
        ("E1 o 0 TABLE {v(a)} = (0,0) (0,1)", "HB-F131", "do not ascend"),
        ("E1 o 0 TABLE {v(a)} = (0,0)", "HB-F131", "two or more points"),
        ("B1 o 0 V=pwl(v(a), 0, 0, v(a), 1)", "HB-F131", "not at a number"),
        ("E1 o 0 LAPLACE {v(a)} = {1/(1+s)}", "HB-F136", "VALUE={...}"),
    ],
)
def test_what_is_no_table_is_refused(tmp_path: Path, row: str, code: str, why: str) -> None:
    with pytest.raises(hb.FileError, match=code) as caught:
        run(tmp_path, SWEPT, row, "R1 o 0 1")
    assert why in str(caught.value)


VARISTOR = ["V1 s 0 SIN(0 100 50)", "R1 s b 10", "L9 b a 1m", "B1 a 0 I=1e-3*v(a)*abs(v(a)/40)^5"]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("beside", [(), ("C9 a 0 10n",)])
def test_a_varistor_behind_a_coil_needs_nothing_beside_it(
    tmp_path: Path, beside: tuple[str, ...]
) -> None:
    path = tmp_path / "varistor.cir"
    path.write_text("\n".join(["varistor", *VARISTOR, *beside, ".tran 10u 6m", ".end"]) + "\n")
    conversion = hb.read_circuit(path)
    run = hb.simulate(conversion.model)
    assert run.audit().holds()
    clamped = run[conversion.signal("v(a)")].max()
    assert float(clamped) == pytest.approx(77.99569, rel=1e-4)  # ngspice 39, without the capacitor


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ("v(a)^3", "a power 3 is so, too"),
        ("v(a)**n", "a power 3 is so, too"),
        ("pow(2*v(a) - 1, 0.5)", "a power 0.5 has no value"),
        ("abs(v(a))^3 + v(a)^2 + (v(a)*v(a) + 1)^0.5 + exp(v(a))^n + n^n + time^n", ""),
    ],
)
def test_a_power_of_what_may_be_below_zero_is_said_to_be_another_elsewhere(
    tmp_path: Path, law: str, said: str
) -> None:
    """ngspice 39 makes 8 of (-2)^3; nothing told that it is -8 here."""
    path = tmp_path / "power.cir"
    rows = ["power", ".param n=3", "V1 a 0 2", f"B1 o 0 V={law}", "R1 o 0 1", "R2 a 0 1"]
    path.write_text("\n".join([*rows, ".tran 1u 1m uic", ".end"]) + "\n")
    found = [str(w) for w in hb.read_circuit(path).warnings if "to ngspice" in str(w)]
    assert [f"power.cir:4: of what is below zero {said}" in w for w in found] == [True] * bool(said)
