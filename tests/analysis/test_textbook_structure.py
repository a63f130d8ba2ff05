"""Textbook systems whose structure is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.structure.controllability import controllability, observability
from hybond.analysis.structure.structure import structure
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import analyse


def bridge(r1: float, r2: float, r3: float, r4: float) -> hb.Model:
    """Wheatstone's bridge with an inductor as the detector, from node a to node b."""
    m = hb.Model("bridge", domain="electrical")
    m.add(V=hb.Se(10), n=hb.Zero(), a=hb.Zero(), b=hb.Zero(), up1=hb.One(), up2=hb.One())
    m.add(R1=hb.R(r1), R2=hb.R(r2), R3=hb.R(r3), R4=hb.R(r4), d=hb.One(), L=hb.I(0.5))
    m.bond("V -> n -> up1 -> a -> R2", "up1 -> R1", "n -> up2 -> b -> R4", "up2 -> R3")
    m.bond("a -> d -> b", "d -> L")
    return m


def parallel(a: float, b: float) -> float:
    return a * b / (a + b)


def test_a_balanced_bridge_loses_controllability_and_nothing_else() -> None:
    row = structure(bridge(100.0, 200.0, 300.0, 600.0), outputs=["L.f"]).rows[0]
    pole = -(parallel(100.0, 200.0) + parallel(300.0, 600.0)) / 0.5
    assert row.order == 1
    assert row.poles == pytest.approx([pole])
    has = row.controllable
    assert has is not None and has.sure
    assert not has.finite and has.structural[0] and has.lost[0] == "finite"
    assert has.modes == pytest.approx([pole])
    assert has.storages == ("L.p",)
    assert row.observable is not None and row.observable.finite
    assert "loses finite" in row.notes[0]


def test_a_bridge_out_of_balance_is_controllable() -> None:
    has = structure(bridge(100.0, 200.0, 300.0, 601.0)).rows[0].controllable
    assert has is not None and has.finite and has.sure and not has.lost


def test_the_source_of_a_balanced_bridge_does_not_see_the_detector() -> None:
    row = structure(bridge(100.0, 200.0, 300.0, 600.0), outputs=["V.f"]).rows[0]
    assert row.observable is not None and row.observable.lost[0] == "finite"
    assert row.observable.storages == ("L.p",)


def test_two_identical_masses_on_one_shaker() -> None:
    """Mass and spring twice on one velocity source: the difference swings by itself."""

    def shaker(second: float) -> hb.Model:
        m = hb.Model("shaker", domain="translational")
        m.add(v=hb.Sf(1), base=hb.One())
        for k, mass in (("1", 2.0), ("2", second)):
            m.add(**{f"n{k}": hb.Zero(), f"k{k}": hb.C(0.02), f"j{k}": hb.One()})
            m.add(**{f"m{k}": hb.I(mass)})
            m.bond(f"base -> n{k} -> j{k} -> m{k}", f"n{k} -> k{k}")
        m.bond("v -> base")
        return m

    row = structure(shaker(2.0)).rows[0]
    has = row.controllable
    assert has is not None
    assert (row.order, has.rank, has.finite, has.structural[0]) == (4, 2, False, True)
    assert np.abs(has.modes) == pytest.approx(np.sqrt(1 / (0.02 * 2.0)))
    assert set(has.storages) == {"m1.p", "m2.p", "k1.q", "k2.q"}
    other = structure(shaker(3.0)).rows[0].controllable
    assert other is not None and (other.finite, other.rank) == (True, 4)


def test_a_loop_of_capacitors_and_a_source_is_free_of_impulses_in_what_is_stored() -> None:
    """V, C1 and C2 in one loop: one charge moves freely at most, one is prescribed."""
    m = hb.Model("loop", domain="electrical")
    m.add(V=hb.Se(1), n=hb.Zero(), C1=hb.C("1 F"), i=hb.One(), R=hb.R("2 ohm"), C2=hb.C("3 F"))
    m.bond("V -> n -> C1", "n -> i -> R", "i -> C2")
    row = structure(m, outputs=["V.f"]).rows[0]
    assert row.derivative == ("C1.q",)
    assert (row.states, row.order, row.index, row.impulse_free) == (2, 1, 1, True)
    assert row.poles == pytest.approx([-1 / 6])
    assert row.controllable is not None
    assert row.controllable.actual == (True, True, True)
    # the current of the source holds C1's rate, an output that reads v'
    assert row.observable is not None and row.observable.finite


