"""Corner cases of what a model means: a test for each row of the table in docs/semantics.md.

Expected are closed forms and what that page says: charges and momenta that are kept, work of
sources, instants of linear motions.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import hybond as hb

PAGE = Path(__file__).parents[3] / "docs" / "semantics.md"


def clock(guard: str, **also: hb.Input) -> hb.Model:
    """A capacitor whose voltage is the time, and a coil that the guard cuts off."""
    m = hb.Model("clock")
    m.add(u=hb.Sf(1.0), n=hb.Zero(), c=hb.C(1.0), i=hb.I(1.0, p=1.0), x=hb.Zero(), a=hb.One())
    m.bond("u -> n -> c", "i -> x -> a")
    m.input(**also)
    m.machine("s", states={"on": ["a"], "off": []}, start="on", rules=[f"on -> off when {guard}"])
    return m


def joined(*rules: str, start: str = "apart") -> hb.Model:
    """Three capacitors, 10 V on 1 F, 4 V on 2 F, 0 V on 2 F, and switches between neighbours."""
    m = hb.Model("joined")
    m.add(c1=hb.C(1.0, e=10.0), c2=hb.C(2.0, e=4.0), c3=hb.C(2.0, e=0.0))
    m.add(n1=hb.Zero(), n2=hb.Zero(), n3=hb.Zero(), s12=hb.One(), s23=hb.One())
    m.bond("n1 -> c1", "n2 -> c2", "n3 -> c3", "n1 -> s12 -> n2", "n2 -> s23 -> n3")
    states = {"apart": [], "first": ["s12"], "second": ["s23"], "over": []}
    m.machine("s", states=states, start=start, rules=list(rules))
    return m


def voltages(run: hb.Result) -> list[float]:
    return [float(run[f"c{k}.e"].at(run.t_end)) for k in (1, 2, 3)]


def kinds(event: object) -> list[str]:
    return [step.kind for step in event.steps]  # type: ignore[attr-defined]


def instants(run: hb.Result) -> list[float]:
    """When machines fired."""
    return [e.t for e in run.events if any(step.fired for step in e.steps)]


# -- the ends of a run ---------------------------------------------------------------------------


def test_guard_true_at_the_start() -> None:
    run = hb.simulate(clock("c.e >= 0"), until=1.0)
    (event,) = run.events
    assert (event.t, event.cause, kinds(event)) == (0.0, "start", ["mythical", "continuous"])
    energy = event.steps[-1].energy
    assert energy is not None and (energy.before, energy.after, energy.lost) == (0.5, 0.0, 0.5)


@pytest.mark.parametrize("guard", ["c.e >= 1", "c.e > 1", "2*c.e >= 2"])
def test_guard_true_exactly_at_until(guard: str) -> None:
    run = hb.simulate(clock(guard), until=1.0)
    assert instants(run) == [pytest.approx(1.0, abs=1e-12)]
    assert run.mode == {"s": "off"} and run.final["i.p"] == 0.0
    assert hb.simulate(clock(guard), until=1.0 - 1e-9).mode == {"s": "on"}


@pytest.mark.parametrize("guard", ["time >= 1", "g > 0.5"])
def test_time_event_at_until(guard: str) -> None:
    run = hb.simulate(clock(guard, g=hb.Input(table=[(0, 0), (1, 1)])), until=1.0)
    assert instants(run) == [1.0] and run.mode == {"s": "off"}


def test_sample_at_until() -> None:
    m = hb.Model("sampled")
    m.add(u=hb.Sf("n"), z=hb.Zero(), c=hb.C(1.0))
    m.bond("u -> z -> c")
    m.signal(n=hb.Sampled("n + 1", every=0.25))
    run = hb.simulate(m, until=1.0)
    # set at 0, 1/4, 1/2 and 3/4: (1 + 2 + 3 + 4)/4
    assert run["n"].at(1.0) == 4.0
    assert run["c.q"].at(1.0) == pytest.approx(2.5, rel=1e-12)


# -- several guards ------------------------------------------------------------------------------


@pytest.mark.parametrize(("first", "second"), [("first", "second"), ("second", "first")])
def test_two_guards_of_one_machine(first: str, second: str) -> None:
    rules = [f"apart -> {first} when time >= 1", f"apart -> {second} when c1.e > 5"]
    for rule in (0, 1):  # both hold at 1 s
        rules[rule] = rules[rule].replace("c1.e > 5", "c1.e > 5 and time >= 1")
    run = hb.simulate(joined(*rules), until=2.0)
    (fired,) = [f for e in run.events for s in e.steps for f in s.fired]
    assert fired.target == first and len(fired.passed_over) == 1
    assert run.mode == {"s": first}


def freewheel(diode: str = "D.e > 0") -> hb.Model:
    """A coil of 1 H and 1 A; its switch opens at 1 s, a diode of 0.5 V may take its current."""
    m = hb.Model("freewheel")
    m.add(L=hb.I(1.0, p=1.0), n=hb.Zero(), sw=hb.One(), D=hb.One(), drop=hb.Se(0.5))
    m.bond("sw -> n -> L", "D -> n", "D -> drop")
    m.machine("S", states={"on": ["sw"], "off": []}, start="on", rules=["on -> off when time >= 1"])
    rules = [f"off -> on when {diode}", "on -> off when D.f < 0"]
    m.machine("V", states={"off": [], "on": ["D"]}, start="off", rules=rules)
    return m


def test_guards_of_two_machines_one_after_the_other() -> None:
    run = hb.simulate(freewheel(), until=2.0)
    (event,) = [e for e in run.events if e.t > 0.0]
    assert event.t == 1.0
    assert [[f.machine for f in s.fired] for s in event.steps] == [["S"], ["V"]]
    assert kinds(event) == ["mythical", "continuous"]
    # the mode between is mythical: its impulse is not the coil's
    assert run["L.p"].at(1.0) == 1.0 and run["L.p"].at(2.0) == pytest.approx(0.5, rel=1e-12)


def test_guard_on_an_impulse() -> None:
    """Its impulse is 1 V s whatever finite part stands beside it."""
    for drop in ("D.e > 0", "D.e > 1000"):
        run = hb.simulate(freewheel(drop), until=2.0)
        (fired,) = [f for e in run.events for s in e.steps for f in s.fired if f.machine == "V"]
        assert fired.impulses["D.e"] == pytest.approx(1.0, rel=1e-12)
        assert fired.values["D.e"] == pytest.approx(-0.5, rel=1e-12)
    run = hb.simulate(
        freewheel('D.e < -0.1 and S.state == "off" and pre(L.p) > 0.5'), until=2.0
    )  # true of the finite part alone
    assert run["L.p"].at(2.0) == 0.0


def test_mode_that_repeats() -> None:
    m = hb.Model("buzzer")
    m.add(V=hb.Se(5.0), s=hb.One(), r=hb.R(1.0))
    m.bond("V -> s -> r")
    rules = ["off -> on when s.e > 1", "on -> off when s.f > 1"]
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    with pytest.raises(hb.HybondError, match="HB-N401"):
        hb.simulate(m, until=1.0)


# -- equality ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("guard", "fires"), [("c1.e < 6", False), ("c1.e <= 6", True)])
def test_jump_that_lands_on_a_threshold(guard: str, fires: bool) -> None:
    """10 V on 1 F and 4 V on 2 F make 6 V."""
    m = joined("apart -> first when time >= 1", f"first -> over when pre({guard[:4]}){guard[4:]}")
    run = hb.simulate(m, until=2.0)
    assert run.mode == {"s": "over" if fires else "first"}
    assert voltages(run) == [pytest.approx(6.0, rel=1e-15)] * 2 + [0.0]


def near(guard: str, rate: str, begin: float, solver: str) -> list[float]:
    """When a guard on c.e fires."""
    m = hb.Model("touch")
    m.add(u=hb.Sf(rate), n=hb.Zero(), c=hb.C(1.0, e=begin), sw=hb.One(), r=hb.R(1.0))
    m.bond("u -> n -> c", "n -> sw -> r")
    rule = f"off -> on when {guard}"
    m.machine("s", states={"off": [], "on": ["sw"]}, start="off", rules=[rule])
    return instants(hb.simulate(m, until=2.0, solver=solver))


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact", "qss2"])
def test_guard_that_is_touched(solver: str) -> None:
    """t^2 is zero at the start; (t - 1)^2 misses zero, or crosses it twice, by 1e-3."""
    assert near("c.e <= 0", "2*time", 0.0, solver) == [0.0]
    assert near("c.e < 0", "2*time", 0.0, solver) == []
    for guard in ("c.e < 0", "c.e <= 0"):
        assert near(guard, "2*(time - 1)", 1.0 + 1e-3, solver) == []
        crossed = 1.0 - (1e-3) ** 0.5
        assert near(guard, "2*(time - 1)", 1.0 - 1e-3, solver) == [pytest.approx(crossed, abs=1e-9)]


def test_input_that_breaks_at_a_guard() -> None:
    gate = hb.Input(table=[(0, 0), (1, 1)])
    m = clock("c.e >= 1", g=gate)
    m.add(b=hb.One())
    m.bond("x -> b")
    m.machine("t", states={"off": [], "on": ["b"]}, start="off", rules=["off -> on when g > 0.5"])
    run = hb.simulate(m, until=2.0)
    assert instants(run) == [pytest.approx(1.0, abs=1e-12)]
    assert run["i.p"].at(2.0) == 1.0  # nothing was open in between


# -- open values ---------------------------------------------------------------------------------


def floating(jump: bool, *first: str) -> hb.Model:
    m = joined("apart -> first when time >= 1") if jump else hb.Model("floating")
    m.add(V=hb.Se(5.0), r=hb.R(1.0), a=hb.One(), f=hb.Zero(), b=hb.One())
    m.bond("V -> a -> f -> b -> r")
    rules = [*first, "off -> both when f.e > 1" + (" and time >= 1" if jump else "")]
    m.machine("m", states={"off": [], "both": ["a", "b"]}, start="off", rules=rules)
    return m


@pytest.mark.parametrize("jump", [False, True])
def test_guard_on_an_open_value(jump: bool) -> None:
    with pytest.raises(hb.HybondError, match="HB-J102"):
        hb.simulate(floating(jump), until=2.0)


def test_open_value_behind_a_rule_that_holds() -> None:
    """A rule is asked, though one before it fires: the record would say whether it held."""
    with pytest.raises(hb.HybondError, match="HB-J102"):
        hb.simulate(floating(False, "off -> both when time >= 0"), until=2.0)


def test_guard_on_an_integral_of_an_impulse() -> None:
    """The coil of 1 V*s is cut off: on trial the integral of its pulse is there already."""
    m = clock("time >= 1")
    m.signal(area=hb.Integral("a.e"))
    m.machine("w", states={"no": [], "yes": []}, start="no", rules=["no -> yes when area < -0.5"])
    run = hb.simulate(m, until=2.0)
    assert kinds(run.events[-1]) == ["mythical", "continuous"]
    assert run.events[-1].t == 1.0 and run.mode == {"s": "off", "w": "yes"}
    assert float(run["area"].at(0.5)) == 0.0
    assert float(run["area"].at(2.0)) == pytest.approx(-1.0, rel=1e-15)


# -- what pre() reads ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["c1.q", "c1.e"])
def test_pre_at_an_inconsistent_start(name: str) -> None:
    """Given are 10 V and 4 V on a closed switch: pre() first reads what was given."""
    run = hb.simulate(joined(f"first -> over when pre({name}) > 8", start="first"), until=1.0)
    assert run.mode == {"s": "over"}
    assert voltages(run) == [10.0, 4.0, 0.0]  # "first" is mythical: nothing was written
    run = hb.simulate(joined(f"first -> over when pre({name}) < 8", start="first"), until=1.0)
    assert kinds(run.events[0]) == ["pinnacle", "continuous"]
    assert voltages(run) == [pytest.approx(6.0, rel=1e-15)] * 2 + [0.0]


def test_pre_of_an_input_behind_its_step() -> None:
    """At the step it is the old value; time that goes on has the new one before it."""
    step = hb.Input(table=[(0, 0), (1, 5)])
    run = hb.simulate(clock("g > 3", g=step), until=2.0)
    assert [e.cause for e in run.events] == ["start", "input"]
    run = hb.simulate(clock("pre(g) > 3", g=step), until=2.0)
    assert instants(run) == [pytest.approx(1.0, abs=1e-12)] and run.mode == {"s": "off"}
    assert run.events[-1].cause == "guard"


def test_pre_in_two_steps_of_one_instant() -> None:
    """The second step reads what the first one wrote, the first what was there before."""
    rules = ["apart -> first when time >= 1", "first -> second when pre(c1.e) < 8"]
    run = hb.simulate(joined(*rules), until=2.0)
    (event,) = [e for e in run.events if e.t > 0.0]
    fired = [f for s in event.steps for f in s.fired]
    assert fired[-1].values["pre(c1.e)"] == pytest.approx(6.0, rel=1e-15)


# -- jumps ---------------------------------------------------------------------------------------


def test_two_writes_at_one_instant() -> None:
    """Each jump begins where the last one ended: 6, 6, 0 V, then 6, 3, 3 V."""
    rules = ["apart -> first when time >= 1", "first -> second when pre(c1.e) < 8"]
    run = hb.simulate(joined(*rules), until=2.0)
    assert voltages(run) == [pytest.approx(k, rel=1e-14) for k in (6.0, 3.0, 3.0)]
    (event,) = [e for e in run.events if e.t > 0.0]
    lost = [s.energy.lost for s in event.steps if s.energy is not None and s.energy.lost != 0.0]
    assert lost == [pytest.approx(12.0, rel=1e-12), pytest.approx(18.0, rel=1e-12)]


@pytest.mark.parametrize(
    ("rule", "kind", "after"),
    [
        ("first -> second when pre(c1.e) < 8", "pinnacle", (6.0, 3.0, 3.0)),
        ("first -> second when c1.e < 8", "mythical", (10.0, 2.0, 2.0)),
        ("first -> second when c1.e < 3", "continuous", (6.0, 6.0, 0.0)),
    ],
)
def test_what_is_conserved(rule: str, kind: str, after: tuple[float, float, float]) -> None:
    """Charge is kept in all three kinds of mode; only a mythical one leaves voltages alone."""
    run = hb.simulate(joined("apart -> first when time >= 1", rule), until=2.0)
    (event,) = [e for e in run.events if e.t > 0.0]
    first = [s for s in event.steps if s.fired and s.fired[0].target == "first"]
    assert first[0].kind == kind
    assert voltages(run) == [pytest.approx(k, rel=1e-14) for k in after]
    assert after[0] + 2.0 * after[1] + 2.0 * after[2] == 18.0


def test_impulse_and_input_step_at_one_instant() -> None:
    """The source's work is its impulse times its own new value: 4 C at 5 V."""
    m = hb.Model("plug")
    m.add(V=hb.Se("u"), s=hb.One(), n=hb.Zero(), c=hb.C(1.0, e=1.0))
    m.bond("V -> s -> n -> c")
    m.input(u=hb.Input(table=[(0, 2), (1, 5)]))
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time >= 1"])
    run = hb.simulate(m, until=2.0)
    (event,) = [e for e in run.events if e.t > 0.0]
    energy = event.steps[-1].energy
    assert energy is not None
    assert (energy.before, energy.after) == (0.5, 12.5)
    assert (energy.source, energy.lost) == (pytest.approx(20.0), pytest.approx(8.0))


