"""A value that does not satisfy its law ends a run as unsound, whoever made it wrong."""

import math
from collections.abc import Callable
from typing import Any

import pytest

import hybond as hb
from hybond.engine.checks import shown

LAWS = [{"e": "1000 [ohm]*f"}, {"e": "1000 [ohm]*f + 1 [V]*tanh(f/(1 [mA]))"}]


def wrong(monkeypatch: pytest.MonkeyPatch, bond: int, factor: float) -> None:
    """Let a bond variable be read wrong by a factor, whatever solved for it."""
    true: Callable[..., int] = shown.evaluate

    def evaluate(e: Any, mode: Any, v: Any, t: float, y: Any) -> int:
        found = true(e, mode, v, t, y)
        v[e.model.bond_slot + bond] *= factor
        return found

    monkeypatch.setattr(shown, "evaluate", evaluate)


def circuit(law: dict[str, str]) -> hb.Model:
    m = hb.Model("rc", domain="electrical")
    m.add(s=hb.Se("10 V"), c=hb.C("1 mF", e="2 V"), r=hb.R(law), node=hb.One())
    m.bond("s -> node", "node -> c", "node -> r")
    return m


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("bond", range(6))
def test_any_variable_that_is_wrong_is_seen(
    monkeypatch: pytest.MonkeyPatch, law: dict[str, str], bond: int
) -> None:
    wrong(monkeypatch, bond, 1.0 + 1e-6)
    run = hb.simulate(circuit(law), "1 ms", engine="python", on_error="return")
    assert run.status == "unsound"
    assert run.error is not None and run.error.code == "HB-N411" and run.error.exit_code == 3
    assert run.audit().laws and not run.audit().holds()
    with pytest.raises(hb.NumericsError):
        hb.simulate(circuit(law), "1 ms", engine="python")


@pytest.mark.parametrize("engine", ["python", None])
@pytest.mark.parametrize("law", LAWS)
def test_what_holds_is_sound(law: dict[str, str], engine: str | None) -> None:
    run = hb.simulate(circuit(law), "1 ms", engine=engine)
    assert run.status == "ok" and run.audit().laws == ()
    assert math.isfinite(run["c.e"].at(1e-3))


@pytest.mark.parametrize("engine", ["python", None])
@pytest.mark.parametrize("power", [2, 3, 5, 7])
@pytest.mark.parametrize("until", [0.02, 0.03, 0.06])
def test_what_ends_at_zero_but_for_rounding_is_sound(
    power: int, until: float, engine: str | None
) -> None:
    """A varistor at a source that is zero at the end: its current there is some 1e-90 A."""
    m = hb.Model("mov", domain="electrical")
    m.add(V=hb.Se("100 V*sin(2*pi*50 Hz*time)"), r=hb.R("10 ohm"), i=hb.One())
    m.add(mov=hb.Sf(f"1 mA*(V.e - r.e)/(1 [V])*abs((V.e - r.e)/(40 [V]))^{power}"))
    m.bond("V -> i -> r", "mov -> i")
    run = hb.simulate(m, until, engine=engine)
    assert run.status == "ok"
    v = 100.0 - run["r.e"].at(5e-3)
    assert run["r.f"].at(5e-3) == pytest.approx(1e-3 * v * abs(v / 40.0) ** power, rel=1e-6)
