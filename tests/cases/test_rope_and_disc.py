"""Mass on a rope around an off-centre disc: a transformer that turns."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

M, G, C, J, BASE, ARM = 1.0, 9.81, 1e-3, 0.5, 0.3, 0.2
T = np.linspace(0.0, 5.0, 101)
NAMES = ["mass.p", "rope.q", "disc.p", "angle"]


def field(t, z):
    p, q, spin, angle = z
    arm = ARM * np.cos(angle) + BASE
    force = q / C
    return [M * G - force, p / M - arm * spin / J, arm * force, spin / J]


@pytest.fixture(scope="module")
def reference():
    found = solve_ivp(field, (0.0, 5.0), np.zeros(4), "DOP853", T, rtol=1e-12, atol=1e-14)
    return dict(zip(NAMES, found.y, strict=True))


@pytest.mark.sampled(1)
def test_against_an_independent_solver(simulate, reference, solver):
    # the rope's ringing asks for a tight tolerance: 130 periods in 5 s
    run = simulate("rope_and_disc", solver=solver, rtol=1e-9)
    found = run.sample(T.tolist(), NAMES)
    for name in NAMES:
        scale = np.abs(reference[name]).max()
        assert np.abs(found[name] - reference[name]).max() < 1e-5 * scale


@pytest.mark.slow
def test_energy_is_constant(simulate):
    run = simulate("rope_and_disc", rtol=1e-10)
    p, q, spin, angle = run.sample(T.tolist(), NAMES).values()
    # the rope has gone down by its stretch and by what the disc has let out
    down = q + ARM * np.sin(angle) + BASE * angle
    stored = p**2 / (2 * M) + q**2 / (2 * C) + spin**2 / (2 * J)
    assert np.abs(stored - M * G * down).max() < 1e-8 * stored.max()
    assert stored.max() > 1.0
