"""``table(x, x0, y0, ...)`` in any expression: laws, signals, moduli, guards."""

import numpy as np
import pytest

import hybond as hb
from hybond.model.expressions import compile_expression, parse

X = [-2.0, -0.5, 1.0, 4.0]
Y = [3.0, -1.0, 0.25, 0.25]
TABLE = "table(x, " + ", ".join(f"{x}, {y}" for x, y in zip(X, Y, strict=True)) + ")"


def at(text, x):
    return compile_expression(parse(text), {"x": 0}, pre_offset=1)([x])


@pytest.mark.parametrize("x", [-7.0, -2.0, -1.3, -0.5, 0.0, 1.0, 2.5, 4.0, 1e9])
def test_it_joins_points_and_holds_its_ends(x):
    assert at(TABLE, x) == pytest.approx(np.interp(x, X, Y), abs=1e-15)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("table(x, 1, 2)", "two or more points"),
        ("table(x, 0, 1, 2)", "two or more points"),
        ("table(x, 0, 1, 1, 2, 2)", "two or more points"),
        ("table(x, 1, 1, 1, 2)", "do not ascend"),
        ("table(x, 1, 1, -1, 2)", "do not ascend"),
        ("table(x, a, 1, 2, 2)", "not at a number"),
        ("tabel(x, 0, 1, 1, 2)", "unknown function"),
    ],
)
def test_what_is_no_table_is_refused(text, says):
    with pytest.raises(hb.HybondError, match=says):
        parse(text)


def test_units_are_those_of_a_sum():
    good = "table(v.f, 0 [m/s], 1 [N], 2 [m/s], 5 [N])"
    bad = "table(v.f, 0 [m/s], 1 [N], 2 [m], 5 [N])"
    for text, fine in ((good, True), (bad, False)):
        m = hb.Model("units", domain="translational")
        m.add(m=hb.I(1.0, f=1.0), v=hb.One(), R=hb.R({"e": text.replace("v.f", "f")}))
        m.bond("v -> m", "v -> R")
        if fine:
            assert hb.simulate(m, 0.1).status == "ok"
        else:
            with pytest.raises(hb.HybondError, match="HB-U102"):
                hb.simulate(m, 0.1)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_a_brake_of_lines_has_its_closed_form(solver):
    """5 N above 2 m/s; then 1 + 4 (v - 1) down to 1 m/s; then as the speed."""
    m = hb.Model("brake")
    m.add(m=hb.I(1.0, f=10.0), v=hb.One(), R=hb.R({"e": "table(f, 0, 0, 1, 1, 2, 5)"}))
    m.bond("v -> m", "v -> R")
    run = hb.simulate(m, 3.0, solver=solver)
    first = 8.0 / 5.0
    second = first + np.log(1.25 / 0.25) / 4.0
    assert run["m.f"].at(first) == pytest.approx(2.0, rel=1e-7)
    assert run["m.f"].at(second) == pytest.approx(1.0, rel=1e-7)
    assert run["m.f"].at(3.0) == pytest.approx(np.exp(-(3.0 - second)), rel=1e-6)


def test_a_schedule_of_gains_and_a_guard_by_it():
    m = hb.Model("schedule", parameters={"top": 8.0})
    m.add(m=hb.I(2.0), v=hb.One(), F=hb.Se("gain"))
    m.bond("F -> v -> m")
    m.signal(gain="table(v.f, 0, top, 2, 3, 5, 1)")
    m.machine("low", states={"no": [], "yes": []}, start="no", rules=["no -> yes when gain < 2"])
    run = hb.simulate(m, 4.0)
    (event,) = [e for e in run.events if e.cause == "guard"]
    # 8 - 2.5 v up to v = 2, then 3 - 2 (v - 2)/3, which is 2 at 3.5
    first = -np.log(3.0 / 8.0) / (2.5 / 2.0)
    then = -np.log(2.0 / 3.0) / (2.0 / 3.0 / 2.0)
    assert event.t == pytest.approx(first + then, rel=1e-7)
    assert run["v.f"].at(event.t) == pytest.approx(3.5, rel=1e-7)
    other = hb.simulate(m, 0.1, parameters={"top": 4.0})
    assert other["gain"].at(0.0) == pytest.approx(4.0)


def test_it_is_written_to_a_file_as_it_was_given(tmp_path):
    m = hb.Model("kept")
    m.add(m=hb.I(1.0, f=1.0), v=hb.One(), R=hb.R({"e": "table(f, 0, 0, 1, 1)"}))
    m.bond("v -> m", "v -> R")
    path = tmp_path / "kept.toml"
    hb.save(m, path)
    assert "table(f, 0, 0, 1, 1)" in path.read_text()
    assert hb.simulate(hb.load(path), 1.0)["m.f"].at(1.0) == pytest.approx(np.exp(-1.0), rel=1e-7)
