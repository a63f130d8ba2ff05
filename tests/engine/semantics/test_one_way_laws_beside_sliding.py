"""One-way laws beside a switch that slides push on the mean, too, or let go.

A clutch that is closed in one of the modes combined and open in the other is held by vanishing
impulses. Their mean had no sign: the clutch braked what it can only push.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb
from hybond.engine.guards import watching
from hybond.engine.sliding import by_means

SOLVERS = ("auto", "radau", "rk45")
LEADS = "3*sin(1.5*time)"


def rules(of: str) -> list[str]:
    return [f"off -> on when {of} < ref", f"on -> off when {of} > ref"]


def pushed(
    form: str,
    own: float = 0.5,
    load: float = 0.2,
    *,
    ref: str = LEADS,
    start: float = 0.0,
    back: bool = False,
    turned: bool = False,
    high: float = 40.0,
    low: float = -20.0,
) -> tuple[hb.Model, str, str]:
    """Return what a relay leads along `ref`, a one-way law, and what that pushes.

    As a clutch between shafts, or a valve between vessels; `back` if it leads from the second to
    the first, `turned` with the half arrow of a load against its flow.
    """
    m = hb.Model("pushed")
    to = f'if q.state == "on" then {high} else {low}'
    way = ("second -> law", "law -> first") if back else ("first -> law", "law -> second")
    if form == "clutch":
        m.add(
            law=hb.Zero(law="diode"),
            first=hb.One(),
            second=hb.One(),
            drive=hb.Se(to),
            one=hb.I(0.2, f=start),
            other=hb.I(own, f=start),
            drag=hb.R(load),
        )
        read = ("first.f", "second.f")
    else:
        m.add(
            drive=hb.Sf(to),
            first=hb.Zero(),
            one=hb.C(0.2, e=start),
            law=hb.One(law="diode"),
            other=hb.C(own, e=start),
            second=hb.Zero(),
            drag=hb.R(1.0 / load),
        )
        read = ("first.e", "second.e")
    drag = "drag -> second" if turned else "second -> drag"
    m.bond(drag, *way, "second -> other", "first -> one", "drive -> first")
    m.signal(ref=ref)
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules(read[0]))
    return m, *read


def by_hand(t: np.ndarray, own: float, load: float) -> np.ndarray:
    """Pushed while that takes a push, then alone until `3 sin(1.5 t)` has come up to it again."""
    push = lambda s: own * 4.5 * np.cos(1.5 * s) + load * 3 * np.sin(1.5 * s)  # noqa: E731
    lead = lambda s: 3 * np.sin(1.5 * s)  # noqa: E731
    off = brentq(push, np.pi / 3, 2 * np.pi / 3)
    alone = lambda s: lead(off) * np.exp(-(s - off) * load / own)  # noqa: E731
    on = brentq(lambda s: lead(s) - alone(s), np.pi * 4 / 3, np.pi * 5 / 3)
    return np.where((t < off) | (t > on), lead(t), alone(t))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("form", ["clutch", "valve"])
@pytest.mark.parametrize(("own", "load", "turned"), [(0.5, 0.2, False), (0.3, 0.4, True)])
def test_what_is_pushed_runs_on_alone_and_is_caught_up_with(
    form: str, own: float, load: float, turned: bool, solver: str
) -> None:
    model, first, second = pushed(form, own, load, turned=turned)
    run = hb.simulate(model, until=5.2, solver=solver)
    t = np.linspace(0.05, 5.15, 60)
    assert run.status == "ok" and run.audit().holds()
    assert run[first].at(t) == pytest.approx(3 * np.sin(1.5 * t), abs=1e-9)
    assert run[second].at(t) == pytest.approx(by_hand(t, own, load), abs=1e-6)
    carried = run["law.e" if form == "clutch" else "law.f"].at(t)
    assert np.min(carried) >= -1e-9 and np.max(carried) > 1.0
    # it has let go of what it pushed between
    assert carried[(t > 1.7) & (t < 4.0)] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("form", ["clutch", "valve"])
@pytest.mark.parametrize(("own", "load", "turned"), [(0.5, 0.2, False), (0.3, 0.4, True)])
def test_a_run_taken_up_just_after_a_law_let_go_goes_on_without_it(
    form: str, own: float, load: float, turned: bool, solver: str
) -> None:
    push = lambda s: own * 4.5 * np.cos(1.5 * s) + load * 3 * np.sin(1.5 * s)  # noqa: E731
    off = brentq(push, np.pi / 3, 2 * np.pi / 3)
    t = np.linspace(2.0, 2.9, 10)
    whole = hb.simulate(pushed(form, own, load, turned=turned)[0], until=3.0, solver=solver)
    for late in (1e-9, 1e-7, 1e-6, 3e-6, 1e-4):
        model, first, second = pushed(form, own, load, turned=turned)
        cut = hb.simulate(model, until=float(off + late), solver=solver)
        for state in (cut.state(), whole.state(float(off + late))):
            run = hb.simulate(model, until=3.0, start=state, solver=solver)
            assert run.status == "ok" and run.audit().holds()
            assert run[first].at(t) == pytest.approx(3 * np.sin(1.5 * t), abs=1e-9)
            assert run[second].at(t) == pytest.approx(by_hand(t, own, load), abs=1e-6)


def test_a_state_of_a_motion_along_a_surface_is_saved_and_read(tmp_path: Path) -> None:
    model, first, second = pushed("clutch")
    hb.simulate(model, until=1.3).state().save(tmp_path / "state.json")
    run = hb.simulate(model, until=3.0, start=hb.load_state(tmp_path / "state.json"))
    t = np.linspace(1.4, 2.9, 10)
    assert run[first].at(t) == pytest.approx(3 * np.sin(1.5 * t), abs=1e-9)
    assert run[second].at(t) == pytest.approx(by_hand(t, 0.5, 0.2), abs=1e-6)
    text = (tmp_path / "state.json").read_text()
    state = json.loads(text)
    state["memory"]["places"][6] = 7
    (tmp_path / "state.json").write_text(json.dumps(state))
    with pytest.raises(hb.UsageError, match="HB-S134"):
        hb.simulate(model, until=3.0, start=hb.load_state(tmp_path / "state.json"))


def test_a_switch_in_a_thin_band_says_the_same() -> None:
    """By hand, in no time of hybond's: Euler's method with a band of 1e-3."""
    w1, w2, on, h = 0.0, 0.0, True, 2e-6
    for k in range(int(1.8 / h)):
        ref = 3 * np.sin(1.5 * k * h)
        on = w1 < ref + 1e-3 if on else w1 < ref - 1e-3
        force = 40.0 if on else -20.0
        push = max(0.0, (force * 0.5 + 0.2 * w2 * 0.2) / 0.7) if w1 >= w2 else 0.0
        w1 += h * (force - push) / 0.2
        w2 += h * (push - 0.2 * w2) / 0.5
        if push > 0.0:
            w1 = w2 = (0.2 * w1 + 0.5 * w2) / 0.7
    model, _, second = pushed("clutch")
    assert hb.simulate(model, until=1.8)[second].at(1.8) == pytest.approx(w2, abs=5e-3)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("form", ["clutch", "valve"])
@pytest.mark.parametrize(("back", "ref"), [(False, "2 - 1.5*time"), (True, "2 + 1.5*time")])
def test_what_is_led_away_from_is_left_alone_from_the_start(
    form: str, back: bool, ref: str, solver: str
) -> None:
    """A law that leads back holds what would be left: it pulls the second along with no push."""
    model, first, second = pushed(form, ref=ref, start=2.0, back=back)
    run = hb.simulate(model, until=1.0, solver=solver)
    t = np.linspace(0.05, 0.95, 20)
    assert run[first].at(t) == pytest.approx(2 + (1.5 if back else -1.5) * t, abs=1e-9)
    assert run[second].at(t) == pytest.approx(2 * np.exp(-0.4 * t), abs=1e-6)


@pytest.mark.parametrize("solver", ["auto", "rk45"])
def test_a_law_closed_in_both_modes_lets_go_as_well(solver: str) -> None:
    """The drive never brakes; what is led has a load of its own."""
    model, first, second = pushed("clutch", ref="3 - 2*time^2/(1 + time)", start=3.0, low=-0.4)
    model.add(drum=hb.R(1.5))
    model.bond("first -> drum")
    run = hb.simulate(model, until=1.2, solver=solver)
    lead = lambda s: 3 - 2 * s**2 / (1 + s)  # noqa: E731
    slope = lambda s: -2 * (2 * s + s**2) / (1 + s) ** 2  # noqa: E731
    off = brentq(lambda s: 0.5 * slope(s) + 0.2 * lead(s), 0.01, 1.0)
    t = np.linspace(0.02, 1.18, 40)
    right = np.where(t < off, lead(t), lead(off) * np.exp(-0.4 * (t - off)))
    assert run[first].at(t) == pytest.approx(lead(t), abs=1e-8)
    assert run[second].at(t) == pytest.approx(right, abs=1e-6)


def three(form: str, pairs: list[tuple[int, int]], *, reverse: bool) -> tuple[hb.Model, str]:
    """Return three bodies, the first led by a relay, and one-way laws between pairs of them."""
    m = hb.Model("three")
    to = 'if q.state == "on" then 60 else -60'
    clutch = form == "clutch"
    parts: dict[str, hb.Part] = {"drive": hb.Se(to) if clutch else hb.Sf(to)}
    bonds = ["drive -> n0"]
    for k, (own, load) in enumerate([(0.2, 0.1), (0.5, 0.2), (0.3, 0.35)]):
        parts[f"n{k}"] = hb.One() if clutch else hb.Zero()
        parts[f"s{k}"] = hb.I(own) if clutch else hb.C(own)
        parts[f"r{k}"] = hb.R(load) if clutch else hb.R(1 / load)
        bonds += [f"n{k} -> s{k}", f"n{k} -> r{k}"]
    for k, (a, b) in enumerate(pairs):
        parts[f"law{k}"] = hb.Zero(law="diode") if clutch else hb.One(law="diode")
        bonds += [f"n{a} -> law{k}", f"law{k} -> n{b}"]
    if reverse:
        parts = dict(reversed(parts.items()))
        bonds.reverse()
    m.add(**parts)
    m.bond(*bonds)
    of = "f" if clutch else "e"
    m.signal(ref=LEADS)
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules(f"n0.{of}"))
    return m, of


def bodies(pairs: list[tuple[int, int]], t: np.ndarray) -> np.ndarray:
    """Integrate two bodies beside the one that is led, pushed by springs of 1e6 that only push."""
    own, load = np.array([0.5, 0.3]), np.array([0.2, 0.35])

    def rate(s: float, w: np.ndarray) -> np.ndarray:
        all_of = np.array([3 * np.sin(1.5 * s), *w])
        force = np.array([0.0, *(-load * w)])
        for a, b in pairs:
            push = 1e5 * max(0.0, all_of[a] - all_of[b])
            force[a] -= push
            force[b] += push
        return force[1:] / own

    found = solve_ivp(rate, (0, t[-1]), [0.0, 0.0], "LSODA", t_eval=t, rtol=1e-9, atol=1e-11)
    return found.y


@pytest.mark.parametrize("form", ["clutch", "valve"])
@pytest.mark.parametrize("pairs", [[(0, 1), (0, 2)], [(0, 1), (1, 2)], [(0, 1), (2, 1)]])
def test_of_several_laws_each_lets_go_on_its_own(form: str, pairs: list[tuple[int, int]]) -> None:
    t = np.linspace(0.05, 2.0, 40)
    right = bodies(pairs, t)
    for solver, reverse in (("auto", False), ("radau", True)):
        model, of = three(form, pairs, reverse=reverse)
        run = hb.simulate(model, until=2.05, solver=solver)
        assert run.status == "ok" and run.audit().holds()
        assert run[f"n1.{of}"].at(t) == pytest.approx(right[0], abs=1e-4)
        assert run[f"n2.{of}"].at(t) == pytest.approx(right[1], abs=1e-4)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_contact_that_is_led_away_from_opens_its_gap(solver: str) -> None:
    m = hb.Model("contact")
    m.add(
        drive=hb.Se('if q.state == "on" then 40 else -20'),
        v1=hb.One(),
        v2=hb.One(),
        car=hb.I(0.2),
        block=hb.I(0.5),
        air=hb.R(0.2),
        touch=hb.Zero(law="unilateral", gap="x2 - x1"),
    )
    m.bond("drive -> v1 -> car", "v1 -> touch -> v2 -> block", "v2 -> air")
    m.signal(ref=LEADS, x1=hb.Integral("v1.f"), x2=hb.Integral("v2.f"))
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules("v1.f"))
    run = hb.simulate(m, until=2.5, solver=solver)
    t = np.linspace(0.05, 2.45, 40)
    assert run["v2.f"].at(t) == pytest.approx(by_hand(t, 0.5, 0.2), abs=1e-6)


def test_a_run_whose_law_pulls_on_the_mean_is_unsound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever lets a law pull, the audit sees it."""
    watch = watching.watch_slide

    def blind(e: object, g: object) -> None:
        s = e.slide  # type: ignore[attr-defined]
        kept = list(s.reached)
        for k in range(len(kept)):
            s.reached[k] = 0
        watch(e, g)  # type: ignore[arg-type]
        for k, reached in enumerate(kept):
            s.reached[k] = reached

    monkeypatch.setattr(watching, "watch_slide", blind)
    model, *_ = pushed("clutch")
    with pytest.raises(hb.HybondError, match="HB-N411 at law") as refused:
        hb.simulate(model, until=1.6, engine="python")
    run = refused.value.partial
    assert run.status == "unsound"
    assert [law.place for law in run.audit().laws] == ["law"]
    assert "mean of fast switching" in str(refused.value)


def test_a_law_for_which_no_way_on_is_found_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(by_means, "MOST", 0)
    model, *_ = pushed("clutch")
    with pytest.raises(hb.HybondError, match=r"HB-N417 at law: .* along first\.f = ref") as refused:
        hb.simulate(model, until=1.6, engine="python")
    assert 'sliding = "hysteresis"' in str(refused.value)
