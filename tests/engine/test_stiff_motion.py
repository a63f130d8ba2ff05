"""`solver = "auto"` goes over to an implicit method where stability binds the explicit one."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from stiff_models import ladder, signals, van_der_pol

import hybond as hb


def voltages_of_ladder(until, cells=8):
    """Return the same by another program, from equations written down by hand."""

    def rate(_, e, on):
        between = 1e-3 * (e[:-1] - e[1:]) + 1e-4 * (e[:-1] - e[1:]) ** 3
        into = np.concatenate([[(1.0 - e[0]) / 1.0 if on else -e[0] / 100.0], between])
        return (into - np.concatenate([between, [0.0]])) / np.array([1e-6, *[1e-5] * (cells - 1)])

    e, t = np.zeros(cells), 0.0
    for on in itertools.cycle([True, False]):
        end = min(t + 0.1, until)
        options = {"method": "Radau", "rtol": 1e-10, "atol": 1e-13, "args": (on,)}
        e, t = solve_ivp(rate, (t, end), e, **options).y[:, -1], end
        if t >= until:
            return e


def test_van_der_pol_by_the_test_set_for_initial_value_problems():
    run = hb.simulate(van_der_pol(), 2000.0, solver="auto")
    assert run["x"].at(2000.0) == pytest.approx(1.706167732170469, rel=1e-6)
    assert run["y"].at(2000.0) == pytest.approx(-0.8928097010247975e-3, rel=1e-6)
    # more than a million with rk45
    assert run.stats["steps"] < 3000
    first, *others = run.turns
    assert first.solver == "radau" and 0.0 < first.t < 1.0
    # it turns round at 807 and 1614
    assert {"rk45", "radau"} == {turn.solver for turn in others}
    assert all(min(abs(turn.t - 807.0), abs(turn.t - 1614.3)) < 1.0 for turn in others)
    assert "stiff: radau from t = " in run.method
    assert run.stats["turns"] == len(run.turns)


def test_robertson_as_published():
    m = signals(
        a=("1e4*b*c - 0.04*a", "1"),
        b=("0.04*a - 1e4*b*c - 3e7*b^2", "0"),
        c=("3e7*b^2", "0"),
    )
    run = hb.simulate(m, 40.0, solver="auto")
    assert [t.solver for t in run.turns] == ["radau"]
    published = {"a": 0.7158270688, "b": 0.9185534765e-5, "c": 0.2841637457}
    for name, value in published.items():
        assert run[name].at(40.0) == pytest.approx(value, rel=1e-6), name
    assert sum(run.final.values()) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.slow
def test_a_ladder_with_a_switch():
    run = hb.simulate(ladder(), 0.25, solver="auto")
    assert run.turns and run.turns[0].solver == "radau"
    expected = voltages_of_ladder(0.25)
    for k, value in enumerate(expected):
        assert run[f"c{k}.e"].at(0.25) == pytest.approx(value, rel=1e-6), k
    # rk45 wants as many for the first tenth
    assert run.stats["steps"] < hb.simulate(ladder(), 0.1, solver="rk45").stats["steps"]


def test_an_oscillator_is_left_as_it_is():
    m = signals(x=("y", "1"), y=("-sin(x)", "0"))
    auto, plain = (hb.simulate(m, 500.0, solver=s) for s in ("auto", "rk45"))
    assert auto.turns == ()
    assert auto.final == plain.final
    assert auto.stats["evaluations"] == plain.stats["evaluations"]


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-8, 1e-11])
def test_what_is_followed_is_not_stiff_at_any_tolerance(rtol):
    """Swings, and a decay that is over within the run: nothing died out long ago."""
    m = signals(x=("y", "1"), y=("-x^3 - 0.05*y", "0"), z=("-3*z^2", "1"))
    assert hb.simulate(m, 60.0, solver="auto", rtol=rtol).turns == ()


def test_what_died_out_near_the_imaginary_axis():
    """A lightly damped swing, a thousand times as fast as what is left of the motion."""
    m = signals(x=("y", "1e-3"), y=("-1e6*sin(x) - 20*y", "0"), z=("-z^2", "1"))
    auto, plain = (hb.simulate(m, 50.0, solver=s) for s in ("auto", "rk45"))
    assert [t.solver for t in auto.turns] == ["radau"]
    # x is at its tolerance where rk45 never lets it rest
    assert auto["z"].at(50.0) == pytest.approx(1.0 / 51.0, rel=1e-6)
    assert auto.stats["steps"] < 0.25 * plain.stats["steps"]


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_events_every_few_steps_leave_what_was_seen_of_stiffness(rtol):
    """A gate switches every ten microseconds; what decays within one has long died out."""
    m = signals(w=("2*u - 1", "0"), z=("1 - z", "0"), x=("-1e6*(x - z)*(1 + x^2)", "0"))
    m.input(u=hb.Input(pwm={"period": 2e-5, "duty": 0.5}))
    auto, plain = (hb.simulate(m, "0.01 s", solver=s, rtol=rtol) for s in ("auto", "rk45"))
    stretches = 1000
    assert plain.stats["steps"] < 5 * stretches
    (turn,) = auto.turns
    # fifteen steps in a row are never between two events
    assert turn.solver == "radau" and 5e-5 < turn.t < 3e-4
    assert auto.stats["steps"] < 0.85 * plain.stats["steps"]
    end = float(auto["z"].at(0.01))
    assert end == pytest.approx(1.0 - np.exp(-0.01), rel=10 * rtol)
    # x is behind z by its slope over its rate
    assert auto["x"].at(0.01) == pytest.approx(end - (1.0 - end) / (1e6 * (1.0 + end**2)), rel=1e-6)


def test_a_mode_that_turns_stiff_later():
    """A contact that closes within the run, with a damper that is not linear."""
    m = hb.Model("drop", domain="translational")
    m.add(g=hb.Se("-9.81 N"), v=hb.One(), m=hb.I("1 kg"), floor=hb.Zero())
    m.add(air=hb.R({"e": "0.1*f^3"}), pad=hb.R({"e": "1e7*f/sqrt(1 [m^2/s^2] + f^2)*(1 [N])"}))
    m.bond("g -> v -> m", "v -> air", "v -> floor -> pad")
    m.signal(h=hb.Integral("v.f", start="1 m"))
    m.machine(
        "S", states={"up": [], "down": ["floor"]}, start="up", rules=["up -> down when h <= 0"]
    )
    run = hb.simulate(m, "1 s", solver="auto")
    assert run.turns[0].t > run.events[1].t
    assert run.stats["steps"] < 2000
    # it sinks at the speed at which the pad carries the weight
    assert run["v.f"].at(1.0) == pytest.approx(-9.81e-7, rel=1e-6)


def test_linear_modes_are_propagated_however_fast():
    m = hb.Model("rc", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("1 mohm"), n=hb.Zero(), c=hb.C("1 uF"))
    m.add(d=hb.R("1 kohm"))
    m.bond("V -> i -> n", "i -> r", "n -> c", "n -> d")
    auto, exact = (hb.simulate(m, "1 s", solver=s) for s in ("auto", "exact"))
    assert auto.turns == () and auto.stats == exact.stats and auto.final == exact.final
    assert auto["c.e"].at(1.0) == pytest.approx(1.0 / (1.0 + 1e-6), rel=1e-12)


def test_the_default_is_auto():
    assert hb.simulate(van_der_pol(), 1.0).solver == "auto"


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("make", "until"), [(van_der_pol, 900.0), (lambda: ladder(2), 0.15)])
def test_the_engine_as_python_goes_over_at_the_same_step(make, until):
    library, python = (
        hb.simulate(make(), until, solver="auto", engine=e) for e in ("library", "python")
    )
    assert library.stats == python.stats
    assert [t.solver for t in library.turns] == [t.solver for t in python.turns] != []
    # powers differ in their last digit
    assert [t.t for t in library.turns] == pytest.approx([t.t for t in python.turns], rel=1e-9)
    assert library.final == pytest.approx(python.final, rel=1e-9)


@pytest.mark.parametrize(
    ("solver", "hint"), [("rk45", "solver = 'auto'"), ("auto", "raise max_steps"), ("radau", "max")]
)
def test_too_many_steps_name_a_remedy_that_is_none_already(solver, hint):
    with pytest.raises(hb.NumericsError, match="HB-N409") as told:
        hb.simulate(van_der_pol(), 2000.0, solver=solver, max_steps=200)
    assert hint in told.value.hint
    assert ("solver" in told.value.hint) == (solver == "rk45")


@pytest.mark.parametrize("turned", ["j -> r", "r -> j"])
@pytest.mark.parametrize(
    ("law", "size"), [("e", 1e-3), ("1e-3*e + e^3", 1e-5), ("max(e, 0)", 1e-3)]
)
def test_what_settles_before_the_time_is_another_number_is_told_with_a_remedy(turned, law, size):
    text = f"""
