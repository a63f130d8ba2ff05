"""Push-pull converters: two halves of a winding balance until one switch closes, but for rounding.

Rounding of what is stored in them goes to the coil behind the diodes, which has nothing yet: the
branches in which both diodes block were refused for that (HB-J111) in one converter of fifteen.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

ROWS = [  # coupling, inductance, ratio of the secondary, supply, snubber's R and C, coil behind
    (0.9999, 1e-3, 4.0, 24.0, 100.0, 1e-9, 200e-6),
    (0.99995, 1e-3, 0.04, 24.0, 10.0, 2.2e-9, 200e-6),
    (0.9995, 1e-3, 4.0, 5.0, 47.0, 4.7e-10, 2e-3),
    (0.998, 0.7e-3, 4.0, 311.0, 100.0, 2.2e-9, 47e-6),
    (0.9995, 0.3e-3, 1.0, 5.0, 33.0, 1e-9, 47e-6),
    (0.99995, 0.3e-3, 0.25, 12.0, 47.0, 1e-9, 200e-6),
]
CLOSES, LOOKED, RON = 5.2e-9, 0.5e-6, 0.02
DROP, RD = 8.0792e-3, 10.259e-3  # of the cards below, as documented: the tangent at 1 A


def deck(row: tuple[float, ...], *, backwards: bool) -> str:
    """The converter as a netlist, its cards in one order or the other."""
    k, own, ratio, supply, r, c, coil = row
    pairs = [(a, b) for a in range(1, 5) for b in range(a + 1, 5)]
    cards = [
        f"Vin in 0 {supply}",
        *("Vg1 g1 0 PULSE(0 5 0 10n 10n 9u 20u)", "Vg2 g2 0 PULSE(0 5 10u 10n 10n 9u 20u)"),
        *(f"L1 in a {own}", f"L2 b in {own}", f"L3 s1 0 {own * ratio}", f"L4 0 s2 {own * ratio}"),
        *(f"K{a}{b} L{a} L{b} {k}" for a, b in pairs),
        *("S1 a 0 g1 0 SWI", "S2 b 0 g2 0 SWI", "D1 s1 r DI", "D2 s2 r DI"),
        *(f"Rsn1 a as {r}", f"Csn1 as 0 {c}", f"Rsn2 b bs {r}", f"Csn2 bs 0 {c}"),
        *(f"Lo r out {coil}", "Co out 0 47u", "RL out 0 20"),
    ]
    models = [
        ".model DI D(IS=1e-14 N=0.01 RS=0.01)",
        f".model SWI SW(VT=2.5 VH=0.1 RON={RON} ROFF=1e8)",
    ]
    end = [".tran 20n 100u uic", ".end"]
    return "\n".join(["push-pull", *(cards[::-1] if backwards else cards), *models, *end])


@cache
def by_hand(row: tuple[float, ...]) -> np.ndarray:
    """i1, i2, the current of D1 and of the coil behind it, three voltages at `LOOKED`."""
    k, own, ratio, supply, r, c, coil = row
    own3, mutual = own * ratio, k * own * ratio**0.5

    def open_(t, y):
        a, b = r * y[0] + y[3], -r * y[1] + y[4]
        rates = np.linalg.solve([[own, k * own], [k * own, own]], [supply - a, b - supply])
        return [*rates, 0.0, y[0] / c, -y[1] / c, 0.0]

    def closed(t, y):
        # the coil's current leaves the third winding: its rate is minus that of the winding
        a, b = (y[0] + y[3] / r) / (1.0 / RON + 1.0 / r), -r * y[1] + y[4]
        matrix = [[own, k * own, -mutual], [k * own, own, -mutual], [mutual, mutual, -own3 - coil]]
        rates = np.linalg.solve(matrix, [supply - a, b - supply, DROP + RD * y[2] + y[5]])
        return [*rates, (a - y[3]) / r / c, -y[1] / c, (y[2] - y[5] / 20.0) / 47e-6]

    options = {"method": "Radau", "rtol": 1e-10, "atol": 1e-15}
    first = solve_ivp(open_, (0.0, CLOSES), np.zeros(6), **options)
    then = solve_ivp(closed, (CLOSES, LOOKED), first.y[:, -1], **options)
    assert (then.y[2] > -1e-12).all()
    return then.y[:, -1]


@pytest.mark.parametrize(
    ("row", "backwards", "solver"),
    [
        *((row, backwards, "auto") for row in ROWS for backwards in (False, True)),
        *((row, k % 2 == 0, "radau") for k, row in enumerate(ROWS)),
        (ROWS[3], True, "rk45"),
    ],
)
def test_the_side_that_is_driven_conducts(row, backwards: bool, solver: str, tmp_path) -> None:
    path = tmp_path / "push_pull.cir"
    path.write_text(deck(row, backwards=backwards), encoding="utf-8")
    circuit = hb.read_circuit(path)
    run = hb.simulate(circuit.model, "100 us", solver=solver)
    assert run.t_end == 100e-6
    names = ["i(L1)", "i(L2)", "i(Lo)", "v(as)", "v(bs)", "v(out)"]
    found = np.array([float(run[circuit.signal(name)].at(LOOKED)) for name in names])
    meant = by_hand(row)
    # fluxes are held to the tolerance, and currents are differences of them
    within = 2e-6 * np.abs(meant) + 1e-9 / (1.0 - row[0]) * np.abs(meant[:3]).max()
    assert (np.abs(found - meant) <= within).all(), (found, meant)
