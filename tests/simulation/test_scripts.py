"""Scripts of steps, as on a test rig."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.draw.plots import plot_run


def charging(**inputs: object) -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"V": "10 V", "R0": "1 kohm"})
    m.add(U=hb.Se("u" if inputs else "V"), R=hb.R("R0"), C=hb.C("1 mF"), i=hb.One())
    m.bond("U -> i -> R", "i -> C")
    m.signal(drop="V - C.e")
    if inputs:
        m.input(**inputs)  # type: ignore[arg-type]
    return m


def test_each_step_has_what_it_sets() -> None:
    run = hb.run_script(
        charging(),
        [
            hb.Step(until="C.e > 8 V", label="charge"),
            hb.Step(lasts="1 s", set={"V": "8 V"}, label="rest"),
            hb.Step(until="5 s", set={"V": "0 V", "R0": "2 kohm"}, label="empty"),
        ],
        limit="10 s",
        rtol=1e-12,
    )
    t = math.log(5.0)
    assert [s.ended_by for s in run.steps] == ["C.e > 8 V", "time", "time"]
    assert [s.t1 for s in run.steps] == pytest.approx([t, t + 1.0, 5.0], abs=1e-9)
    times = [0.5 * t, t + 0.5, 4.0, 5.0]
    expected = [10.0 * (1.0 - math.exp(-0.5 * t)), 8.0]
    expected += [8.0 * math.exp(-(s - t - 1.0) / 2.0) for s in (4.0, 5.0)]
    np.testing.assert_allclose(run["C.e"].at(times), expected, rtol=1e-9)
    # what reads a parameter reads that of its step
    np.testing.assert_allclose(
        run["drop"].at(times), np.array([10.0, 8.0, 0.0, 0.0]) - expected, rtol=1e-9, atol=1e-9
    )
    assert run.audit().holds()


def test_a_script_is_the_run_with_the_same_input_as_a_table() -> None:
    levels = [(0.0, 10.0), (0.5, 4.0), (1.0, 7.0), (1.5, -2.0), (2.5, 0.0)]
    table = charging(u=hb.Input(table=levels))
    whole = hb.simulate(table, "3 s", rtol=1e-13)
    script = [hb.Step(until=t, set={"V": f"{v} V"}) for (_, v), t in
              zip(levels, [0.5, 1.0, 1.5, 2.5, 3.0], strict=True)]  # fmt: skip
    run = hb.run_script(charging(), script, rtol=1e-13)
    times = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(run["C.e"].at(times), whole["C.e"].at(times), rtol=0, atol=1e-12)


def test_inputs_and_values_of_elements_are_set_as_well() -> None:
    m = charging(u=hb.Input(constant="10 V"))
    run = hb.run_script(
        m, [hb.Step(lasts=1.0), hb.Step(lasts=1.0, set={"u": "0 V", "C.C": "2 mF"})]
    )
    # the charge is kept: half the voltage, and twice the time constant
    start = 5.0 * (1.0 - math.exp(-1.0))
    assert run.final["C.e"] == pytest.approx(start * math.exp(-0.5), rel=1e-10)
    assert run["C.e"].at(1.0, side="left") == pytest.approx(2.0 * start, rel=1e-10)
    assert run["C.e"].at(1.0) == pytest.approx(start, rel=1e-10)


def test_steps_are_repeated_and_marked() -> None:
    pulse = hb.Step(
        repeat=3,
        label="pulse",
        steps=[hb.Step(lasts="0.1 s"), hb.Step(lasts="0.2 s", label="rest")],
    )
    run = hb.run_script(charging(), [pulse])
    assert [s.label for s in run.steps] == ["pulse", "rest"] * 3
    assert run.t_end == pytest.approx(0.9, abs=1e-15)
    begins = [0.0, 0.1, 0.3, 0.4, 0.6, 0.7]
    assert [t for t, _ in run.marks] == pytest.approx(begins, abs=1e-15)
    labelled = [(e.t, e.label) for e in run.events if e.label]
    assert labelled == list(run.marks)
    # nothing was set: it is one charge
    assert run.final["C.e"] == pytest.approx(10.0 * (1.0 - math.exp(-0.9)), rel=1e-12)


def test_a_change_that_makes_a_guard_hold_is_settled_at_once() -> None:
    m = hb.Model("relay", domain="electrical", parameters={"V": "1 V", "most": "5 V"})
    m.add(U=hb.Se("V"), R=hb.R("1 ohm"), C=hb.C("1 F"), s=hb.One())
    m.bond("U -> s -> R", "s -> C")
    states: dict[str, list[str]] = {"on": ["s"], "off": []}
    m.machine("switch", states=states, start="on", rules=["on -> off when V > most"])
    run = hb.run_script(m, [hb.Step(lasts=1.0), hb.Step(lasts=1.0, set={"V": "9 V"})])
    change = next(e for e in run.events if e.cause == "change")
    assert (change.t, run.mode["switch"]) == (1.0, "off")
    assert change.steps[-1].fired[0].machine == "switch"
    assert run.final["C.e"] == pytest.approx(1.0 - math.exp(-1.0), rel=1e-10)


def test_a_script_stops_where_a_condition_has_no_time_left() -> None:
    run = hb.run_script(
        charging(), [hb.Step(until="C.e > 20 V", label="never"), hb.Step(lasts=1)], limit=2.0
    )
    assert (run.t_end, len(run.steps), run.ended_by) == (2.0, 1, "time")
    assert any("never" in text and "did not hold" in text for text in run.warnings)


def test_a_script_goes_on_from_a_run_and_a_run_from_a_script() -> None:
    m = charging()
    first = hb.simulate(m, "1 s")
    script = hb.run_script(m, [hb.Step(lasts=0.5), hb.Step(lasts=0.5)], start=first, rtol=1e-12)
    last = hb.simulate(m, "3 s", start=script)
    assert (script.t_begin, last.t_begin) == (1.0, 2.0)
    assert last.final["C.e"] == pytest.approx(10.0 * (1.0 - math.exp(-3.0)), rel=1e-12)
    assert script.state(1.25).stored["C.q"] == pytest.approx(
        0.01 * (1.0 - math.exp(-1.25)), rel=1e-10
    )


@pytest.mark.parametrize(
    ("steps", "code"),
    [
        ([], "HB-S140"),
        ([{"lasts": "1 s", "lable": "a"}], "HB-S140"),
        ([hb.Step(label="no end")], "HB-S140"),
        ([hb.Step(lasts=1, repeat=0)], "HB-S140"),
        ([hb.Step(lasts=1, repeat=10**9)], "HB-S140"),
        ([hb.Step(lasts=1), hb.Step(until=0.5)], "HB-S140"),
        ([hb.Step(until=[1.0, "2 s"])], "HB-S140"),
        ([hb.Step(until="soon")], "HB-S106"),
        ([hb.Step(until="C.e > 1 V")], "HB-S132"),
        ([hb.Step(lasts=1, set={"W": "1 V"})], "HB-S141"),
        ([hb.Step(lasts=1, set={"C.q": "1 C"})], "HB-S141"),
        ([hb.Step(lasts=1, set={"V": "1 A"})], "HB-S141"),
    ],
)
def test_a_script_that_makes_no_sense_is_refused(steps: list[hb.Step], code: str) -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.run_script(charging(), steps)
    assert error.value.code == code, error.value


@pytest.mark.parametrize(
    ("options", "code", "where"),
    [
        ({"on_error": "ignore"}, "HB-S105", "on_error"),
        ({"parameters": ["V"]}, "HB-S130", "parameters"),
        ({"until": "3 s"}, "HB-S130", "run_script"),
        ({"keep": 3}, "HB-S130", "run_script"),
        ({"rtol": 2.0}, "HB-S107", "rtol"),
        ({"start": 3}, "HB-S134", "start"),
    ],
)
def test_a_call_that_does_not_fit_is_refused(
    options: dict[str, object], code: str, where: str
) -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.run_script(charging(), [hb.Step(lasts=1)], **options)  # type: ignore[arg-type]
    assert (error.value.code, error.value.where) == (code, where)


def test_a_flat_graph_has_nothing_that_a_script_can_set() -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.run_script(charging().flatten(), [hb.Step(lasts=1)])  # type: ignore[arg-type]
    assert (error.value.code, error.value.where) == ("HB-S130", "model")


def test_a_script_begins_with_a_state_in_a_file(tmp_path: Path) -> None:
    m, file = charging(), tmp_path / "state.json"
    hb.simulate(m, "10 s", rtol=1e-12).state("1 s").save(file)
    for start in (file, str(file)):
        run = hb.run_script(m, [hb.Step(lasts=0.5)], start=start, rtol=1e-12)
        assert (run.t_begin, run.t_end) == (1.0, 1.5)
        assert run.final["C.e"] == pytest.approx(10.0 * (1.0 - math.exp(-1.5)), rel=1e-10)


def test_labels_stand_in_the_table_and_in_the_picture(tmp_path: Path) -> None:
    run = hb.run_script(charging(), [hb.Step(lasts=1, label="up"), hb.Step(lasts=1, label="on")])
    assert "start: up" in str(run.events)
    assert "change: on" in str(run.events)
    figure = plot_run(run, ["C.e"], path=tmp_path / "script.svg")
    assert {t.get_text() for t in figure.axes[0].texts} >= {"up", "on"}
