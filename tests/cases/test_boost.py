"""Boost converter: gains of textbooks, and the same circuit by matrix exponentials."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

V, D, T, L, C = 12.0, 0.5, 20e-6, 100e-6, 10e-6
LIGHT, BOTH = 200.0, 20.0


def periods(count):
    """Return ``(time, current, voltage)`` at the start of each period, and when the diode lets go.

    Kirchhoff's laws, phase by phase.
    """
    i, v, found, blocks = 0.0, 33.5, [], []
    for k in range(count):
        found.append((k * T, i, v))
        R = LIGHT if k * T < 1e-3 - T / 2 else BOTH
        i, v = i + V / L * D * T, v * math.exp(-D * T / (R * C))
        A = np.array([[0, -1 / L, V / L], [1 / C, -1 / (R * C), 0], [0, 0, 0]])
        rest = (1 - D) * T

        def after(t, A=A, z=(i, v, 1.0)):
            return expm(A * t) @ z

        if after(rest)[0] > 0:
            i, v, _ = after(rest)
            continue
        end = brentq(lambda t: after(t)[0], 0.0, rest, xtol=1e-18)
        blocks.append(k * T + D * T + end)
        i, v = 0.0, after(end)[1] * math.exp(-(rest - end) / (R * C))
    return np.array(found), blocks


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("boost")


def test_gains_are_those_of_textbooks(run):
    def mean(start):
        return np.mean(run["out.e"].at(np.linspace(start, start + 2 * T, 4001)[:-1]))

    K = 2 * L / (LIGHT * T)
    assert 2 * L / (BOTH * T) > D * (1 - D) ** 2 > K
    # to the ripple, which textbooks neglect
    assert mean(0.9e-3) / V == pytest.approx((1 + math.sqrt(1 + 4 * D**2 / K)) / 2, rel=2e-3)
    assert mean(3.95e-3) / V == pytest.approx(1 / (1 - D), rel=5e-3)
    t = np.linspace(3.5e-3, 4e-3, 5001)
    assert run["coil.current"].at(t).min() > 1.0
    assert run["coil.current"].at(np.linspace(0.5e-3, 1e-3, 5001)).min() == pytest.approx(0.0)


@pytest.mark.slow
def test_every_period_is_that_of_kirchhoffs_laws(run):
    found, blocks = periods(200)
    t, i, v = found.T
    assert run["coil.current"].at(t) == pytest.approx(i, abs=1e-9)
    assert run["out.e"].at(t) == pytest.approx(v, rel=1e-10)
    blocked = [e.t for e in run.events if e.cause == "guard"]
    assert blocked == pytest.approx(blocks, abs=1e-13)
    assert 40 < len(blocked) < 60
