"""Machines that follow one that slides, and remember: latches, counters, gates that feed back.

A comparator holds ``c.q = 0`` from 0.8 s on, ON for 5/8 of the time. What follows it is where bands
that become ever thinner would have it.
"""

from __future__ import annotations

import pytest

import hybond as hb

ON, OFF = 'k.state == "on"', 'k.state == "off"'
FIELD = f"(if {ON} then -1 else 1) + 0.25"
UNTIL, FIRST, PART = 5.0, 0.8, 0.625


def comparator(
    states: str, *rules: str, q: float = -1.0, field: str = FIELD, turned: bool = False, y: str
) -> hb.Model:
    """Return a comparator at ``c.q = 0`` and a machine L that follows; y is integrated."""
    m = hb.Model("comparator")
    m.add(c=hb.C(1.0, q=q), s=hb.Sf(f"-({field})" if turned else field), n=hb.Zero())
    m.bond("n -> s" if turned else "s -> n", "n -> c")
    m.machine(
        "k",
        states={"on": [], "off": []},
        start="off" if q < 0.0 else "on",
        rules=["off -> on when c.q > 0", "on -> off when c.q < 0"],
    )
    if states:
        names = states.split()
        m.machine("L", states={n: [] for n in names}, start=names[0], rules=list(rules))
    m.signal(y=hb.Integral(f"if {y} then 1 else 0", start=0.0))
    return m


def value_of(m: hb.Model) -> float:
    run = hb.simulate(m, UNTIL)
    assert run.status == "ok"
    assert run.audit().holds()
    return float(run["y"].at(UNTIL))


IN_S = 'L.state == "s"'
LATCHES = [
    # the first ON sets it, from where it begins too
    ([f"r -> s when {ON}"], -1.0, UNTIL - FIRST),
    ([f"r -> s when {ON}"], 0.0, UNTIL),
    ([f"r -> s when {OFF}"], 0.0, UNTIL),
    # what both modes of the combination set later, whichever of them is shown
    ([f"r -> s when {ON} and time > 2"], -1.0, UNTIL - 2.0),
    ([f"r -> s when {OFF} and time > 2"], -1.0, UNTIL - 2.0),
    # that resets it is no matter while the other sets it, and follows from then on
    ([f"r -> s when {ON}", f"s -> r when {OFF} and time > 2"], -1.0, 1.2 + 3.0 * PART),
    ([f"r -> s when {ON} and time < 2", f"s -> r when {OFF} and time > 3"], -1.0, 3.0 - FIRST),
    # a pulse of one turn
    ([f"r -> s when {OFF} and pre({ON})"], -1.0, UNTIL - FIRST),
]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("rules", "q", "y"), LATCHES)
def test_a_latch_stays_where_the_first_turn_has_set_it(rules, q, y, turned) -> None:
    m = comparator("r s", *rules, q=q, turned=turned, y=IN_S)
    assert value_of(m) == pytest.approx(y, abs=1e-9)


def counting(n: int) -> list[str]:
    up = [f"l{j} -> h{j} when {ON}" for j in range(n)]
    return up + [f"h{j} -> l{j + 1} when {OFF}" for j in range(n)]


