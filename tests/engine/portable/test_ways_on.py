"""Which way a state goes on from switching surfaces, against enumeration of all choices."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from engine.sliding_models import relays
from engine.ways_by_hand import switching, ways_by_hand
from hypothesis import HealthCheck, given, settings

from hybond.engine.sliding.filippov import SLIDES, find_ways, pivot
from hybond.engine.surfaces.slide_records import Slide, fit_slide, make_slide
from hybond.engine.tables import answered, tables_of

MOST = 5


@pytest.fixture(scope="module")
def slide() -> Slide:
    """Room for a few surfaces."""
    return make_slide(answered(tables_of(relays(MOST, [0.0] * MOST).flatten(), until=1.0)))


def ways(slide: Slide, a: np.ndarray, b: np.ndarray) -> tuple[int, np.ndarray, np.ndarray | None]:
    """Return how many ways there are for ``dg/dt = a + B w``, one, and what pivoting finds."""
    k = len(a)
    model = SimpleNamespace(storages=k, integrals=0, bonds=0, laws=0, ports=0)
    fit_slide(model, slide, MOST, MOST + 1)
    slide.k, slide.product, slide.parts = k, False, k + 1
    slide.part_speed[: k * (k + 1)] = np.vstack([a, a + b.T]).ravel().tolist()
    slide.sides[:k] = [SLIDES] * k
    e = SimpleNamespace(slide=slide)
    many = find_ways(e)
    best = np.array(slide.best_weight[:k])
    return many, best, np.array(slide.best_weight[:k]) if pivot(e) else None


def is_p(m: np.ndarray) -> bool:
    k = len(m)
    return all(
        np.linalg.det(m[np.ix_(c, c)]) > 1e-3
        for r in range(1, k + 1)
        for c in itertools.combinations(range(k), r)
    )


@settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
@given(system=switching())
def test_a_p_matrix_leaves_one_way_and_pivoting_finds_it(slide, system) -> None:
    a, b = system
    expected = ways_by_hand(a, b)
    many, best, pivoted = ways(slide, a, b)
    assert many >= len(expected)
    assert bool(many) == bool(expected)
    if many:
        assert any(np.abs(best - other).max() < 1e-9 for other in expected)
    if is_p(-b):
        assert len(expected) == 1
        assert pivoted == pytest.approx(expected[0], abs=1e-9)


def test_relays_that_win_on_their_own_surfaces_have_one_way(slide) -> None:
    generator = np.random.default_rng(11)
    for _ in range(60):
        k = int(generator.integers(1, MOST + 1))
        b = generator.uniform(-1.0, 1.0, (k, k)) / k
        b -= np.diag(np.abs(b).sum(axis=1) + generator.uniform(0.1, 1.0, k))
        a = generator.uniform(-0.5, 1.5, k)
        many, only, found = ways(slide, a, b)
        assert many == 1
        assert found == pytest.approx(only, abs=1e-14)
        # the inclusion itself
        speed = a + b @ only
        inside = (only > 0) & (only < 1)
        assert np.abs(speed[inside]).max(initial=0.0) < 1e-12
        assert (speed[only >= 1] >= -1e-12).all()
        assert (speed[only <= 0] <= 1e-12).all()


@pytest.mark.parametrize(
    ("a", "b", "many", "best"),
    [(1.5, -2.0, 1, 0.75), (1.5, -1.0, 1, 1.0), (-1.0, 2.0, 3, 0.5)],
)
def test_both_push_in_or_through_or_away(slide, a, b, many, best) -> None:
    found, weight, _ = ways(slide, np.array([a]), np.array([[b]]))
    assert (found, weight.tolist()) == (many, [best])
