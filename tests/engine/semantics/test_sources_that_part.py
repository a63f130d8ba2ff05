"""Sources that must agree, and do so at one instant only: their rates decide nothing there.

Of such sources the equations follow one or another, by the order of declaration. Oracles: what the
sources say of themselves; a closed form; the same outcome in all orders.
"""

from __future__ import annotations

import math

import pytest
from in_orders import in_orders

import hybond as hb

Parts = dict[str, object]


def refusals(models: list[hb.Model]) -> set[str]:
    """The codes by which runs of models are refused."""
    found = set()
    for m in models:
        with pytest.raises(hb.HybondError) as refused:
            hb.simulate(m, 1.0)
        found.add(refused.value.code)
    return found


@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize(
    ("effort", "flow"), [("-1.65*sin(2.24*time)", "time"), ("-time^2", "time^2")]
)
def test_sources_at_both_sides_of_a_gyrator_contradict_each_other_whatever_a_diode_does(
    effort: str, flow: str, bent: bool
) -> None:
    """Both say what the effort of the diode is: ever after the start they say different things."""
    parts: Parts = {
        "d": hb.Zero(law="diode"),
        "t": hb.GY(1.0),
        "s": hb.Se(effort),
        "u": hb.Sf(flow),
        "j": hb.One(),
    }
    bonds = ["d -> t", "s -> d", "u -> j", "t -> j"]
    if bent:
        parts |= {"x": hb.One(), "b": hb.R({"e": "f + f^3"}), "c": hb.C(1.0)}
        bonds += ["d -> x", "x -> b", "x -> c"]
    assert refusals(in_orders(parts, bonds)) == {"HB-C101"}


@pytest.mark.parametrize("effort", ["time", "-time", "1 - cos(1.0*time)"])
def test_gears_of_two_ratios_hold_an_effort_at_zero_whatever_a_diode_does(effort: str) -> None:
    """A node that two gears turn by two ratios can have no effort; the source has some."""
    parts: Parts = {
        "n": hb.Zero(),
        "k": hb.Zero(),
        "d": hb.One(law="diode"),
        "g": hb.GY(-1.07),
        "a": hb.TF(-1.81),
        "b": hb.TF(0.7),
        "s": hb.Se(effort),
    }
    bonds = ["s -> n", "n -> a -> k", "n -> b -> k", "n -> g -> d"]
    assert refusals(in_orders(parts, bonds)) == {"HB-C101"}


def test_a_mode_that_is_left_at_once_need_not_agree_a_moment_later() -> None:
    """Two sources are joined at the instant at which both are zero, and are no longer after it.

    The one that stays charges a capacitor: ``q' = t - q``.
    """
    parts: Parts = {
        "n": hb.Zero(law="diode"),
        "s": hb.Se("time"),
        "u": hb.Se("-time"),
        "v": hb.One(),
        "w": hb.One(),
        "x": hb.One(),
        "r": hb.R(1.0),
        "c": hb.C(1.0),
    }
    bonds = ["s -> v -> n", "u -> w -> n", "n -> x", "x -> r", "x -> c"]
    for m in in_orders(parts, bonds):
        m.machine(
            "M",
            states={"joined": ["v", "w"], "apart": ["v"]},
            start="joined",
            rules=["joined -> apart when time >= 0"],
        )
        run = hb.simulate(m, 1.0)
        assert run["c.q"].at(1.0) == pytest.approx(math.exp(-1.0), rel=1e-7)


def test_sources_that_agree_for_good_let_a_diode_follow_them_from_their_turn() -> None:
    """Two sources of one effort on one node, at its lowest: a diode charges as it rises from there.

    Between a cosine and the same wave by a sine there is rounding, and nothing else.
    """
    parts: Parts = {
        "n": hb.Zero(),
        "s": hb.Se("-cos(1.0*time)"),
        "u": hb.Se("-sin(1.0*time + 0.5*pi)"),
        "d": hb.One(law="diode"),
        "c": hb.C(2.0, q=-2.0),
    }
    for m in in_orders(parts, ["s -> n", "u -> n", "n -> d -> c"]):
        run = hb.simulate(m, 3.0)
        for t in (0.5, 2.5):
            assert run["c.q"].at(t) == pytest.approx(-2.0 * math.cos(t), rel=1e-9)