@pytest.mark.parametrize("n", [1, 3, 40])
def test_a_counter_counts_to_its_end_in_no_time(n: int) -> None:
    states = " ".join(f"l{j} h{j}" for j in range(n)) + f" l{n}"
    m = comparator(states, *counting(n), y=f'L.state == "l{n}"')
    assert value_of(m) == pytest.approx(UNTIL - FIRST, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_count_that_turns_the_motion_round_ends_the_sliding(n: int, turned: bool) -> None:
    states = " ".join(f"l{j} h{j}" for j in range(n)) + f" l{n}"
    done = f'L.state == "l{n}"'
    m = comparator(
        states, *counting(n), field=f"if {done} then 1.25 else {FIELD}", turned=turned, y=done
    )
    run = hb.simulate(m, UNTIL)
    assert float(run["c.q"].at(UNTIL)) == pytest.approx(1.25 * (UNTIL - FIRST), abs=1e-9)
    assert run.sliding == ()


@pytest.mark.parametrize("q", [-1.0, 1.0])
def test_a_latch_of_two_gates_is_set(q: float) -> None:
    m = comparator("", q=q, y='Q.state == "hi"')
    low = f'{ON} or Q.state == "hi"'
    m.machine(
        "Q",
        states={"lo": [], "hi": []},
        start="lo",
        rules=['lo -> hi when P.state == "lo"', 'hi -> lo when P.state == "hi"'],
    )
    m.machine(
        "P",
        states={"lo": [], "hi": []},
        start="hi",
        rules=[f"lo -> hi when not ({low})", f"hi -> lo when {low}"],
    )
    assert value_of(m) == pytest.approx(UNTIL - FIRST if q < 0.0 else UNTIL, abs=1e-9)


@pytest.mark.parametrize("by", [ON, OFF])
@pytest.mark.parametrize("q", [-1.0, 1.0])
def test_a_latch_that_waits_for_a_level_is_asked_in_each_mode(by: str, q: float) -> None:
    m = comparator("r s", f"r -> s when {by} and w > 2", q=q, y=IN_S)
    m.signal(w=hb.Integral("1", start=0.0))
    assert value_of(m) == pytest.approx(UNTIL - 2.0, abs=1e-9)


def test_a_machine_of_three_states_goes_round_where_a_comparator_leads_it() -> None:
    rules = [f"a -> b when {ON}", f"b -> c when {ON} and time > 2.5"]
    m = comparator("a b c", *rules, f"b -> a when {OFF}", f"c -> a when {OFF}", y='L.state == "c"')
    assert value_of(m) == pytest.approx(2.5 * PART, abs=1e-9)


TOGGLE = [f"a -> b when {ON}", f"b -> c when {OFF}", f"c -> d when {ON}", f"d -> a when {OFF}"]


@pytest.mark.parametrize("turned", [False, True])
def test_a_toggle_has_no_limit(turned: bool) -> None:
    m = comparator("a b c d", *TOGGLE, turned=turned, y='L.state == "b"')
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, UNTIL)
    assert caught.value.code == "HB-N415"
    assert caught.value.where == "machines.L"
    assert caught.value.hint
    # and with a band it has what it has: for half of the time
    run = hb.simulate(m, UNTIL, sliding="hysteresis", hysteresis=0.01)
    assert float(run["y"].at(UNTIL)) == pytest.approx(PART / 2 * (UNTIL - FIRST), rel=0.03)


def test_a_latch_between_two_comparators_that_switch_by_themselves_has_no_limit() -> None:
    m = comparator("r s", f"r -> s when {ON}", 's -> r when j.state == "on"', y=IN_S)
    m.add(d=hb.C(1.0, q=-2.0), t=hb.Sf('(if j.state == "on" then -1 else 1) + 0.25'), o=hb.Zero())
    m.bond("t -> o -> d")
    rules = ["off -> on when d.q > 0", "on -> off when d.q < 0"]
    m.machine("j", states={"on": [], "off": []}, start="off", rules=rules)
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, UNTIL)
    assert caught.value.code == "HB-N415"


@pytest.mark.parametrize(("rules", "y"), [(2, PART * (UNTIL - FIRST)), (1, UNTIL - FIRST)])
@pytest.mark.parametrize("turned", [False, True])
def test_what_a_divider_shows_of_a_comparator_is_followed(rules: int, y: float, turned) -> None:
    """The flow that is compared is 5 or 0, and never the average between."""
    level = -2.5 if turned else 2.5
    there = ["r -> s when R.f > 2.5", "s -> r when R.f < 2.5"][:rules]
    m = comparator("r s", *there, turned=turned, y=IN_S)
    m.add(g=hb.Se(f"if {ON} then {2 * level} else 0"), R=hb.R(1.0), v=hb.One())
    m.bond("v -> g" if turned else "g -> v", "v -> R")
    run = hb.simulate(m, UNTIL)
    assert (run.status, run.warnings) == ("ok", ())
    assert float(run["y"].at(UNTIL)) == pytest.approx(y, abs=1e-9)
    assert run.weight("L", "s", 4.0) == pytest.approx(PART if rules == 2 else 1.0, abs=1e-9)


