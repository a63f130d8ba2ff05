"""What only a run can show: contradictions, NaN, impulses without meaning, open guards."""

import math

import pytest

import hybond as hb


def test_two_sources_joined_by_a_switch_name_both_ends_and_the_switch() -> None:
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se("10 V"), W=hb.Se("5 V"), n=hb.Zero(), s=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> n", "W -> s -> n", "n -> R")
    m.machine("k", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time > 1"])
    with pytest.raises(hb.CausalityError) as caught:
        hb.simulate(m, 2.0)
    error = caught.value
    assert error.code == "HB-C101"
    for part in ("Se V", "Se W", "'W -> s'", "k = on", "5"):
        assert part in error.why
    assert error.partial is not None
    assert error.partial.t_end == 1.0


def test_equal_sources_joined_by_a_switch_are_fine() -> None:
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se("5 V"), W=hb.Se("5 V"), n=hb.Zero(), s=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> n", "W -> s -> n", "n -> R")
    m.machine("k", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time > 1"])
    run = hb.simulate(m, 2.0)
    assert run["R.f"].at(1.5) == pytest.approx(5.0)
    assert any("least leakage" in w for w in run.warnings)  # the shares are free


def test_nan_names_the_law_and_the_time() -> None:
    m = hb.Model()
    m.add(C=hb.C(1e-3, e=1.0), r=hb.R({"f": "0.001*(0.1 + sqrt(e - 0.5))"}), n=hb.Zero())
    m.bond("n -> C", "n -> r")
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, 5.0)
    assert caught.value.code == "HB-N302"
    assert "R r" in caught.value.why
    # C e' = -k (1/10 + s), with s^2 = e - 1/2, takes the time of 2 s/(1/10 + s) from s to 0
    s = math.sqrt(0.5)
    assert caught.value.partial.t_end == pytest.approx(2 * s - 0.2 * math.log1p(10 * s), rel=1e-3)


@pytest.mark.parametrize("solver", ["rk45", "auto"])
def test_what_comes_to_rest_where_a_root_ends_stays_there(solver: str) -> None:
    """The same without a part that draws on: the law holds at 1/2, with no flow."""
    m = hb.Model()
    m.add(C=hb.C(1e-3, e=1.0), r=hb.R({"f": "0.001*sqrt(e - 0.5)"}), n=hb.Zero())
    m.bond("n -> C", "n -> r")
    run = hb.simulate(m, 5.0, solver=solver)
    for t in (0.4, 1.2):
        assert run["C.e"].at(t) == pytest.approx(0.5 + (math.sqrt(0.5) - t / 2) ** 2, abs=1e-6)
    assert (run["C.e"].at(5.0), run["r.f"].at(5.0)) == (0.5, 0.0)


def test_product_of_impulses_is_refused_by_name() -> None:
    m = hb.Model(domain="electrical")
    m.add(A=hb.C("1 F", e="2 V"), B=hb.C("1 F"), a=hb.Zero(), b=hb.Zero(), s=hb.One())
    m.bond("a -> A", "b -> B", "a -> s -> b")
    m.machine(
        "k",
        states={"off": [], "on": ["s"]},
        start="off",
        rules=["off -> on when time > 1", "on -> off when s.f*B.f > 3"],
    )
    with pytest.raises(hb.ModelError) as caught:
        hb.simulate(m, 2.0)
    assert caught.value.code == "HB-J101"
    assert "s.f*B.f" in caught.value.why
    assert "t = 1" in caught.value.where


def series_switches() -> hb.Model:
    """Two switches in series: the node between them floats while both are open."""
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se("10 V"), s1=hb.One(), n=hb.Zero(), s2=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> s1 -> n -> s2 -> R")
    rules = ["off -> on when n.e > 3"]
    m.machine("k", states={"off": [], "on": ["s1", "s2"]}, start="off", rules=rules)
    return m


def test_guard_on_a_floating_node_is_refused() -> None:
    with pytest.raises(hb.ModelError) as caught:
        hb.simulate(series_switches(), 1.0)
    assert caught.value.code == "HB-J102"
    assert "least leakage" in caught.value.hint


def test_guard_on_a_floating_node_goes_by_least_leakage_if_the_model_asks() -> None:
    m = series_switches()
    m.indeterminate = "least leakage"
    run = hb.simulate(m, 1.0)
    assert run.mode == {"k": "on"}  # equal leaks: the node is at half the voltage, 5 V


def test_ending_in_a_fieldless_mode_is_an_error() -> None:
    m = hb.Model(domain="translational")
    m.add(b=hb.I("1 kg", f="1 m/s"), v=hb.One(), c=hb.Zero(), r=hb.Sf("-pre(b.f)"))
    m.bond("v -> b", "c -> v", "r -> c")
    m.machine(
        "k",
        states={"free": [], "hit": ["c"]},
        start="free",
        rules=["free -> hit when time > 1", "hit -> free when pre(b.f) > 5"],
    )
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, 2.0)
    assert caught.value.code == "HB-N403"


def test_interrupt_keeps_what_there_is() -> None:
    m = hb.Model()
    m.add(C=hb.C(1.0, e=1.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> C", "n -> r")

    def stop(t: float, events: int) -> None:
        if t > 0.5:
            raise KeyboardInterrupt

    run = hb.simulate(m, 5.0, progress=stop)
    assert run.status == "interrupted"
    assert 0.5 < run.t_end < 5.0
    assert run["C.e"].at(0.5) == pytest.approx(math.exp(-0.5), rel=1e-7)