def test_start_against_a_constraint() -> None:
    """1 kg at 3 m/s and 2 kg at rest on one rod: 1 m/s, 3 J are lost."""
    m = hb.Model("rod", domain="translational")
    m.add(a=hb.I(1.0, f=3.0), b=hb.I(2.0, f=0.0), v=hb.One())
    m.bond("v -> a", "v -> b")
    run = hb.simulate(m, until=1.0)
    assert run["v.f"].at(1.0) == pytest.approx(1.0, rel=1e-15)
    energy = run.events[0].steps[-1].energy
    assert energy is not None and energy.lost == pytest.approx(3.0, rel=1e-15)


def test_switching_off_the_current_of_a_coil() -> None:
    """What a coil holds is lost through the bonds of the junction, and the record says so."""
    run = hb.simulate(clock("time >= 1"), until=2.0)
    (event,) = [e for e in run.events if e.t > 0.0]
    step = event.steps[-1]
    assert step.energy is not None and step.energy.lost == 0.5
    assert step.impulses["i.e"] == -1.0 and step.exchanged == {'"x -> a".e': -1.0}
    assert run.final["i.p"] == 0.0


def hand_over(second: str) -> hb.Model:
    """5 V and 3 V on one node, one after the other."""
    m = hb.Model("hand over")
    m.add(V=hb.Se(5.0), W=hb.Se(3.0), a=hb.One(), b=hb.One(), n=hb.Zero(), r=hb.R(1.0))
    m.bond("V -> a -> n", "W -> b -> n", "n -> r")
    m.machine("A", states={"on": ["a"], "off": []}, start="on", rules=[f"on -> off when {second}"])
    m.machine("B", states={"off": [], "on": ["b"]}, start="off", rules=["off -> on when time >= 1"])
    return m


