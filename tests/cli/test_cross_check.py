"""check --cross."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import hybond.analysis.cross.check as module

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def circuit(shell: Any) -> Any:
    shell.file("rlcd.toml", (EXAMPLES / "rlcd.toml").read_text(encoding="utf-8"))
    return shell


@pytest.mark.slow
def test_two_engines_agree(circuit: Any) -> None:
    done = circuit("check", "--cross", "rlcd.toml", "--until", "2 ms", "--step", "5 us")
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert lines[1].startswith("auto and moreau-jean, up to 2 ms")
    assert lines[-1].startswith("agree: ")


def test_json_is_one_object(circuit: Any) -> None:
    words = ("--until", "1 ms", "--engines", "rk45, radau", "--json")
    done = circuit("check", "rlcd.toml", "--cross", *words)
    assert done.code == 0
    assert done.json["hybond"] == 1 and done.json["file"] == "rlcd.toml"
    assert done.json["engines"] == ["rk45", "radau"] and done.json["verdict"] == "agree"
    assert [v["rtol"] for v in done.json["levels"]] == pytest.approx([1e-4, 1e-6, 1e-8])
    assert "error" not in done.json


def test_engines_that_differ_end_with_3(circuit: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    made = module.simulate

    def wrong(graph: Any, until: Any, **options: Any) -> Any:
        if options["solver"] == "moreau-jean":
            # as if it took the diode for shorted
            start = tuple(2 if m.law is None else 1 for m in graph.machines)
            assert start == (1,)
            options["theta"] = 1.0
            until = 2e-3
            options["step"] = 3e-5
        return made(graph, until, **options)

    monkeypatch.setattr(module, "simulate", wrong)
    done = circuit("check", "--cross", "rlcd.toml", "--until", "2 ms", "--step", "5 us", "--json")
    assert done.code == 3
    assert done.json["verdict"] == "differ" and done.json["error"]["code"] == "HB-A402"
    assert "HB-A402" in done.err and "try:" in done.err


def test_settings_reach_both_runs(circuit: Any) -> None:
    words = ("--until", "1 ms", "--engines", "rk45,radau", "--json")
    plain = circuit("check", "--cross", "rlcd.toml", *words).json
    other = circuit("check", "--cross", "rlcd.toml", "--set", "C.e=20 V", *words).json
    scale = {
        name: next(d["scale"] for d in found["differences"] if d["name"] == "C.q")
        for name, found in (("plain", plain), ("other", other))
    }
    assert scale["other"] == pytest.approx(2 * scale["plain"], rel=1e-9)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("--until", "1 ms"), "HB-X101"),
        (("--step", "1 ms"), "HB-X101"),
        (("--cross", "--engines", "rk45"), "HB-A401"),
    ],
)
def test_refusals(circuit: Any, words: tuple[str, ...], code: str) -> None:
    done = circuit("check", "rlcd.toml", *words)
    assert done.code == 1 and code in done.err
