"""Where what is stored moves with each share of the laws, nothing is left to be shared."""

from __future__ import annotations

import numpy as np
import pytest
from example_runs import example
from portable_runs import portable

import hybond as hb
from hybond.engine.laws import law_parallel


def chain(many: int, *, beside: int = 1) -> hb.Model:
    """Equal capacitors in a row, diodes from each to the next, the first one charged."""
    m = hb.Model("chain", domain="electrical")
    for k in range(many):
        m.add(**{f"c{k}": hb.C(1.0, q=float(k == 0)), f"n{k}": hb.Zero()})
        m.bond(f"n{k} -> c{k}")
        for i in range(beside if k else 0):
            m.add(**{f"d{k}{i}": hb.One(law="diode")})
            m.bond(f"n{k - 1} -> d{k}{i} -> n{k}")
    return m


@pytest.mark.parametrize(
    ("model", "until", "told", "stored"),
    [
        (chain(3), 1.0, True, [1.0 / 3.0] * 3),
        (chain(3, beside=2), 1.0, False, [1.0 / 3.0] * 3),
        (example("cockcroft_walton"), 1e-3, True, None),
    ],
    ids=["one after the other", "two beside each other", "ladder"],
)
def test_it_is_the_rank_of_what_laws_do_to_what_is_stored(
    model: hb.Model,
    until: float,
    told: bool,
    stored: list[float] | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is found once, and answers are those of a search that does not know it."""
    found, searched = [], []
    real, left = law_parallel.told_by_storage, law_parallel.directions_left

    def noted(e, r):
        found.append((real(e, r), np.array(r.response.e).reshape(e.model.storages, -1)))
        return found[-1][0]

    def counted(*given):
        searched.append(given)
        return left(*given)

    monkeypatch.setattr(law_parallel, "told_by_storage", noted)
    monkeypatch.setattr(law_parallel, "directions_left", counted)
    run = portable(model, monkeypatch, until=until)
    assert found
    for said, gains in found:
        assert said == told == (np.linalg.matrix_rank(gains) == gains.shape[1])
    assert len(searched) == 1 if told else len(searched) > 1
    if stored is not None:
        assert run.y == pytest.approx(stored, rel=1e-9)
    monkeypatch.setattr(law_parallel, "told_by_storage", lambda e, r: False)
    np.testing.assert_array_equal(portable(model, monkeypatch, until=until).y, run.y)
