"""A source that asks a law for more than its flat end gives: this is said of the law.

The law's pieces are states of a machine that nobody declared: a source and a flat end that fix the
same variable leave the other open, and the pieces led to each other without end (HB-N401).
"""

from __future__ import annotations

import math
import re

import pytest

import hybond as hb

AT = math.asin(0.11 / 2.15) / 24.1
"""When the source reaches 0.11."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(
    ("kind", "law"),
    [
        ("e", "0.11*tanh(f/0.826)"),
        ("e", "max(-0.11, min(0.11, f))"),
        ("e", "max(-0.05, min(0.11, 3*f))"),
        ("f", "0.11*tanh(e/0.826)"),
        ("f", "max(-0.11, min(0.11, e))"),
    ],
)
def test_it_is_the_law_that_has_no_solution(kind: str, law: str, solver: str, turned: bool) -> None:
    m = hb.Model("source")
    wave = "2.15*sin(24.1*time)"
    # another storage at the same junction: its part does not matter, and the law may become a stop
    if kind == "e":
        m.add(s=hb.Se(wave), j=hb.Zero(), k=hb.Zero(), i=hb.I(3.7, p=0.4), c=hb.C(1.0))
        beside = ["k -> j", "c -> k", "k -> i"]
    else:
        m.add(s=hb.Sf(wave), j=hb.One(), k=hb.One(), c=hb.C(3.7, q=0.4), i=hb.I(1.0))
        beside = ["j -> k", "k -> c", "k -> i"]
    m.add(r=hb.R({kind: law}))
    m.bond("s -> j", "r -> j" if turned else "j -> r", *beside)
    with pytest.raises(hb.HybondError) as refusal:
        hb.simulate(m, until=0.1, solver=solver)
    assert refusal.value.code == "HB-N301"
    assert "the laws of r have no common solution" in str(refusal.value)
    (at,) = re.findall(r"t = (\S+) s", str(refusal.value))
    assert float(at) == pytest.approx(AT, rel=1e-6)


@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
def test_a_law_that_storage_relieves_is_not_said_to_have_no_solution(rtol: float) -> None:
    """Steps may not tell it apart at a coarse tolerance; it has one, found at a finer one."""
    m = hb.Model("relieved")
    m.add(s=hb.Sf("12"), j=hb.Zero(), c=hb.C(1.0), r=hb.R({"e": "tanh(f)"}))
    m.add(k=hb.One(), i=hb.I(0.7), q=hb.R(0.1))
    m.bond("s -> j", "j -> r", "j -> c", "j -> k", "k -> i", "k -> q")
    run = hb.simulate(m, until=20.0, rtol=rtol, on_error="return")
    assert run.status == "ok" or (rtol > 1e-6 and run.error is not None)
    assert run.error is None or run.error.code != "HB-N301"
