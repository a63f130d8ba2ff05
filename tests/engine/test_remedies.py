"""What refusals tell one to try, done: the run goes on, to values known otherwise."""

from typing import Any

import numpy as np
import pytest

import hybond as hb


def model(bonds: str, switch: tuple[str, ...] = (), **parts: Any) -> hb.Model:
    """Return a model of parts and chains of bonds; `switch` are OFF until 0.5 s."""
    m = hb.Model("remedies")
    m.add(**parts)
    m.bond(*bonds.split(", "))
    if switch:
        states = {"off": [], "on": list(switch)}
        m.machine("k", states=states, start="off", rules=["off -> on when time >= 0.5"])
    return m


def refusal(m: hb.Model, code: str) -> hb.HybondError:
    """Return how it is refused."""
    with pytest.raises(hb.HybondError, match=code) as seen:
        hb.simulate(m, 1.0)
    return seen.value


def test_two_sources_of_flow_get_resistors_beside() -> None:
    parts = {"a": hb.Sf(3.0), "b": hb.Sf(2.0), "j": hb.One(), "l": hb.I(1.0)}
    hint = refusal(model("a -> j -> l, b -> j", **parts), "HB-C101").hint
    assert hint == "put a resistor beside a, and one beside b"
    more = {"x": hb.Zero(), "y": hb.Zero(), "r": hb.R(2.0), "s": hb.R(2.0)}
    mended = model("a -> x -> j -> l, x -> r, b -> y -> j, y -> s", **parts, **more)
    run = hb.simulate(mended, 10.0)
    # at rest the coil has no voltage: 2*(3 - f) + 2*(2 - f) = 0
    assert run["l.f"].at(10.0) == pytest.approx(2.5, rel=1e-6)


def test_a_source_that_a_switch_shorts_gets_one_in_series() -> None:
    parts = {"v": hb.Se(5.0), "n": hb.Zero(), "c": hb.C(1.0)}
    hint = refusal(model("v -> n -> c", ("n",), **parts), "HB-C101").hint
    assert hint == "put a resistor in series with v, or change what switches it so"
    more = {"j": hb.One(), "r": hb.R(2.0)}
    run = hb.simulate(model("v -> j -> n -> c, j -> r", ("n",), **parts, **more), 1.0)
    assert run["r.f"].at(0.4) == pytest.approx(2.5, rel=1e-12)


@pytest.mark.parametrize(("law", "most"), [("2*tanh(f)", 2.0), ("max(-1.5, min(1.5, f))", 1.5)])
def test_a_flat_end_is_named_and_its_source_gets_the_resistor(law: str, most: float) -> None:
    parts = {"v": hb.Se(5.0), "c": hb.C(0.01), "r": hb.R({"e": law})}
    error = refusal(model("v -> n -> r, n -> c", n=hb.Zero(), **parts), "HB-C101")
    assert error.why.endswith("at t = 0 s")  # and no empty sentence after it
    assert error.hint == "put a resistor in series with v, or let the law of r rise at its flat end"
    more = {"n": hb.Zero(), "s": hb.One(), "x": hb.R(0.1)}
    run = hb.simulate(model("v -> s -> n -> r, s -> x, n -> c", **parts, **more), 1.0)
    # at rest r gives all that it can, and the resistor the rest
    assert run["c.e"].at(1.0) == pytest.approx(most, rel=1e-6)
    assert run["x.f"].at(1.0) == pytest.approx((5.0 - most) / 0.1, rel=1e-6)


def test_a_source_that_pushes_a_relay_beyond_its_limit_is_named() -> None:
    parts = {"s": hb.Sf("2*time"), "j": hb.Zero(law="relay", limit=0.7)}
    error = refusal(model("s -> j", **parts), "HB-J110")
    assert error.hint == "put a resistor beside s"
    run = hb.simulate(model("s -> n -> j, n -> r", **parts, n=hb.Zero(), r=hb.R(5.0)), 1.0)
    # the relay takes what it can, the resistor the rest
    assert run["r.e"].at(0.9) == pytest.approx(5.0 * (1.8 - 0.7), rel=1e-9)


