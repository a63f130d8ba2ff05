"""A valve closes to nothing on what flows on: what the refusal offers does serve."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.model.parts import Part

PRESSURE, INERTANCE, LOSS, K, LAMINAR = 5e6, 1e7, 1e7, 3.3e-7, 1e6
OPENING = "1 - time/(0.1 [s])"
LAW = f"{K}*e/(e^2 + {LAMINAR})^(1/4)"


def line(opening: str, *, turned: bool = False, leak: float = 0.0) -> hb.Model:
    """A line with inertia behind a valve."""
    m = hb.Model("line")
    m.add(source=hb.Se(PRESSURE), inertia=hb.I(INERTANCE), flow=hb.One(), loss=hb.R(LOSS))
    m.add(valve=hb.R({"f": f"opening*{LAW}"}), port=hb.Zero(), gate=hb.One())
    m.signal(opening=opening)
    m.bond("source -> flow", "flow -> inertia", "flow -> loss", "gate -> valve")
    m.bond(*(("port -> flow", "gate -> port") if turned else ("flow -> port", "port -> gate")))
    if leak:
        m.add(leak=hb.G(leak))
        m.bond("port -> leak")
    return m


def switched(*, turned: bool) -> hb.Model:
    m = line(OPENING, turned=turned)
    rules = ["open -> closed when opening <= 1e-4", "closed -> open when opening > 1e-4"]
    m.machine("spool", states={"open": ["gate"], "closed": []}, start="open", rules=rules)
    return m


def known(times: list[float]) -> np.ndarray:
    """Return the flow while the valve closes, its law turned round."""

    def rates(t: float, y: np.ndarray) -> list[float]:
        x = y[0] / (K * (1.0 - t / 0.1))
        e = math.sqrt(0.5 * (x**4 + math.sqrt(x**8 + 4.0 * LAMINAR * x**4)))
        return [(PRESSURE - LOSS * y[0] - math.copysign(e, x)) / INERTANCE]

    return solve_ivp(rates, (0.0, times[-1]), [0.0], "Radau", times, rtol=1e-9, atol=1e-15).y[0]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("remedy", ["a little left", "a leak", "a machine"])
def test_what_is_offered_closes_the_valve(remedy: str, turned: bool) -> None:
    m = switched(turned=turned)
    if remedy == "a little left":
        m = line(f"max(1e-4, {OPENING})", turned=turned)
    if remedy == "a leak":
        m = line(f"max(0, {OPENING})", turned=turned, leak=1e-14)
    run = hb.simulate(m, 0.2)
    times = [0.02, 0.05, 0.08, 0.099]
    np.testing.assert_allclose(run["inertia.f"].at(times), known(times), rtol=1e-6, atol=1.1e-7)
    # a ten thousandth of the opening, or what leaks
    assert abs(run["inertia.f"].at(0.2)) < 1.01e-4 * K * math.sqrt(PRESSURE)
    assert run.audit().holds()


@pytest.mark.parametrize("opening", [f"max(0, {OPENING})", f"max(min({OPENING}, 1), 0)"])
def test_a_valve_that_closes_to_nothing_is_told_to_keep_a_little(opening: str) -> None:
    """It was told of a resistor beside it alone."""
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(line(opening), 0.2)
    # nothing solves the law there, and no step is short enough to get there: either is found first
    assert refused.value.code in {"HB-N301", "HB-N201"}
    assert "what multiplies the law of valve goes to zero" in str(refused.value)
    assert "max(1e-4, ...)" in str(refused.value)


def test_laws_that_nothing_multiplies_are_not_said_to_be_valves() -> None:
    m = hb.Model("asked for too much")
    m.add(V=hb.Se(2.0), d=hb.R({"f": "tanh(e)"}), r=hb.R({"f": "e^2 + 3"}), j=hb.One())
    m.bond("V -> j -> d", "j -> r")
    with pytest.raises(hb.HybondError, match="HB-N301") as refused:
        hb.simulate(m, 1)
    assert "multiplies" not in str(refused.value)


FORMS = {
    "flow": hb.R({"f": f"opening*{LAW}"}),
    "conductance": hb.G("1e-9*opening"),
    "effort": hb.R({"e": f"f*abs(f)/{K}^2/opening^2"}),
    "resistance": hb.R("1e9/opening"),
}


def closing(form: str, *, turned: bool = False, step: bool = False) -> hb.Model:
    """A line with inertia behind a valve in one of the forms that its law may have."""
    m = hb.Model("line")
    m.add(source=hb.Se(PRESSURE), inertia=hb.I(INERTANCE), flow=hb.One(), port=hb.Zero())
    m.add(valve=FORMS[form])
    m.input(opening=hb.Input(table=[[0, 1], [0.1, 0]], linear=not step))
    m.bond("source -> flow -> inertia", *(("port -> flow",) if turned else ("flow -> port",)))
    m.bond("port -> valve")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "rk45"])
@pytest.mark.parametrize("form", list(FORMS))
def test_every_form_is_told_the_two_elements_and_what_serves(
    form: str, solver: str, turned: bool
) -> None:
    """A law of efforts was told of a division by zero, and explicit steps of too small ones."""
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(closing(form, turned=turned), 0.2, solver=solver)
    assert refused.value.code in ("HB-N201", "HB-N301", "HB-N302")
    said = str(refused.value)
    does = "divides" if form in ("effort", "resistance") else "multiplies"
    assert f"what {does} the law of valve goes to zero" in said
    assert "what flows on (inertia)" in said
    assert "a leak (a G) beside it or a compliance (a C) between it and inertia" in said
    assert ("give it as f = ..." in said) == (does == "divides")


@pytest.mark.parametrize("form", ["flow", "conductance"])
def test_an_input_that_closes_at_once_stops_the_flow_by_an_impulse(form: str) -> None:
    """A conductance of zero is a constraint: what is stored goes, and the event says so."""
    run = hb.simulate(closing(form, step=True), 0.2)
    event = run.events[-1].steps[-1]
    p = run["inertia.p"].at(0.1 - 1e-9)
    assert event.energy is not None
    assert event.energy.lost == pytest.approx(p**2 / (2 * INERTANCE), rel=1e-6)
    assert run["inertia.f"].at(0.15) == 0.0


@pytest.mark.parametrize("form", ["effort", "resistance"])
def test_a_law_of_efforts_that_closes_at_once_is_told_to_be_turned_round(form: str) -> None:
    with pytest.raises(hb.HybondError, match=r"HB-N302[^;]*; .*give it as f = \.\.\."):
        hb.simulate(closing(form, step=True), 0.2)


def test_a_compliance_takes_what_a_closed_valve_does_not() -> None:
    m = closing("flow")
    m.add(hose=hb.C(1e-12))
    m.bond("port -> hose")
    run = hb.simulate(m, 0.2)
    assert run["valve.f"].at(0.15) == 0.0
    # from then on the line and the hose swing with what they have
    flow, pressure = run["inertia.f"].at(0.15), run["hose.e"].at(0.15) - PRESSURE
    size = math.hypot(flow * math.sqrt(INERTANCE), pressure * math.sqrt(1e-12))
    flow, pressure = run["inertia.f"].at(0.2), run["hose.e"].at(0.2) - PRESSURE
    assert math.hypot(flow * math.sqrt(INERTANCE), pressure * math.sqrt(1e-12)) == pytest.approx(
        size, rel=1e-6
    )


@pytest.mark.parametrize(
    "law", [hb.R("a*(5 [ohm])"), hb.R({"e": "a*(5 [ohm])*f"}), hb.G("0.2 [S]/a")]
)
def test_what_shorts_a_capacitor_is_told_so(law: Part) -> None:
    m = hb.Model("short", domain="electrical")
    m.add(V=hb.Se("10 V"), Ri=hb.R("1 ohm"), C=hb.C("1 mF"), j=hb.One(), z=hb.Zero(), r=law)
    m.signal(a="max(0, 1 - time/(0.1 [s]))")
    m.bond("V -> j -> Ri", "j -> z -> C", "z -> r")
    with pytest.raises(hb.HybondError, match=r"shorts what is charged \(C\)") as refused:
        hb.simulate(m, 0.2)
    assert "a resistance in series with it or an inertia (an I)" in str(refused.value)
