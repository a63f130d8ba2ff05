"""Two engines on one model: published circuits agree, laws that differ are told from mistakes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
import hybond.analysis.cross.check as module
from hybond.analysis.cross.reasons import uniqueness
from hybond.errors import UsageError

EXAMPLES = Path(__file__).parents[2] / "examples"


def rlcd() -> hb.Model:
    m = hb.Model("rlcd", domain="electrical")
    m.add(
        c=hb.C("1 uF", e="10 V"), l=hb.I("10 mH"), r=hb.R("1 kohm"), d=hb.One(law="diode"),
        n=hb.Zero(),
    )  # fmt: skip
    m.bond("n -> c", "n -> l", "n -> d -> r")
    return m


def ball(eps: float = 0.9) -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(
        weight=hb.Se("-9.81 N"), ball=hb.I("1 kg"), v=hb.One(), floor=hb.Sf(0.0),
        contact=hb.Zero(law="unilateral", gap="height", restitution=eps),
    )  # fmt: skip
    m.bond("weight -> v -> ball", "floor -> contact -> v")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    return m


def balls(apart: float = 0.0) -> hb.Model:
    """One ball runs into two at rest; elastic."""
    m = hb.Model("balls", domain="translational")
    for k, (v, x) in enumerate(((1.0, -0.1), (0.0, 0.0), (0.0, apart)), start=1):
        m.add(**{f"m{k}": hb.I(1.0, f=v), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=x)})
    for k in (1, 2):
        law = hb.Zero(law="unilateral", gap=f"x{k + 1} - x{k}", restitution=1.0)
        m.add(**{f"c{k}": law})
        m.bond(f"v{k} -> c{k} -> v{k + 1}")
    return m


@pytest.mark.slow
def test_the_diode_circuit_agrees_with_order_one() -> None:
    found = hb.cross_check(rlcd(), "3 ms", step="5 us")
    assert found.engines == ("auto", "moreau-jean")
    assert found.verdict == "agree" and found.agrees
    assert [v.value for v in found.levels] == pytest.approx([5e-6, 2.5e-6, 1.25e-6])
    assert found.levels[-1].order == pytest.approx(1.0, abs=0.2)
    e = found.events
    assert (e.first, e.second, e.paired, e.parted) == (10, 10, 10, None)
    # an event lies in its step, or the next one
    assert e.apart < 1.25e-6
    # the discharge through the diode: what l and w of its law add up to is compared as well
    assert {d.quantity.name for d in found.differences} == {"c.q", "l.p", "d.f", "d.e"}
    assert not found.reasons and not found.shares


@pytest.mark.slow
def test_what_a_law_adds_up_to_is_the_charge_that_went_through() -> None:
    """Charge and flux of the diode's law, from the balance of the circuit, in both engines."""
    graph = module.watched(rlcd().flatten())
    for options in ({}, {"solver": "moreau-jean", "step": 2e-6, "theta": 1.0}):
        run = hb.simulate(graph, "3 ms", **options)
        y = run.segments[-1].y[-1]
        names = [q.name for q in module.quantities(rlcd().flatten(), run)]
        charge, drop = y[names.index("d.f")], y[names.index("d.e")]
        q, p = y[names.index("c.q")], y[names.index("l.p")]
        # C e: e integrates to the flux p; the resistor takes R times the charge, the diode the rest
        assert p == pytest.approx(1e3 * charge + drop, rel=1e-3, abs=1e-9)
        assert drop < 0.0 < charge < 2 * 1e-5
        assert abs(q) < 1e-5


@pytest.mark.slow
def test_the_bridge_agrees_though_its_shares_do_not_count() -> None:
    found = hb.cross_check(hb.load(EXAMPLES / "diode_bridge.toml"), "1 ms", step="5 us")
    assert found.verdict == "agree"
    assert found.events.first == found.events.second == found.events.paired > 0
    assert {d.quantity.machine for d in found.shares} == {"d1", "d2", "d3", "d4"}
    assert max(d.mean for d in found.shares) < 1e-2


