"""A body that friction and a law with a sign bring to rest together: friction alone holds it there.

``p' = -(relay + sign)`` as long as it moves, whatever the law of its inertia: it rests from
``t = p / (relay + sign)`` on. The sign jumps at the same zero as the friction comes to hold, which
a step that has stages behind it sees too early, again and again.
"""

from __future__ import annotations

from itertools import permutations

import pytest

import hybond as hb

PARTS = (
    'slip = { junction = 1, law = "relay", limit = 2.68 }',
    'body = { I = { f = "1.91*((p/0.913) + (p/0.913)^3)" }, p = %s }',
    'rub = { R = { e = "5.71*sign(f)" } }',
)
BONDS = ('"slip -> body"', '"slip -> rub"')


@pytest.mark.parametrize("order", list(permutations(range(3))))
@pytest.mark.parametrize("momentum", ["1.1", "0.642", "-0.5"])
def test_what_friction_and_a_sign_stop_rests_in_any_order(
    momentum: str, order: tuple[int, ...]
) -> None:
    """In the order of momentum 1.1, and only there, it was refused: a jump switches back."""
    parts = "\n".join(PARTS[k] for k in order) % momentum
    bonds = ", ".join(BONDS if order[0] < order[1] else BONDS[::-1])
    text = f"hybond = 1\n[elements]\n{parts}\n[graph]\nbonds = [{bonds}]\n"
    run = hb.simulate(hb.loads(text), 1.0)
    rests = abs(float(momentum)) / (2.68 + 5.71)
    assert run.events[-1].t == pytest.approx(rests, abs=2e-12)
    assert run.final["body.p"] == 0.0
