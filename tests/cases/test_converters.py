"""Switched converters against exact integration: matrix exponentials and a list of all modes."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import expm


@dataclass
class Mode:
    """``x' = A x + b`` while all `holds` are above zero, then the mode that `leave` names.

    A conjugate pair that is zero in a mode is zero in its rows.
    """

    A: np.ndarray
    b: np.ndarray
    holds: Callable[[np.ndarray], Sequence[float]]
    leave: Callable[[np.ndarray, int], str]


def exactly(modes: dict[str, Mode], x, mode: str, length: float, *, points: int = 100):
    """Go through `length` from x in `mode`; return the end, its mode, and the times of leaving.

    Between `points` the first change of sign is bisected; every step is a matrix exponential.
    """
    t, switched, grid = 0.0, [], length / points
    while t < length * (1.0 - 1e-13):
        now = modes[mode]
        n = len(x)
        H = np.zeros((n + 1, n + 1))
        H[:n, :n], H[:n, n] = now.A, now.b

        def after(h, H=H, x=x):
            return (expm(H * h) @ np.append(x, 1.0))[:-1]

        h = min(grid, length - t)
        y = after(h)
        if min(now.holds(y)) >= 0.0:
            t, x = t + h, y
            continue
        low, high = 0.0, h
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if min(now.holds(after(middle))) >= 0.0 else (low, middle)
        y = after(high)
        broken = int(np.argmin(np.asarray(now.holds(y)) / (np.abs(now.holds(x)) + 1e-300)))
        t, x, mode = t + high, y, now.leave(y, broken)
        switched.append(t)
    return x, mode, switched


def resonant(source: float) -> dict[str, Mode]:
    """The four ways in which a bridge joins Lr, Cr (i, v) to Lf, Cf (j, u)."""
    Lr, Cr, Lf, Cf, R = 150e-6, 68e-9, 0.4e-3, 2.2e-6, 33.0
    b = np.array([source / Lr, 0.0, 0.0, 0.0])

    def rows(way: int, flows: bool) -> np.ndarray:
        A = np.zeros((4, 4))
        A[0, 1] = -1.0 / Lr
        A[1, 0], A[1, 2] = 1.0 / Cr, -way / Cr
        A[2, 1], A[2, 3] = way / Lf, -1.0 / Lf
        A[3, 2], A[3, 3] = 1.0 / Cf, -1.0 / (R * Cf)
        if not flows:
            A[1, 2], A[2, :], A[3, 2] = 0.0, 0.0, 0.0
        return A

    shorted = rows(0, True)
    shorted[0, 1] = 0.0
    shorted[1, :] = 0.0

    def at_zero(x, _broken):
        if x[2] <= 0.0:
            return "blocked"
        return "shorted" if abs(x[0]) <= x[2] else ("plus" if x[0] > 0.0 else "minus")

    def from_half(x, broken):
        return at_zero(x, broken) if broken == 0 else "blocked"

    return {
        "plus": Mode(rows(1, True), b, lambda x: (x[1], x[2]), from_half),
        "minus": Mode(rows(-1, True), b, lambda x: (-x[1], x[2]), from_half),
        "shorted": Mode(
            shorted,
            b,
            lambda x: (x[2] - x[0], x[2] + x[0]),
            lambda x, k: ("plus", "minus")[k],
        ),
        "blocked": Mode(
            rows(0, False),
            b,
            lambda x: (x[3] - x[1], x[3] + x[1]),
            lambda x, k: ("plus", "minus")[k],
        ),
    }


class TestParallelResonantConverter:
    """150 uH, 68 nF, a bridge, 0.4 mH, 2.2 uF and 33 ohm; square wave of 1 V and 55 kHz."""

    HALF = 0.5 / 55e3

    @pytest.mark.slow
    def test_against_exact_integration(self, simulate, solver):
        halves = 22 if solver == "rk45" else 8
        run = simulate("parallel_resonant_converter", until=halves * self.HALF, solver=solver)
        signals = ("Lr.f", "Cr.e", "Lf.f", "Cf.e")
        x, mode, times = np.zeros(4), "plus", []
        for k in range(halves):
            x, mode, switched = exactly(resonant(1.0 if k % 2 == 0 else -1.0), x, mode, self.HALF)
            times += [k * self.HALF + t for t in switched]
            got = [run[s].at((k + 1) * self.HALF, side="left") for s in signals]
            assert got == pytest.approx(x, rel=1e-5, abs=1e-6)
        # how four conducting diodes share a current is free, so that there may be more events
        events = np.array([e.t for e in run.events])
        for t in times:
            assert np.abs(events - t).min() <= 1e-6 * t

    def test_the_bridge_shorts_its_capacitor(self, simulate):
        """Where all four diodes conduct, the voltage stays zero while the current reverses."""
        run = simulate("parallel_resonant_converter")
        all_on = 0
        for segment in run.segments:
            states = list(run.graph.mode_names(segment.mode).values())
            if states != ["conducts"] * 4 or segment.t[-1] - segment.t[0] < 1e-9:
                continue
            all_on += 1
            t = np.linspace(segment.t[0], segment.t[-1], 9)[1:-1].tolist()
            found = run.sample(t, ["Cr.e", "Lr.f", "Lf.f", "d1.f", "d2.f", "d3.f", "d4.f"])
            assert np.abs(found["Cr.e"]).max() <= 1e-9
            for d in ("d1.f", "d2.f", "d3.f", "d4.f"):
                assert found[d].min() >= 0.0
            # how the four share the two currents
            assert found["d1.f"] + found["d2.f"] == pytest.approx(found["Lf.f"], abs=1e-12)
            assert found["d1.f"] - found["d3.f"] == pytest.approx(found["Lr.f"], abs=1e-12)
        assert all_on >= 3

    @pytest.mark.sampled(1)
    @pytest.mark.parametrize("d", ["d1", "d2", "d3", "d4"])
    def test_complementarity(self, simulate, d):
        run = simulate("parallel_resonant_converter", until="0.1 ms")
        found = run.sample(np.linspace(0.0, 1e-4, 401).tolist(), [f"{d}.f", f"{d}.e"])
        assert found[f"{d}.f"].min() >= -1e-9
        assert found[f"{d}.e"].max() <= 1e-7
        assert np.abs(found[f"{d}.f"] * found[f"{d}.e"]).max() <= 1e-12


class TestSubmodules:
    """Four half bridges of 1 mF at 20 V with 1 mH and 0.5 ohm on 60 V; blocked at 9.6 ms."""

    V, L, R, C, PERIOD, BLOCK = 60.0, 1e-3, 0.5, 1e-3, 1e-3, 9.6e-3

    def inserted(self, t: float) -> np.ndarray:
        phases = 0.25e-3 * np.arange(4)
        return ((t - phases) / self.PERIOD) % 1.0 < 0.6

    def matrix(self, inserted) -> tuple[np.ndarray, np.ndarray]:
        A = np.zeros((5, 5))
        A[0, 0] = -self.R / self.L
        A[0, 1:] = -np.asarray(inserted, dtype=float) / self.L
        A[1:, 0] = np.asarray(inserted, dtype=float) / self.C
        return A, np.array([self.V / self.L, 0.0, 0.0, 0.0, 0.0])

    def until_blocked(self):
        """State at every edge of a gate, by matrix exponentials."""
        edges = {0.0, self.BLOCK}
        for k, phase in itertools.product(range(-1, 10), 0.25e-3 * np.arange(4)):
            edges |= {phase + k * self.PERIOD, phase + (k + 0.6) * self.PERIOD}
        edges = sorted({round(t, 9) for t in edges if 0.0 <= t <= self.BLOCK})
        x, found = np.array([0.0, 20.0, 20.0, 20.0, 20.0]), []
        for one, two in itertools.pairwise(edges):
            A, b = self.matrix(self.inserted(0.5 * (one + two)))
            H = np.zeros((6, 6))
            H[:5, :5], H[:5, 5] = A, b
            x = (expm(H * (two - one)) @ np.append(x, 1.0))[:5]
            found.append((two, x))
        return found

    @pytest.mark.sampled(1)
    def test_commanded_arm(self, simulate, solver):
        run = simulate("mmc_arm", until=self.BLOCK, solver=solver)
        signals = ["i.f", "m1.C.e", "m2.C.e", "m3.C.e", "m4.C.e"]
        for t, x in self.until_blocked()[4::6]:
            got = [run[s].at(t, side="left") for s in signals]
            assert got == pytest.approx(x, rel=1e-5, abs=1e-5)

    @pytest.mark.sampled(1)
    @pytest.mark.parametrize("block", [9.6e-3, 5.1e-3, 6.3e-3])
    def test_blocked_arm_charges_or_passes_by_until_its_current_ends(self, simulate, block):
        run = simulate("mmc_arm", parameters={"t_block": block}, until=block + 1e-3)
        current = run["i.f"].at(block)
        held = np.array([run[f"m{k}.C.e"].at(block) for k in range(1, 5)])
        assert abs(current) > 0.1
        if current > 0.0:  # through the upper diodes of all
            A, b = self.matrix(np.ones(4))
        else:  # through the lower diodes, past all capacitors
            A, b = self.matrix(np.zeros(4))
        sign = np.sign(current)
        modes = {
            "flows": Mode(A, b, lambda x: (sign * x[0],), lambda x, k: "rests"),
            "rests": Mode(np.zeros((5, 5)), np.zeros(5), lambda x: (1.0,), lambda x, k: "rests"),
        }
        x, _, (end,) = exactly(modes, np.append(current, held), "flows", 1e-3)
        assert run["i.f"].at(block + 0.5 * end) * sign > 0.1
        assert abs(run["i.f"].at(block + end * (1.0 + 1e-6))) <= 1e-9
        assert abs(run.final["i.f"]) <= 1e-9
        assert [run.final[f"m{k}.C.e"] for k in range(1, 5)] == pytest.approx(x[1:], rel=1e-5)
        t = np.linspace(block, block + 2.0 * end, 101).tolist()
        for k in range(1, 5):
            assert np.diff(run[f"m{k}.C.e"].at(t)).min() >= -1e-9

    def test_no_diode_breaks_its_law(self, simulate):
        run = simulate("mmc_arm")
        t = np.linspace(0.0, 9.9e-3, 301).tolist()
        for k, d in itertools.product(range(1, 5), ("d_up", "d_low")):
            found = run.sample(t, [f"m{k}.{d}.f", f"m{k}.{d}.e"])
            assert found[f"m{k}.{d}.f"].min() >= -1e-8
            assert found[f"m{k}.{d}.e"].max() <= 1e-6
