"""Searches whose first step is a part of next to nothing end: such a part may be zero.

A source that begins at zero is next to nothing after the shortest of times. Friction that is
written as ``sign(f)`` holds it with a value within its jump, which the function has not.
"""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.errors import HybondError

HELD_AT_A_STOP = """
hybond = 1
name = "held"

[elements]
stop = { junction = 1, law = "unilateral", restitution = 0.5 }
a = { junction = 1 }
b = { junction = 1 }
dry = { R = { e = "5.79*sign(f)" } }
i = { I = { f = { table = [
  [-0.1366, -0.0683, 0.0, 0.0683, 0.2049],
  [-111.60000000000001, -37.2, 0.0, 37.2, 55.800000000000004],
], extrapolate = "linear" } }, p = 0.0 }
s = { Se = "54.6*sin(0.0213*time)" }
at = { junction = 1 }
r = { R = 1.0 }

[graph]
bonds = ["a -> b", "b -> dry", "stop -> a", "b -> stop", "i -> b", "s -> at", "at -> stop",
         "at -> r"]
"""


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("drive", ["0.011*sin(2.74*time)", "0.002*time"])
def test_friction_that_holds_a_source_without_storage_is_refused(drive: str, turned: bool) -> None:
    m = hb.Model("held")
    m.add(j=hb.One(), dry=hb.R({"e": "0.0121*sign(f)"}), g=hb.G(0.0135), s=hb.Se(drive))
    m.bond("j -> dry", "s -> j", "g -> j" if turned else "j -> g")
    with pytest.raises(HybondError) as refused:
        hb.simulate(m, 0.676)
    assert refused.value.code == "HB-N301"
    assert "dry may be asked for a value within a jump" in str(refused.value)


def test_the_same_with_efforts_and_flows_exchanged() -> None:
    m = hb.Model("held")
    m.add(n=hb.Zero(), dry=hb.R({"f": "0.0121*sign(e)"}), r=hb.R(0.0135), s=hb.Sf("0.01*time"))
    m.bond("n -> dry", "s -> n", "n -> r")
    with pytest.raises(HybondError) as refused:
        hb.simulate(m, 0.5)
    assert refused.value.code == "HB-N301"


def test_a_kink_that_nothing_shows_before_it_is_met() -> None:
    """The step that would end before it has no time to end earlier by a part of."""
    with pytest.raises(HybondError) as refused:
        hb.simulate(hb.loads(HELD_AT_A_STOP), 0.201)
    assert refused.value.code == "HB-N410"
    assert "dry_side" in str(refused.value)
