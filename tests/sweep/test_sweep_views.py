"""Quantiles, tornados and Sobol indices against closed forms; drawings by what is on them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb

PNG = b"\x89PNG"


def line() -> hb.Model:
    """A flow a + 2 b into a store that starts with c: q(1 s) = a + 2 b + c."""
    m = hb.Model("line", parameters={"a": 1.0, "b": 1.0, "c": 0.0})
    m.add(s=hb.Sf("a + 2*b"), n=hb.Zero(), q=hb.C(1.0, q="c"))
    m.bond("s -> n -> q")
    m.experiment["until"] = 1.0
    return m


def swept(factors: dict[str, Any], collect: str = "final(q.q)", **options: Any) -> Any:
    return hb.sweep(line(), hb.Plan(factors, **options), collect=collect)


def test_sobol_indices_of_a_sum() -> None:
    table = swept({"a": "0..1", "b": "0..1", "c": "normal(0, 1)"}, sample="saltelli:1024", seed=3)
    found = table.sobol("final(q.q)")
    variances = np.array([1.0 / 12.0, 4.0 / 12.0, 1.0])
    np.testing.assert_allclose(found.first, variances / variances.sum(), atol=0.01)
    np.testing.assert_allclose(found.total, variances / variances.sum(), atol=0.01)
    salib = pytest.importorskip("SALib.analyze.sobol", reason="SALib is not installed")
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[0, 1]] * 3}
    other = salib.analyze(problem, table["final(q.q)"], calc_second_order=False, seed=1)
    np.testing.assert_allclose(found.total, other["ST"], rtol=0.02)
    np.testing.assert_allclose(found.first, other["S1"], atol=0.01)


def test_a_tornado_swings_between_quantiles() -> None:
    table = swept({"a": "0..2", "b": "0..2", "c": "normal(0, 1)"}, sample="ends")
    rows = table.tornado("final(q.q)")
    assert [row[0] for row in rows] == ["b", "c", "a"]
    z = 1.6448536269514722  # of the normal distribution, at 95 %
    np.testing.assert_allclose(rows[0][1:], [0.1, 1.9, 1.2, 4.8], rtol=1e-9)
    np.testing.assert_allclose(rows[1][1:], [-z, z, 3.0 - z, 3.0 + z], rtol=1e-9)


def test_quantiles_of_a_family() -> None:
    c = np.linspace(0.0, 1.0, 101)
    table = swept({"c": c, "a": [2.0], "b": [0.0]}, "curve(q.q, 3)")
    t, found = table.quantiles("curve(q.q, 3)", (0.25, 0.5))
    assert t.tolist() == [0.0, 0.5, 1.0]
    np.testing.assert_allclose(found, [[0.25, 1.25, 2.25], [0.5, 1.5, 2.5]], atol=1e-9)


def test_drawings(tmp_path: Path) -> None:
    table = swept({"a": "0:1:0.25", "b": "0..1:4"}, "final(q.q), ended, curve(q.q, 5)")
    figure = table.plot_map("a", "b", "final(q.q)", path=tmp_path / "map.png")
    mesh = figure.axes[0].collections[0]
    a, b = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 4))
    np.testing.assert_allclose(mesh.get_array().reshape(4, 5), a + 2 * b, atol=1e-9)
    assert figure.axes[0].get_xlim() == (-0.125, 1.125)
    named = table.plot_map("a", "b", "ended")
    assert [t.get_text() for t in named.axes[0].get_legend().get_texts()] == ["time"]
    family = table.plot_family("curve(q.q, 5)", path=tmp_path / "family.png")
    median = next(line for line in family.axes[0].lines if line.get_label() == "median")
    np.testing.assert_allclose(median.get_ydata()[-1], 1.5, atol=1e-9)
    for name in ("map", "family"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(PNG)
    drawn = swept({"a": "0..1", "b": "0..1"}, sample="ends")
    bars = drawn.plot_tornado("final(q.q)").axes[0]
    assert [label.get_text() for label in bars.get_yticklabels()] == ["b", "a"]
    assert max(p.get_x() + p.get_width() for p in bars.patches) == pytest.approx(1.5 + 0.9)


@pytest.mark.parametrize(
    "look",
    [
        lambda t: t.sobol("final(q.q)"),
        lambda t: t.tornado("final(q.q)"),
        lambda t: t.quantiles("final(q.q)"),
        lambda t: t.plot_map("a", "ended", "final(q.q)"),
    ],
)
def test_what_cannot_be_told_is_refused(look: Any) -> None:
    with pytest.raises(hb.UsageError) as refused:
        look(swept({"a": [0.0, 1.0]}, "final(q.q), ended"))
    assert refused.value.code == "HB-P113"


def test_an_estimate_counts_members_and_space(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hybond.sweep.estimating.PATIENCE", 0.05)
    plan = {"a": "0:1:0.001", "b": "0:1:0.001"}
    found = hb.sweep.estimate(line(), plan, collect="final(q.q)")
    assert found.members == 1001**2 and found.failed == 0 and not found.ordinary
    assert found.parts >= 8 * found.members
    assert found.seconds == pytest.approx(found.each * found.members)