def test_conflict_in_a_mode_that_is_passed() -> None:
    """Where the values of a mythical mode contradict each other, it is left by what asks for none.

    Together there is no mode between; a switch that waits for the other one knows that it is on;
    what waits for a voltage between the two sources waits for nothing that there is.
    """
    for second in ("time >= 1", "b.on"):
        run = hb.simulate(hand_over(second), until=2.0)
        assert run["r.e"].at(0.5) == 5.0 and run["r.e"].at(1.5) == 3.0
    with pytest.raises(hb.HybondError, match="HB-C101"):
        hb.simulate(hand_over("r.e < 4"), until=2.0)


# -- landing -------------------------------------------------------------------------------------


def ball() -> hb.Model:
    """Falls 0.05 m in 0.1 s at 10 m/s2, restitution 1/2: at rest after 0.3 s."""
    m = hb.Model("ball", domain="translational")
    m.add(w=hb.Se("-10 N"), b=hb.I("1 kg"), v=hb.One())
    m.add(c=hb.Zero(law="unilateral", gap="x", restitution=0.5))
    m.bond("w -> v -> b", "c -> v")
    m.signal(x=hb.Integral("v.f", "0.05 m"))
    return m


def test_landing_at_until() -> None:
    run = hb.simulate(ball(), until=0.3)
    assert run.status == "ok" and run.t_end == 0.3
    assert abs(run["x"].at(0.3)) < 1e-12 and abs(run["v.f"].at(0.3)) < 1e-6
    for a in run.accumulations:
        assert a.t == pytest.approx(0.3, abs=1e-9)