def test_capacitors_joined_by_nothing_but_a_switch() -> None:
    m = hb.Model("caps", domain="electrical")
    m.add(J=hb.Sf(1), a=hb.C(1), n1=hb.Zero(), sw=hb.One(), n2=hb.Zero(), b=hb.C(2))
    m.bond("J -> n1 -> a", "n1 -> sw -> n2 -> b")
    m.machine(
        "S",
        states={"open": [], "closed": ["sw"]},
        start="open",
        rules=["open -> closed when time >= 1"],
    )
    report = structure(m)
    opened, closed = report.row({"S": "open"}), report.row({"S": "closed"})
    assert (opened.order, closed.order) == (2, 1)
    assert opened.derivative == () and len(closed.derivative) == 1
    assert opened.controllable is not None and closed.controllable is not None
    assert (opened.controllable.finite, opened.controllable.rank) == (False, 1)
    assert opened.controllable.storages == ("b.q",) == opened.controllable.unreached
    assert not opened.controllable.lost
    # closed: u moves the common charge, the constraint stays out of its reach
    assert closed.controllable.actual == (True, False, True)
    assert report.summary["controllable, finite"] == (False, True)
    assert report.summary["solvable"] == (True, True)


def test_series_capacitors_cannot_be_charged_apart() -> None:
    """Causal paths reach both, but not all storage accepts derivative causality."""
    m = hb.Model("series", domain="electrical")
    m.add(J=hb.Sf(1), i=hb.One(), c1=hb.C(1), c2=hb.C(2))
    m.bond("J -> i -> c1", "i -> c2")
    has = structure(m).rows[0].controllable
    assert has is not None
    assert (has.finite, has.structural[0], has.by_paths, has.rank) == (False, False, False, 1)
    assert has.unreached == () and len(has.stuck) == 1
    assert has.modes == (0.0,)


def by_hand(e, a, b, c=(), f=None) -> Descriptor:
    n, p, q = len(e), len(b[0]), len(c)
    d = Descriptor.of(
        e,
        a,
        b,
        C=c,
        D=np.zeros((q, p)),
        states=tuple(f"x{k}" for k in range(n)),
        inputs=tuple(f"u{k}" for k in range(p)),
        outputs=tuple(f"y{k}" for k in range(q)),
    )
    return (
        d
        if f is None
        else Descriptor(
            d.E, d.A, d.B, d.C, d.D, np.array(f, dtype=float), d.states, d.inputs, d.outputs, n
        )
    )


@pytest.mark.parametrize(("constraint", "index"), [([0, 1, 0], 2), ([1, 0, 0], 3)])
def test_a_mass_held_by_a_mechanical_constraint(constraint, index) -> None:
    """x' = v, m v' = lambda + u, and v or x is held at zero: index 2 or 3, impulses in lambda."""
    e = [[1, 0, 0], [0, 2, 0], [0, 0, 0]]
    a = [[0, 1, 0], [0, 0, 1], constraint]
    p = analyse(by_hand(e, a, [[0], [1], [0]]))
    assert (p.index, p.order, p.rank_e, p.impulse_free) == (index, 3 - index, 2, False)
    reach = controllability(p)
    # the held velocity cannot be pushed: neither motion nor impulse is within reach of u
    assert (reach.infinite, reach.impulse) == (False, False)


@pytest.mark.parametrize(
    ("e", "a", "rank"),
    [
        ([[1, 0], [0, 0]], [[1, 1], [0, 0]], 1),
        ([[0, 0], [0, 0]], [[1, 1], [1, 1]], 1),
        ([[1, 1], [1, 1]], [[2, 2], [2, 2]], 1),
        ([[0, 1, 0], [0, 0, 1], [0, 0, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, 0]], 2),
    ],
)
def test_singular_pencils(e, a, rank) -> None:
    p = analyse(by_hand(e, a, [[1]] * len(e)))
    assert (p.regular, p.order, p.normal_rank, p.impulse_free) == (False, None, rank, None)


def test_an_input_in_place_of_a_constraint_reaches_infinity() -> None:
    """x' = -x + z, 0 = z - u: z follows u, so u steers x as well."""
    p = analyse(by_hand([[1, 0], [0, 0]], [[-1, 1], [0, 1]], [[0], [-1]]))
    assert controllability(p).complete
    dead = analyse(by_hand([[1, 0], [0, 0]], [[-1, 1], [0, 1]], [[0], [0]]))
    reach = controllability(dead)
    assert (reach.finite, reach.infinite, reach.impulse, reach.rank) == (False, False, True, 0)


