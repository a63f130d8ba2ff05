"""Coils that are coupled by 1 beside others that are less: windings on one leg of a core.

The oracle is SciPy's, in the currents of the legs: that of the first is its ampere-turns ``j``,
since what is wound twice as often has twice the voltage and counts twice.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

AT = np.linspace(0.0, 2e-3, 6)
FIELD = np.array([[2e-3, 0.6 * np.sqrt(6e-6)], [0.6 * np.sqrt(6e-6), 3e-3]])
"""Of both legs, H: 2 and 3 mH, coupled by 0.6."""
COILS = ("L1 a 0 2m", "L2 b 0 8m", "L3 c 0 3m")


def legs(second: float, *, begin: tuple[float, float] = (0.0, 0.0)) -> tuple[np.ndarray, ...]:
    """Return what leg 1 has across a turn, and the current of leg 2, at all times.

    10 V, 0.5 ohm feed the first coil, the second one has twice its turns and `second` ohm.
    """
    feeds, loads = 1.0 / 0.5, 4.0 / second

    def across(t: float, j: float) -> float:
        return (10.0 * np.sin(2e3 * np.pi * t) * feeds - j) / (feeds + loads)

    made = solve_ivp(
        lambda t, y: np.linalg.solve(FIELD, [across(t, y[0]), -2.0 * y[1]]),
        (0.0, AT[-1]),
        begin,
        method="DOP853",
        rtol=1e-10,
        atol=1e-12,
        t_eval=AT,
    )
    return np.array([across(t, j) for t, j in zip(AT, made.y[0], strict=True)]), made.y[1]


def run_of(where: Path, *lines: str) -> hb.Result:
    """Run a deck with a source and its resistor at node a."""
    deck = where / "core.cir"
    text = ("* a core", "V1 s 0 SIN(0 10 1k)", "R1 s a 0.5", *lines, ".tran 1u 2m UIC")
    deck.write_text("\n".join(text) + "\n")
    return hb.simulate(hb.read_circuit(deck).model, until=2e-3, rtol=1e-9)


def couplings(sign: float) -> tuple[str, ...]:
    """Return how the three coils are coupled, the second one perhaps wound the other way."""
    return f"K1 L1 L2 {sign:g}", "K2 L1 L3 0.6", f"K3 L2 L3 {0.6 * sign:g}"


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_two_of_three_coils_are_windings_of_one_leg(
    tmp_path: Path, order: tuple[int, ...], sign: float
) -> None:
    coils = [COILS[k] for k in order]
    run = run_of(tmp_path, "R2 b 0 4", "R3 c 0 2", *coils, *couplings(sign))
    turn, current = legs(4.0)
    assert run["R2.e"].at(AT) == pytest.approx(sign * 2.0 * turn, abs=1e-7)
    assert run["R3.f"].at(AT) == pytest.approx(-current, abs=1e-7)
    assert run.audit().holds()


def test_windings_of_a_leg_begin_with_its_ampere_turns(tmp_path: Path) -> None:
    coils = [f"{c} IC={i}" for c, i in zip(COILS, ("0.2", "0.1", "-0.3"), strict=True)]
    run = run_of(tmp_path, "R2 b 0 4", "R3 c 0 2", *coils, *couplings(-1.0))
    turn, current = legs(4.0, begin=(0.0, -0.3))
    assert run["R2.e"].at(AT) == pytest.approx(-2.0 * turn, abs=1e-7)
    assert run["R3.f"].at(AT) == pytest.approx(-current, abs=1e-7)


def test_open_windings_see_what_their_leg_has(tmp_path: Path) -> None:
    """An open one beside one with a current, and a leg of which none has one."""
    beside = run_of(tmp_path, "L1 a 0 2m", "L2 b 0 8m", "L3 c 0 3m", "R3 c 0 2", *couplings(1.0))
    _, current = legs(np.inf)
    assert beside["R3.f"].at(AT) == pytest.approx(-current, abs=1e-7)
    alone = run_of(tmp_path, "L3 a 0 3m", "L1 c 0 2m", "L2 b 0 8m", *couplings(-1.0))
    fed = 10.0 * np.sin(2e3 * np.pi * AT) - alone["R1.e"].at(AT)
    assert alone["L1"].at(AT) == pytest.approx(0.6 * np.sqrt(2 / 3) * fed, abs=1e-9)
    assert alone["L2"].at(AT) == pytest.approx(-1.2 * np.sqrt(2 / 3) * fed, abs=1e-9)
