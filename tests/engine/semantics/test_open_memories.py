"""What was left open stays so in integrals and samples, and nothing stored may move by it.

A node floats between two switches from 0.2 to 0.4 s; before and after, it is at 1 V (or -1 V).
"""

from __future__ import annotations

import pytest

import hybond as hb

I, S = hb.Integral, hb.Sampled


def floating(turned: bool, watch: str, **signals: hb.Integral | hb.Sampled) -> hb.Model:
    """Return a source, a switch, a node n, a switch, a load; and a machine that watches it."""
    m = hb.Model("node", domain="electrical")
    m.add(s=hb.Se(1.0), a=hb.One(), n=hb.Zero(), b=hb.One(), r=hb.R(1.0))
    m.bond(*(("s -> a", "n -> a", "b -> n", "r -> b") if turned else ("s -> a -> n -> b -> r",)))
    rules = ["on -> off when time >= 0.2 s", "off -> again when time >= 0.4 s"]
    for name, junction in (("A", "a"), ("B", "b")):
        states = {"on": [junction], "off": [], "again": [junction]}
        m.machine(name, states=states, start="on", rules=rules)
    m.signal(**signals)
    if watch:
        rules = ["z -> u when time >= 0.1 s", f"u -> v when {watch}"]
        m.machine("W", states={"z": [], "u": [], "v": []}, start="z", rules=rules)
    return m


MEMORIES = {
    "later": ("time > 0.5 s and abs(x) > 0.25", {"x": I("n.e")}),
    "held": ("time > 0.5 s and abs(x) > 0.01", {"x": I("if a.on then 0 [V] else n.e")}),
    "sum of two": ("time > 0.5 s and x + y > 3", {"x": I("n.e"), "y": I("2*n.e")}),
    "sampled": ("time > 0.35 s and abs(u) < 0.7", {"u": S("n.e", every="0.1 s")}),
    "sampled integral": ("abs(u) > 0.6", {"u": S("x", every="0.1 s"), "x": I("n.e")}),
    "integral of a sample": ("abs(x) > 0.6", {"u": S("n.e", every="0.1 s"), "x": I("u")}),
    "chain": (
        "time > 0.55 s and abs(w) < 0.7",
        {"u": S("n.e", every="0.1 s"), "w": S("u", every="0.2 s")},
    ),
    "together": ("abs(x) > 0.15 and abs(n.e) > 2", {"x": I("n.e")}),
}


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("watch", "signals"), MEMORIES.values(), ids=MEMORIES)
def test_a_guard_read_later_what_least_leakage_had_put_into_a_memory(
    watch: str, signals: dict[str, hb.Integral], turned: bool
) -> None:
    with pytest.raises(hb.HybondError, match="HB-J102 at W"):
        hb.simulate(floating(turned, watch, **signals), until=1.0)


def test_a_state_entered_later_asks_what_was_open() -> None:
    m = floating(False, "", x=I("n.e"))
    rules = ["z -> u when time > 0.45 s", "u -> v when x > 0.25"]
    m.machine("W", states={"z": [], "u": [], "v": []}, start="z", rules=rules)
    with pytest.raises(hb.HybondError, match=r"HB-J102 at W at t = 0\.45 s.* depends on x, which"):
        hb.simulate(m, until=1.0)


@pytest.mark.parametrize("cut", [0.1, 0.3, 0.45])
def test_a_run_that_goes_on_knows_what_was_open(cut: float) -> None:
    m = floating(False, "time > 0.5 s and x > 0.25", x=I("n.e"))
    run = hb.simulate(m, until=cut)
    with pytest.raises(hb.HybondError, match="HB-J102 at W"):
        hb.simulate(m, until=1.0, start=run)


DECIDED = {
    "sampled anew": ("time > 0.55 s and abs(u) > 0.7", {"u": S("n.e", every="0.1 s")}, 0.55),
    "cancels": ("time > 0.5 s and y - x > 0.3", {"x": I("n.e"), "y": I("n.e + s.e")}, 0.5),
    "twice": ("time > 0.5 s and abs(y - 2*x) < 0.1", {"x": I("n.e"), "y": I("2*n.e")}, 0.5),
    "not asked": ("time > 0.5 s", {"x": I("n.e")}, 0.5),
}


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("watch", "signals", "fires"), DECIDED.values(), ids=DECIDED)
def test_what_does_not_depend_on_what_was_open_is_decided(
    watch: str, signals: dict[str, hb.Integral], fires: float, turned: bool
) -> None:
    run = hb.simulate(floating(turned, watch, **signals), until=1.0)
    times = [e.t for e in run.trace.events]
    assert times == pytest.approx([0.0, 0.1, 0.2, 0.4, fires], abs=1e-9)


