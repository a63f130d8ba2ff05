"""Linear modes: their variations by the exponential, against closed forms and by collocation."""

import mpmath
import numpy as np
import pytest

import hybond as hb
from hybond.analysis.sensitivity import along
from hybond.analysis.sensitivity.exponential import grown, split


def ladder() -> hb.Model:
    """A coil and two capacitors, with time constants from 1 ns to 1 s, and a source that ramps."""
    values = {"U": 2.0, "s": 3.0, "R1": 1.0, "R2": 1000.0, "C1": 1e-9, "C2": 1e-3, "L": 0.2}
    m = hb.Model("ladder", domain="electrical", parameters=values)
    m.add(V=hb.Se("U + s*time/(1 s)"), r1=hb.R("R1"), c1=hb.C("C1"), n=hb.Zero(), j=hb.One())
    m.add(r2=hb.R("R2"), c2=hb.C("C2"), k=hb.One(), o=hb.Zero(), coil=hb.I("L"), load=hb.R("R2"))
    m.add(back=hb.One())
    m.bond("V -> j -> n -> c1", "j -> r1", "n -> k -> o -> c2", "k -> r2")
    m.bond("o -> back -> coil", "back -> load")
    return m


def of_ladder(p: list[mpmath.mpf], t: float) -> list[mpmath.mpf]:
    """Return charges and flux at a time, by the exponential in 60 digits."""
    U, s, R1, R2, C1, C2, L = p
    # states, then 1 and t
    A = mpmath.matrix([
        [-(1 / R1 + 1 / R2) / C1, 1 / (R2 * C2), 0, U / R1, s / R1],
        [1 / (R2 * C1), -1 / (R2 * C2), -1 / L, 0, 0],
        [0, 1 / C2, -R2 / L, 0, 0],
        [0, 0, 0, 0, 0],
        [0, 0, 0, 1, 0],
    ])  # fmt: skip
    values, V = mpmath.eig(A[:3, :3])
    b, c = A[:3, 3], A[:3, 4]
    X1 = -mpmath.lu_solve(A[:3, :3], c)
    X0 = mpmath.lu_solve(A[:3, :3], X1 - b)
    w = mpmath.lu_solve(V, -X0)
    moved = mpmath.matrix([w[k] * mpmath.exp(values[k] * t) for k in range(3)])
    found = X0 + X1 * t + V * moved
    return [mpmath.re(found[k]) for k in range(3)]


def test_a_stiff_ladder_by_all_its_values() -> None:
    m = ladder()
    wrt = ["U", "s", "R1", "R2", "C1", "C2", "L"]
    times = [2e-9, 1e-4, 0.3, 1.5]
    s = hb.sensitivities(m, "2 s", wrt=wrt, times=times, solver="exact", rtol=1e-9)
    assert s.of == ("c1.q", "c2.q", "coil.p")
    # where a parameter hardly counts (C1 behind 1 us), a millionth of the state for all of it
    size = np.abs(s.y).max(axis=0) / np.array([s.values]).T
    with mpmath.workdps(60):
        for k in range(len(wrt)):
            h = mpmath.mpf(s.values[k]) * mpmath.mpf(10) ** -20
            ends = [[mpmath.mpf(v) + side * h * (j == k) for j, v in enumerate(s.values)]
                    for side in (1, -1)]  # fmt: skip
            for t in times:
                high, low = (of_ladder(p, t) for p in ends)
                exact = np.array([float((a - b) / (2 * h)) for a, b in zip(high, low)])
                found = np.array([s.at(t, of, wrt[k]) for of in s.of])
                near = np.maximum(np.abs(exact), 1e-6 * size[k])
                assert (np.abs(found - exact) <= 1e-9 * near).all()


