"""What is at rest is joined to what moves, beside a law that turns at rest: no sign of rounding.

Two masses whose speeds a source holds together are as right as their last digits. Where a third
that is at rest joins them, these digits would be left to it, and whether it is pulled or pushed
hung on them: a law that lets it go one way only was found in both branches by turns.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

SPEED = """
hybond = 1
name = "joined at rest"
[elements]
n = {{ junction = 0 }}
j = {{ junction = 1 }}
a = {{ I = 1.7, p = 0.53 }}
b = {{ I = 0.9, p = -0.21 }}
c = {{ I = 1.3 }}
d = {{ R = {{ f = "if e > 0 then 0.7*e else 0" }} }}
s = {{ Sf = "0.63*sin(4.92*time)" }}
x = {{ TF = 1.6 }}
[graph]
bonds = ["n -> a", "n -> b", "s -> n", "j -> c", {bonds}]
[machines.m]
states = {{ off = [], on = ["j"] }}
start = "off"
rules = ["off -> on when time >= {time}"]
"""
WAYS = {
    "straight": '"n -> j", "j -> d"',
    "turned round": '"n -> j", "d -> j"',
    "through a lever": '"n -> x.1", "x.2 -> j", "j -> d"',
    "charges": '"n -> j", "j -> d"',
}


def model(way: str, time: float) -> hb.Model:
    """Return it, for charges with efforts and flows exchanged."""
    text = SPEED.format(bonds=WAYS[way], time=time)
    if way != "through a lever":
        text = text.replace("x = { TF = 1.6 }\n", "")
    if way == "charges":
        for old, new in (
            ("junction = 0", "junction = _"),
            ("junction = 1", "junction = 0"),
            ("junction = _", "junction = 1"),
            ("I =", "C ="),
            ("p =", "q ="),
            ("Sf", "Se"),
            ("{ f = ", "{ e = "),
            ("if e > 0 then 0.7*e", "if f > 0 then 0.7*f"),
        ):
            text = text.replace(old, new)
    return hb.loads(text)


@pytest.mark.parametrize("way", WAYS)
def test_a_mass_at_rest_that_joins_others_begins_with_the_rate_of_the_law(way: str) -> None:
    # joined, all have the effort s' / (1/I_a + 1/I_b + g^2/I_c), but the law only pulls one way
    gain = 1.0 / 1.6 if way == "through a lever" else 1.0
    turns = -1.0 if way == "turned round" else 1.0
    stored, rate = ("q", "f") if way == "charges" else ("p", "e")
    names = [f"{k}.{stored}" for k in "abc"]
    for time in (0.31, 0.42, 0.47, 0.55, 0.58, 0.71, 0.97):
        run = hb.simulate(model(way, time), 1.0)
        before = run.sample([time], names, side="left")
        after = run.sample([time], names)
        for name in names:
            assert after[name][0] == pytest.approx(before[name][0], rel=1e-15)
        assert after[f"c.{stored}"][0] == 0.0
        free = (
            gain * 0.63 * 4.92 * math.cos(4.92 * time) / (1.0 / 1.7 + 1.0 / 0.9 + gain * gain / 1.3)
        )
        began = run.sample([time + 1e-9], [f"c.{rate}"])[f"c.{rate}"][0]
        assert began == pytest.approx(turns * max(turns * free, 0.0), rel=1e-6, abs=1e-9)
