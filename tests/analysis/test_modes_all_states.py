"""All states of each mode at once: gaps worked out by hand, proofs, what never fires."""

from pathlib import Path

import numpy as np
import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name):
    return hb.load(EXAMPLES / f"{name}.toml")


def capacitor(*machines):
    """A capacitor of 1 F, so that its voltage is what it stores; switches that do not move it."""
    m = hb.Model("capacitor")
    m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0))
    m.bond("f -> n -> c")
    for k, (states, start, rules) in enumerate(machines):
        for state in states:
            m.add(**{f"s{k}{state}": hb.One(), f"r{k}{state}": hb.R(1)})
            m.bond(f"n -> s{k}{state} -> r{k}{state}")
        named = {state: [f"s{k}{state}"] for state in states}
        m.machine(f"m{k}", states=named, start=start, rules=rules)
    return m


def kinds(found):
    return {n.mode: set(n.kinds) for n in found.nodes}


def test_the_ball_of_two_contacts_has_no_mode_between_two_speeds():
    found = hb.reachable(example("bouncing_ball_no_mode"), until=0)
    assert found.exact and found.time == "possible"
    (gap,) = found.gaps
    # mass 1 kg: by hand, -fast <= p < -slow while it is not above the floor
    assert gap.states == ("-1 <= ball.p < -0.5", "height <= 0")
    assert gap.begin == "off, off" and gap.confirmed and gap.cycle
    assert gap.modes == ("off, off", "off, on", "off, off")
    assert kinds(found)["on, off"] == {"pinnacle"}
    assert kinds(found)["off, on"] == {"continuous", "mythical"}


@pytest.mark.parametrize(
    ("p", "stops"), [(-1.01, False), (-0.99, True), (-0.51, True), (-0.49, False)]
)
def test_the_gap_is_where_runs_stop(p, stops):
    text = (EXAMPLES / "bouncing_ball_no_mode.toml").read_text(encoding="utf-8")
    text = text.replace('I = "1 kg"', f'I = "1 kg", p = "{p} N*s"').replace('1 m"', '0 m"')
    run = hb.simulate(hb.loads(text), until="1 us", on_error="return")
    assert (run.error is not None and run.error.code == "HB-N401") is stops


def test_the_repaired_ball_is_proved():
    found = hb.reachable(example("bouncing_ball_two_junctions"), until=0)
    assert found.exact and (found.time, found.gaps, found.left_out) == ("proved", (), ())
    # at rest the plastic contact carries the weight, whatever is stored
    assert [str(t) for t in found.never] == [
        "slow_impact: on -> off when plastic.e < 0 or pre(v.f) < -slow"
    ]


def test_the_published_diode_lacks_a_mode_below_its_threshold():
    found = hb.reachable(example("diode_inductor_no_mode"), until=0)
    gaps = {(g.begin, g.states) for g in found.gaps}
    # L*I_th = 0.1 H * 10 mA
    assert ("open, conducts", ("0 < L.p < 0.001",)) in gaps
    # the switch closed: the coil has to take V + drop = 10.7 V at 10 ohm, 1.07 A to 1.08 A
    assert ("closed, blocks", ("0.107 < L.p < 0.108", "time < 0.05")) in gaps
    assert all(g.confirmed for g in found.gaps)
    assert "mythical" in kinds(found)["open, blocks"]


def test_the_repaired_diode_is_proved_for_currents_that_the_source_can_make():
    found = hb.reachable(example("diode_inductor"), until=0, where="L.f <= 1 A")
    assert found.exact and found.time == "proved" and found.where == ("L.f <= 1 A",)
    without = hb.reachable(example("diode_inductor"), until=0)
    assert [g.states[0] for g in without.gaps] == ["0.107 < L.p < 0.108"] * 2


def test_complementary_guards_are_proved_and_overlapping_ones_are_not():
    two = ["a", "b"]
    rules = ["a -> b when c.e > 1", "b -> a when c.e <= 1"]
    assert hb.reachable(capacitor((two, "a", rules)), until=0).time == "proved"
    found = hb.reachable(
        capacitor((two, "a", ["a -> b when c.e > 1", "b -> a when c.e < 1.5"])), until=0
    )
    assert found.time == "possible"
    assert {g.states for g in found.gaps} == {("1 < c.q < 1.5",)}