def test_shares_are_those_that_a_circuit_leaves_open() -> None:
    m = hb.Model("two", domain="electrical")
    m.add(u=hb.Se(5.0), l=hb.I(1.0), a=hb.One(), n=hb.Zero(), r=hb.R(1.0))
    m.add(d1=hb.One(law="diode"), d2=hb.One(law="diode"), d3=hb.One(law="diode"), p=hb.Zero())
    m.bond("u -> a -> n", "a -> l", "n -> d1 -> p", "n -> d2 -> p", "p -> d3 -> r")
    found = uniqueness(m.flatten(), [m.flatten().start_mode])
    # two diodes in parallel share a current; the third carries all of it
    assert not found.several
    assert {("d1", "common"), ("d2", "common")} <= found.shares
    assert ("d3", "common") not in found.shares


@pytest.mark.slow
def test_a_bouncing_ball_agrees() -> None:
    found = hb.cross_check(ball(), 2.0, step="2 ms")
    assert found.verdict == "agree"
    fall = math.sqrt(2 / 9.81)
    assert found.events.first == 3 and found.events.paired == 3 and 2 * 0.9 * fall < 2.0
    # at half the step half the error, but for where in its step the impact falls
    assert found.levels[-1].mean < 0.25 * found.levels[0].mean
    assert not found.reasons


@pytest.mark.slow
def test_balls_that_touch_differ_legitimately() -> None:
    found = hb.cross_check(balls(), 0.3, step="1 ms")
    assert found.verdict == "differ legitimately"
    assert [r.name for r in found.reasons if r.since < 0.11] == ["simultaneous impacts"]
    assert found.reasons[0].since == pytest.approx(0.1, abs=1e-3)
    # (0, 0, 1) one after another, (-1/3, 2/3, 2/3) all at once, for two thirds of the run
    mean = {d.quantity.name: d.mean for d in found.differences}
    assert mean["m2.p"] == pytest.approx(2 / 3, rel=0.01)
    assert [mean["m1.p"], mean["m3.p"]] == pytest.approx([2 / 9, 2 / 9], rel=0.01)
    assert found.events.machine == "c2"


@pytest.mark.slow
def test_one_ball_after_another_agrees() -> None:
    found = hb.cross_check(balls(apart=0.05), 0.3, step="1 ms")
    assert found.verdict == "agree"
    assert "simultaneous impacts" not in [r.name for r in found.reasons]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("model", [rlcd, ball], ids=["rlcd", "ball"])
def test_an_engine_that_is_wrong_is_found(model: object, monkeypatch: pytest.MonkeyPatch) -> None:
    end = {rlcd: 2e-3, ball: 1.0}[model]
    made = module.simulate

    def wrong(graph, until, **options):
        """Let time-stepping lose a twentieth of everything after a fifth of the run."""
        run = made(graph, until, **options)
        if options["solver"] == "moreau-jean":
            run.segments = tuple(
                replace(s, y=np.where(s.t[:, None] > 0.2 * end, 0.95, 1.0) * s.y)
                for s in run.segments
            )
        return run

    monkeypatch.setattr(module, "simulate", wrong)
    found = hb.cross_check(model(), end, step=end / 400)
    assert found.verdict == "differ" and not found.agrees
    # as large as it was made, whatever the step, from where it begins
    assert 0.01 < found.levels[-1].mean < 0.05
    assert 0.2 * end <= found.differences[0].time <= end
    assert min(d.since for d in found.differences if d.since) >= 0.195 * end


