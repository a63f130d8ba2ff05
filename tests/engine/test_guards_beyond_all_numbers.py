"""A guard or a signal whose exponentials are beyond all numbers fires and reads as its value says.

``x`` grows evenly from 0 to 1500; oracles are inverses in closed form.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

FORMS = {
    "log(1 + exp(x))": (750.0, 750.0, 1500.0),
    "log(exp(x) + exp(-x))": (750.0, 750.0, 1500.0),
    "log(cosh(x))": (750.0, 750.0 + math.log(2.0), 1500.0 - math.log(2.0)),
    "exp(x - 750)/(1 + exp(x - 750))": (0.75, 750.0 + math.log(3.0), 1.0),
    "sinh(x - 720)/cosh(x - 720)": (0.5, 720.0 + math.atanh(0.5), 1.0),
    "sqrt((x*1e200)^2 + (8e202)^2)": (1e203, 600.0, 1.7e203),
    "exp(x)": (1e300, 300.0 * math.log(10.0), math.inf),
}
"""What it is compared with, where x is when they are the same, and what it is at the end."""


def ramp(form: str, bound: float, *, back: bool) -> hb.Model:
    m = hb.Model("ramp")
    m.add(s=hb.Sf(-1500.0 if back else 1500.0), c=hb.C(1.0))
    m.bond("c -> s" if back else "s -> c")
    m.signal(x="c.q", y=form)
    rules = [f"low -> high when y > {bound!r}"]
    m.machine("g", states={"low": [], "high": []}, start="low", rules=rules)
    return m


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("form", FORMS)
def test_a_guard_fires_where_the_value_says(form: str, *, back: bool) -> None:
    bound, at, last = FORMS[form]
    run = hb.simulate(ramp(form, bound, back=back), 1.0)
    assert [e.t for e in run.events[1:]] == pytest.approx([at / 1500.0], rel=1e-11)
    assert run["y"].at(1.0) == pytest.approx(last, rel=1e-12)
    assert run.final["y"] == pytest.approx(last, rel=1e-12)


def test_one_that_begins_beyond_all_numbers_holds_at_once() -> None:
    m = ramp("exp(x + 800)", 5.0, back=False)
    assert hb.simulate(m, 0.1).mode["g"] == "high"


def test_a_source_that_grows_on_is_no_pulse_without_a_bound() -> None:
    """The charge of ``log(1 + exp(1500 t))`` is ``750 + pi^2/12/1500``, within one exponential."""
    m = hb.Model("soft")
    m.add(s=hb.Sf("log(1 + exp(1500*time))"), c=hb.C(1.0))
    m.bond("s -> c")
    run = hb.simulate(m, 1.0)
    assert run.final["c.q"] == pytest.approx(750.0 + math.pi**2 / 12.0 / 1500.0, rel=1e-9)
    assert not run.warnings
