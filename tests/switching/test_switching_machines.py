"""A Petri net and a global automaton choose the modes that local machines choose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb

sw = hb.switching
EXAMPLES = Path(__file__).parents[2] / "examples"


def same_events(run: hb.Result, want: hb.Result, names: list[str]) -> None:
    """The same instants, kinds of modes, states, impulses, and what is ON."""
    assert len(run.events) == len(want.events) > 1
    for a, b in zip(run.events, want.events, strict=True):
        assert a.t == pytest.approx(b.t, rel=1e-12, abs=1e-12)
        assert [s.kind for s in a.steps] == [s.kind for s in b.steps]
        assert a.after == pytest.approx(b.after, rel=1e-9, abs=1e-9)
        for s, r in zip(a.steps, b.steps, strict=True):
            on = {run.graph.nodes[n].path for n in run.graph.on_nodes(s.mode)}
            assert on == {want.graph.nodes[n].path for n in want.graph.on_nodes(r.mode)}
            assert dict(s.impulses) == pytest.approx(dict(r.impulses), rel=1e-9)
    t = np.linspace(0.0, run.t_end, 50)
    for name in names:
        assert run[name].at(t) == pytest.approx(want[name].at(t), rel=1e-9, abs=1e-9)


# -- global automaton


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("example", "names"),
    [("diode_inductor", ["L.f"]), ("clutch", []), ("half_bridge", ["L.f"]), ("falling_rod", [])],
)
def test_published_models_run_alike_with_one_machine(example: str, names: list[str]) -> None:
    """With mythical modes, jumps and sliding; the diode's machine and the switch's fire apart."""
    model = hb.load(EXAMPLES / f"{example}.toml")
    whole = sw.global_automaton(model, "mode")
    assert list(whole.machines) == ["mode"] and "mode" not in model.machines
    same_events(hb.simulate(whole), hb.simulate(model), names)


def two_tanks() -> hb.Model:
    """Two machines that fire at one instant, laws and a third machine that read their states."""
    m = hb.Model("tanks")
    m.add(a=hb.C(1.0, e=3.0), b=hb.C(2.0), na=hb.Zero(), nb=hb.Zero(), pipe=hb.One(), rp=hb.R(0.5))
    m.add(drain=hb.One(), rd=hb.R('if A.state == "open" then 1 else 2'), alarm=hb.One())
    m.add(fill=hb.Sf('if B.state != "closed" then u else 0'), ra=hb.R(5.0))
    m.bond("na -> a", "nb -> b", "na -> pipe -> nb", "pipe -> rp", "nb -> drain -> rd")
    m.bond("fill -> na", "na -> alarm -> ra")
    m.input(u=0.7)
    m.signal(watched='if A.state == "open" then a.e else 0', total=hb.Integral("watched"))
    m.machine(
        "A",
        states={"closed": [], "open": ["pipe"]},
        start="closed",
        rules=["closed -> open when time >= 0.5 and time < 2", "open -> closed when time >= 2"],
    )
    m.machine(
        "B",
        states={"closed": [], "open": ["drain"], "wide": ["drain"]},
        start="closed",
        rules=[
            "closed -> open when time >= 0.5 and time < 1",
            "open -> wide when b.e > 1",
            "wide -> closed when b.e < 0.6",
        ],
    )
    m.machine(
        "C",
        states={"quiet": [], "loud": ["alarm"]},
        start="quiet",
        rules=[
            'quiet -> loud when A.state == "open" and a.e < 2.5 and a.e > 2.2',
            "loud -> quiet when a.e < 2",
        ],
    )
    return m


@pytest.mark.parametrize("machines", [None, ["A", "B"], ["C", "A"], ["B"]])
def test_laws_signals_and_other_machines_follow_the_new_machine(machines) -> None:
    want = hb.simulate(two_tanks(), until=4, rtol=1e-11)
    assert len(want.events) >= 5
    together = [e for e in want.events if len(e.steps[0].fired) > 1]
    assert together, "two machines must fire at one instant"
    whole = sw.global_automaton(two_tanks(), "mode", machines=machines)
    run = hb.simulate(whole, until=4, rtol=1e-11)
    same_events(run, want, ["a.e", "b.e", "rd.e", "watched", "total"])


def test_what_would_be_too_large_is_refused() -> None:
    m = hb.Model("many")
    for k in range(12):
        m.add(**{f"j{k}": hb.One()})
        m.machine(
            f"S{k}",
            states={"off": [], "on": [f"j{k}"]},
            start="off",
            rules=[f"off -> on when time >= {k}", f"on -> off when time >= {k + 20}"],
        )
    with pytest.raises(hb.ModelError, match="HB-M195"):
        sw.global_automaton(m, "mode")
    with pytest.raises(hb.ModelError, match="HB-M144"):
        sw.global_automaton(m, "mode", machines=["S1", "T"])
    assert len(sw.global_automaton(m, "mode", machines=["S0", "S1"]).machines) == 11


# -- Petri net


def plan(times: list[float], net: str) -> hb.Model:
    """Two independent switches in one circuit, as machines or as one net."""
    m = hb.Model("plan")
    m.add(
        V=hb.Se(5.0), s=hb.One(), rs=hb.R(1.0), n=hb.Zero(), c=hb.C(1.0), d=hb.One(), rd=hb.R(0.3)
    )
    m.add(w=hb.One(), L=hb.I(0.4))
    m.bond("V -> s -> n -> c", "s -> rs", "n -> d -> rd", "n -> w -> L")
    t = sorted(times)
    first = ["fill -> rest when c.e >= 3", f"rest -> fill when time >= {t[1]!r} and c.e < 2"]
    second = [
        f"keep -> drain when time >= {t[0]!r} and time < {t[2]!r}",
        f"drain -> swing when time >= {t[2]!r} or c.e < 0.5",
        "swing -> keep when L.f < 0",
    ]
    if net == "net":
        sw.petri_net(
            m,
            "N",
            places={"fill": ["s"], "rest": [], "keep": [], "drain": ["d"], "swing": ["w"]},
            marked=["fill", "keep"],
            transitions=[*first, *second],
        )
    else:
        m.machine("A", states={"fill": ["s"], "rest": []}, start="fill", rules=first)
        m.machine(
            "B", states={"keep": [], "drain": ["d"], "swing": ["w"]}, start="keep", rules=second
        )
    return m


@settings(max_examples=4, deadline=None)
@given(st.lists(st.floats(0.1, 4.0), min_size=3, max_size=3))
def test_a_net_of_independent_loops_is_as_many_machines(times) -> None:
    run, want = (hb.simulate(plan(times, k), until=5, rtol=1e-11) for k in ("net", "machines"))
    same_events(run, want, ["c.e", "L.f"])


def test_concurrent_transitions_fire_together_and_conflicts_go_to_the_first() -> None:
    m = hb.Model("bare")
    m.add(**{k: hb.One() for k in "abcd"})
    sw.petri_net(
        m,
        "N",
        places={"p": ["a"], "q": ["b"], "r": ["c"], "s": ["d"], "t": []},
        marked=["p", "q"],
        transitions=[
            "p -> r when time >= 1 and time < 2",
            "p -> t when time >= 1",
            "q -> s when time >= 1 and time < 2",
            "r + s -> p + q when time >= 2",
            "q -> when time >= 3",
        ],
    )
    run = hb.simulate(m, until=6)
    seen = [[run.graph.mode_text(s.mode) for s in e.steps] for e in run.events]
    # at 1 both tokens move in one step, p's to the place listed first; at 2 they come back together
    # and p's goes on at the same instant; at 3 the last token of q is taken away
    assert seen == [["p__q"], ["r__s"], ["p__q", "q__t"], ["t"]]
    assert [s.kind for s in run.events[2].steps] == ["mythical", "continuous"]


def mutex(m: hb.Model) -> None:
    """Two users of one resource: not a product of machines, which is what nets are for."""
    sw.petri_net(
        m,
        "N",
        places={"idle1": [], "busy1": ["j1"], "idle2": [], "busy2": ["j2"], "free": []},
        marked=["idle1", "idle2", "free"],
        transitions=[
            "idle1 + free -> busy1 when c1.e < 1",
            "idle2 + free -> busy2 when c2.e < 1",
            "busy1 -> idle1 + free when c1.e > 2",
            "busy2 -> idle2 + free when c2.e > 2",
        ],
    )


def test_a_shared_resource_serves_one_at_a_time() -> None:
    """Against one machine written by hand."""

    def tanks() -> hb.Model:
        m = hb.Model("mutex")
        m.add(V=hb.Se(4.0), rail=hb.Zero())
        m.bond("V -> rail")
        for k, e in ((1, 1.5), (2, 1.7)):
            m.add(**{f"j{k}": hb.One(), f"r{k}": hb.R(1.0), f"n{k}": hb.Zero()})
            m.add(**{f"c{k}": hb.C(0.5, e=e), f"leak{k}": hb.R(3.0 + k)})
            m.bond(f"rail -> j{k} -> n{k} -> c{k}", f"j{k} -> r{k}", f"n{k} -> leak{k}")
        return m

    m, hand = tanks(), tanks()
    mutex(m)
    hand.machine(
        "N",
        states={"free": [], "one": ["j1"], "two": ["j2"]},
        start="free",
        rules=[
            "free -> one when c1.e < 1",
            "free -> two when c2.e < 1",
            "one -> free when c1.e > 2",
            "two -> free when c2.e > 2",
        ],
    )
    run, want = (hb.simulate(k, until=12, rtol=1e-11) for k in (m, hand))
    assert len(run.events) > 5
    same_events(run, want, ["c1.e", "c2.e"])
    assert set(run.graph.machines[0].states) == {
        "idle1__idle2__free",
        "busy1__idle2",
        "idle1__busy2",
    }


@pytest.mark.parametrize(
    ("code", "options"),
    [
        ("HB-M193", {"transitions": ["p to q when time > 1"]}),
        ("HB-M193", {"transitions": ["p -> x when time > 1"]}),
        ("HB-M193", {"transitions": ["p -> q + q when time > 1"]}),
        ("HB-M193", {"transitions": [" -> q when time > 1"]}),
        ("HB-M193", {"marked": ["x"]}),
        ("HB-M194", {"transitions": ["p -> q when time > 1"], "marked": ["p", "q"]}),
        ("HB-M194", {"transitions": ["p -> q when time > 1", "r -> q when time > 2"]}),
        ("HB-M195", {"transitions": ["p -> q when time > 1"], "limit": 1}),
    ],
)
def test_a_net_that_is_not_one_is_refused(code, options) -> None:
    given = {"places": {"p": [], "q": [], "r": []}, "marked": ["p", "r"], "transitions": []}
    with pytest.raises(hb.ModelError) as refusal:
        m = hb.Model()
        sw.petri_net(m, "N", **(given | options))
    assert refusal.value.code == code
    assert not m.machines


def test_many_concurrent_transitions_are_refused_quickly() -> None:
    places = {f"{side}{k}": [] for k in range(40) for side in "ab"}
    with pytest.raises(hb.ModelError, match="HB-M195"):
        sw.petri_net(
            hb.Model(),
            "N",
            places=places,
            marked=[f"a{k}" for k in range(40)],
            transitions=[f"a{k} -> b{k} when time >= {k}" for k in range(40)],
        )
