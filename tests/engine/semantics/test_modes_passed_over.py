"""Gates of one signal through chains of different lengths: no short circuit of no duration.

The mode in which both switches of a leg are closed has no solution, and machines leave it by what
does not ask for one. Means of the leg are closed forms; what stays shorted is refused as before.
"""

import math

import pytest

import hybond as hb

D, T = 0.3, 1e-4


def chain(m: hb.Model, length: int, closes: str, opens: str) -> str:
    """Add machines that follow each other, one more in each mode, and return the last one's."""
    before = ""
    for k in range(length):
        up = closes if k == 0 else f'(if {before}.state == "on" then 1 else 0) > 0.5'
        down = opens if k == 0 else f'(if {before}.state == "on" then 1 else 0) < 0.5'
        m.machine(
            f"k{k}",
            states={"off": [], "on": []},
            start="off",
            rules=[f"off -> on when {up}", f"on -> off when {down}"],
        )
        before = f"k{k}"
    return before


States = dict[str, list[str]]


def gates(m: hb.Model, length: int, upper: States, lower: States, start: str = "open") -> None:
    """Let one machine follow the clock at once, and the other one behind a chain."""
    m.input(u=hb.Input(pwm={"period": "0.1 ms", "duty": D}))
    rules = ["open -> closed when u > 0.5", "closed -> open when u < 0.5"]
    m.machine("up", states=upper, start=start, rules=rules)
    last = chain(m, length, "u < 0.5", "u > 0.5")
    on = f'(if {last}.state == "on" then 1 else 0)'
    rules = [f"open -> closed when {on} > 0.5", f"closed -> open when {on} < 0.5"]
    m.machine("low", states=lower, start="open", rules=rules)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("engine", ["python", None])
@pytest.mark.parametrize("length", [1, 2, 4])
def test_a_leg_of_a_source_of_voltage(length: int, engine: str | None) -> None:
    m = hb.Model("leg", domain="electrical")
    m.add(V=hb.Se("10 V"), s=hb.One(), x=hb.Zero(), short=hb.Zero(), i=hb.One())
    m.add(L=hb.I("10 mH"), R=hb.R("1 ohm"))
    # a controlled 0-junction that is off shorts its bonds
    m.bond("V -> s -> x -> short", "x -> i -> L", "i -> R")
    gates(m, length, {"open": [], "closed": ["s"]}, {"open": ["short"], "closed": []})
    run = hb.simulate(m, 20 * T, engine=engine)
    assert run.status == "ok"
    assert run["x.e"].mean(period=T, periods=5) == pytest.approx(10 * D, rel=1e-9)
    a, b = math.exp(-D * T / 10e-3), math.exp(-(1 - D) * T / 10e-3)
    i = 0.0
    for _ in range(20):
        i = (10 + (i - 10) * a) * b
    assert run["L.f"].at(20 * T) == pytest.approx(i, rel=1e-8)


@pytest.mark.parametrize("length", [1, 3])
def test_a_source_of_current_that_is_cut_off_for_no_time(length: int) -> None:
    """The dual: both ways of a current are open for a moment."""
    m = hb.Model("dual", domain="electrical")
    m.add(J=hb.Sf("2 A"), a=hb.Zero(), s=hb.One(), t=hb.One(), r=hb.R("5 ohm"), q=hb.R("1 ohm"))
    m.bond("J -> a -> s -> r", "a -> t -> q")
    gates(m, length, {"open": [], "closed": ["s"]}, {"open": [], "closed": ["t"]}, "closed")
    with pytest.raises(hb.HybondError) as caught:
        # nothing is passed over where the current stays cut off
        hb.simulate(_still(), 1e-5)
    assert caught.value.code == "HB-C101"
    run = hb.simulate(m, 20 * T)
    assert run["a.e"].mean(period=T, periods=5) == pytest.approx(10 * D + 2 * (1 - D), rel=1e-9)


def _still() -> hb.Model:
    m = hb.Model("cut", domain="electrical")
    m.add(J=hb.Sf("2 A"), a=hb.Zero(), s=hb.One(), r=hb.R("5 ohm"))
    m.bond("J -> a -> s -> r")
    m.machine("S", states={"open": [], "closed": ["s"]}, start="closed",
              rules=["closed -> open when time > 1e-6"])  # fmt: skip
    return m


