"""A value that does not satisfy its law ends a run as unsound, whoever made it wrong."""

import math
from collections.abc import Callable
from typing import Any

import pytest

import hybond as hb
from hybond.engine.checks import laws_held, shown

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


@pytest.mark.sampled(3)
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


def coupled(k: float, turned: bool) -> hb.Model:
    """Return two coils, the second of which a switch opens after 1 ms onto a load."""
    m = hb.Model("coils", domain="electrical")
    m.add(core=hb.I([[1e-3, k * 1e-3], [k * 1e-3, 1e-3]]), a=hb.One(), b=hb.One(), d=hb.One())
    m.add(s=hb.Se("10*sin(314*time/(1 s))"), ra=hb.R(0.1), o=hb.Zero(), c=hb.C(1e-4), r=hb.R(100.0))
    m.bond("s -> a", "a -> core.1", "a -> ra", "d -> o", "o -> c", "o -> r")
    m.bond(*(("core.2 -> b", "d -> b") if turned else ("b -> core.2", "b -> d")))
    rules = ["off -> on when time > 1 ms"]
    m.machine("D", states={"off": [], "on": ["d"]}, start="off", rules=rules)
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("k", "solver", "rtol", "until"),
    [
        (0.9999999, "exact", 1e-6, 0.9e-3),
        (0.9999999, "exact", 1e-7, 0.95e-3),
        (0.9999999, "radau", 1e-6, 0.5e-3),
        (0.999999, "radau", 1e-8, 0.7e-3),
    ],
)
def test_a_current_that_is_zero_in_coupled_coils_was_unsound(
    k: float, solver: str, rtol: float, until: float, turned: bool
) -> None:
    """While it is open the secondary carries nothing: 1/(1 - k^2) times its flux is left of it."""
    run = hb.simulate(coupled(k, turned), until, rtol=rtol, solver=solver)
    assert run.status == "ok" and run.audit().laws == ()


@pytest.mark.parametrize("k", [0.5, 0.99])
@pytest.mark.parametrize("off", [3e-9, -3e-9])
def test_a_law_of_coupled_coils_that_is_wrong_is_seen(
    monkeypatch: pytest.MonkeyPatch, k: float, off: float
) -> None:
    """As before what rounding of its terms excuses: that is 1e-15 of them."""
    true: Callable[..., float] = laws_held.co_energy_of
    monkeypatch.setattr(laws_held, "co_energy_of", lambda *at: true(*at) * (1.0 + off))
    run = hb.simulate(coupled(k, False), 0.9e-3, engine="python", on_error="return")
    assert run.status == "unsound" and "core" in str(run.error)


@pytest.mark.sampled(3)
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