def test_differentiated_inputs_steer() -> None:
    """x' = z', 0 = z - u, so x' = u': s and the pole at 0 cancel, u moves no motion."""
    p = analyse(by_hand([[1, -1], [0, 0]], [[0, 0], [0, 1]], [[0], [-1]]))
    reach = controllability(p)
    # rank [0 - A, B] is 1 < 2 at s = 0, by hand
    assert (p.order, reach.finite, reach.rank) == (1, False, 0)
    assert reach.modes.tolist() == [0.0]


def test_an_output_that_is_a_rate_sees_what_changes() -> None:
    """y = v' of x' = -x shows x; of x' = 0 it does not."""
    moving = analyse(by_hand([[1]], [[-1]], [[1]], c=[[0]], f=[[1]]))
    assert observability(moving).finite
    still = analyse(by_hand([[1]], [[0]], [[1]], c=[[0]], f=[[1]]))
    assert (observability(still).finite, observability(still).variables) == (False, (0,))


def test_multiple_uncontrollable_poles_are_found_where_eigenvalues_are_blurred() -> None:
    """A Jordan block of 4 at -1 that nothing drives: QR knows its eigenvalues to 1e-4."""
    n = 4
    block = -np.eye(n) + np.eye(n, k=1)
    a = np.block([[block, np.zeros((n, 1))], [np.ones((1, n)), -np.eye(1)]])
    b = np.zeros((n + 1, 1))
    b[-1] = 1.0
    q = np.linalg.qr(np.random.default_rng(3).normal(size=(n + 1, n + 1)))[0]
    reach = controllability(analyse(by_hand(np.eye(n + 1), q @ a @ q.T, (q @ b).tolist())))
    assert (reach.finite, reach.rank) == (False, 1)


def test_a_free_mass_has_two_poles_at_exactly_zero() -> None:
    q = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    a = q @ np.array([[0, 1, 0], [0, 0, 0], [0, 0, -5.0]]) @ q.T
    p = analyse(by_hand(np.eye(3), a, [[1], [0], [0]]))
    assert p.poles is not None and p.poles.tolist()[1:] == [0.0, 0.0]


def test_rates_that_are_measured_make_constraints_visible() -> None:
    """0 = x - u: x is not seen at infinity by y = 0, but its rate shows a jump of x."""
    held = [[0]], [[1]], [[-1]]
    blind = observability(analyse(by_hand(*held, c=[[0]])))
    assert (blind.infinite, blind.impulse) == (False, True)
    seen = observability(analyse(by_hand(*held, c=[[0]], f=[[1]])))
    assert (seen.infinite, seen.impulse) == (True, True)


def test_the_unobservable_part_is_named_whatever_the_units() -> None:
    """A chain a -> b with only a measured, in units 1e9 apart: b alone is not seen."""
    unit = 1e9
    a = [[-1.0, 0.0], [unit, -2.0]]
    p = analyse(by_hand(np.eye(2), a, [[1], [0]], c=[[1, 0]]))
    assert observability(p).variables == (1,)
    turned = analyse(by_hand(np.eye(2), np.array(a).T / unit, [[1], [0]]))
    assert controllability(turned).variables == (1,)
    # two that cancel in the output are both in it, though one unit is 1e9 of the other
    pair = analyse(by_hand(np.eye(2), [[-1, 0], [0, -1]], [[1], [1]], c=[[unit, 1]]))
    assert observability(pair).variables == (0, 1)


@pytest.mark.parametrize(("coupling", "reached"), [(0.5, True), (0.0, False)])
def test_coupled_coils_are_steered_through_their_field(coupling: float, reached: bool) -> None:
    """Two coils, a source on the first only; the poles solve det(s L + R) = 0."""
    m = hb.Model("coils", domain="electrical")
    m.add(V=hb.Se(1), a=hb.One(), ra=hb.R(3), b=hb.One(), rb=hb.R(5))
    m.add(L=hb.I([[2, coupling], [coupling, 1]]))
    m.bond("V -> a -> ra", "a -> L.1", "b -> L.2", "b -> rb")
    row = structure(m, outputs=["rb.f"]).rows[0]
    exact = np.roots([2 * 1 - coupling**2, 2 * 5 + 1 * 3, 15])
    assert sorted(z.real for z in row.poles) == pytest.approx(sorted(exact))
    for has in (row.controllable, row.observable):
        assert has is not None and has.sure and not has.lost
        assert has.finite == has.by_paths == reached
    assert row.controllable is not None
    assert row.controllable.unreached == (() if reached else ("L.2.p",))