@pytest.mark.parametrize(
    ("r", "kind"), [({"e": "2*sign(f)"}, "1-junction"), ({"f": "2*sign(e)"}, "0-junction")]
)
def test_a_value_within_a_jump_is_one_of_dry_friction(r: dict[str, str], kind: str) -> None:
    by_flow = "f" in r
    source = hb.Sf(0.5) if by_flow else hb.Se(0.5)
    parts = {"s": source, "j": hb.Zero() if by_flow else hb.One()}
    error = refusal(model("s -> j -> r", **parts, r=hb.R(r)), "HB-N301")
    assert f"a {kind} with law = 'coulomb'" in error.hint
    held = hb.Zero if by_flow else hb.One
    run = hb.simulate(model("s -> j -> r", **parts, r=held(law="coulomb", limit=2.0)), 1.0)
    assert run["r.e" if by_flow else "r.f"].at(0.5) == 0.0


def test_a_law_that_ends_gets_a_resistor_for_the_rest() -> None:
    parts = {"s": hb.Se(3.0), "j": hb.One(), "r": hb.R({"e": "2*tanh(f)"})}
    error = refusal(model("s -> j -> r", **parts), "HB-N301")
    assert "put a resistor in series with r" in error.hint
    run = hb.simulate(model("s -> j -> r, j -> x", **parts, x=hb.R(1.0)), 1.0)
    f = run["x.f"].at(0.5)
    assert 3.0 - f == pytest.approx(run["r.e"].at(0.5), rel=1e-9)
    assert 0.9 < f < 1.6  # between all of it and none of it saturated


@pytest.mark.parametrize("bonds", ["s -> j -> t -> k -> r", "s -> j, t.1 -> j, k -> t.2, r -> k"])
@pytest.mark.parametrize("gyrates", [False, True])
def test_a_two_port_among_laws_is_named_once_and_gets_no_resistor(
    gyrates: bool, bonds: str
) -> None:
    """It has two laws, and hands on what others give."""
    parts: dict[str, Any] = {"k": hb.One(), "r": hb.R({"e": "2*tanh(f)"})}
    parts |= {"s": hb.Se(3.0), "j": hb.One(), "t": hb.TF("1 + 0.1*tanh(j.f)")}
    if gyrates:
        parts |= {"s": hb.Sf(3.0), "j": hb.Zero(), "t": hb.GY("1 + 0.1*tanh(j.e)")}
    error = refusal(model(bonds, **parts), "HB-N301")
    assert sorted(error.why.split("the laws of ")[1].split(" have ")[0].split(", ")) == ["r", "t"]
    assert "put a resistor in series with r, which" in error.hint
    run = hb.simulate(model(f"{bonds}, k -> x", **parts, x=hb.R(5.0)), 1.0)
    given = run["k.f"].at(0.5) * 5.0 + run["r.e"].at(0.5) * (1.0 if "t -> k" in bonds else -1.0)
    gear = 1.0 + 0.1 * np.tanh(run["j.e" if gyrates else "j.f"].at(0.5))
    assert abs(given) == pytest.approx(3.0 * gear if gyrates else 3.0 / gear, rel=1e-9)


def wedge(stiff: bool, **more: Any) -> hb.Model:
    """Return a contact whose friction moves the body on against it, by two to one (Painleve)."""
    m = hb.Model("wedge", domain="translational")
    m.add(a=hb.I(1.0), b=hb.I(1.0, f=0.5), va=hb.One(), vb=hb.One(), F=hb.Se(-1.0), **more)
    m.add(contact=hb.C({"e": "1e3*max(q, 0)"}) if stiff else hb.Zero(law="unilateral"))
    m.add(tf=hb.TF(2.0), rub=hb.Zero(), slip=hb.One(law="coulomb", limit="contact.e"))
    m.bond("F -> va -> a", "contact -> va", "vb -> b", "va -> tf -> rub", "vb -> rub -> slip")
    m.bond(*(f"va -> {name}" for name in more))
    return m


def test_friction_that_leaves_no_answer_gets_a_stiffness_and_no_resistance() -> None:
    hint = refusal(wedge(False), "HB-J110").hint
    assert hint.endswith("(Painleve): give the contact a stiffness")
    refusal(wedge(False, x=hb.R(5.0)), "HB-J110")
    run = hb.simulate(wedge(True), 0.07)
    # until it sticks: x'' = -1 - 1e3*(-x), and the slip of b dies away
    x = (np.cosh(np.sqrt(1e3) * 0.07) - 1.0) / 1e3
    assert run["contact.q"].at(0.07) == pytest.approx(x, rel=1e-6)


