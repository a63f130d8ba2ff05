"""Sliding beside junction laws: their branches are those of each mode that is combined."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def charger(high: str, low: str, *, more: bool = False) -> hb.Model:
    """A voltage relay charges a capacitor through a diode: up to 1 V, or so."""
    m = hb.Model("charger")
    m.add(
        c=hb.C(1.0),
        u=hb.Se(f'if r.state == "above" then {low} else {high}'),
        R=hb.R(1.0),
        load=hb.R(2.0),
        n=hb.Zero(),
        d=hb.One(law="diode"),
    )
    m.bond("u -> d -> n -> c", "d -> R", "n -> load")
    if more:
        m.add(c2=hb.C(0.5), R2=hb.R(1.5), j=hb.One())
        m.bond("n -> j -> c2", "j -> R2")
    m.machine(
        "r",
        states={"above": [], "below": []},
        start="below",
        rules=["above -> below when c.e < 1", "below -> above when c.e > 1"],
    )
    return m


def test_a_diode_conducts_on_one_side_of_the_surface_and_blocks_on_the_other() -> None:
    """+1/2 below, where it conducts; -1/2 above, where it blocks (were it to conduct: -7/2)."""
    run = hb.simulate(charger("2", "-2"), until=4.0, rtol=1e-10)
    (sliding,) = run.sliding
    # c' = 2 - 1.5 c: 1 is reached at ln(4)/1.5
    assert sliding.t0 == pytest.approx(np.log(4.0) / 1.5, abs=1e-9)
    assert run.weight("r", "below", 3.0) == pytest.approx(0.5, abs=1e-13)
    assert run["d.f"].at(3.0) == pytest.approx(0.5, abs=1e-13)
    # blocked half of the time, with -2 - 1 across it
    assert run["d.e"].at(3.0) == pytest.approx(-1.5, abs=1e-13)
    assert run.audit().holds()
    band = hb.simulate(charger("2", "-2"), until=1.2, sliding="hysteresis", hysteresis=1e-3)
    below = [
        (s.t[-1] - s.t[0]) for s in band.segments if s.mode[-1] == 1 and s.t[0] > sliding.t0 + 0.01
    ]
    rest = [
        (s.t[-1] - s.t[0]) for s in band.segments if s.mode[-1] == 0 and s.t[0] > sliding.t0 + 0.01
    ]
    assert np.mean(below) / (np.mean(below) + np.mean(rest)) == pytest.approx(0.5, abs=0.01)


def voltage(t: float) -> float:
    return 2.2 + 1.5 * np.cos(2.0 * t)


def by_hand(until: float) -> tuple[list[tuple[float, float]], np.ndarray]:
    """Integrate the charger with a second capacitor: charge, hold at 1 V, sag, charge again."""
    t, z, slides = 0.0, np.zeros(2), False
    found = []
    while t < until:
        if slides:
            field = lambda t, z: [0.0, (1.0 - z[1]) / 0.75]  # noqa: E731
            end = lambda t, z: voltage(t) - 1.5 - (1.0 - z[1]) / 1.5  # noqa: E731
            end.direction = -1
        else:
            field = lambda t, z: [  # noqa: E731
                max(0.0, voltage(t) - z[0]) - z[0] / 2.0 - (z[0] - z[1]) / 1.5,
                (z[0] - z[1]) / 0.75,
            ]
            end = lambda t, z: z[0] - 1.0  # noqa: E731
            end.direction = 1
        end.terminal = True
        part = solve_ivp(
            field, (t, until), z, "DOP853", events=end, rtol=1e-11, atol=1e-13, max_step=0.05
        )
        if slides:
            found.append((t, part.t[-1]))
        t, z = part.t[-1], part.y[:, -1]
        if part.status:
            slides = not slides
            z[0] = 1.0
    return found, z


def test_sliding_is_left_and_entered_as_the_source_sinks_and_swells() -> None:
    expected, z = by_hand(8.0)
    run = hb.simulate(
        charger("2.2 + 1.5*cos(2*time/(1 s))", "-1", more=True), until=8.0, rtol=1e-10
    )
    found = [(s.t0, s.t1) for s in run.sliding]
    assert len(expected) == 3
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-9)
    assert [run.final["c.e"], run.final["c2.e"]] == pytest.approx(list(z), abs=1e-9)
    # on leaving, the diode has at once the branch of the mode that goes on alone
    times = [e.t for e in run.events]
    assert np.diff(times).min() > 1e-3
    assert run.audit().holds(1e-10)


def test_a_branch_that_changes_in_both_modes_does_not_end_the_sliding() -> None:
    m = hb.Model("drained")
    m.add(
        c=hb.C(1.0),
        u=hb.Sf('if r.state == "above" then -1 else 1'),
        R=hb.R(1.0),
        sink=hb.Se("1 + 0.5*cos(2*time/(1 s))"),
        n=hb.Zero(),
        d=hb.One(law="diode"),
    )
    m.bond("u -> n -> c", "n -> d -> R", "d -> sink")
    m.machine(
        "r",
        states={"above": [], "below": []},
        start="below",
        rules=["above -> below when c.e < 1", "below -> above when c.e > 1"],
    )
    run = hb.simulate(m, until=6.0)
    (sliding,) = run.sliding
    assert sliding.t1 == 6.0
    for t in np.linspace(sliding.t0 + 0.01, 5.99, 23):
        current = max(0.0, -0.5 * np.cos(2.0 * t))
        assert run["d.f"].at(float(t)) == pytest.approx(current, abs=1e-12)
        assert run.weight("r", "below", float(t)) == pytest.approx(0.5 * (1 + current), abs=1e-12)
    assert run.audit().holds()


def two_blocks(first: str) -> hb.Model:
    m = hb.Model("blocks", domain="translational")
    m.add(
        m1=hb.I(1.0, f=0.2),
        m2=hb.I(0.5),
        k=hb.C(0.25),
        pull=hb.Se("3*sin(1.3*time/(1 s))"),
        n=hb.Zero(),
        v2=hb.One(law="coulomb", limit=0.6),
    )
    if first == "law":
        m.add(v1=hb.One(law="coulomb", limit=1.0))
    else:
        m.add(v1=hb.One(), rub=hb.Se('if slip.state == "forward" then -1 else 1'))
        m.bond("rub -> v1")
        m.machine(
            "slip",
            states={"forward": [], "backward": []},
            start="forward",
            rules=["forward -> backward when v1.f < 0", "backward -> forward when v1.f > 0"],
        )
    m.bond("pull -> v1 -> m1", "v1 -> n -> v2 -> m2", "n -> k")
    return m


def test_friction_by_machine_beside_friction_by_law_is_friction_by_law_twice() -> None:
    """Sliding in the one, complementarity in the other: neither knows of the other's algorithm."""
    one = hb.simulate(two_blocks("machine"), until=12.0, rtol=1e-10)
    other = hb.simulate(two_blocks("law"), until=12.0, rtol=1e-10)
    assert len(one.sliding) == 3
    assert other.sliding == ()
    assert [e.t for e in one.events] == pytest.approx([e.t for e in other.events], abs=1e-9)
    t = np.linspace(0.1, 11.9, 60)
    for name in ("m1.p", "m2.p", "k.q"):
        assert one[name].at(t) == pytest.approx(other[name].at(t), abs=1e-9)
    assert one.audit().holds(1e-10)


