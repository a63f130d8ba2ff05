"""Sources that say nothing, then something for a while: seen by every method, at any size."""

from __future__ import annotations

import math
import warnings

import pytest

import hybond as hb

PULSE = "5 [V]*exp(-((time - 1 [s])/(0.01 [s]))^2)"
QUANTISED = [("qss1", 1e-3), ("qss2", 1e-5), ("qss3", 1e-6), ("liqss2", 1e-5), ("liqss3", 1e-6)]


def loop(source: str, law: object) -> hb.Model:
    m = hb.Model("loop")
    m.add(s=hb.Se(source), r=hb.R(law), j=hb.One(), c=hb.C("0.1 F"))
    m.bond("s -> j -> r", "j -> c")
    return m


@pytest.mark.parametrize(("solver", "rtol"), QUANTISED)
def test_quantised_states_see_a_pulse_where_nothing_moves(solver: str, rtol: float) -> None:
    """Convolution of the pulse with exp(-t/0.2): 5 sigma after it all of it has come."""
    run = hb.simulate(loop(PULSE, "2 ohm"), 3.0, solver=solver, rtol=rtol)
    charge = 5.0 / 2.0 * 0.01 * math.sqrt(math.pi)
    expected = charge * math.exp(-0.05 / 0.2 + (0.01 / 0.2) ** 2 / 4.0)
    assert run["c.q"].at(1.05) == pytest.approx(expected, rel=20.0 * rtol)


def test_a_source_whose_power_is_no_number_is_refused_without_other_warnings() -> None:
    """1e200 V on a kilohm: its power is infinite, its charge would not be."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = hb.simulate(loop("1e200 V", "1 kohm"), 100.0, solver="rk45", on_error="return")
        assert run.error is not None and run.error.code == "HB-N203"
        large = hb.simulate(loop("1e149 V", "1 kohm"), 100.0, solver="rk45")
        assert large.audit().holds()
    assert large["c.e"].at(100.0) == pytest.approx(1e149 * -math.expm1(-1.0), rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau", "exact", "qss3"])
def test_a_large_source_charges_as_a_small_one(solver: str) -> None:
    run = hb.simulate(loop("1e14 V", "1 kohm"), 100.0, solver=solver, rtol=1e-6)
    assert run["c.e"].at(100.0) == pytest.approx(1e14 * -math.expm1(-1.0), rel=1e-5)


@pytest.mark.parametrize("solver", ["qss3", "auto"])
def test_a_source_faster_than_any_run_ends_by_its_steps(solver: str) -> None:
    m = loop("5 [V]*sin(6e16 [rad/s]*time)", "1 kohm")
    run = hb.simulate(m, 1.0, solver=solver, max_steps=5000, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N409"
