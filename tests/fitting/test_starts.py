"""Fits from several starts: a ball whose bounces say the same of several restitutions, nearly."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.cli.main import main

BALL = "examples/bouncing_ball_newton.toml"
TRUE = 0.8
T = np.linspace(3.0, 3.6, 8)
BOUNDS = {"eps": (0.7, 0.9)}


def height(t: float, e: float) -> float:
    """Return where a ball is that is dropped from 3 m, by the parabola that it is in."""
    g, drop = 9.81, 3.0
    since, v = math.sqrt(2.0 * drop / g), math.sqrt(2.0 * drop * g)
    while True:
        v *= e
        if t < since + 2.0 * v / g:
            return v * (t - since) - 0.5 * g * (t - since) ** 2
        since += 2.0 * v / g


def minima() -> list[tuple[float, float]]:
    """Return the minima of the sum of squares, by looking at 1,000 restitutions."""
    e = np.linspace(0.7, 0.9, 1001)
    made = np.array([height(t, TRUE) for t in T])
    sums = np.array([sum((height(t, k) - y) ** 2 for t, y in zip(T, made)) for k in e])
    at = np.flatnonzero((sums[1:-1] < sums[:-2]) & (sums[1:-1] < sums[2:])) + 1
    return [(float(e[k]), float(sums[k])) for k in at]


def measured() -> dict[str, list[float]]:
    return {"t": T.tolist(), "height": [float(height(t, TRUE)) for t in T]}


def test_the_right_one_of_several_minima() -> None:
    ball = hb.load(BALL)
    known = minima()
    assert len(known) >= 4
    asked = {"free": "eps", "bounds": BOUNDS, "parameters": {"eps": 0.72}}
    many = hb.fit(ball, measured(), **asked, starts=3, seed=1)
    assert many["eps"] == pytest.approx(TRUE, rel=1e-8)
    best, *others = many.minima
    assert many.starts == sum(m.starts for m in many.minima) == 3 and best.starts >= 2
    assert best.left < 1e-10
    # where the search from the model's own value ends, what is left of the height is known:
    # it is divided by how much it varies
    size = float(np.std(measured()["height"]))
    (lost,) = others
    wrong, left = min(known, key=lambda m: abs(m[0] - lost.values[0]))
    assert lost.values[0] == pytest.approx(wrong, abs=4e-4) and left > 1.0
    assert lost.left * size**2 == pytest.approx(left, rel=1e-3)
    assert f"{best.starts} of 3 starts end here" in str(many)


def test_the_command_says_where_searches_ended(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = zip(*measured().values(), strict=True)
    table = tmp_path / "drop.csv"
    table.write_text("time,height\n" + "\n".join(f"{t!r},{y!r}" for t, y in rows))
    words = ["fit", BALL, str(table), "--free", "eps", "--set", "eps=0.81"]
    assert main([*words, "--bounds", "eps=0.78..0.85", "--starts", "2", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["starts"] == 2 and said["minima"][0]["values"] == [pytest.approx(TRUE, rel=1e-8)]
    assert main([*words, "--starts", "2"]) == 1
    assert "HB-A532 at eps: several starts lie within bounds" in capsys.readouterr().err


def test_starts_that_are_none() -> None:
    ball = hb.load(BALL)
    for wrong in ({"starts": 0}, {"starts": 2.0}, {"starts": 2, "seed": -1}):
        with pytest.raises(hb.UsageError) as refused:
            hb.fit(ball, measured(), free="eps", bounds=BOUNDS, **wrong)
        assert refused.value.code == "HB-A532"