hybond = 1
name = "too fast for the time"
[elements]
s = {{ Se = "if time >= 0.5 then 1 else 0.2" }}
j = {{ junction = 1 }}
r = {{ R = {size} }}
n = {{ junction = 0 }}
c = {{ C = 1e-12 }}
d = {{ R = {{ f = "{law}" }} }}
[graph]
bonds = ["s -> j", "{turned}", "j -> n", "n -> c", "n -> d"]
"""
    with pytest.raises(hb.NumericsError, match="HB-N201") as told:
        hb.simulate(hb.loads(text), 1.0)
    assert f"c.q settles within {size * 1e-12:.1g} s" in told.value.hint
    # the remedy: the charge follows at once, or jumps where nothing resists
    without = text.replace("c = { C = 1e-12 }\n", "").replace(', "n -> c"', "")
    jumps = text.replace(f"r = {{ R = {size} }}\n", "").replace(f', "{turned}"', "")
    for other in (without, jumps):
        assert hb.simulate(hb.loads(other), 1.0)["n.e"].at(1.0) == pytest.approx(1.0, rel=1e-2)
    sooner = text.replace("0.5", "5e-6")
    assert hb.simulate(hb.loads(sooner), 1e-5).final["c.e"] == pytest.approx(1.0, rel=1e-2)
