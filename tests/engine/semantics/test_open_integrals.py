"""Guards and gaps that read integrals of what the equations leave open.

Nothing says how far such an integral has come, so nothing may depend on it.
"""

from __future__ import annotations

import pytest

import hybond as hb

I = hb.Integral


def between_switches(turned: bool, rule: str, **signals: hb.Integral) -> hb.Model:
    """Return 1 V, a switch, a node n whose effort is open, a switch, a load; both are OFF."""
    m = hb.Model("node", domain="electrical")
    m.add(s=hb.Se(1.0), a=hb.One(), n=hb.Zero(), b=hb.One(), r=hb.R(1.0))
    bonds = ("s -> a", "n -> a", "b -> n", "r -> b") if turned else ("s -> a -> n -> b -> r",)
    m.bond(*bonds)
    for name, junction in (("A", "a"), ("B", "b")):
        states = {"off": [], "on": [junction]}
        m.machine(name, states=states, start="off", rules=["off -> on when time > 10 s"])
    m.signal(**signals)
    m.machine("W", states={"u": [], "v": []}, start="u", rules=[f"u -> v when {rule}"])
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("rule", "signals"),
    [
        ("x > 0.2", {"x": I("n.e")}),
        ("pre(x) > 0.2", {"x": I("n.e")}),
        ("x < -500 or x > 500", {"x": I("n.e")}),
        ("y > 0.2", {"x": I("n.e"), "y": I("x")}),
        ("z > 0.2", {"x": I("n.e"), "y": I("x - y"), "z": I("y")}),
        ("y > 0.2", {"y": I("1e-9*n.e")}),
        ("x > 0.2 and y > 0.2", {"x": I("n.e"), "y": I("s.e", start=1.0)}),
        ("x - y > 0.2", {"x": I("n.e"), "y": I("2*n.e")}),
    ],
)
def test_a_guard_on_an_integral_of_an_open_effort_fired_by_least_leakage(
    rule: str, signals: dict[str, hb.Integral], turned: bool
) -> None:
    with pytest.raises(
        hb.HybondError, match=r"HB-J102 at W at t = 0 s: the guard .* integrals? of"
    ):
        hb.simulate(between_switches(turned, rule, **signals), until=1.0)


def test_a_guard_fired_by_an_open_integral_that_first_mattered_later() -> None:
    """Up to 0.2 s y decides; the guard held at 0.4 s, where least leakage brings x to 0.2."""
    m = between_switches(False, "y > 0.2 and x > 0.2", x=I("n.e"), y=I("s.e"))
    with pytest.raises(
        hb.HybondError, match=r"HB-J102 at W at t = 0\.4 s.*reads x, an integral of"
    ):
        hb.simulate(m, until=1.0)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("rule", "signals", "fires"),
    [
        ("y > 0.2", {"x": I("n.e"), "y": I("s.e")}, 0.2),
        ("time > 0.3 s", {"x": I("n.e")}, 0.3),
        ("y > 0.2", {"y": I("n.e + s.e - n.e")}, 0.2),
        ("y - x > 0.2", {"x": I("n.e"), "y": I("n.e + s.e")}, 0.2),
        ("y > 0.2", {"y": I("if s.e > 0 then s.e else n.e")}, 0.2),
        ("y > 0.2 or x < -1", {"x": I("abs(n.e)"), "y": I("s.e")}, 0.2),
    ],
)
def test_an_open_integral_that_decides_nothing_is_shown(
    rule: str, signals: dict[str, hb.Integral], fires: float, turned: bool
) -> None:
    run = hb.simulate(between_switches(turned, rule, **signals), until=1.0)
    assert [e.t for e in run.trace.events] == pytest.approx([0.0, fires], abs=1e-9)
    assert any("least leakage decides" in w for w in run.warnings)


