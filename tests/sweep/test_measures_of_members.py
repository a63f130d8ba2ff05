"""What is measured of members by the library: closed forms, and what each run itself says."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.sweep.runner import Runner

EXAMPLES = Path(__file__).parents[2] / "examples"
RECTIFIER = """
hybond = 1
domain = "electrical"

[elements]
V  = { Se = "10 V*sin(314*time/(1 s))" }
d  = { junction = 1, law = "diode" }
rs = { R = "1 ohm" }
n  = { junction = 0 }
c  = { C = "1 mF" }
r  = { R = "100 ohm" }

[graph]
bonds = ["V -> d -> n", "d -> rs", "n -> c", "n -> r"]
"""


@pytest.fixture
def ordinary(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Members that were ordinary runs."""
    found: list[int] = []
    run = Runner._ordinary

    def counted(self: Runner, work: object, members: list[int]) -> None:
        found.extend(members)
        run(self, work, members)  # type: ignore[arg-type]

    monkeypatch.setattr(Runner, "_ordinary", counted)
    return found


def test_a_ball_that_is_dropped(ordinary: list[int]) -> None:
    """It is highest where it begins, fastest where it first strikes; later at its first apex."""
    ball = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
    g, eps = 9.81, np.linspace(0.6, 0.9, 7)
    measures = "max(height), min(v.f), max_at(v.f), max(height, start=0.9), integral(v.f)"
    table = hb.sweep(ball, {"eps": eps.tolist()}, until="1.6 s", collect=measures)
    assert not ordinary
    drop = 3.0
    strikes, speed = math.sqrt(2.0 * drop / g), math.sqrt(2.0 * drop * g)
    assert table["max(height)"] == pytest.approx(drop)
    assert table["min(v.f)"] == pytest.approx(-speed, rel=1e-12)
    assert table["max_at(v.f)"] == pytest.approx(strikes, rel=1e-12)
    apex = strikes + eps * speed / g
    assert (apex > 0.9).all() and (strikes + 2.0 * eps * speed / g > 1.6).all()
    assert table["max(height, start=0.9)"] == pytest.approx(eps**2 * drop, rel=1e-10)
    height = eps * speed * (1.6 - strikes) - 0.5 * g * (1.6 - strikes) ** 2
    assert table["integral(v.f)"] == pytest.approx(height - drop, rel=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("model", "plan", "until", "measures"),
    [
        (
            "bouncing_ball_newton.toml",
            {"eps": "0.5, 0.8"},
            "1.5 s",
            ["mean(height)", "rms(v.f)", "peak_to_peak(v.f)", "min_at(v.f)", "max(height*v.f)"],
        ),
        (
            "bouncing_ball.toml",
            {"m": "1 kg, 2 kg", "pad.C": "1e-4, 1e-2"},
            "1.2 s",
            ["max(contact.e)", "mean(contact.e)", "max_at(contact.e)", "rms(v.f, start=0.5)"],
        ),
        (
            "falling_rod.toml",
            {"mu": "0.2, 0.3"},
            None,
            ["max(w.f)", "min(yA)", "mean(w.f*theta)", "max(abs(w.f))"],
        ),
        (
            RECTIFIER,
            {"c.C": "1e-4, 1e-2"},
            "60 ms",
            ["max(d.f)", "mean(n.e)", "peak_to_peak(n.e, period=0.02)", "mean(V.e*V.f)"],
        ),
    ],
    ids=["ball", "contact", "rod", "rectifier"],
)
def test_as_each_run_says(
    model: str, plan: dict[str, str], until: str | None, measures: list[str], ordinary: list[int]
) -> None:
    read = hb.loads(model) if "\n" in model else hb.load(EXAMPLES / model)
    table = hb.sweep(read, plan, until=until, collect=measures)
    assert not ordinary
    for member in range(len(table)):
        run = table.run(member)
        for text in measures:
            name, _, rest = text.partition("(")
            signal, *given = rest.removesuffix(")").split(", ")
            options = {k: float(v) for k, v in (word.split("=") for word in given)}
            said = getattr(run[signal], name)(**options)
            size = abs(float(said)) if name.endswith("_at") else max(abs(float(said)), 1e-9)
            assert table[text][member] == pytest.approx(float(said), abs=4e-14 * size), text


def test_the_same_bits_whoever_runs_beside() -> None:
    ball = hb.load(EXAMPLES / "bouncing_ball.toml")
    asked = {"until": "1 s", "collect": "max(contact.e), mean(contact.e*v.f)"}
    plan = {"m": "lin(1 kg, 2 kg, 11)"}
    tables = [hb.sweep(ball, plan, **asked, workers=w, part=p) for w, p in ((1, 11), (2, 3))]
    for text in ("max(contact.e)", "mean(contact.e*v.f)"):
        assert tables[0][text].tobytes() == tables[1][text].tobytes()


def test_what_has_impulses_is_said_by_a_run(ordinary: list[int]) -> None:
    ball = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
    asked = "max(height), max(contact.e), integral(contact.e)"
    table = hb.sweep(ball, {"eps": "0.5, 0.7"}, until="1 s", collect=asked)
    assert {*ordinary} == {0, 1}
    assert table.counts() == {"ok (HB-R106)": 2}
    # what the floor gives is what the ball has more than its weight has given
    run = table.run(1)
    given = run.final["ball.p"] + run.graph.parameters["m"] * 9.81 * 1.0
    assert table["integral(contact.e)"][1] == pytest.approx(given, rel=1e-9)
    assert np.isnan(table["max(contact.e)"]).all()
    assert table["max(height)"] == pytest.approx(3.0)
