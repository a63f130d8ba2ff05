"""Textbook systems against equations derived by hand: their motion, matrices and poles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import hybond as hb

G = 9.81
FINE = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "dense_output": True}


def two_carts() -> hb.Model:
    """Return two carts and springs, the left one at a stop that takes all: van der Schaft 1998."""
    m = hb.Model("two carts", domain="translational")
    m.add(m1=hb.I(1.0, f=-1.0), m2=hb.I(1.0, f=-0.3), v1=hb.One(), v2=hb.One(), z=hb.Zero())
    m.add(k1=hb.C(1.0, q=0.5), k2=hb.C(1.0, q=0.2), wall=hb.Sf(0.0))
    m.add(stop=hb.Zero(law="unilateral", gap="x1"))
    m.bond("v1 -> m1", "v2 -> m2", "v1 -> k1", "v2 -> z -> v1", "z -> k2", "wall -> stop -> v1")
    m.signal(x1=hb.Integral("v1.f", 0.5))
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_two_carts_and_a_stop_move_as_complementarity_says(solver: str) -> None:
    run = hb.simulate(two_carts(), 15.0, solver=solver, rtol=1e-10)
    t, x, held, at_stop = 0.0, np.array([0.5, 0.7, -1.0, -0.3]), False, 0
    free = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-2, 1, 0, 0], [1, -1, 0, 0]], dtype=float)
    fixed = np.array([[0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0], [0, -1, 0, 0]], dtype=float)
    while t < 15.0:

        def leaves(t: float, y: np.ndarray, held: bool = held) -> float:
            # the stop pushes with -x2; 1e-13 m: it does not touch where it was left
            return y[1] if held else -y[0] - 1e-13

        leaves.terminal, leaves.direction = True, 1.0
        matrix = fixed if held else free
        step = solve_ivp(
            lambda t, y, a=matrix: a @ y, (t, 15.0), x, events=[leaves], max_step=0.05, **FINE
        )
        for place in (t + 1e-9, 0.5 * (t + step.t[-1]), step.t[-1] - 1e-9):
            assert run["m1.f"].at(place) == pytest.approx(step.sol(place)[2], abs=2e-7)
            assert run["m2.f"].at(place) == pytest.approx(step.sol(place)[3], abs=2e-7)
        t, x = step.t[-1], step.y[:, -1].copy()
        if not held and t < 15.0:
            x[0] = x[2] = 0.0
            at_stop += 1
        held = not held and x[1] < 0.0
    assert at_stop > 3
    assert run.audit().holds()


def test_two_carts_and_a_stop_have_the_poles_of_each_mode() -> None:
    eq = hb.state_equations(two_carts())
    golden = [math.sqrt((3 + way * math.sqrt(5)) / 2) for way in (-1, 1)]
    poles = eq.at({"stop": "open"}).poles()
    assert sorted(p.imag for p in poles) == pytest.approx(
        [-golden[1], -golden[0], *golden], abs=1e-12
    )
    poles = eq.at({"stop": "closed"}).poles()
    # k1 keeps its length, and m2 swings on k2
    assert sorted(p.imag for p in poles) == pytest.approx([-1.0, 0.0, 1.0], abs=1e-12)
    assert max(abs(p.real) for p in poles) < 1e-12


def test_a_double_pendulum_of_four_masses_has_two_speeds() -> None:
    """All but two masses are in derivative causality, behind transformers that turn with them."""
    m = hb.Model("double pendulum", domain="translational")
    m.add(w1=hb.One(domain="rotational"), w2=hb.One(domain="rotational"))
    m.add(X1=hb.One(), Y1=hb.One(), X2=hb.One(), Y2=hb.One(), zx=hb.Zero(), zy=hb.Zero())
    m.add(ax=hb.TF("cos(a)"), ay=hb.TF("sin(a)"), bx=hb.TF("0.7*cos(b)"), by=hb.TF("0.7*sin(b)"))
    m.add(m1x=hb.I(1.0), m1y=hb.I(1.0), m2x=hb.I(2.0), m2y=hb.I(2.0))
    m.add(g1=hb.Se(-G), g2=hb.Se(-2 * G))
    m.bond("w1 -> ax -> X1 -> m1x", "w1 -> ay -> Y1 -> m1y", "X1 -> zx -> X2 -> m2x")
    m.bond("Y1 -> zy -> Y2 -> m2y", "w2 -> bx -> zx", "w2 -> by -> zy", "g1 -> Y1", "g2 -> Y2")
    m.signal(a=hb.Integral("w1.f", 1.2), b=hb.Integral("w2.f", -0.5))

    def rates(t: float, y: np.ndarray) -> list[float]:
        a, b, p, q = y
        mixed, bent = 1.4 * math.cos(a - b), 1.4 * math.sin(a - b)
        forces = [-bent * q * q - 3 * G * math.sin(a), bent * p * p - 1.4 * G * math.sin(b)]
        return [p, q, *np.linalg.solve([[3.0, mixed], [mixed, 0.98]], forces)]

    told = solve_ivp(rates, (0.0, 1.0), [1.2, -0.5, 0.0, 0.0], **FINE)
    run = hb.simulate(m, 1.0)
    for t in (0.25, 0.5, 1.0):
        found = [run[name].at(t) for name in ("a", "b", "w1.f", "w2.f")]
        assert found == pytest.approx(told.sol(t), rel=1e-5, abs=1e-5)
    assert run.audit().holds()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_scotch_yoke_rubs_and_turns_round_at_its_ends(solver: str) -> None:
    """Friction turns at each dead centre, where the crank moves the yoke at no speed."""
    m = hb.Model("yoke", domain="rotational")
    m.add(T=hb.Se("3 N*m"), J=hb.I(0.3, f=1.0), w=hb.One(), d=hb.R(0.3))
    m.add(crank=hb.TF("-0.2*sin(th)"), x=hb.One(domain="translational"), M=hb.I(4.0))
    m.add(rub=hb.One(law="coulomb", limit="6 N"))
    m.bond("T -> w -> J", "w -> d", "w -> crank -> x -> M", "x -> rub")
    m.signal(th=hb.Integral("w.f", 0.3))
    t, turns = 0.0, 1
    y = np.array([0.3, 0.3 / (0.3 + 4.0 * (0.2 * math.sin(0.3)) ** 2)])
    run = hb.simulate(m, 4.0, solver=solver)
    dead = [event.t for event in run.events[1:]]
    while True:
        sign = 1.0 if turns % 2 == 0 else -1.0

        def rates(t: float, y: np.ndarray, sign: float = sign) -> list[float]:
            arm, slope = -0.2 * math.sin(y[0]), -0.2 * math.cos(y[0])
            turning = 3.0 - 0.3 * y[1] - 4.0 * arm * slope * y[1] ** 2 - 6.0 * sign * arm
            return [y[1], turning / (0.3 + 4.0 * arm**2)]

        def at_centre(t: float, y: np.ndarray, turns: int = turns) -> float:
            return y[0] - turns * math.pi

        at_centre.terminal, at_centre.direction = True, 1.0
        step = solve_ivp(rates, (t, 4.0), y, events=[at_centre], **FINE)
        t, y = step.t[-1], step.y[:, -1]
        if t >= 4.0:
            break
        assert dead[turns - 1] == pytest.approx(t, rel=1e-7)
        assert run["w.f"].at(t) == pytest.approx(y[1], rel=1e-6)
        turns += 1
    assert turns > 4 and len(dead) == turns - 1
    assert run.audit().holds()


def two_tanks() -> hb.Model:
    """Return two tanks with a pipe that is shut, and an overflow: Mosterman & Biswas, Low et al."""
    m = hb.Model("two tanks", domain="hydraulic")
    m.add(Q=hb.Sf(2.0), C1=hb.C(1.0), C2=hb.C(2.0), n1=hb.Zero(), n2=hb.Zero())
    m.add(R12=hb.R(4.0), R2=hb.R(1.5), pipe=hb.One(), over=hb.One(), rim=hb.Se(3.0), R1=hb.R(0.5))
    m.bond("Q -> n1 -> C1", "n1 -> pipe -> n2 -> C2", "pipe -> R12", "n2 -> R2")
    m.bond("n1 -> over -> rim", "over -> R1")
    rules = ["dry -> wet when n1.e > 3", "wet -> dry when n1.e < 3"]
    m.machine("o", states={"dry": [], "wet": ["over"]}, start="dry", rules=rules)
    rules = ["open -> shut when time >= 6 and time < 12", "shut -> open when time >= 12"]
    m.machine("v", states={"open": ["pipe"], "shut": []}, start="open", rules=rules)
    return m


@pytest.mark.parametrize("wet", [False, True])
@pytest.mark.parametrize("open_", [False, True])
def test_two_tanks_have_the_matrices_of_each_mode(wet: bool, open_: bool) -> None:
    m = two_tanks()
    mode = {"o": "wet" if wet else "dry", "v": "open" if open_ else "shut"}
    told = hb.state_equations(m).at(mode)
    a = np.array([[-0.25 * open_ - 2.0 * wet, 0.125 * open_], [0.25 * open_, 0.0]])
    a[1, 1] = -0.125 * open_ - 1 / 3
    assert told.states == ("C1.q", "C2.q") and told.inputs == ("Q", "rim")
    np.testing.assert_allclose(told.E, np.eye(2))
    np.testing.assert_allclose(told.A, a, atol=1e-14)
    np.testing.assert_allclose(told.B, [[1.0, 2.0 * wet], [0.0, 0.0]], atol=1e-14)
    row = hb.structure(m, outputs=["C2.e"]).row(mode)
    reach = np.linalg.matrix_rank(np.column_stack([told.B, a @ told.B]))
    seen = np.linalg.matrix_rank(np.array([[0.0, 0.5], [0.0, 0.5] @ a]))
    assert row.order == 2
    assert bool(row.controllable.finite) == (reach == 2)
    assert bool(row.observable.finite) == (seen == 2)


def test_two_tanks_fill_to_where_one_runs_over() -> None:
    """Each interval by the matrices of its mode, derived by hand; the events are where 3 is met."""
    run = hb.simulate(two_tanks(), 20.0)
    fired = [step.fired[-1] for e in run.events[1:] for step in e.steps]
    names = [(f.machine, f.target) for f in fired]
    open_, wet, x, t = True, False, np.zeros(2), 0.0
    for event, (machine, state) in zip(run.events[1:], names):
        x = later(x, event.t - t, open_, wet)
        t = event.t
        assert [run["C1.q"].at(t), run["C2.q"].at(t)] == pytest.approx(x, rel=1e-6)
        if machine == "o":
            assert x[0] == pytest.approx(3.0, rel=1e-6)
            wet = state == "wet"
        else:
            assert t in (6.0, 12.0)
            open_ = state == "open"
    assert len(names) == 3
    x = later(x, 20.0 - t, open_, wet)
    assert [run["C1.q"].at(20.0), run["C2.q"].at(20.0)] == pytest.approx(x, rel=1e-6)


def later(x: np.ndarray, span: float, open_: bool, wet: bool) -> np.ndarray:
    """Return what is in both tanks after a time, by the exponential of its matrix."""
    whole = np.zeros((3, 3))
    whole[0] = [-0.25 * open_ - 2.0 * wet, 0.125 * open_, 2.0 + 6.0 * wet]
    whole[1] = [0.25 * open_, -0.125 * open_ - 1 / 3, 0.0]
    return (expm(whole * span) @ [*x, 1.0])[:2]