def test_accumulation_beyond_until() -> None:
    """Impacts at 0.1, 0.2, 0.25, 0.275, 0.2875 s; then it flies, and no landing is looked ahead."""
    run = hb.simulate(ball(), until=0.29)
    assert not run.accumulations
    times = [e.t for e in run.events if e.t > 0.0]
    assert times == [pytest.approx(t, abs=1e-9) for t in (0.1, 0.2, 0.25, 0.275, 0.2875)]
    s = 0.29 - 0.2875
    assert run["x"].at(0.29) == pytest.approx(s / 32.0 - 5.0 * s * s, abs=1e-9)


# -- hardly a model ------------------------------------------------------------------------------


def test_parts_without_content() -> None:
    m = hb.Model("resistive")
    m.add(V=hb.Se(2.0), j=hb.One(), r=hb.R(4.0))
    m.bond("V -> j -> r")
    m.machine("idle", states={"here": []}, start="here", rules=[])
    run = hb.simulate(m, until=1.0)
    assert run["r.f"].at([0.0, 1.0]).tolist() == [0.5, 0.5] and run.mode == {"idle": "here"}


def test_storage_without_bonds() -> None:
    m = hb.Model("loose")
    m.add(V=hb.Se(2.0), j=hb.One(), r=hb.R(4.0), c=hb.C(1.0, e=3.0))
    m.bond("V -> j -> r")
    with pytest.raises(hb.ModelError) as refused:
        hb.simulate(m, until=1.0)
    assert refused.value.code.startswith("HB-M") and "c" in str(refused.value)


