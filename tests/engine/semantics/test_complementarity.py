"""Junction laws where rounding, rest or several answers make the choice of branches hard."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

EXAMPLES = Path(__file__).parents[3] / "examples"
W = 2.0 * math.pi * 50.0


def conducting(run: hb.Result) -> list[tuple[float, set[str]]]:
    """Instants of the events, and what conducts after each."""
    return [
        (e.t, {n for n, s in run.graph.mode_names(e.steps[-1].mode).items() if s == "conducts"})
        for e in run.events
    ]


def test_a_ratchet_starts_from_rest() -> None:
    """At the start speed and acceleration are zero; only the one after that pushes the pawl."""
    text = (EXAMPLES / "ratchet.toml").read_text(encoding="utf-8")
    assert "cos(3 [rad/s]*time)" in text
    run = hb.simulate(hb.loads(text.replace("cos(3", "sin(3")), until=1.0)

    # parameters of the example; the link and the drum turn as one once the spring lifts the weight
    def alone(t: float, z: np.ndarray) -> list[float]:
        swing = 2.0 * math.sin(3.0 * t)
        return [swing - z[1], (z[0] / 0.005 + 0.5 * (swing - z[1]) - 2.0) / (0.21 + 4.0 * 0.05**2)]

    def lifts(t: float, z: np.ndarray) -> float:
        return z[0] / 0.005 + 0.5 * 2.0 * math.sin(3.0 * t) - 2.0

    lifts.terminal = True  # type: ignore[attr-defined]
    held = solve_ivp(
        lambda t, z: [2.0 * math.sin(3.0 * t)],
        (0.0, 1.0),
        [0.0],
        rtol=1e-11,
        atol=1e-13,
        events=lifts,
    )
    (begin,) = held.t_events[0]
    turn = solve_ivp(
        alone, (begin, 0.9), [held.y[0, -1], 0.0], rtol=1e-10, atol=1e-12, dense_output=True
    )
    stop = [t for t, on in conducting(run) if "drum" in on and t > 1e-6]
    assert stop[0] == pytest.approx(begin, rel=1e-6)
    for t in np.linspace(begin, 0.6, 7):
        assert run["drum.f"].at(t) == pytest.approx(turn.sol(t)[1], abs=1e-6)
    assert run["drum.f"].at(0.9 * begin) == pytest.approx(0.0, abs=1e-12)


def controller(alpha: float) -> hb.Model:
    """Two thyristors back to back before a load of resistor and inductor."""
    m = hb.Model("controller", domain="electrical")
    m.add(V=hb.Se(f"100*sin({W}*time)"), s=hb.Zero(), n=hb.Zero(), load=hb.One())
    m.add(R=hb.R("10 ohm"), L=hb.I("0.01 H"))
    m.add(t=hb.One(law="thyristor", gate=f"sin({W}*time - {alpha}) > 0"))
    m.add(u=hb.One(law="thyristor", gate=f"sin({W}*time - {alpha}) < 0"))
    m.bond("V -> s", "s -> t -> n", "n -> u -> s", "n -> load -> R", "load -> L")
    return m


def test_thyristors_back_to_back() -> None:
    """The current of one half-wave ends before the other is fired: closed form."""
    alpha, R, L = 1.0, 10.0, 0.01
    run = hb.simulate(controller(alpha), until=0.04)
    late, impedance = math.atan(W * L / R), math.hypot(R, W * L)

    def current(t: float) -> float:
        half, angle = divmod(W * t - alpha, math.pi)
        phase = angle + alpha
        i = math.sin(phase - late) - math.sin(alpha - late) * math.exp(-angle * R / (W * L))
        return (-1.0) ** half * 100.0 / impedance * max(i, 0.0) if W * t > alpha else 0.0

    t = np.linspace(1e-4, 0.0399, 200)
    assert run["L.f"].at(t) == pytest.approx([current(a) for a in t], abs=1e-5)
    fired = [(alpha + k * math.pi) / W for k in range(4)]
    assert [e.t for e in run.events[1::2]] == pytest.approx(fired, rel=1e-9)
    assert len(run.events) == 8  # the start, four that fire, three currents that end


def test_a_blocked_current_is_zero_and_costs_nothing() -> None:
    """The current of a blocked arm ends; it must not fade through ever smaller numbers."""
    model = hb.load(EXAMPLES / "mmc_arm.toml")
    run = hb.simulate(model, until=5.6e-3, parameters={"t_block": 5.1e-3})
    last = run.events[-1].t
    assert 5.1e-3 < last < 5.2e-3
    assert not np.any(run["L.f"].at(np.linspace(last, 5.6e-3, 50)[1:]))


def test_a_commutation_keeps_the_flux() -> None:
    """Two thyristors hand their current over to two others; the inductor does not notice."""
    run = hb.simulate(hb.load(EXAMPLES / "thyristor_rectifier.toml"), until=0.03)
    names = [s.path for s in run.graph.storages]
    commutations = run.events[1:]
    assert len(commutations) >= 2
    for event in commutations:
        for name in names:
            before, after = (run[name].at(event.t, side=s) for s in ("left", "right"))
            assert after == pytest.approx(before, rel=1e-9, abs=1e-9)
        assert not event.steps[-1].impulses


def test_a_capacitor_behind_blocking_diodes_keeps_its_charge() -> None:
    """One node hangs on diodes only and rests at zero: rounding of either sign counts as zero."""
    m = hb.Model("held", domain="electrical")
    m.add(n1=hb.Zero(), n2=hb.Zero(), b1=hb.One(), C=hb.C(2.99, e=1.04), R=hb.R(2.956))
    m.add(b2=hb.One(law="diode"), b3=hb.One(law="diode"), b5=hb.One(law="diode"))
    m.bond("n1 -> b1 -> n2", "C -> b1", "b2 -> n1", "b3 -> n2", "n1 -> b5", "R -> b5")
    run = hb.simulate(m, until=2.0)
    t = np.linspace(0.0, 2.0, 21)
    assert run["C.e"].at(t) == pytest.approx(1.04, rel=1e-12)
    assert run["n2.e"].at(t) == pytest.approx(1.04, rel=1e-12)
    assert np.abs(run["n1.e"].at(t)).max() < 1e-12


def test_a_switch_closes_beside_a_diode() -> None:
    """How the two share the current is open; charge and oscillation are not: closed form."""
    C0, C1, L, v1, v2, i, t1 = 0.709, 0.874, 0.401, 1.04, 0.47, 1.61, 0.66
    m = hb.Model("beside", domain="electrical")
    m.add(n1=hb.Zero(), n2=hb.Zero(), C0=hb.C(C0, e=v1), C1=hb.C(C1, e=v2), L=hb.I(L, f=i))
    m.add(d=hb.One(law="diode"), s=hb.One())
    m.bond("n1 -> C0", "n2 -> C1", "n2 -> L", "n2 -> d -> n1", "n2 -> s -> n1")
    m.machine(
        "switch",
        states={"open": [], "closed": ["s"]},
        start="open",
        rules=[f"open -> closed when time >= {t1}"],
    )
    run = hb.simulate(m, until=1.0, rtol=1e-10)

    def swing(C: float, v: float, i: float, t: float) -> tuple[float, float]:
        Z, a = math.sqrt(L / C), t / math.sqrt(L * C)
        return v * math.cos(a) - i * Z * math.sin(a), i * math.cos(a) + v / Z * math.sin(a)

    assert [e.t for e in run.events[1:]] == pytest.approx([t1])
    assert run["C1.e"].at(0.3) == pytest.approx(swing(C1, v2, i, 0.3)[0], rel=1e-8)
    v, i = swing(C1, v2, i, t1)
    shared = (C1 * v + C0 * v1) / (C0 + C1)
    for t in (0.7, 0.85, 1.0):
        now = swing(C0 + C1, shared, i, t - t1)
        assert [run[n].at(t) for n in ("C0.e", "C1.e", "L.f")] == pytest.approx(
            [now[0], *now], rel=1e-7
        )


def one_way_wedge(mu: float, lever: float, force: float) -> hb.Model:
    """A rigid contact at rest whose friction moves the body against the contact, or off it."""
    m = hb.Model("wedge", domain="translational", parameters={"mu": mu})
    m.add(a=hb.I("1 kg"), b=hb.I("1 kg", f="0.5 m/s"), va=hb.One(), vb=hb.One())
    m.add(F=hb.Se(f"{force} N"), contact=hb.Zero(law="unilateral", gap="y"))
    m.add(tf=hb.TF(lever), rub=hb.Zero(), slip=hb.One(law="coulomb", limit="mu*contact.e"))
    m.bond("F -> va -> a", "contact -> va", "vb -> b", "va -> tf -> rub", "vb -> rub -> slip")
    m.signal(y=hb.Integral("va.f", "0 m"))
    return m


def test_two_answers_are_said() -> None:
    """Acceleration N (1 - mu lever) + 1 of the contact: N = 0 and N = 1 both do (Painleve)."""
    run = hb.simulate(one_way_wedge(1.0, 2.0, 1.0), until=0.01)
    assert any("have 2 answers" in str(w) for w in run.warnings)
    assert hb.simulate(one_way_wedge(1.0, -2.0, 1.0), until=0.01).warnings == ()


def test_no_answer_is_refused() -> None:
    """Acceleration -N - 1: no N keeps the contact from closing further (Painleve)."""
    with pytest.raises(hb.HybondError, match="HB-J110"):
        hb.simulate(one_way_wedge(1.0, 2.0, -1.0), until=0.01)
    # with the lever the other way round the contact bears 1/(1 + 2)
    run = hb.simulate(one_way_wedge(1.0, -2.0, -1.0), until=0.01)
    assert run["contact.e"].at(0.005) == pytest.approx(1.0 / 3.0, rel=1e-12)


def test_a_blocked_thyristor_in_series_with_a_current_is_named() -> None:
    """Nothing else may conduct: the refusal says who opposes whom."""
    m = hb.Model("lone", domain="electrical")
    m.add(t=hb.One(law="thyristor", gate="time > 1 [s]"), drive=hb.Sf("2 A"), coil=hb.I("5 mH"))
    m.bond("drive -> t -> coil")
    with pytest.raises(hb.HybondError, match="HB-J110") as refused:
        hb.simulate(m, until=0.01)
    why = refused.value.why
    assert "impulses of t have no solution" in why
    assert "OFF 1-junction t" in why and "Sf drive" in why


@pytest.mark.parametrize("options", [{}, {"solver": "radau"}, {"solver": "rk4", "step": 5.0}])
@pytest.mark.parametrize("order", ["late first", "early first"])
def test_two_guards_in_one_step(options: dict[str, object], order: str) -> None:
    """The earlier root comes first, whichever machine is listed first; it slows the filling."""
    m = hb.Model("tank", domain="hydraulic")
    m.add(n=hb.Zero(), tank=hb.C(1.0))
    m.add(inflow=hb.Sf('if early.state == "high" then 0.5 else 1'))
    m.bond("inflow -> n -> tank")
    for name in sorted(("early", "late"), reverse=order == "late first"):
        level = 1 if name == "early" else 2
        m.machine(
            name,
            states={"low": [], "high": []},
            start="low",
            rules=[f"low -> high when tank.q > {level}"],
        )
    run = hb.simulate(m, until=10.0, **options)
    fired = [(e.t, f.machine) for e in run.events[1:] for s in e.steps for f in s.fired]
    assert [name for _, name in fired] == ["early", "late"]
    assert [t for t, _ in fired] == pytest.approx([1.0, 3.0], rel=1e-9)