def test_what_trips_at_the_peak_of_a_chopped_flow_does_not_wait_for_the_average() -> None:
    m = comparator("r s", "r -> s when R.f > 4", y=IN_S)
    m.signal(w=hb.Integral("1", start=0.0))
    m.add(g=hb.Se(f"if {ON} then 2*w else 0"), R=hb.R(1.0), v=hb.One())
    m.bond("g -> v -> R")
    assert value_of(m) == pytest.approx(UNTIL - 2.0, abs=1e-7)


def test_what_is_led_elsewhere_by_the_mode_that_an_event_comes_in_has_no_limit() -> None:
    """At 2 s it waits for OFF, from where ON takes it away for good, or is there at once."""
    rules = [f"r -> s when {ON} and time > 2", f"r -> t when {OFF} and time > 2"]
    m = comparator("r s t", *rules, y=IN_S)
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, UNTIL)
    assert caught.value.code == "HB-N415"


def test_what_reads_itself_as_it_was_is_asked_again_once_that_is_settled() -> None:
    rules = [f"r -> s when pre({ON}) and {ON}", f"s -> r when {OFF} and w > 2"]
    m = comparator("r s", *rules, y=IN_S)
    m.signal(w=hb.Integral("1", start=0.0))
    assert value_of(m) == pytest.approx(2.0 - FIRST + 3.0 * PART, abs=1e-9)


def beside_another(when: str) -> hb.Model:
    """Return a comparator, and a latch that moves the level of a second one that slides at zero."""
    m = comparator("r s", f"r -> s when {when}", y="time > 0")
    m.add(d=hb.C(1.0, q=-0.3), w=hb.Sf('(if k2.state == "on" then -1 else 1) + 0.3'), o=hb.Zero())
    m.bond("w -> o -> d")
    level = f"(if {IN_S} then -0.58 else 0)"
    rules = [f"off -> on when d.q > {level}", f"on -> off when d.q < {level}"]
    m.machine("k2", states={"on": [], "off": []}, start="off", rules=rules)
    return m


@pytest.mark.parametrize("when", [f"{OFF} and time > 1", f"{ON} and time > 1"])
def test_a_latch_that_moves_what_another_slides_on_while_it_is_led_is_refused(when: str) -> None:
    """It was passed over, and the second one slid on beside its level, or the run had no end."""
    with pytest.raises(hb.NumericsError, match="HB-N415") as refused:
        hb.simulate(beside_another(when), UNTIL)
    assert refused.value.where == "machines.L"
    assert "moves what another machine compares" in str(refused.value)


@pytest.mark.parametrize(
    ("when", "level"),
    [
        (f"{OFF} and time > 99", 0.0),
        (f"{OFF} and d.q > 5", 0.0),
        (ON, -0.58),
        (f"{OFF} and c.q > -0.5", -0.58),
        ("time > 2", -0.58),
    ],
)
def test_a_latch_that_may_move_what_another_slides_on_and_does_not_is_none(when, level) -> None:
    """It was refused for what it might do; what an event sets moves the level at that event."""
    run = hb.simulate(beside_another(when), UNTIL)
    assert float(run["d.q"].at(UNTIL)) == pytest.approx(level, abs=1e-9)


@pytest.mark.slow
def test_a_counter_of_too_many_turns_is_named() -> None:
    n = 4100
    states = " ".join(f"l{j} h{j}" for j in range(n)) + f" l{n}"
    m = comparator("a b", f"a -> b when {ON}", y="time > 0")
    m.machine("count", states={s: [] for s in states.split()}, start="l0", rules=counting(n))
    with pytest.raises(hb.NumericsError, match="HB-N415") as refused:
        hb.simulate(m, UNTIL)
    assert refused.value.where == "machines.count"