@pytest.mark.slow
def test_an_impact_law_that_is_wrong_is_not_excused_by_a_later_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Balls that touch excuse nothing that goes wrong before they are hit."""
    made = module.simulate

    def wrong(graph, until, **options):
        run = made(graph, until, **options)
        if options["solver"] == "moreau-jean":
            run.segments = tuple(
                replace(s, y=np.where(s.t[:, None] > 0.02, 0.9, 1.0) * s.y) for s in run.segments
            )
        return run

    monkeypatch.setattr(module, "simulate", wrong)
    found = hb.cross_check(balls(), 0.3, step="1 ms")
    assert found.verdict == "differ"
    assert found.reasons[0].name == "simultaneous impacts"


@pytest.mark.slow
def test_where_small_errors_grow_nothing_is_called_wrong() -> None:
    """A mass between two stops, driven: impacts part neighbouring motions ever further."""
    found = hb.cross_check(hb.load(EXAMPLES / "end_stops.toml"), 1.2, step="5 ms")
    since = [level.since for level in found.levels]
    assert found.verdict in ("undecided", "agree")
    assert since[0] is not None and (since[-1] is None or since[-1] > 2 * since[0])


@pytest.mark.slow
def test_a_run_that_stops_early_is_a_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    made = module.simulate

    def stops(graph, until, **options):
        run = made(graph, 1.0 if options["solver"] == "moreau-jean" else until, **options)
        if options["solver"] == "moreau-jean":
            run.error = hb.NumericsError("gave up", code="HB-N201")
        return run

    monkeypatch.setattr(module, "simulate", stops)
    found = hb.cross_check(ball(), 2.0, step="1 ms")
    assert found.verdict == "differ" and "gave up" in found.why


def test_without_laws_the_tolerance_is_refined() -> None:
    found = hb.cross_check(hb.load(EXAMPLES / "clutch.toml"))
    assert (found.engines, found.refined, found.verdict) == (("auto", "radau"), "rtol", "agree")
    assert [v.value for v in found.levels] == pytest.approx([1e-4, 1e-6, 1e-8])
    means = [v.mean for v in found.levels]
    assert means[0] > 10 * means[1] > 100 * means[2]
    assert found.events.parted is None and "no junction has a law" in found.chosen


def test_a_stiff_model_is_checked_by_the_solver_that_runs_take_and_says_where_both_are_one() -> (
    None
):
    """Explicit steps of a nanosecond would fill the memory before they end."""
    m = hb.Model("stiff", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("1 ohm"), c=hb.C("1 nF"), n=hb.Zero())
    m.add(leak=hb.R({"f": "1e-3*e + 1e-3*e^3"}))
    m.bond("V -> i -> n -> c", "i -> r", "n -> leak")
    found = hb.cross_check(m, "1 s")
    assert found.engines == ("auto", "radau") and found.verdict == "agree"
    assert "auto went over to radau, too, at t = " in found.chosen


@pytest.mark.slow
def test_engines_as_given_and_the_models_own() -> None:
    m = ball()
    m.experiment["solver"] = "moreau-jean"
    m.experiment["step"] = "2 ms"
    found = hb.cross_check(m, 0.6)
    assert found.engines == ("moreau-jean", "rk45") and found.levels[0].value == 2e-3
    found = hb.cross_check(rlcd(), "1 ms", engines=["rk45", "qss3"], rtol=1e-7)
    assert found.refined == "rtol" and found.verdict == "agree"


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"engines": ["rk45"]}, "HB-A401"),
        ({"engines": ["rk45", "rk45"]}, "HB-A401"),
        ({"engines": ["rk45", "moreau"]}, "HB-A401"),
        ({"levels": 1}, "HB-A401"),
        ({"step": "1 kg"}, "HB-S106"),
        ({"until": None}, "HB-S106"),
    ],
)
def test_what_cannot_be_compared_is_refused(options: dict, code: str) -> None:
    with pytest.raises(UsageError) as refused:
        hb.cross_check(ball(), **{"until": 1.0, **options})
    assert refused.value.code == code


@pytest.mark.slow
def test_data_and_text_say_the_same() -> None:
    found = hb.cross_check(ball(), 1.0, step="2 ms")
    data = found.to_data()
    assert data["verdict"] == found.verdict == "agree"
    assert [d["name"] for d in data["differences"]][:4] == [
        d.quantity.name for d in found.differences
    ]
    text = str(found)
    assert text.splitlines()[-1].startswith("agree: ")
    assert "1 and 1 events of machines, 1 alike and in order" in text
    assert f"{data['levels'][-1]['mean']:.3g}" in text
