"""Sliding on several coupled surfaces, against time stepping written here."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from engine.ways_by_hand import switching, ways_by_hand
from hypothesis import HealthCheck, given, settings

import hybond as hb


def signum(machine: str) -> str:
    """Return +1 in the state ``above``, -1 below."""
    return f'(if {machine}.state == "above" then 1 else -1)'


def relays(rates: list[str], start: list[float]) -> hb.Model:
    """Return ``x_k' = rates[k]`` with a relay on each state."""
    m = hb.Model("relays")
    for k, (rate, x0) in enumerate(zip(rates, start, strict=True), 1):
        m.add(**{f"x{k}": hb.C(1.0, q=x0), f"s{k}": hb.Sf(rate), f"n{k}": hb.Zero()})
        m.bond(f"s{k} -> n{k} -> x{k}")
        m.machine(
            f"r{k}",
            states={"above": [], "below": []},
            start="above" if x0 > 0 else "below",
            rules=[f"above -> below when x{k}.q < 0", f"below -> above when x{k}.q > 0"],
        )
    return m


def stepped(a: np.ndarray, b: np.ndarray, c, x0, until: float, h: float) -> np.ndarray:
    """Implicit Euler of x' = A x + c(t) - B s, s in Sgn(x): signs chosen by trying them."""
    x, n = np.array(x0), len(x0)
    last: tuple[int, ...] = tuple(int(np.sign(v)) for v in x)
    choices = list(itertools.product((-1, 0, 1), repeat=n))
    inverse = np.linalg.inv(np.eye(n) - h * a)
    for step in range(round(until / h)):
        free = inverse @ (x + h * c((step + 1) * h))
        gain = h * inverse @ b
        for signs in (last, *choices):
            s = np.array(signs, dtype=float)
            held = [k for k in range(n) if signs[k] == 0]
            if held:
                s[held] = np.linalg.solve(gain[np.ix_(held, held)], (free - gain @ s)[held])
            new = free - gain @ s
            new[held] = 0.0
            if (np.abs(s) <= 1.0).all() and all(
                new[k] * signs[k] >= 0 for k in range(n) if signs[k]
            ):
                x, last = new, signs
                break
        else:
            raise AssertionError("no signs")
    return x


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", range(4))
def test_coupled_relays_agree_with_implicit_time_stepping(seed: int) -> None:
    generator = np.random.default_rng(seed)
    n = 3
    a = generator.uniform(-1.0, 1.0, (n, n))
    b = generator.uniform(-0.4, 0.4, (n, n))
    b += np.diag(np.abs(b).sum(axis=1) + 0.3)
    c0, c1 = generator.uniform(-1.0, 1.0, (2, n))
    x0 = generator.uniform(-1.0, 1.0, n)
    rates = []
    for k in range(n):
        terms = [f"({a[k, j]})*x{j + 1}.q" for j in range(n)]
        terms += [f"({-b[k, j]})*{signum(f'r{j + 1}')}" for j in range(n)]
        terms.append(f"{c0[k]} + ({2 * c1[k]})*sin(2*time/(1 s))")
        rates.append(" + ".join(terms))
    m = relays(rates, [float(v) for v in x0])
    run = hb.simulate(m, until=3.0, rtol=1e-10)
    assert run.status == "ok"
    assert run.sliding
    assert not run.warnings
    found = [run.final[f"x{k + 1}.q"] for k in range(n)]
    errors = []
    for h in (4e-3, 5e-4):
        x = stepped(a, b, lambda t: c0 + 2 * c1 * np.sin(2 * t), x0, 3.0, h)
        errors.append(np.abs(x - found).max())
    # first order, irregular where an event falls within a step: an eighth of it leaves under half
    assert errors[1] < 2e-3
    assert errors[1] < 0.5 * errors[0]


# -- one way on where -B is a P-matrix


@pytest.mark.slow
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(switching(3))
def test_a_start_on_all_surfaces_goes_the_one_way_or_tells_of_several(system) -> None:
    a, b = system
    k = len(a)
    ways = ways_by_hand(a, b)
    rates = [
        " + ".join([f"({a[i]})", *(f"({b[i, j]})*(1 + {signum(f'r{j + 1}')})/2" for j in range(k))])
        for i in range(k)
    ]
    run = hb.simulate(relays(rates, [0.0] * k), until=1e-3, on_error="return")
    told = [w for w in run.warnings if "not unique" in w or "no way on" in w]
    if len(ways) != 1:
        speeds = [a + b @ w for w in ways]
        if all(
            np.abs(v[(w == 0) | (w == 1)]).min(initial=1.0) > 1e-6
            for v, w in zip(speeds, ways, strict=True)
        ):
            assert told
            assert all(f"x{j}.q = 0" in told[0] for j in range(1, k + 1))
        return
    assert not told
    (w,) = ways
    assert [run.weight(f"r{j + 1}", "above", 5e-4) for j in range(k)] == pytest.approx(
        list(w), abs=1e-9
    )
    end = [run.final[f"x{j + 1}.q"] for j in range(k)]
    assert end == pytest.approx(list(1e-3 * (a + b @ w)), abs=1e-13)


def test_two_surfaces_left_at_one_instant() -> None:
    """x_k' = t - sgn(x_k): both leave at 1, upwards."""
    m = relays([f"time - {signum('r1')}", f"time - {signum('r2')}"], [0.0, 0.0])
    run = hb.simulate(m, until=2.0)
    (sliding,) = run.sliding
    assert (sliding.t0, sliding.t1) == pytest.approx((0.0, 1.0), abs=1e-11)
    assert [run.final["x1.q"], run.final["x2.q"]] == pytest.approx([0.5, 0.5], abs=1e-11)
    assert not run.warnings


def test_two_surfaces_left_to_different_sides_within_rounding() -> None:
    m = relays([f"time - {signum('r1')}", f"-1.0000000001*time - {signum('r2')}"], [0.0, 0.0])
    run = hb.simulate(m, until=2.0, atol=1e-9)
    assert [run.final["x1.q"], run.final["x2.q"]] == pytest.approx([0.5, -0.5], abs=1e-9)


def test_a_weight_that_touches_its_bound_does_not_leave() -> None:
    """The drift 1 - (t - 1)^2 touches 1 at t = 1: an end of the sliding there would be none."""
    m = relays([f"1 - (time - 1)^2 - {signum('r1')}"], [0.0])
    run = hb.simulate(m, until=1.9)
    assert abs(run.final["x1.q"]) < 1e-12
    assert run.sliding[-1].t1 == 1.9
    assert run.weight("r1", "above", 1.5) == pytest.approx(0.5 * (2 - 0.25), abs=1e-12)


def test_a_surface_grazed_is_not_slid_upon() -> None:
    """x1 = (t - 1)^2 touches zero: above, both before and after."""
    m = relays([f"2*(time - 1) - 0.1*(1 - {signum('r1')})"], [1.0])
    run = hb.simulate(m, until=2.0)
    assert run.sliding == ()
    assert run.final["x1.q"] == pytest.approx(1.0, abs=1e-9)