def both_ways(m: hb.Model, until: str, monkeypatch: pytest.MonkeyPatch, **how: object) -> None:
    exact = hb.sensitivities(m, until, **how)
    with monkeypatch.context() as patched:
        patched.setattr(along, "flows", lambda *_: None)
        steps = hb.sensitivities(m, until, **how)
    assert (exact.t == steps.t).all()
    size = np.abs(steps.derivatives).max(axis=0)
    off = np.abs(exact.derivatives - steps.derivatives) / np.where(size > 0.0, size, 1.0)
    assert off.max() < 1e-10
    for a, b in zip(exact.events, steps.events, strict=True):
        assert a.by == pytest.approx(b.by, rel=1e-9, abs=1e-12)


def test_a_converter_as_by_collocation(monkeypatch: pytest.MonkeyPatch) -> None:
    m = hb.Model("buck", domain="electrical", parameters={"D": 0.4, "up": 0.0, "V0": 12.0})
    m.input(gate=hb.Input(pwm={"period": "10 us", "duty": "D"}))
    m.input(ramp=hb.Input(table=[["0 s", 0], ["1 ms", "up"]], linear=True))
    m.add(V=hb.Se("V0*gate + ramp"), L=hb.I("20 uH"), C=hb.C("10 uF"), R=hb.R("2 ohm"))
    m.add(j=hb.One(), n=hb.Zero())
    m.bond("V -> j -> L", "j -> n -> C", "n -> R")
    both_ways(m, "55 us", monkeypatch, wrt=["D", "up", "V0", "L.I", "C.C", "R.R"], rtol=1e-11)


def test_storage_that_follows_other_storage_as_by_collocation(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    m = hb.Model("geared", parameters={"a": 2.0, "b": 0.3})
    m.add(F=hb.Se("a"), J1=hb.I(1.0), J2=hb.I("b"), gear=hb.TF(3.0), R=hb.R(0.7), C=hb.C("b"))
    m.add(v=hb.One(), w=hb.One())
    m.bond("F -> v -> J1", "v -> gear.1", "gear.2 -> w -> J2", "w -> R", "w -> C")
    both_ways(m, "3 s", monkeypatch, wrt=["a", "b", "J1.I"], rtol=1e-11, solver="radau")


def test_an_integral_by_adjoint_and_forward() -> None:
    m = ladder()
    wrt = ["U", "R1", "C2", "L"]
    goal = hb.Total("coil.f + 2*c2.e")
    back = hb.gradient(m, goal, "1 s", wrt=wrt, solver="exact")
    forth = hb.gradient(m, goal, "1 s", wrt=wrt, mode="forward", solver="exact")
    assert back.by == pytest.approx(forth.by, rel=1e-11)
    # linear in U and s together
    by_s = hb.gradient(m, goal, "1 s", wrt=["s"], solver="exact")["s"]
    assert back.value == pytest.approx(2.0 * back["U"] + 3.0 * by_s, rel=1e-9)


def test_slow_parts_keep_their_digits_beside_fast_ones() -> None:
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(4, 4)))[0]
    A = turn @ np.diag([-1e9, -2e9, -0.5, -3.0]) @ turn.T
    T, back, blocks, apart = split(A, 1.0)
    assert apart
    E = T @ (grown(blocks[None])[0] + np.eye(4)) @ back
    exact = turn @ np.diag(np.exp([-1e9, -2e9, -0.5, -3.0])) @ turn.T
    # the matrix itself holds its slow parts only to 1e9 roundings
    assert np.abs(E - exact).max() < 1e-6
    graded = np.array([[-1.0, 1e-3, 0.0], [5.0, -1e8, 2.0], [0.0, 1e-3, -2.0]])
    T, back, blocks, apart = split(graded, 1.0)
    assert apart
    E = T @ (grown(blocks[None])[0] + np.eye(3)) @ back
    values, V = np.linalg.eig(graded)
    exact = (V * np.exp(values)) @ np.linalg.inv(V)
    assert pytest.approx(exact, rel=1e-9, abs=1e-14) == E
