"""A body that rises from a plastic stop beneath one that bounces on it: events within events.

A force lifts the lower one as long as the upper one flies; where they meet it is struck back to its
stop. The bounces accumulate within the strokes against the stop, and these as well: in the end
both rest, the upper one on the lower one, and the stop carries what is left of both forces.
"""

from __future__ import annotations

import pytest

import hybond as hb


def pile(
    lower: float, upper: float, lift: float, weight: float, restitution: float, turned: bool
) -> hb.Model:
    m = hb.Model("pile", domain="translational")
    m.add(a=hb.One(), lower=hb.I(lower), lift=hb.Se(lift))
    m.add(b=hb.One(), upper=hb.I(upper), weight=hb.Se(weight if turned else -weight))
    m.add(stop=hb.Zero(law="unilateral", gap="under"))
    m.add(bounce=hb.Zero(law="unilateral", gap="between", restitution=restitution))
    m.signal(under=hb.Integral("a.f", start=0.0778), between=hb.Integral("b.f - a.f", start=0.087))
    m.bond("lift -> a -> lower", "b -> upper", "b -> weight" if turned else "weight -> b")
    m.bond("stop -> a", "bounce -> b", "a -> bounce")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("lower", "upper", "lift", "weight", "restitution"),
    [
        (1.9, 1.0, 3.39, 6.69, 0.4065),
        (0.3, 2.93, 1.33, 3.56, 0.59),
        (2.54, 2.08, 2.79, 7.8, 0.34),
        (1.16, 1.97, 2.41, 3.48, 0.34),
        (2.76, 1.36, 1.53, 3.94, 0.36),
    ],
)
def test_both_come_to_rest(
    lower: float, upper: float, lift: float, weight: float, restitution: float, turned: bool
) -> None:
    run = hb.simulate(pile(lower, upper, lift, weight, restitution, turned), 6.0)
    assert run.status == "ok" and run.audit().holds()
    assert run.mode == {"stop": "closed", "bounce": "closed"}
    end = run.sample(6.0, ["under", "between", "a.f", "b.f", "stop.e", "bounce.e"])
    assert abs(end["under"][0]) < 1e-9 and abs(end["between"][0]) < 1e-9
    assert (end["a.f"][0], end["b.f"][0]) == (0.0, 0.0)
    assert end["bounce.e"][0] == pytest.approx(weight)
    assert end["stop.e"][0] == pytest.approx(weight - lift)