def test_closed_guards_meet_in_one_state():
    rules = ["a -> b when c.e >= 1", "b -> a when c.e <= 1"]
    m = hb.Model("held")
    m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0))
    m.bond("f -> n -> c")
    m.machine("m0", states={"a": [], "b": []}, start="a", rules=rules)
    found = hb.reachable(m, until=0)
    assert {g.states for g in found.gaps} == {("c.q = 1",)}
    assert found.time == "possible" and found.gaps[0].witness == {"c.q": 1.0}


def test_closed_guards_that_meet_where_one_of_them_ceases_are_not_confirmed():
    # it falls: what holds at 1 in (a) does not a moment later
    rules = ["a -> b when c.e >= 1", "b -> a when c.e <= 1"]
    found = hb.reachable(capacitor((["a", "b"], "a", rules)), until=0)
    assert {g.states for g in found.gaps} == {("c.q = 1",)}
    assert found.time == "not decided" and not found.gaps[0].witness


def test_a_cycle_of_three_is_where_all_sets_that_are_left_meet():
    rules = ["a -> b when c.e > 1", "b -> c when c.e < 4 and c.e > 2", "c -> a when c.e < 3"]
    found = hb.reachable(capacitor((["a", "b", "c"], "a", rules)), until=0)
    assert {g.states for g in found.gaps} == {("2 < c.q < 3",)}
    (first, *_) = found.gaps
    assert first.modes == ("a", "b", "c", "a") and first.confirmed
    assert 2.0 < first.witness["c.q"] < 3.0


def test_a_state_behind_a_guard_that_contradicts_itself_is_never_reached():
    rules = [
        "a -> b when c.e > 1",
        "b -> a when c.e < 0.5",
        "b -> c when c.e > 2 and c.e < 1.5",
        "c -> a when c.e < 0",
    ]
    found = hb.reachable(capacitor((["a", "b", "c"], "a", rules)), until=0)
    assert found.unreachable == ("m0.c",) and found.time == "proved"
    assert [(t.source, t.target) for t in found.never] == [("b", "c"), ("c", "a")]


def test_a_rule_in_the_shadow_of_an_earlier_one_never_fires():
    rules = ["a -> b when c.e > 1", "a -> c when c.e > 2", "b -> a when c.e < 0"]
    found = hb.reachable(capacitor((["a", "b", "c"], "a", rules)), until=0)
    assert [t.target for t in found.never] == ["c"]


def test_hysteresis_has_witnesses_beyond_its_thresholds():
    rules = ["a -> b when c.e > 2", "b -> a when c.e < 1"]
    found = hb.reachable(capacitor((["a", "b"], "a", rules)), until=0)
    up, down = found.edges
    assert up.witness["c.q"] > 2.0 and down.witness["c.q"] < 1.0
    assert (up.known, down.known, found.time) == ("possible", "possible", "proved")


def test_what_joins_two_states_is_a_condition_on_both():
    found = hb.reachable(example("bouncing_ball"), until=0)
    # the floor pulls where q/C - p/(m*G) < 0, with C = 1 mm/N and G = 10 m/(N*s)
    states = ("ball.p < 0", "height <= 0", "ball.p - 10000*pad.q > 0")
    assert {g.states for g in found.gaps} == {states} and found.time == "possible"
    kept = hb.reachable(example("bouncing_ball"), until=0, where="pad.q >= 0")
    assert kept.exact and kept.time == "proved"


def test_a_law_that_asks_for_the_state_is_affine_in_each_mode():
    m = capacitor((["a", "b"], "a", ["a -> b when f.e > 2", "b -> a when f.e < 1"]))
    m.add(g=hb.Sf('if m0.state == "b" then -2*c.e else 1'))
    m.bond("g -> n")
    found = hb.reachable(m, until=0)
    assert found.exact and found.time == "proved"


