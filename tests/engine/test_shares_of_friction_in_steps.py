"""Frictions that hold one body share by least leakage in fixed steps, whatever is between them."""

from __future__ import annotations

import pytest

import hybond as hb

LEVERS = {
    "turned by the body": "1.2 + 0.5*sin(2*x)",
    "turned by time": "-0.8 - 0.3*time",
    "turned by another body": "1.2 + 0.3*cos(3*y)",
    "that does not turn": "1.2",
}
BESIDE = {
    "nothing": (),
    "a belt": ("belt",),
    "limits that follow a floor": ("floor",),
    "limits that follow one that is far": ("far",),
    "one that slides behind a lever": ("slider",),
}


def held(lever: str, beside: tuple[str, ...], backwards: bool) -> hb.Model:
    """Return a body that comes to rest on a friction and on another one behind a lever."""
    m = hb.Model("held", parameters={"F": 0.4})
    limit = "1 + 0.3*n.e" if {"floor", "far"} & set(beside) else "1.5"
    m.add(v=hb.One(), m=hb.I(0.4, f=1.0), g=hb.Se("F*sin(3*time)"), lever=hb.TF(lever))
    m.add(r=hb.One(law="coulomb", limit=limit), o=hb.One(law="coulomb", limit="1.2"), w=hb.One())
    m.add(u=hb.One(), M=hb.I(1.0, f=0.7))
    m.bond("g -> v -> m", "v -> lever -> w", "u -> M", "o -> w" if backwards else "w -> o")
    m.bond("r -> v" if backwards else "v -> r")
    m.signal(x=hb.Integral("v.f"), y=hb.Integral("u.f"))
    if "belt" in beside:
        m.add(s=hb.Sf(-0.08), z=hb.Zero(), b=hb.One(law="coulomb", limit="0.6"))
        m.bond("s -> z -> v", "z -> b")
    if "slider" in beside:
        m.add(turns=hb.TF("1.2 + 0.5*sin(2*y)"), c=hb.One(), C=hb.I(1.1))
        m.add(slips=hb.One(law="coulomb", limit="0.1"))
        m.bond("u -> turns -> c -> C", "c -> slips")
    if {"floor", "far"} & set(beside):
        gap = "1 + h" if "far" in beside else "h"
        m.add(n=hb.Zero(law="unilateral", gap=gap), wall=hb.Sf(0.0), q=hb.One(), B=hb.I(1.0))
        m.add(W=hb.Se(0.0 if "far" in beside else -2.0))
        m.bond("n -> q -> B", "W -> q", "wall -> n")
        m.signal(h=hb.Integral("q.f"))
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("backwards", [False, True], ids=["with", "against"])
@pytest.mark.parametrize("beside", BESIDE.values(), ids=BESIDE)
@pytest.mark.parametrize("lever", LEVERS.values(), ids=LEVERS)
def test_frictions_that_hold_behind_levers_share_by_least_leakage(
    lever: str, beside: tuple[str, ...], backwards: bool
) -> None:
    """``r + n o = F`` and the least ``r^2 + o^2``: r = F/(1 + n^2), o = n r."""
    model = held(lever, beside, backwards)
    run = hb.simulate(model, 0.5, solver="moreau-jean", step="4 ms", theta=1.0)
    assert run.status == "ok"
    side, other = ('"r -> v".e', '"o -> w".e') if backwards else ('"v -> r".e', '"w -> o".e')
    way = -1.0 if backwards else 1.0
    for t in (0.32, 0.4, 0.5):
        r, o = (way * float(run[of].at(t)) for of in (side, other))
        n = float(run["lever.1.e"].at(t)) / float(run["lever.2.e"].at(t))
        force = float(run["g.e"].at(t)) + (float(run["z.e"].at(t)) if "belt" in beside else 0.0)
        assert abs(float(run["v.f"].at(t))) < 1e-12
        assert r == pytest.approx(force / (1 + n * n), rel=1e-6, abs=1e-9)
        assert o == pytest.approx(n * r, rel=1e-6, abs=1e-9)
