"""Laws with several solutions: one is followed over events, into runs that go on, up to its end."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

FALLS = "3 [V]*cos(time/(1 [s]))"


def cubic(drive: str, law: str = "E^3 - 3*E") -> hb.Model:
    """Return ``x^3 - 2*x = drive`` for ``x = G0.e``: a fold at 1.0887 V."""
    m = hb.Model("cubic", domain="electrical")
    m.add(V=hb.Se(drive), z=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"), C=hb.C("1 F"))
    m.add(i0=hb.One(), R0=hb.R("1 ohm"))
    m.add(G0=hb.G({"f": f"({law.replace('E', '(e/(1 [V]))')})*1 [A]"}))
    m.bond("V -> z -> ic -> Rc", "ic -> C", "z -> i0 -> R0", "i0 -> G0")
    return m


def root(drive: float, near: float) -> float:
    """Return the solution of the cubic that is nearest."""
    found = np.roots([1.0, 0.0, -2.0, -drive])
    real = found[np.abs(found.imag) < 1e-9].real
    return float(real[np.argmin(np.abs(real - near))])


@pytest.mark.parametrize("until", np.linspace(1.943, 2.3, 10))
def test_a_fold_is_told_wherever_the_run_ends_behind_it(until: float) -> None:
    run = hb.simulate(cubic(FALLS), until, on_error="return")
    assert run.status == "unsound" and "ends (a fold)" in str(run.error)
    fold = np.arccos(-((2 / 3) ** 1.5) * 2 / 3)
    assert run.audit().laws[0].t == pytest.approx(fold, abs=1e-6)


def test_an_event_elsewhere_does_not_change_the_solution() -> None:
    m = cubic("2.5 [V]*cos(time/(1 [s]))")
    m.add(U=hb.Se("1 V"), k=hb.One(), Rk=hb.R("1 ohm"))
    m.bond("U -> k -> Rk")
    m.machine("S", states={"a": [], "b": ["k"]}, start="a", rules=["a -> b when time > 1.7 s"])
    run = hb.simulate(m, 1.75)
    for t in (1.69, 1.71, 1.75):
        assert float(run["G0.e"].at(t)) == pytest.approx(root(2.5 * np.cos(t), 1.3), rel=1e-9)


def test_a_law_scaled_by_a_state_is_followed() -> None:
    m = cubic(FALLS, "E^3 - 3*(M.q/(1 [C]))*E")
    m.add(y=hb.One(), M=hb.C("1 F", q="1 C"), big=hb.R("1 Tohm"))
    m.bond("y -> M", "y -> big")
    run = hb.simulate(m, 1.93)
    near = 1.9
    for t in (0.0, 0.5, 1.0, 1.5, 1.7, 1.9):
        near = root(3 * np.cos(t), near)
        assert float(run["G0.e"].at(t)) == pytest.approx(near, rel=1e-6)
    assert float(run["G0.e"].at(1.7)) == pytest.approx(root(3 * np.cos(1.7), 1.3), rel=1e-6)


def test_a_run_that_goes_on_has_the_solution_of_a_loop_of_sources() -> None:
    m = hb.Model("loop", domain="electrical")
    m.add(V=hb.Se(FALLS), z=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"), C=hb.C("1 F"))
    m.add(a=hb.One(), Ra=hb.R("1 ohm"), n=hb.Zero(), A=hb.Se("5 [V]*tanh(n.e/(1 [V]))"))
    m.add(b=hb.One(), Rb=hb.R("1 ohm"))
    m.bond("V -> z -> a -> Ra", "a -> n", "A -> b -> Rb", "b -> n", "z -> ic -> Rc", "ic -> C")
    whole = hb.simulate(m, 2.2)
    first = hb.simulate(m, 1.7)
    goal = float(whole["n.e"].at(2.1))
    assert 2 * goal - 5 * np.tanh(goal) == pytest.approx(3 * np.cos(2.1), rel=1e-9) and goal > 1.5
    for start in (whole.state(2.0), first.state()):
        run = hb.simulate(m, 2.2, start=start)
        assert float(run["n.e"].at(2.1)) == pytest.approx(goal, rel=1e-9)


@pytest.mark.parametrize("early", ["(1 + D2.e/(50 [V]))", "(1 + 0.2*tanh(D2.e/(1 [V])))"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_clipper_whose_current_grows_with_another_voltage_has_no_fold(
    early: str, *, turned: bool
) -> None:
    """Rows are eliminated anew within a step, for other unknowns."""
    m = hb.Model("clipper", domain="electrical")
    m.add(V=hb.Se("5*cos(200*time/(1 [s]))*1 [V]"), z=hb.Zero(), s=hb.One(), Rs=hb.R("1 kohm"))
    m.add(a=hb.Zero(), D=hb.G({"f": f"1e-12*(exp(e/(0.026 [V]))-1)*{early}*1 [A]"}))
    m.add(D2=hb.G({"f": "-1e-12*(exp(-e/(0.026 [V]))-1)*1 [A]"}), ss=hb.One(), R5=hb.R("100 ohm"))
    m.add(ic=hb.One(), Rc=hb.R("10 kohm"), C=hb.C("1 uF"))
    m.bond("V -> z -> s -> Rs", "s -> a -> D", "a -> ss -> D2", "z -> ic -> Rc", "ic -> C")
    m.bond("R5 -> ss" if turned else "ss -> R5")
    assert hb.simulate(m, "0.1 s").audit().holds()


@pytest.mark.parametrize("bent", ["1e5*f^3*(1 [V/A^3])", "1e5*f*abs(f)*(1 [V/A^2])"])
@pytest.mark.parametrize("first", [False, True])
def test_a_dead_zone_beside_a_cubic_that_rests_has_no_fold(bent: str, *, first: bool) -> None:
    def rests() -> None:
        m.add(V=hb.Se("0.2 V"), z=hb.Zero(), s=hb.One(), Rs=hb.R("1 ohm"))
        m.add(D=hb.G({"f": "((e/(1 [V]))^3 - 3*(e/(1 [V])))*1 [A]"}))
        m.add(ic=hb.One(), Rc=hb.R("1 kohm"), C=hb.C("1 uF"))
        m.bond("V -> z -> s -> Rs", "s -> D", "z -> ic -> Rc", "ic -> C")

    m = hb.Model("two", domain="electrical")
    if first:
        rests()
    m.add(V3=hb.Se("500*time/(1 [s])*1 [V]"), s3=hb.One())
    m.add(Rs3=hb.R({"e": f"1000*f*(1 [ohm]) + {bent}"}))
    m.add(D1=hb.G({"f": "0.01*max(0 [V], e - 2 [V])*(1 [A/V])"}))
    m.bond("V3 -> s3 -> Rs3", "s3 -> D1")
    if not first:
        rests()
    assert hb.simulate(m, "40 ms").audit().holds()


@pytest.mark.parametrize(
    ("drive", "until"),
    [
        ("if time < 1 [s] then 0 [Pa] else 1e5*(time/(1 [s]) - 1)*1 [Pa]", "2 s"),
        ("max(0, 1e7*(time/(1 [s]) - 0.0123))*1 [Pa]", "0.1 s"),
        ("1e5*sin(200*time/(1 [s]))*1 [Pa]", "0.1 s"),
    ],
)
def test_a_tee_that_starts_from_rest_has_no_fold(drive: str, until: str) -> None:
    """All slopes are zero there, and the flow is the root of the pressure."""
    m = hb.Model("tee", domain="hydraulic")
    m.add(P=hb.Se(drive), n0=hb.Zero(), p=hb.One(), n=hb.Zero())
    m.add(V0=hb.R({"e": "1e9*f*abs(f)*(1 [Pa*s^2/m^6])"}))
    m.add(V1=hb.R({"e": "1e9*f*abs(V0.f)*(1 [Pa*s^2/m^6])"}), V2=hb.R("1e7 [Pa*s/m^3]"))
    m.add(pt=hb.One(), Rt=hb.R("1e7 [Pa*s/m^3]"), T=hb.C("1e-9 [m^3/Pa]"))
    m.bond("P -> n0 -> p -> V0", "p -> n -> V1", "n -> V2", "n0 -> pt -> Rt", "pt -> T")
    assert hb.simulate(m, until).audit().holds()