@pytest.mark.slow
def test_twenty_switches_cost_no_more_than_the_modes_that_follow_each_other():
    rules = [[f"a -> b when c.e > {k + 1}", f"b -> a when c.e < {k}"] for k in range(20)]
    model = capacitor(*((["a", "b"], "a", own) for own in rules))
    found = hb.reachable(model, until=0, limit=2, samples=1)
    # from the start mode: as many of them on, from the first, as there are volts
    own = {e.target for e in found.edges if e.begin == "all at start"}
    assert own == {", ".join(f"m{j} = b" for j in range(k + 1)) for k in range(20)}
    assert found.left_out and found.time == "not decided"


def test_what_is_left_out_is_said():
    rules = ["a -> b when c.e > 2", "b -> a when c.e < 1"]
    found = hb.reachable(capacitor((["a", "b"], "a", rules)), until=0, limit=1, samples=5)
    assert found.time == "not decided" and not found.exact and found.never == ()
    assert "1 modes: what follows (b)" in found.left_out[0]


@pytest.mark.parametrize(
    "wrong", [{"where": "c.q"}, {"limit": 0}, {"samples": -1}, {"programs": 1.5}]
)
def test_refusals(wrong):
    with pytest.raises(hb.UsageError) as caught:
        hb.reachable(capacitor((["a", "b"], "a", ["a -> b when c.e > 1"])), **wrong)
    assert caught.value.code == "HB-A601"


def test_inputs_may_have_any_value():
    m = capacitor((["a", "b"], "a", ["a -> b when u > 1", "b -> a when u < 2"]))
    m.input(u=0.0)
    found = hb.reachable(m, until=0)
    assert {g.states for g in found.gaps} == {("1 < u < 2",)} and found.gaps[0].confirmed


def test_time_may_have_any_value():
    rules = ["a -> b when time >= 1", "b -> a when sin(time/(1 s)) < 2"]
    found = hb.reachable(capacitor((["a", "b"], "a", rules)), until=0)
    # that the sine is below 2 at all times is not known here: it is held as any number
    assert found.time == "possible" and "time >= 1" in found.gaps[0].states


def test_absolute_values_and_extremes_are_cut_into_cases():
    rules = ["a -> b when abs(c.e - 3) > 1", "b -> a when max(c.e, 0) < 2.5"]
    found = hb.reachable(capacitor((["a", "b"], "a", rules)), until=0)
    # left of 2 both hold, in two cases of the maximum; right of 4 only the first one
    assert found.exact and all(g.confirmed for g in found.gaps)
    told = {g.states[0] for g in found.gaps if g.states}
    assert told == {"c.q < 0", "0 <= c.q < 2"}


def brute(machines, q):
    """Settle by hand: all machines fire together, first rules first; True if it never ends."""
    state = [0] * len(machines)
    seen = set()
    while tuple(state) not in seen:
        seen.add(tuple(state))
        fired = False
        for k, rules in enumerate(machines):
            for source, target, low, high in rules:
                if source == state[k] and low < q < high:
                    state[k], fired = target, True
                    break
        if not fired:
            return False
    return True


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", range(2))
def test_random_machines_stop_where_settling_by_hand_does_not_end(seed):
    rng = np.random.default_rng(seed)
    machines = []
    for _ in range(2):
        ends = np.sort(rng.integers(-20, 20, (4, 2)) / 4.0, axis=1) + [[0.0, 0.5]]
        pairs = [(0, 1), (1, 2), (1, 0), (2, 0)]
        machines.append([(*p, *map(float, e)) for p, e in zip(pairs, ends, strict=True)])
    names = "abc"
    model = capacitor(
        *(
            (
                list(names),
                "a",
                [
                    f"{names[s]} -> {names[t]} when c.e > {lo} and c.e < {hi}"
                    for s, t, lo, hi in own
                ],
            )
            for own in machines
        )
    )
    found = hb.reachable(model, until=0)
    assert found.exact
    told = [bounds(g.states[0]) for g in found.gaps if g.begin == "a, a" and g.states]
    for q in np.arange(-6.0, 6.0, 0.25) + 0.125:
        inside = any(low < q < high for low, high in told)
        assert inside is brute(machines, float(q)), q


def bounds(text):
    words = text.split()
    if len(words) == 5:
        return float(words[0]), float(words[4])
    return (float(words[2]), np.inf) if ">" in words[1] else (-np.inf, float(words[2]))
