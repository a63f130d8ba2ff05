"""A run that is refused before it has values: what there is of it can be asked."""

from __future__ import annotations

import pytest

import hybond as hb


@pytest.mark.parametrize("turn", [False, True])
def test_what_a_run_without_values_leaves_has_none_and_says_so(turn: bool) -> None:
    m = hb.Model("x")
    m.add(j=hb.Zero(), c=hb.C({"e": "sqrt(q)"}, q=-1.0), r=hb.R({"e": "sqrt(f)"}))
    m.bond("c -> j" if turn else "j -> c", "j -> r")
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, 1.0)
    assert caught.value.code == "HB-N302"
    run = caught.value.partial
    assert run is not None and not run.segments
    for name in ("c.q", "r.f"):
        assert len(run[name].y) == len(run[name].t) == 0
    with pytest.raises(hb.UsageError, match="refused at 0 s, before it had values") as asked:
        run.sample([0.0], ["c.q"])
    assert asked.value.code == "HB-S110"