@pytest.mark.slow
def test_a_relay_law_beside_a_sliding_machine_agrees_with_time_stepping() -> None:
    """Two tanks, one held at its edge by a machine, the other by a relay law."""
    m = hb.Model("held")
    m.add(
        c1=hb.C(1.0, q=0.5),
        c2=hb.C(1.0, q=-0.5),
        r1=hb.Sf('if top.state == "over" then -1 else 1'),
        n1=hb.Zero(),
        n2=hb.Zero(law="relay", limit=0.8),
        link=hb.One(),
        R=hb.R(1.0),
        feed=hb.Sf("0.7*sin(2*time/(1 s))"),
    )
    m.bond("r1 -> n1 -> c1", "n1 -> link -> n2 -> c2", "link -> R", "feed -> n2")
    m.machine(
        "top",
        states={"under": [], "over": []},
        start="over",
        rules=["under -> over when c1.q > 0.2", "over -> under when c1.q < 0.2"],
    )
    run = hb.simulate(m, until=5.0, rtol=1e-10)
    assert run.sliding
    x = np.array([0.5, -0.5])
    h = 2e-4
    # implicit Euler of both relays, each clamped: a stiff linear step tried by its four faces
    for k in range(round(5.0 / h)):
        d = 0.7 * np.sin(2.0 * (k + 1) * h)
        for s1, s2 in [(a, b) for a in (0, 1, -1) for b in (0, 1, -1)]:
            # x1' = -s1 - (x1 - x2), x2' = -0.8 s2 + (x1 - x2) + d
            left = np.array([[1 + h, -h, h, 0], [-h, 1 + h, 0, 0.8 * h], [0, 0, 0, 0], [0] * 4])
            right = np.array([x[0], x[1] + h * d, 0.0, 0.0])
            left = left.astype(float)
            for row, (sign, level, col) in enumerate([(s1, 0.2, 0), (s2, 0.0, 1)], 2):
                left[row, col if sign == 0 else col + 2] = 1.0
                right[row] = level if sign == 0 else sign
            y = np.linalg.solve(left, right)
            over = [y[0] - 0.2, y[1]]
            if all(
                abs(y[2 + i]) <= 1 + 1e-12 if s == 0 else s * over[i] >= 0
                for i, s in enumerate((s1, s2))
            ):
                x = y[:2]
                break
        else:
            raise AssertionError("no face")
    assert [run.final["c1.q"], run.final["c2.q"]] == pytest.approx(list(x), abs=5 * h)