@pytest.mark.parametrize("rule", ["J.f > 1 and time > 2", "time > 2 us"])
def test_what_stays_shorted_is_refused(rule: str) -> None:
    m = hb.Model("short", domain="electrical")
    m.add(V=hb.Se("10 V"), J=hb.Sf("2 A"), s=hb.One(), x=hb.Zero(), y=hb.Zero(), r=hb.R("1 ohm"))
    m.bond("V -> s -> x -> r", "J -> y", "x -> y")
    rules = ["open -> closed when time >= 1 us", f"closed -> open when {rule}"]
    m.machine("S", states={"open": ["y"], "closed": ["s"]}, start="open", rules=rules)
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, 1e-5)
    assert caught.value.code in ("HB-C101", "HB-C102")


# -- states that machines cannot begin in --------------------------------------------------------


def fed(*, chained: int = 0, laws: bool = False) -> hb.Model:
    """2 A into 5 ohm or 1 ohm, whose switches are both open until their gates are read."""
    m = hb.Model("fed", domain="electrical")
    m.add(J=hb.Sf("2 A"), a=hb.Zero(), s=hb.One(), t=hb.One(), r=hb.R("5 ohm"), q=hb.R("1 ohm"))
    if laws:
        m.add(ds=hb.One(law="diode"), dt=hb.One(law="diode"), x=hb.Zero(), y=hb.Zero())
        m.bond("J -> a -> s -> x -> ds -> r", "a -> t -> y -> dt -> q")
    else:
        m.bond("J -> a -> s -> r", "a -> t -> q")
    gates(m, chained, {"open": [], "closed": ["s"]}, {"open": [], "closed": ["t"]})
    return m


@pytest.mark.parametrize("engine", ["python", None])
@pytest.mark.parametrize(("chained", "laws"), [(1, False), (3, False), (1, True)])
def test_both_ways_of_a_current_are_open_until_gates_are_read(
    chained: int, laws: bool, engine: str | None
) -> None:
    run = hb.simulate(fed(chained=chained, laws=laws), 10 * T, engine=engine)
    assert run["a.e"].mean(period=T, periods=5) == pytest.approx(10 * D + 2 * (1 - D), rel=1e-9)
    kinds = [step.kind for step in run.events[0].steps]
    assert kinds == ["mythical"] * (len(kinds) - 1) + ["continuous"]


def test_both_ways_of_a_voltage_are_shorted_until_gates_are_read() -> None:
    """The dual, with a coil that keeps its current: the short has not been there."""
    m = hb.Model("leg", domain="electrical")
    m.add(V=hb.Se("10 V"), s=hb.One(), x=hb.Zero(), short=hb.Zero(), i=hb.One())
    m.add(L=hb.I("10 mH", f="3 A"), R=hb.R("1 ohm"))
    m.bond("V -> s -> x -> short", "x -> i -> L", "i -> R")
    rules = ["shut -> apart when time >= 0"]
    m.machine("low", states={"shut": [], "apart": ["short"]}, start="shut", rules=rules)
    m.machine("up", states={"off": [], "on": ["s"]}, start="on", rules=["on -> off when time > 1"])
    run = hb.simulate(m, 1e-2)
    assert run["L.f"].at(1e-2) == pytest.approx(10 - 7 * math.exp(-1), rel=1e-9)
    assert all(not step.impulses for step in run.events[0].steps)


def read_at_the_start(rule: str) -> hb.Model:
    m = hb.Model("read", domain="electrical")
    m.add(J=hb.Sf("2 A"), a=hb.Zero(), s=hb.One(), r=hb.R("5 ohm"))
    m.bond("J -> a -> s -> r")
    m.signal(held=hb.Sampled("a.e", every="1 ms", start=1.0))
    rules = [f"open -> closed when {rule}"]
    m.machine("S", states={"open": [], "closed": ["s"]}, start="open", rules=rules)
    return m


def test_a_sample_at_the_start_is_of_the_mode_that_machines_can_begin_in() -> None:
    assert hb.simulate(read_at_the_start("time >= 0"), 1e-3)["held"].at(0.5e-3) == 10.0


@pytest.mark.parametrize("rule", ["pre(a.e) < 100", "a.e < 100", "time > 1 ms"])
def test_states_that_machines_cannot_begin_in_are_refused_where_nothing_leads_out(
    rule: str,
) -> None:
    with pytest.raises(hb.HybondError, match="HB-C101"):
        hb.simulate(read_at_the_start(rule), 1e-3)