def driving(turned: bool, effort: str, **signals: hb.Sampled) -> hb.Model:
    """Return the same with a source of its own that drives a capacitor, and a resistor."""
    m = floating(turned, "", **signals)
    m.add(s2=hb.Se(effort), q=hb.One(), r2=hb.R(1.0), c2=hb.C(1.0))
    m.add(s3=hb.Se(effort), p=hb.One(), r3=hb.R(2.0))
    m.bond(*(("s2 -> q", "r2 -> q", "c2 -> q") if turned else ("s2 -> q", "q -> r2", "q -> c2")))
    m.bond("s3 -> p -> r3")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("effort", "signals", "t"),
    [("u", {"u": S("n.e", every="0.1 s")}, 0.3)],
    ids=["sampled"],
)
def test_what_is_stored_followed_a_source_of_what_is_open(
    effort: str, signals: dict[str, hb.Sampled], t: float, turned: bool
) -> None:
    m = driving(turned, effort, **signals)
    with pytest.raises(hb.HybondError, match=rf"HB-J102 at c2\.q at t = {t} s: the rate of c2\.q"):
        hb.simulate(m, until=1.0)
    m.indeterminate = "least leakage"
    run = hb.simulate(m, until=1.0)
    assert any("the rate of c2.q" in w and "as the model asks" in w for w in run.warnings)


@pytest.mark.parametrize(("t", "refused"), [("0.35 s", True), ("0.65 s", False)])
def test_a_guard_on_a_flow_that_a_sample_of_what_is_open_drives(t: str, refused: bool) -> None:
    m = floating(False, "", u=S("n.e", every="0.1 s"))
    m.add(s3=hb.Se("u"), p=hb.One(), r3=hb.R(2.0))
    m.bond("s3 -> p -> r3")
    rules = [f"u -> v when time > {t} and r3.f > 0.2"]
    m.machine("W", states={"u": [], "v": []}, start="u", rules=rules)
    if refused:
        with pytest.raises(hb.HybondError, match=r"HB-J102 at W at .* depends on u"):
            hb.simulate(m, until=1.0)
    else:
        assert hb.simulate(m, until=1.0).mode["W"] == "v"


# -- open from within a mode -----------------------------------------------------------------------


def between_valves(turned: bool, watch: str = "", **signals: hb.Integral) -> hb.Model:
    """Return a node between two valves that open at 0.3 V: it floats where exp(-t) is below 0.6."""
    m = hb.Model("valves", domain="electrical")
    m.add(c=hb.C(1.0, q=1.0), rc=hb.R(1.0), z=hb.Zero(), s=hb.Se("c.e"), a=hb.One(), n=hb.Zero())
    law = {"f": "max(0 [A], (e - 0.3 [V])/(1 ohm))"}
    m.add(g1=hb.R(law), b=hb.One(), g2=hb.R(law))
    m.bond("c -> z -> rc", "s -> a", "n -> b" if not turned else "b -> n", "a -> n")
    m.bond("a -> g1", "b -> g2")
    if turned:
        m = hb.Model("valves", domain="electrical")
        m.add(c=hb.C(1.0, q=1.0), rc=hb.R(1.0), z=hb.Zero(), s=hb.Se("-c.e"), a=hb.One())
        m.add(n=hb.Zero(), g1=hb.R(law), b=hb.One(), g2=hb.R(law))
        m.bond("c -> z -> rc", "a -> s", "a -> g1", "a -> n", "n -> b", "b -> g2")
    m.signal(**signals)
    if watch:
        m.machine("W", states={"u": [], "v": []}, start="u", rules=[f"u -> v when {watch}"])
    return m


@pytest.mark.parametrize("turned", [False, True])
def test_what_comes_to_be_open_within_a_mode_was_not_told(turned: bool) -> None:
    run = hb.simulate(between_valves(turned), until=2.0)
    assert len(run.trace.events) == 1
    assert any("come to leave" in w and '"a -> n".e' in w for w in run.warnings)
    closed = hb.simulate(between_valves(turned), until=0.4)
    assert not closed.warnings


@pytest.mark.parametrize("turned", [False, True])
def test_an_integral_of_what_comes_to_be_open_within_a_mode(turned: bool) -> None:
    m = between_valves(turned, "abs(x) > 1.1", x=I("n.e"))
    with pytest.raises(hb.HybondError, match=r"HB-J102 at W at t = 0\.[5-9].*reads x, an integral"):
        hb.simulate(m, until=3.0)


@pytest.mark.parametrize("turned", [False, True])
def test_the_effort_of_a_modulus_that_comes_to_zero_is_told_open(turned: bool) -> None:
    m = hb.Model("gear", domain="electrical")
    m.add(v=hb.Sf("2*k"), t=hb.TF("k"), n=hb.Zero(), g=hb.Zero(), rr=hb.R(1.0))
    m.signal(k="max(0, 1 - 2*time/(1 s))")
    bonds = ("v -> g", "t.2 -> g", "n -> t.1") if turned else ("v -> g", "g -> t.2", "t.1 -> n")
    m.bond(*bonds, "n -> rr")
    assert any("come to leave" in w for w in hb.simulate(m, until=1.0).warnings)


# -- guards that hold within limits ----------------------------------------------------------------


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    "watch",
    ["abs(n.e) > 0.2 and time > 0.25 s", "n.e > 10 and n.e < 20", "abs(n.e + 40) < 30"],
)
def test_a_guard_that_holds_within_limits_only_was_decided_by_least_leakage(
    watch: str, turned: bool
) -> None:
    with pytest.raises(hb.HybondError, match=r"HB-J102 at W .* reads n\.e"):
        hb.simulate(floating(turned, watch), until=1.0)