def ladder(seed: int) -> hb.Model:
    """Two capacitors, each charged by a relay through a diode, with a diode between them."""
    g = np.random.default_rng(seed)
    m = hb.Model("ladder")
    m.add(dj=hb.One(law="diode"), Rj=hb.R(float(g.uniform(0.5, 3.0))), j=hb.One(), Rb=hb.R(4.0))
    for k in (1, 2):
        high, low = g.uniform(1.5, 4.0), g.uniform(-2.0, 0.5)
        swing, rate = g.uniform(0.0, 1.5), g.uniform(0.5, 3.0)
        m.add(
            **{
                f"c{k}": hb.C(float(g.uniform(0.3, 2.0))),
                f"u{k}": hb.Se(
                    f'if r{k}.state == "above" then {low} else '
                    f"{high} + {swing}*cos({rate}*time/(1 s))"
                ),
                f"R{k}": hb.R(float(g.uniform(0.5, 2.0))),
                f"n{k}": hb.Zero(),
                f"d{k}": hb.One(law="diode"),
                f"l{k}": hb.R(float(g.uniform(1.0, 4.0))),
            }
        )
        m.bond(f"u{k} -> d{k} -> n{k} -> c{k}", f"d{k} -> R{k}", f"n{k} -> l{k}")
        level = f"c{k}.e + 0.3*c{3 - k}.e"
        m.machine(
            f"r{k}",
            states={"above": [], "below": []},
            start="below",
            rules=[f"above -> below when {level} < 1", f"below -> above when {level} > 1"],
        )
    m.bond("n1 -> dj -> n2", "dj -> Rj", "n2 -> j -> n1", "j -> Rb")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", range(4))
def test_two_relays_and_three_diodes_agree_with_switching_in_a_band(seed: int) -> None:
    run = hb.simulate(ladder(seed), until=2.5, rtol=1e-8)
    assert run.status == "ok"
    assert any(len(s.machines) == 2 for s in run.sliding)
    band = 1e-2
    other = hb.simulate(ladder(seed), until=2.5, sliding="hysteresis", hysteresis=band)
    for name in ("c1.e", "c2.e"):
        assert run.final[name] == pytest.approx(other.final[name], abs=3.0 * band)
    assert run.audit().holds()
