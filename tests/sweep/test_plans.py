"""Plans: what factors take, how members are drawn; against NumPy, SciPy and counting."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

import hybond as hb
from hybond.sweep.laws import LAWS

WRITTEN = {
    "uniform(1, 3)": lambda: scipy.stats.uniform(1.0, 2.0),
    "1..3": lambda: scipy.stats.uniform(1.0, 2.0),
    "loguniform(1e-4, 1e-2)": lambda: scipy.stats.loguniform(1e-4, 1e-2),
    "log(1e-4, 1e-2)": lambda: scipy.stats.loguniform(1e-4, 1e-2),
    "normal(0.2, 0.01)": lambda: scipy.stats.norm(0.2, 0.01),
    "truncnormal(2, 1, 0, 3)": lambda: scipy.stats.truncnorm(-2.0, 1.0, 2.0, 1.0),
    "lognormal(3, 0.2)": lambda: scipy.stats.lognorm(0.2, scale=3.0),
    "triangular(1, 2, 5)": lambda: scipy.stats.triang(0.25, 1.0, 4.0),
    "beta(2, 3, -1, 1)": lambda: scipy.stats.beta(2.0, 3.0, -1.0, 2.0),
    "gamma(2, 3)": lambda: scipy.stats.gamma(2.0, scale=3.0),
    "weibull(2, 3)": lambda: scipy.stats.weibull_min(2.0, scale=3.0),
    "exponential(3)": lambda: scipy.stats.expon(scale=3.0),
}


def test_a_grid_has_all_combinations_the_last_fastest() -> None:
    plan = hb.Plan({"a": [1.0, 2.0], "b": "0:0.3:0.1", "c": "5 mm, 6 mm"})
    rows = plan.rows(0, len(plan))
    expected = np.array(np.meshgrid([1, 2], [0, 0.1, 0.2, 0.3], [5e-3, 6e-3], indexing="ij"))
    np.testing.assert_array_equal([rows[p] for p in "abc"], expected.reshape(3, -1))
    assert plan.rows(5, 6)["b"].tolist() == [0.2]


def test_side_by_side_there_is_no_grid() -> None:
    rows = hb.Plan({"a": [1, 2, 3], "s": "x, y, x"}, together=True).rows(1, 3)
    assert rows["a"].tolist() == [2.0, 3.0] and rows["s"] == ["y", "x"]


@pytest.mark.parametrize("text", WRITTEN)
def test_distributions_are_those_of_scipy(text: str) -> None:
    drawn = hb.Plan({"x": text}, sample="random:500", seed=3).rows(0, 500)["x"]
    unit = hb.Plan({"x": "0..1"}, sample="random:500", seed=3).rows(0, 500)["x"]
    law = WRITTEN[text]()
    np.testing.assert_allclose(drawn, law.ppf(unit), rtol=1e-12)
    given = hb.Plan({"x": law}, sample="random:500", seed=3)
    np.testing.assert_allclose(given.rows(0, 500)["x"], drawn, rtol=1e-12)
    again = hb.Plan.from_dict(given.to_dict())
    np.testing.assert_array_equal(again.rows(0, 500)["x"], given.rows(0, 500)["x"])


def test_every_distribution_is_tried() -> None:
    assert {text.partition("(")[0] for text in WRITTEN} >= set(LAWS)


@pytest.mark.parametrize("sample", ["random:9000", "lhs:9000", "sobol:8192", "saltelli:2048"])
def test_parts_are_cut_from_one_whole(sample: str) -> None:
    plan = hb.Plan({"a": "0..1", "b": "normal(0, 1)"}, sample=sample, seed=11)
    n = len(plan)
    whole = plan.rows(0, n)
    for first, last in ((0, 1), (4095, 4097), (17, 5000), (n - 1, n)):
        for path, column in plan.rows(first, last).items():
            np.testing.assert_array_equal(column, whole[path][first:last])
    other = hb.Plan({"a": "0..1", "b": "normal(0, 1)"}, sample=sample, seed=12)
    assert not np.array_equal(other.rows(0, n)["a"], whole["a"])


def test_a_latin_hypercube_has_one_value_in_each_part() -> None:
    plan = hb.Plan({"a": "2..4", "b": "normal(1, 2)", "k": "1, 2, 4"}, sample="lhs:300", seed=5)
    rows = plan.rows(0, 300)
    parts = np.sort(np.floor((rows["a"] - 2.0) / 2.0 * 300))
    assert parts.tolist() == list(range(300))
    parts = np.sort(np.floor(scipy.stats.norm(1.0, 2.0).cdf(rows["b"]) * 300))
    assert parts.tolist() == list(range(300))
    assert np.unique(rows["k"], return_counts=True)[1].tolist() == [100, 100, 100]


def test_sobols_sequence_is_balanced() -> None:
    a, b = hb.Plan({"a": "0..1", "b": "0..1"}, sample="sobol:256", seed=2).rows(0, 256).values()
    cells = np.histogram2d(a, b, bins=16, range=[[0, 1], [0, 1]])[0]
    assert (cells == 1).all()  # a net of strength 8 in base 2


@pytest.mark.parametrize(
    ("factors", "options", "code"),
    [
        ({}, {}, "HB-P101"),
        ({"a": "1 kg:2 s:0.1"}, {}, "HB-P101"),
        ({"a": "1:2:-1"}, {}, "HB-P101"),
        ({"a": "1 kg, 2 m"}, {}, "HB-P101"),
        ({"a": "log(0, 1, 3)"}, {}, "HB-P101"),
        ({"a": "norml(0, 1)"}, {"sample": "lhs:3"}, "HB-P101"),
        ({"a": "normal(0, -1)"}, {"sample": "lhs:3"}, "HB-P101"),
        ({"a": "normal(1 kg, 1 m)"}, {"sample": "lhs:3"}, "HB-P101"),
        ({"a": [[1, 2]]}, {}, "HB-P101"),
        ({"a": "normal(0, 1)"}, {}, "HB-P102"),
        ({"a": "0..1"}, {"sample": "lhs"}, "HB-P102"),
        ({"a": "0..1"}, {"sample": "lhc:3"}, "HB-P102"),
        ({"a": "0..1"}, {"sample": "lhs:3", "seed": -1}, "HB-P102"),
        ({"a": [1, 2], "b": [1, 2, 3]}, {"together": True}, "HB-P102"),
        ({"a": "1:2:0.1", "b": "1:1e6:0.001", "c": "1:1e6:1"}, {}, "HB-P101"),
    ],
)
def test_what_means_nothing_is_refused(factors: dict, options: dict, code: str) -> None:
    with pytest.raises(hb.UsageError) as refused:
        hb.Plan(factors, **options)
    assert refused.value.code == code and refused.value.hint
