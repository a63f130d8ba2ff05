"""Two storages at one potential, beside a law that bends, where all comes to rest.

What flows into either is there the difference of large flows: it has their last digit, and the
other, an unknown with all its digits, went after that for forty steps (HB-N301).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from scipy.optimize import brentq

import hybond as hb

LAW = "2.71*((x/0.00121) + (x/0.00121)^3)"


def fed(order: int, *, turned: bool, dual: bool) -> hb.Model:
    m = hb.Model("fed")
    letter, way = ("f", "e") if dual else ("e", "f")
    store: Callable[..., Any] = hb.I if dual else hb.C
    source = hb.Se if dual else hb.Sf
    m.add(j=hb.One() if dual else hb.Zero())
    held = {"p" if dual else "q": -0.405}
    bent = {"p" if dual else "q": 0.000893}
    name = next(iter(bent))
    parts = {
        "linear": store(0.009829787234042554, **held),
        "law": hb.R({way: LAW.replace("x", letter)}),
        "bent": store({letter: f"0.765*sinh({name}/0.00137)"}, **bent),
        "fast": source(f"37.9*(1 - 0.5*tanh(linear.{name}/0.405))"),
        "slow": source("-0.00227"),
    }
    names = list(parts)
    names = names[order:] + names[:order]
    m.add(**{k: parts[k] for k in names})
    m.signal(w=hb.Integral(f"bent.{name}"))
    for k in ("fast", "slow", "linear", "bent", "law"):
        sent = k in ("fast", "slow", "linear", "bent") if not turned else k in ("fast", "slow")
        m.bond(f"{k} -> j" if sent else f"j -> {k}")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("order", range(5))
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("dual", [False, True])
def test_what_two_storages_exchange_at_rest_is_no_law_without_a_solution(
    order: int, turned: bool, dual: bool
) -> None:
    run = hb.simulate(fed(order, turned=turned, dual=dual), until=0.986)

    def left(x: float) -> float:
        y = x / 0.00121
        return 37.9 - 0.00227 - 2.71 * (y + y**3)

    rest = brentq(left, 0.0, 0.01, xtol=1e-18)
    # what the source takes off by what is stored moves the rest by 3e-5
    assert run["law.f" if dual else "law.e"].at(0.986) == pytest.approx(rest, rel=1e-4)
    # momenta count along their own bonds, which lead to the junction or away
    held = run["linear.p" if dual else "linear.q"].at(0.986)
    sign = -1.0 if dual and not turned else 1.0
    assert held == pytest.approx(sign * 0.009829787234042554 * rest, rel=1e-4)