@pytest.mark.parametrize("gap", ["y - 1/(time - time)", "y + 1/(0*y)", "y - exp(1e4 + y)"])
@pytest.mark.parametrize("how", [{}, {"solver": "moreau-jean", "step": 1e-3}])
def test_a_contact_of_no_distance_neither_touches_nor_stays_open(
    gap: str, how: dict[str, Any]
) -> None:
    m = hb.Model("gap")
    m.add(c=hb.Zero(law="unilateral", gap="h"), v=hb.One(), i=hb.I(1.0, p=-1.0))
    m.bond("c -> v -> i")
    m.signal(y=hb.Integral("v.f", start=0.1), h=gap)
    with pytest.raises(hb.HybondError, match="HB-N302 at c: the gap of the contact is infinite"):
        hb.simulate(m, 0.05, **how)


@pytest.mark.parametrize("how", [{}, {"solver": "moreau-jean", "step": 1e-3}])
def test_samples_without_an_event_are_steps_to_remember(how: dict[str, Any]) -> None:
    m = hb.Model("clock")
    m.signal(a=hb.Sampled("time", every=1e-5))
    limits = hb.Limits(steps=500)
    with pytest.raises(hb.NumericsError, match="HB-N409") as seen:
        hb.simulate(m, 0.02, limits=limits, **how)
    # no more than two slices of a run beyond it
    assert seen.value.partial is not None
    assert 500 * 1e-5 < seen.value.partial.t_end < 0.02
    more = {"limits": hb.Limits(steps=6000)} if how else {"limits": limits, "keep": 10}
    kept = hb.simulate(m, 0.02, **more, **how)
    assert kept["a"].at(0.02) == pytest.approx(0.02, abs=1.5e-5)


def test_no_law_is_named_where_sources_and_storages_have_no_solution() -> None:
    """A source asks an inertia for all that it has, and then for more: "the laws of  have ..."."""
    m = hb.Model("tied")
    m.add(top=hb.One(law="coulomb", limit=21.6), i=hb.I({"f": "p"}, p=0.5))
    m.add(s=hb.Sf("i.p^2 + 0.25 + time"))
    m.bond("s -> top", "top -> i")
    error = refusal(m, "HB-N301")
    assert "the laws of  have" not in str(error)
    assert "what sources give" in str(error)


@pytest.mark.parametrize("law", ["1.13*sign(e)*sqrt(abs(e)/0.629)", "0.2*sign(e)*abs(e)^2"])
def test_a_law_whose_sign_makes_no_jump_is_no_dry_friction(law: str) -> None:
    m = hb.Model("clipped")
    m.add(j=hb.Zero(), s=hb.Se(-1.29), r=hb.R({"e": "0.911*tanh(f/0.863)"}), g=hb.R({"f": law}))
    m.bond("s -> j", "j -> r", "g -> j")
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until=0.1)
    assert caught.value.code == "HB-N301"
    assert "sign()" not in caught.value.hint
    assert "in series with r" in caught.value.hint


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("source", "joins", "end", "passes"),
    [(hb.Sf("1 A"), hb.One, hb.Zero, "flow"), (hb.Se("1 V"), hb.Zero, hb.One, "effort")],
)
def test_what_nothing_is_joined_to_is_said_to_be_unjoined_and_not_shorted(
    source: object, joins: type, end: type, passes: str, turned: bool
) -> None:
    part = hb.Model("part", domain="electrical")
    part.add(source=source, i=joins(), port=end())
    part.bond("source -> i", "port -> i" if turned else "i -> port")
    part.port(port="port")
    m = hb.Model("whole", domain="electrical")
    m.add(part=hb.Submodel(part))
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(m, until=1.0)
    assert refused.value.code == "HB-C101"
    assert f"nothing is joined to part.port, so that no {passes} passes, but" in str(refused.value)
    assert "shorted" not in str(refused.value)
    assert refused.value.hint.startswith('join part.port: "part.port -> ..."')
    (conflict,) = hb.causality(m).conflicts
    assert "part.port (nothing else is joined to it)" in conflict
    m.add(load=hb.R("1 ohm"))
    m.bond("part.port -> load")
    run = hb.simulate(m, until=1.0)
    assert [abs(run[f"load.{v}"].at(0.5)) for v in "ef"] == [1.0, 1.0]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("rules", ["diode", "late", "together"])
