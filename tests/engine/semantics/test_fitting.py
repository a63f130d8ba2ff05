"""`solver = "auto"` takes what fits the model, and says why."""

import pytest

import hybond as hb
from hybond.engine.outcome.engines import choose_engine
from hybond.engine.outcome.fitting import fitting
from hybond.engine.tables import tables_of


def circuit(law, *, r="1 mohm"):
    m = hb.Model("circuit", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R(r), n=hb.Zero(), c=hb.C("1 uF"), d=hb.R(law))
    m.bond("V -> i -> n", "i -> r", "n -> c", "n -> d")
    return m


def test_a_linear_model_is_propagated():
    run = hb.simulate(circuit("1 kohm"), "1 s", solver="auto")
    assert run.solver == "exact"
    assert run.method.startswith("exact chosen: the mode looked at is linear; 1 mode propagated")
    assert run["c.e"].at(1.0) == pytest.approx(1.0 / (1.0 + 1e-6), rel=1e-12)


def test_a_stiff_law_takes_an_implicit_method():
    run = hb.simulate(circuit({"f": "1e-3*e^3"}), "1 s", solver="auto")
    assert run.solver == "radau"
    # 1 mohm and 1 uF
    assert "decays within 1e-09 s" in run.method
    assert run.stats["steps"] < 200


def test_the_same_law_where_nothing_is_fast():
    run = hb.simulate(circuit({"f": "1e-3*e^3"}, r="1 kohm"), "1 s", solver="auto")
    assert run.solver == "rk45"
    assert run.method.startswith("rk45 chosen: not linear")


def test_what_oscillates_fast_is_not_stiff():
    """An implicit method would have to follow it as well."""
    m = hb.Model("ring", domain="electrical")
    m.add(l=hb.I("1 uH", f="1 A"), c=hb.C("1 uF"), i=hb.One(), d=hb.R({"e": "1e-3*f^3"}))
    m.bond("l -> i -> c", "i -> d")
    assert hb.simulate(m, "10 ms", solver="auto").solver == "rk45"


def test_a_stiff_mode_that_the_run_begins_without_is_seen():
    """A contact that closes later: one machine's other state."""
    m = hb.Model("drop", domain="translational")
    m.add(g=hb.Se("-9.81 N"), v=hb.One(), m=hb.I("1 kg"), floor=hb.One())
    m.add(air=hb.R({"e": "0.1*f^3"}), pad=hb.R({"e": "1e7*f/sqrt(1 [m^2/s^2] + f^2)*(1 [N])"}))
    m.bond("g -> v -> m", "v -> air", "v -> floor -> pad")
    m.signal(h=hb.Integral("v.f", start="1 m"))
    m.machine(
        "S", states={"up": [], "down": ["floor"]}, start="up", rules=["up -> down when h <= 0"]
    )
    run = hb.simulate(m, "1 s", solver="auto")
    assert run.solver == "radau" and "down" in run.method


def test_the_choice_does_not_change_what_a_run_says_of_itself():
    run = hb.simulate(circuit("1 kohm"), "1 ms", solver="auto")
    plain = hb.simulate(circuit("1 kohm"), "1 ms", solver="exact")
    assert run.stats == plain.stats
    assert run.method.endswith(plain.method)


def test_a_step_is_refused_as_for_what_is_chosen():
    with pytest.raises(hb.UsageError, match="HB-S104"):
        hb.simulate(circuit("1 kohm"), "1 s", solver="auto", step="1 ms")


@pytest.mark.parametrize(
    ("law", "solver"), [("1 kohm", "exact"), ({"f": "1e-3*e^3"}, "radau"), ("1 ohm", "exact")]
)
def test_the_engine_as_python_finds_the_same(law, solver):
    tables = tables_of(circuit(law).flatten(), until="1 s", solver="exact")
    found = fitting(choose_engine("python").prepare(tables))
    assert found.solver == solver
    assert found == fitting(choose_engine().prepare(tables))