def test_an_integral_of_an_effort_that_is_open_no_longer_decides() -> None:
    """A guard of a state that is not the present one asks nothing yet."""
    m = between_switches(False, "time > 0.1 s", x=I("n.e"))
    m.machine("Z", states={"p": [], "q": []}, start="p", rules=["q -> p when x > 0.2"])
    assert hb.simulate(m, until=1.0).status == "ok"


@pytest.mark.parametrize("turned", [False, True])
def test_a_model_may_ask_for_least_leakage_of_integrals(turned: bool) -> None:
    """Blocked efforts 1 - n.e and n.e: the sum of their squares is least at 1/2 V."""
    m = between_switches(turned, "abs(x) > 0.2", x=I("n.e"))
    m.indeterminate = "least leakage"
    run = hb.simulate(m, until=1.0)
    assert [e.t for e in run.trace.events] == pytest.approx([0.0, 0.4], abs=1e-9)
    assert any("reads x, an integral" in w and "as the model asks" in w for w in run.warnings)


# -- gaps ------------------------------------------------------------------------------------------


def above_a_plate(way: float, turned: bool, held: bool) -> hb.Model:
    """Return a ball that falls onto a plate without mass, which a brake holds, or nothing."""
    m = hb.Model("plate", domain="translational")
    m.add(w=hb.Se(-way * 9.81), ball=hb.I(1.0), v=hb.One(), p=hb.One(), j=hb.Zero(), r=hb.R(1.0))
    m.add(c=hb.Zero(law="unilateral", gap="h"))
    m.bond("w -> v -> ball", *(("c -> v", "p -> c") if way > 0.0 else ("v -> c", "c -> p")))
    m.bond(*(("j -> p", "r -> j") if turned else ("p -> j", "j -> r")))
    rules = ["off -> on when time > 10 s"]
    m.machine("J", states={"off": [], "on": ["j"]}, start="on" if held else "off", rules=rules)
    m.signal(h=I(f"{way}*(v.f - p.f)", start=0.5))
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_contact_closed_where_least_leakage_had_its_plate(way: float, turned: bool) -> None:
    with pytest.raises(hb.HybondError, match=r"HB-J102 at c at t = 0 s: the gap of c reads h, an"):
        hb.simulate(above_a_plate(way, turned, held=False), until=1.0)
    run = hb.simulate(above_a_plate(way, turned, held=True), until=0.5)
    assert [e.t for e in run.trace.events][1] == pytest.approx((1.0 / 9.81) ** 0.5, abs=1e-9)


def test_a_gap_of_an_open_flow_with_least_leakage() -> None:
    """Of v.f, the contact leaks v.f - p.f, the brake p.f: least squares have p.f = v.f/2."""
    m = above_a_plate(1.0, turned=False, held=False)
    m.indeterminate = "least leakage"
    run = hb.simulate(m, until=0.5)
    assert [e.t for e in run.trace.events][1] == pytest.approx((2.0 / 9.81) ** 0.5, abs=1e-9)
    assert any("the gap of c reads h" in w for w in run.warnings)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("kept", "source", "moves"),
    [
        (hb.C(1.0), "2*n.e", "k.q"),
        (hb.I(1.0), "2*n.e", "k.p"),
        (hb.C(1.0), "n.e - n.e", None),
        (hb.C(1.0), "s.e", None),
    ],
)
def test_what_is_stored_hung_on_least_leakage_and_nobody_said_so(
    kept: hb.C | hb.I, source: str, moves: str | None, turned: bool
) -> None:
    m = between_switches(turned, "time > 20 s")
    m.add(V=hb.Se(source), j=hb.One(), load=hb.R(1.0), k=kept)
    m.bond("V -> j", *(("j -> load", "j -> k") if not turned else ("load -> j", "k -> j")))
    (said,) = (w for w in hb.simulate(m, until=1.0).warnings if "least leakage decides" in w)
    assert said.endswith("decides" if moves is None else f"decides, and by that how {moves} moves")
