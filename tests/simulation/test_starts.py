"""Where runs start: states of other runs, files, values by name."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import hybond as hb

G = 9.81


def ball(mass: str = "1 kg", *, floor: bool = True) -> hb.Model:
    m = hb.Model("ball", domain="translational", parameters={"m": mass, "g": "9.81 m/s^2"})
    m.add(mass=hb.I("m"), weight=hb.Se("m*g"), v=hb.One())
    m.bond("v -> mass", "v -> weight")
    m.signal(height=hb.Integral("v.f", start="2 m"))
    if floor:
        states: dict[str, list[str]] = {"flying": [], "under": []}
        rules = ["flying -> under when height < 0"]
        m.machine("floor", states=states, start="flying", rules=rules)
    return m


def test_values_by_name_are_a_start() -> None:
    run = hb.simulate(ball(floor=False), "0.5 s", start={"mass.f": "3 m/s", "height": "1 m"})
    assert run.final["height"] == pytest.approx(1.0 + 3.0 * 0.5 - 0.5 * G * 0.25, rel=1e-12)
    assert run.events[0].cause == "start"
    momentum = hb.simulate(ball(floor=False), "0.5 s", start={"mass.p": 3.0, "height": 1.0})
    assert momentum.final == pytest.approx(run.final, rel=1e-15)


def test_time_and_mode_are_part_of_a_start() -> None:
    run = hb.simulate(ball(), "2 s", start={"time": "1.5 s", "floor": "under"})
    assert (run.t_begin, run.mode["floor"]) == (1.5, "under")
    assert run.final["height"] == pytest.approx(2.0 - 0.5 * G * 0.25, rel=1e-12)


def test_a_state_within_a_run_is_a_start() -> None:
    # thrown up at 5 m/s: the second half by itself is a parabola from the middle on
    whole = hb.simulate(ball(floor=False), "1 s", start={"mass.f": 5.0})
    state = whole.state("400 ms")
    assert state.stored["mass.p"] == pytest.approx(5.0 - G * 0.4, rel=1e-12)
    run = hb.simulate(ball(floor=False), "1 s", start=state)
    assert run.t_begin == 0.4
    assert run.final["height"] == pytest.approx(2.0 + 5.0 - 0.5 * G, rel=1e-11)


def test_another_model_has_the_state_and_its_own_parameters() -> None:
    first = hb.simulate(ball("1 kg", floor=False), "1 s", start={"mass.f": 5.0})
    heavier = hb.simulate(ball("2 kg", floor=False), "2 s", start=first)
    # the momentum is what is kept: half the velocity
    v = 0.5 * (5.0 - G)
    h = 2.0 + 5.0 - 0.5 * G
    assert heavier.events[0].cause == "start"
    assert heavier.final["height"] == pytest.approx(h + v - 0.5 * G, rel=1e-11)
    parameters = hb.simulate(
        ball("1 kg", floor=False), "2 s", start=first, parameters={"m": "2 kg"}
    )
    assert parameters.final == pytest.approx(heavier.final, rel=1e-14)


def test_a_state_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    run = hb.simulate(hb.load("examples/bouncing_ball_newton.toml"), "1 s")
    run.state().save(tmp_path / "state.json")
    again = hb.load_state(tmp_path / "state.json")
    assert again == run.state()
    a, b = (hb.simulate(hb.load("examples/bouncing_ball_newton.toml"), "2 s", start=s)
            for s in (run, tmp_path / "state.json"))  # fmt: skip
    assert a.final == b.final
    assert a.t_begin == 1.0


HALF = {"eps": 0.5}
"""Of restitution: it is at rest after three times its first fall, 1 + 2 eps/(1 - eps)."""


def resting() -> tuple[hb.Model, hb.Result]:
    model = hb.load("examples/bouncing_ball_newton.toml")
    run = hb.simulate(model, "4 s", parameters=HALF)
    fall = math.sqrt(2.0 * model.flatten().parameters["h0"] / G)
    assert run.accumulations[0].t == pytest.approx(3.0 * fall, rel=1e-9)
    return model, run


@pytest.mark.parametrize("t", [1.0, 2.0, 2.345, 3.0])
def test_impacts_accumulate_over_a_cut(t: float) -> None:
    model, whole = resting()
    first = hb.simulate(model, t, parameters=HALF)
    second = hb.simulate(model, "4 s", parameters=HALF, start=first)
    both = [*first.accumulations, *second.accumulations]
    assert len(first.events) + len(second.events) == len(whole.events)
    assert [(a.machine, a.events) for a in both] == [("floor", whole.accumulations[0].events)]
    assert both[0].t == pytest.approx(whole.accumulations[0].t, rel=1e-12)
    assert second.final == pytest.approx(
        {"ball.p": 0, "ball.f": 0, "height": 0, "v.f": 0}, abs=1e-15
    )


def test_a_landed_ball_lies_still_from_a_state_within_a_run() -> None:
    model, whole = resting()
    state = whole.state(3.5)
    assert state.landed == ("floor",)
    assert "at rest" in str(state)
    run = hb.simulate(model, "4 s", parameters=HALF, start=state)
    assert len(run.events) == 0
    assert run.final == pytest.approx(whole.final, abs=1e-15)


def test_a_landed_ball_rises_when_a_step_turns_gravity_round() -> None:
    # it is no start: the ball leaves the floor by what it carries, and rises by t^2/2
    model, _ = resting()
    up = hb.Step(lasts=0.5, set={"g": "-1 m/s^2"})
    run = hb.run_script(model, [hb.Step(until=3.0), up], parameters=HALF)
    assert run.mode == {"floor": "away"}
    assert run.final["height"] == pytest.approx(0.125, rel=1e-12)


@pytest.mark.parametrize(
    ("start", "code", "words"),
    [
        ({"mass.q": 1.0}, "HB-S134", "mass.p"),
        ({"hieght": 1.0}, "HB-S134", "height"),
        ({"height": "1 kg"}, "HB-S134", "measured in kg"),
        ({"floor": "flyng"}, "HB-S134", "flying"),
        ({"height": math.nan}, "HB-S134", "not finite"),
        ({"time": "3 s"}, "HB-S133", "ends at 2"),
        (7, "HB-S134", "no run"),
        ("nowhere.json", "HB-S135", "cannot be read"),
    ],
)
def test_what_is_no_start_is_refused(start: object, code: str, words: str) -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.simulate(ball(), "2 s", start=start)  # type: ignore[arg-type]
    assert error.value.code == code
    assert words in str(error.value)


def test_a_state_of_a_model_with_other_parts_is_refused_by_name() -> None:
    other = hb.Model("rc", domain="electrical")
    other.add(c=hb.C("1 mF", e="1 V"), r=hb.R("1 kohm"), n=hb.Zero())
    other.bond("n -> c", "n -> r")
    run = hb.simulate(other, "1 s")
    with pytest.raises(hb.UsageError, match=r"the model has no 'c\.q'"):
        hb.simulate(ball(), "2 s", start=run)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda r: r.update(format="hybond state 9"),
        lambda r: r["stored"].update({"ball.p": "much"}),
        lambda r: r["memory"].update(places=[2**40]),
        lambda r: r["memory"].update(places=[10**6] * len(r["memory"]["places"])),
        lambda r: r["memory"]["numbers"].pop(),
        lambda r: r["memory"]["numbers"].__setitem__(0, "nan"),
    ],
)
def test_a_file_that_no_run_has_written_is_refused(tmp_path: Path, spoil: object) -> None:
    model = hb.load("examples/bouncing_ball_newton.toml")
    record = json.loads(hb.simulate(model, "1 s").state().to_json())
    spoil(record)  # type: ignore[operator]
    path = tmp_path / "state.json"
    path.write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(hb.UsageError) as error:
        hb.simulate(model, "2 s", start=path)
    assert error.value.code in ("HB-S134", "HB-S135")


def crank(law: hb.C | None = None, *, turned: bool = False) -> hb.Model:
    """A piston that follows its crank: what it stores is tied to what the crank stores."""
    m = hb.Model("crank", domain="rotational", parameters={"r": "40 mm", "l": "120 mm"})
    m.add(T=hb.Se("2 N*m"), w=hb.One(), fly=hb.I("0.02 kg*m^2", f="30 rad/s"))
    m.add(rod=hb.TF("r*sin(phi)*(1 + r*cos(phi)/sqrt(l^2 - r^2*sin(phi)^2))"))
    m.add(v=hb.One(domain="translational"), piston=hb.I("0.4 kg", domain="translational"))
    m.bond("T -> w -> fly", "w -> rod -> v", "piston -> v" if turned else "v -> piston")
    if law is not None:
        m.add(gas=law)
        m.bond("v -> gas")
    m.signal(phi=hb.Integral("w.f", start=0.5))
    return m


@pytest.mark.parametrize(
    "model",
    [
        crank(),
        crank(turned=True),
        crank(hb.C({"e": "300 [N]*((100 [mm])/(100 [mm] - q) - 1)"}, domain="translational")),
    ],
    ids=["idle", "turned", "gas"],
)
def test_a_state_within_a_step_keeps_what_its_mode_ties_together(model: hb.Model) -> None:
    run = hb.simulate(model, "0.5 s")
    state = run.state("0.37 s")
    stored = {**state.stored, **state.signals}
    assert stored == {name: run[name].at(0.37) for name in stored}
    phi, w = state.signals["phi"], state.stored["fly.p"] / 0.02
    ratio = 0.04 * math.sin(phi)
    ratio *= 1 + 0.04 * math.cos(phi) / math.sqrt(0.12**2 - (0.04 * math.sin(phi)) ** 2)
    speed = abs(state.stored["piston.p"]) / 0.4
    assert speed == pytest.approx(abs(ratio * w), rel=1e-14)
    again = hb.simulate(model, "0.5 s", start=state)
    for name, value in run.final.items():
        assert again.final[name] == pytest.approx(value, rel=1e-6), name