def test_a_freewheeling_junction_by_rules_is_told_of_the_law(rules: str, *, turned: bool) -> None:
    """Where the other switch closes while it conducts, both were on, and nothing named the law."""

    def buck(law: str | None) -> hb.Model:
        fw = hb.One(law=law) if law else hb.One()
        m = hb.Model("buck", parameters={"w": 2e4 * np.pi})
        m.add(vin=hb.Se(24.0), sw=hb.One(), fw=fw, n=hb.Zero(), g=hb.Se(0.0), l=hb.I(1e-4))
        m.add(
            j=hb.One(),
            o=hb.Zero(),
            c=hb.C(1e-5),
            r=hb.R(1.0),
            also=hb.One(),
            rr=hb.R(1.0),
            u=hb.Se(1.0),
        )
        m.bond("vin -> sw -> n", "g -> fw -> n", "o -> j -> n" if turned else "n -> j -> o")
        m.bond("j -> l", "o -> c", "o -> r", "u -> also -> rr")
        gate = ["on -> off when sin(w*time) < 0", "off -> on when sin(w*time) > 0"]
        m.machine("gate", states={"off": [], "on": ["sw"]}, start="on", rules=gate)
        on = ["fw", "also"] if rules == "together" else ["fw"]
        if law is None:
            free = ["no -> yes when fw.e > 0", f"yes -> no when fw.f < {-(rules == 'late')}"]
            m.machine("free", states={"no": [], "yes": on}, start="no", rules=free)
        return m

    said = refusal(buck(None), "HB-C101")
    assert ("law = 'diode' of fw" in said.hint) == (rules == "diode")
    if rules == "diode":
        run = hb.simulate(buck("diode"), 2e-3)
        assert run.status == "ok"
        # the mean of what is behind the coil is half of 24 V where its current never ends
        v = run["c.e"].at(np.linspace(1.9e-3, 2e-3, 1001)[:-1])
        assert np.mean(v) == pytest.approx(12.0, rel=1e-3)


def test_a_toggle_by_one_guard_gets_states_between() -> None:
    """It was told to write a guard that never holds: ``X and not (X)``."""
    up = "mod(time, 1) >= 0.5"
    rules = [f"a -> b when {up}", f"b -> a when {up}"]
    flat = hb.Model("toggle")
    flat.machine("k", states={"a": [], "b": []}, start="a", rules=rules)
    hint = refusal(flat, "HB-N401").hint
    assert hint is not None
    assert hint.endswith(f"lead to states of their own, left when not ({up})")
    between = hb.Model("toggle")
    between.machine(
        "k",
        states={"a": [], "to_b": [], "b": [], "to_a": []},
        start="a",
        rules=[
            *(f"{s} -> to_{t} when {up}" for s, t in ("ab", "ba")),
            *(f"to_{s} -> {s} when not ({up})" for s in "ab"),
        ],
    )
    run = hb.simulate(between, 2.2)
    assert [e.t for e in run.events] == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0], abs=1e-12)


@pytest.mark.parametrize(("forward", "backward"), [(10.0, 3.0), (5.0, 1.0)])
def test_a_limit_by_the_way_of_slip_gets_a_mean_and_a_source(
    forward: float, backward: float
) -> None:
    """A band brake holds more one way: as one limit by a condition it is refused."""
    limit = f"if w.f > 0 then {forward} else {backward}"
    torque = f"{forward + 2}*min(time/0.5, 1)"
    load = {"J": hb.I(1.0), "T": hb.Se(torque)}
    m = model("T -> w -> J", w=hb.One(law="coulomb", limit=limit), **load)
    error = refusal(m, "HB-N410")
    assert error.where == "w.friction"
    assert error.hint is not None and "half of their difference" in error.hint
    mean, half = (forward + backward) / 2, (forward - backward) / 2
    brake = {"w": hb.One(law="coulomb", limit=mean), "B": hb.Se(-half)}
    run = hb.simulate(model("T -> w -> J, B -> w", **brake, **load), 1.0)
    slips = 0.5 * forward / (forward + 2)
    speed = 2.0 * (0.5 - slips) / 2 + 2.0 * 0.5
    assert run["J.f"].at(slips) == pytest.approx(0.0, abs=1e-9)
    assert run["J.f"].at(1.0) == pytest.approx(speed, rel=1e-9)


def test_a_limit_by_speed_is_told_nothing_of_ways() -> None:
    limit = hb.One(law="coulomb", limit="if w.f > 1 then 10 else 3")
    m = model("T -> w -> J", w=limit, J=hb.I(1.0), T=hb.Se("20*min(time/0.5, 1)"))
    run = hb.simulate(m, 1.0, on_error="return")
    assert run.error is None or "half of their difference" not in str(run.error)