# -- the sign of zero ------------------------------------------------------------------------------


def at_zero(x: str = "x") -> hb.Model:
    """A law, a source, a modulus, a signal and a sample that read the sign of zero."""
    m = hb.Model("zero")
    m.add(i=hb.I(1.0, p=0.0), v=hb.One(), law=hb.R({"e": "sign(f)"}))
    m.add(u=hb.Sf(f"3 + sign({x})"), c=hb.C(1.0), n=hb.Zero())
    m.add(a=hb.Se(1.0), t=hb.TF(f"2 + sign({x})"), r=hb.R(1.0), w=hb.One(), s=hb.One())
    m.bond("v -> i", "v -> law", "u -> n -> c", "a -> w -> t -> s -> r")
    m.signal(x=hb.Integral("0", start=0.0), said=f"5 + sign({x})")
    m.signal(held=hb.Sampled(f"7 + sign({x})", every="0.1 s"))
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_sign_of_zero(solver: str) -> None:
    run = hb.simulate(at_zero(), until=1.0, solver=solver)
    values = [float(run[n].at(0.5)) for n in ("law.e", "i.p", "u.f", "c.q", "r.e", "said", "held")]
    assert values == pytest.approx([0.0, 0.0, 3.0, 1.5, 0.5, 5.0, 7.0], rel=1e-12)
    # at rest with a force beyond it the mass leaves at once: from there on the law gives 1
    m = hb.Model("leaves")
    m.add(u=hb.Se(1.5), i=hb.I(1.0), v=hb.One(), law=hb.R({"e": "sign(f)"}))
    m.bond("u -> v -> i", "v -> law")
    run = hb.simulate(m, until=1.0, solver=solver)
    assert [float(run["law.e"].at(t)) for t in (0.0, 0.5)] == [0.0, 1.0]
    assert float(run["i.p"].at(1.0)) == pytest.approx(0.5, rel=1e-9)


