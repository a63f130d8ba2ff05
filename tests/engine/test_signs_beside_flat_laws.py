"""A flow that a law without effort takes whole, beside a law ``sign(f)`` that so has no flow.

Which of their flows the equations solve for is a matter of the order of declaration. Where it was
the other two, no step said that the first is zero, and the laws had no solution that was found.
"""

import itertools
from typing import Any, Literal

import pytest

import hybond as hb

NAMES = ["i", "n", "s", "b", "d"]


def node(order: tuple[str, ...], bend: str, flow: float, turned: bool = False) -> hb.Model:
    """Return an inertia that pushes a flow through a node with three laws, one of them one-way."""
    way = -1.0 if turned else 1.0
    parts: dict[str, Any] = {
        "i": hb.I(2.0, f=way * flow),
        "n": hb.Zero(),
        "s": hb.R({"e": "0.953*sign(f)"}),
        "b": hb.R({"e": bend}),
        # gives no effort to what flows out of the node by it
        "d": hb.R({"e": "if f > 0 then 0.9*f else 0"}),
    }
    m = hb.Model("node")
    m.add(**{name: parts[name] for name in order})
    m.bond("n -> i" if turned else "i -> n", "n -> s", "n -> b", "n -> d")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("order", list(itertools.permutations(NAMES))[::7])
@pytest.mark.parametrize("bend", ["1.17*max(-1, min(1, f/0.611))", "2*f", "0.5*(f + f^3)"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_law_without_effort_takes_a_flow_whole(
    order: tuple[str, ...], bend: str, turned: bool
) -> None:
    # the inertia takes a flow of 0.9 out of the node, which what is one-way lets in
    for solver in SOLVERS:
        flow = 0.9 if not turned else -0.9
        run = hb.simulate(node(order, bend, flow, turned), 1.0, solver=solver)
        assert run.status == "ok"
        for t in (0.0, 0.4, 1.0):
            assert run["i.p"].at(t) == pytest.approx(1.8, rel=1e-12)
            assert run["d.f"].at(t) == pytest.approx(-0.9, rel=1e-9)
            for name in "sb":
                assert run[f"{name}.f"].at(t) == pytest.approx(0.0, abs=1e-9)
                assert run[f"{name}.e"].at(t) == pytest.approx(0.0, abs=1e-9)


SOLVERS: list[Literal["auto", "radau"]] = ["auto", "radau"]


@pytest.mark.parametrize("order", [NAMES, NAMES[::-1]])
def test_a_sign_that_would_have_to_hold_an_effort_is_refused(order: list[str]) -> None:
    # the other way the one-way law asks for an effort of 0.3, which a sign at rest does not give
    with pytest.raises(hb.NumericsError, match="HB-N301"):
        hb.simulate(node(tuple(order), "2*f", -0.35), 1.0)
