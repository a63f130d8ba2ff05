"""A mass that a source ties to what it reads, where the source turns within far less than a step.

The mass follows by the rate of the source, which is nothing beside the turn: error control sees
none of it. Oracle: the quadrature of ``dq/s(q)``, in closed form.
"""

from __future__ import annotations

import itertools
import math

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import hybond as hb


def time_to(q: float, width: float) -> float:
    """How long ``q' = 44.4 (1 - tanh(q/width)/2)`` takes from -1 to q.

    With ``x = exp(2 q/width)`` it is ``q' = 44.4 (3 + x)/(2 (1 + x))``.
    """

    def antiderivative(q: float) -> float:
        # ln(3 + x), without an x that is too large
        x = 2.0 * q / width
        log = x + math.log1p(3.0 * math.exp(-x)) if x > 0.0 else math.log(3.0 + math.exp(x))
        return 2.0 * (q + width * log) / (3.0 * 44.4)

    return antiderivative(q) - antiderivative(-1.0)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("width", [0.5, 0.05, 0.00718, 1e-4])
def test_what_a_source_drives_slows_down_with_it(width: float, solver: str) -> None:
    m = hb.Model("turns")
    m.add(j=hb.One(), c=hb.C(4.0, q=-1.0), i=hb.I(491.0, p=491.0 * 66.6))
    m.add(s=hb.Sf(f"44.4*(1 - 0.5*tanh(c.q/{width}))"))
    m.bond("s -> j", "j -> c", "j -> i")
    run = hb.simulate(m, 1.27, solver=solver)
    q = brentq(lambda q: time_to(q, width) - 1.27, 1.0, 100.0, xtol=1e-13)
    assert run["c.q"].at(1.27) == pytest.approx(q, rel=1e-6)
    assert run["i.p"].at(1.27) == pytest.approx(491.0 * 22.2, rel=1e-6)
    assert run.audit().energy < 1e-6


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("least", [1.0, 2.0])
@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
def test_a_source_turns_at_what_others_have_reached(
    width: float, least: float, solver: str
) -> None:
    """The mass stands in a relation of a mode that bends, and not in a row of its constraints.

    ``f = t`` of the other mass, so the source is ``s(t) = least + tanh((t - 0.3)/width)`` and
    ``q' = s(t) - q`` beside it. Wrong by 1e-4 to all of it, status ok.
    """
    m = hb.Model("turns")
    m.add(push=hb.Se(1.0), a=hb.One(), L=hb.I(1.0), v=hb.One(), M=hb.I(2.0))
    m.add(s=hb.Sf(f"{least} + tanh((a.f - 0.3)/{width})"))
    m.add(n=hb.Zero(), K=hb.C(1.0), u=hb.One(), D=hb.R(1.0))
    m.bond("push -> a -> L", "s -> v -> M", "v -> n -> K", "n -> u -> D")
    run = hb.simulate(m, 1.0, solver=solver)

    def gives(t: float) -> float:
        return (least + math.tanh((t - 0.3) / width)) * math.exp(t - 1.0)

    ends = [0.0, 0.3 - 20.0 * width, 0.3, 0.3 + 20.0 * width, 1.0]
    q = sum(quad(gives, a, b, epsabs=1e-13)[0] for a, b in itertools.pairwise(ends))
    assert run["K.q"].at(1.0) == pytest.approx(q, rel=1e-8)
    assert run["M.p"].at(1.0) == pytest.approx(2.0 * (least + 1.0), rel=1e-9)
    assert run.audit().energy < 1e-6