def test_law_that_would_hold_by_its_sign() -> None:
    for law, code in (({"e": "sign(f)"}, "HB-N410"), (None, "")):
        m = hb.Model("held")
        m.add(u=hb.Se(0.5), i=hb.I(1.0), v=hb.One())
        m.bond("u -> v -> i")
        m.add(law=hb.One(law="relay", limit=1.0) if law is None else hb.R(law))
        m.bond("v -> law")
        run = hb.simulate(m, until=1.0, on_error="return")
        assert (run.error.code if run.error is not None else "") == code
        if not code:
            assert float(run["v.f"].at(1.0)) == 0.0 and run.mode["law"] == "sticks"


@pytest.mark.parametrize(
    ("guard", "fires"),
    [
        ("sign(c.q) >= 0", True),
        ("sign(c.q) > 0", False),
        ("sign(c.q) < 0", False),
        ("sign(d.q - 0.3) > 0", False),
        ("sign(d.q - 0.3) >= 0", True),
    ],
)
def test_guard_on_the_sign_of_zero(guard: str, fires: bool) -> None:
    # d.q - 0.3 is 5.6e-17, the rounding of its terms
    m = hb.Model("guarded")
    m.add(c=hb.C(1.0, q=0.0), n=hb.Zero(), r=hb.R(1.0), d=hb.C(1.0, q=0.1 + 0.2), k=hb.Zero())
    m.bond("n -> c", "n -> r", "k -> d")
    m.machine("M", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {guard}"])
    assert instants(hb.simulate(m, until=1.0)) == ([0.0] if fires else [])


@pytest.mark.parametrize(("way", "fires"), [("> 0", True), ("< 0", False), ("== 0", False)])
def test_sign_of_an_impulse(way: str, fires: bool) -> None:
    # the finite part is below zero, the impulse above
    way = way if "=" not in way else ">= 0 and sign(D.e) <= 0"
    run = hb.simulate(
        freewheel(f'sign(D.e) {way} and S.state == "off" and pre(L.p) > 0.5'), until=2.0
    )
    fired = [f.machine for e in run.events for step in e.steps for f in step.fired]
    assert ("V" in fired) == fires
    assert run["L.p"].at(2.0) == pytest.approx(0.5 if fires else 0.0, rel=1e-12)


# -- the page ------------------------------------------------------------------------------------


def test_source_that_jumps_at_a_time_event() -> None:
    m = hb.Model("sign", domain="translational")
    m.add(s=hb.Sf("sign(time - 1 [s])*1 [m/s]"), mass=hb.I("2 kg"), v=hb.One())
    m.add(push=hb.Se("sign(time - 1 [s])*1 [N]"), free=hb.I("1 kg"), w=hb.One())
    m.bond("s -> v -> mass", "push -> w -> free")
    m.machine("M", states={"a": [], "b": []}, start="a", rules=["a -> b when time >= 1"])
    run = hb.simulate(m, "2 s")
    assert [e.t for e in run.events] == [0.0, 1.0]
    assert run.events[1].steps[-1].impulses["s.e"] == pytest.approx(4.0)
    assert [float(run["push.e"].at(1.0, side=side)) for side in ("left", "right")] == [-1.0, 1.0]
    assert float(run["free.p"].at(2.0)) == pytest.approx(0.0, abs=1e-12)


def test_modulus_that_jumps_between_tied_bodies() -> None:
    # 2 kg and 3 kg at 1 m/s, f2 = m f1: from m = 1 to 2, by impulses in the ratio 2
    m = hb.Model("gear", domain="translational")
    m.add(a=hb.I("2 kg", f="1 m/s"), b=hb.I("3 kg", f="1 m/s"), v=hb.One(), w=hb.One())
    m.add(t=hb.TF("if time >= 0.5 then 2 else 1"))
    m.bond("v -> a", "v -> t.1", "t.2 -> w", "w -> b")
    run = hb.simulate(m, "1 s")
    first = (2.0 + 2.0 * 3.0) / (2.0 + 4.0 * 3.0)
    assert [float(run[n].at(1.0)) for n in ("a.f", "b.f")] == pytest.approx([first, 2.0 * first])
    energy = run.events[1].steps[-1].energy
    assert energy is not None and energy.lost == pytest.approx(2.5 - 7.0 * first**2)


def test_each_row_of_the_page_has_its_test() -> None:
    text = PAGE.read_text(encoding="utf-8").split("## Corner cases", 1)[1].split("\n## ", 1)[0]
    rows = [line for line in text.splitlines() if line.startswith("| ")][2:]
    named = {row.split("|")[-2].strip(" `") for row in rows}
    files = {name for name in named if name.endswith(".py")}
    assert all((Path(__file__).parent / name).is_file() for name in files)
    here = {name for name in globals() if name.startswith("test_")}
    assert named - files == here - {"test_each_row_of_the_page_has_its_test"}
