"""Times that somebody has computed, and that are an end of a run but for rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def emptied(dual: bool = False) -> hb.Model:
    """Return what empties in a second."""
    m = hb.Model("emptied")
    if dual:
        m.add(s=hb.I(1.0, f=2.0), r=hb.R(1.0), n=hb.One())
    else:
        m.add(s=hb.C(1.0, e=2.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> s", "n -> r")
    return m


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize(("parts", "step"), [(50, 2e-5), (3, 0.1), (7, 0.7), (6, 1.1)])
def test_the_end_of_a_run_that_was_counted_in_steps_is_a_time_of_it(
    parts: int, step: float, dual: bool
) -> None:
    """49*2e-5 + 2e-5 was refused: from 0 to 0.001 s, not to 0.001 s."""
    counted = (parts - 1) * step + step
    summed = sum(step for _ in range(parts))
    name = "s.p" if dual else "s.q"
    for end in {parts * step, counted, summed, math.nextafter(parts * step, 0.0)}:
        run = hb.simulate(emptied(dual), end)
        for t in (counted, parts * step):
            assert run[name].at(t) == pytest.approx(2.0 * math.exp(-end), rel=1e-6)
            assert run.state(t).t == pytest.approx(end, rel=1e-15)
        times = [0.5 * end, counted, math.nextafter(end, math.inf)]
        assert run[name].at(times)[1:] == pytest.approx([run.final[name]] * 2, rel=1e-12)


def test_the_right_limit_at_the_end_is_that_of_the_end() -> None:
    """A switch at the end itself has fired there, for a time beyond it by rounding as well."""
    m = emptied()
    m.add(w=hb.One(), more=hb.R(1.0))
    m.bond("n -> w -> more")
    rules = ["off -> on when time >= 0.3"]
    m.machine("k", states={"off": [], "on": ["w"]}, start="off", rules=rules)
    run = hb.simulate(m, 0.3)
    assert run["w.f"].at(0.1 + 0.2) == run["w.f"].at(0.3) == pytest.approx(2 * math.exp(-0.3))
    assert run["w.f"].at(0.1 + 0.2, side="left") == run["w.f"].at(0.3, side="left") == 0.0


@pytest.mark.parametrize("beyond", [1e-14, 1e-9, 1.0, math.inf, math.nan])
def test_what_is_more_than_rounding_beyond_the_end_is_refused(beyond: float) -> None:
    run = hb.simulate(emptied(), 1.0)
    for t in (1.0 + beyond, -abs(beyond)):
        with pytest.raises(hb.UsageError, match="HB-S110"):
            run["s.q"].at([0.5, t])
        with pytest.raises(hb.UsageError, match="HB-S110"):
            run.state(t)
    assert np.isfinite(run["s.q"].at(np.array([0.0, 1.0]))).all()
