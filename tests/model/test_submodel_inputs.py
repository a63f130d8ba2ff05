"""Inputs of submodels: what a model gives to the parts that it is made of."""

import pytest

import hybond as hb


def sampled(inputs: dict[str, object], gate: hb.Input | None = None) -> hb.Model:
    """A capacitor that a switch connects to a source; the switch is a submodel with a gate."""
    m = hb.Model("sampled", domain="electrical", parameters={"high": "2 V"})
    m.add(
        V=hb.Se("10 V"),
        n=hb.Zero(),
        s=hb.Submodel("electrical.switch", inputs=inputs, R_on="1 kohm"),
        C=hb.C("1 uF"),
    )
    m.bond("V -> n -> s.plus", "s.minus -> C")
    if gate is not None:
        m.input(u=gate)
    m.signal(clock="if time < 2 [ms] then 1 else 0")
    return m


@pytest.mark.parametrize(
    "given",
    [
        {"gate": "time >= 1 [ms] and time < 2 [ms]"},
        {"gate": "clock*u"},
        {"gate": "if u > 0.5 and time < 2 [ms] then 3 else 0.2"},
    ],
)
def test_a_gate_may_be_a_condition_a_signal_or_an_expression(given: dict[str, object]) -> None:
    model = sampled(given, hb.Input(table=[(0, 0), ("1 ms", 1)]))
    run = hb.simulate(model, until="3 ms", rtol=1e-10)
    times = [e.t for e in run.events if e.cause != "start"]
    assert times == [0.001, 0.002]
    assert run["C.e"].at(0.003) == pytest.approx(10 * (1 - 2.718281828459045**-1), rel=1e-8)


def test_a_comparison_of_a_condition_with_a_number_is_the_condition() -> None:
    graph = sampled({"gate": "time >= 1 [ms]"}).flatten()
    closes, opens = graph.machines[0].rules
    (watch,) = (w for w in graph.watches if f"at:{w.index}" == str(closes.guard))
    assert watch.times == (0.001,)
    assert str(opens.guard) == f"not at:{watch.index}"


def test_a_gate_may_be_a_value_and_is_the_parts_own_if_not_given() -> None:
    for given, charged in (({"gate": 1}, True), ({"gate": "high/(1 [V])"}, True), ({}, False)):
        run = hb.simulate(sampled(given), until="20 ms")
        assert (run["C.e"].at(0.02) > 9.9) == charged


def test_an_unknown_input_is_refused_with_what_was_meant() -> None:
    with pytest.raises(hb.ModelError, match="gate") as caught:
        sampled({"gat": 1}).flatten()
    assert (caught.value.code, caught.value.where) == ("HB-M111", "s.gat")


def test_an_input_in_another_unit_is_refused() -> None:
    inner = hb.Model("inner", domain="electrical")
    inner.add(V=hb.Se("u"), R=hb.R("1 ohm"), i=hb.One())
    inner.bond("V -> i -> R")
    inner.input(u="5 V")
    m = hb.Model("outer", domain="electrical")
    m.add(a=hb.Submodel(inner, inputs={"u": "way"}))
    m.signal(way=hb.Integral("1 [m/s]"))
    with pytest.raises(hb.UnitError) as caught:
        m.flatten()
    assert (caught.value.code, caught.value.where) == ("HB-U103", "a.u")


def test_files_keep_inputs_and_what_a_model_is_about() -> None:
    model = sampled({"gate": "time >= 1 [ms]"})
    model.about = "Two lines\nof text.\n"
    for format in ("toml", "json"):
        again = hb.loads(hb.dumps(model, format=format), format=format)
        assert again.elements["s"] == model.elements["s"]
        assert again.about == model.about


def test_a_setting_replaces_what_an_input_was_given() -> None:
    from hybond.cli.settings import model_with

    changed = model_with(sampled({"gate": "time >= 1 [ms]"}), ["s.gate=1"])
    assert hb.simulate(changed, until="20 ms")["C.e"].at(0.02) > 9.9


def test_a_model_without_a_domain_takes_that_of_its_parts() -> None:
    m = hb.Model("plain")
    m.add(
        V=hb.Se(1), n=hb.Zero(), s=hb.Submodel("electrical.switch", inputs={"gate": 1}), R=hb.R(1)
    )
    m.bond("V -> n -> s.plus", "s.minus -> R")
    assert {bond.domain.name for bond in m.flatten().bonds} == {"electrical"}


def test_ports_of_two_domains_cannot_be_joined() -> None:
    m = hb.Model("wrong", domain="rotational")
    m.add(shaft=hb.One(), J=hb.I("1 kg*m^2"), s=hb.Submodel("electrical.switch"))
    m.bond("shaft -> J", "shaft -> s.plus")
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M134"


@pytest.mark.parametrize("given", ["if time < 1 then 50 else 0", "50", "50 + 10*sin(0*time)", 50])
def test_what_is_given_without_a_unit_is_in_the_unit_of_the_input(given: object) -> None:
    inner = hb.Model("inner", domain="rotational", parameters={"r": "0.1 m"})
    inner.add(M=hb.Se("r*force"), d=hb.R("1 N*m*s"), w=hb.One())
    inner.bond("M -> w -> d")
    inner.input(force="0 N")
    inner.signal(twice="2*force")
    m = hb.Model("outer", domain="rotational")
    m.add(a=hb.Submodel(inner, inputs={"force": given}))
    run = hb.simulate(m, until=2)
    assert run["a.d.f"].at(0.5) == pytest.approx(5.0)
    assert run["a.twice"].at(0.5) == pytest.approx(100.0)


def test_what_is_given_in_another_unit_after_a_number_is_still_refused() -> None:
    inner = hb.Model("inner", domain="electrical")
    inner.add(V=hb.Se("u"), R=hb.R("1 ohm"), i=hb.One())
    inner.bond("V -> i -> R")
    inner.input(u="5 V")
    m = hb.Model("outer", domain="electrical")
    m.add(a=hb.Submodel(inner, inputs={"u": "2*way"}))
    m.signal(way=hb.Integral("1 [m/s]"))
    with pytest.raises(hb.UnitError) as caught:
        m.flatten()
    assert (caught.value.code, caught.value.where) == ("HB-U103", "a.u")


def test_a_parameter_given_without_a_unit_is_in_the_unit_of_its_own_value() -> None:
    inner = hb.Model("inner", domain="rotational", parameters={"m": "1 kg", "l": "1 m"})
    inner.parameter(J="m*l^2")
    inner.add(rotor=hb.I("J", f="3 rad/s"), w=hb.One())
    inner.bond("w -> rotor")
    for m, l in ((2, 3.0), ("2", "3 m"), ("two", "300 cm")):
        outer = hb.Model("outer", domain="rotational", parameters={"two": 2})
        outer.add(a=hb.Submodel(inner, m=m, l=l))
        assert hb.simulate(outer, until=1)["a.rotor.p"].at(1) == pytest.approx(54.0)
    assert hb.simulate(inner, until=1, parameters={"l": 2})["rotor.p"].at(1) == pytest.approx(12)
    outer.elements["a"] = hb.Submodel(inner, m="2 m")
    with pytest.raises(hb.UnitError):
        outer.flatten()


def two_parts(bond: str, **given: object) -> hb.Model:
    m = hb.Model("wrong", domain="electrical")
    m.add(
        V=hb.Submodel("electrical.voltage_source"),
        s=hb.Submodel("electrical.switch", **given),
        J=hb.Submodel("rotational.inertia"),
        gnd=hb.Zero(),
    )
    m.bond("V.minus -> gnd", bond)
    return m


@pytest.mark.parametrize(
    ("bond", "why", "remedy"),
    [
        (
            "V -> s.plus",
            "'V', which is a submodel and no port of it",
            "its ports are V.minus, V.pl",
        ),
        ("V.plus -> s.pin", "'s.pin', but 's' has no port 'pin'", "its ports are s.minus, s.plus"),
        ("V.plus -> s.plu", "'s.plu', but 's' has no port 'plu'", "its ports are s.minus, s.plus"),
        ("V.plus -> gmd", "'gmd', which is not an element", "did you mean 'gnd'?"),
    ],
)
def test_a_bond_that_misses_a_port_is_told_the_ports(bond: str, why: str, remedy: str) -> None:
    with pytest.raises(hb.ModelError) as caught:
        two_parts(bond).flatten()
    assert caught.value.code == "HB-M101"
    assert caught.value.where == "graph.bonds[1]"
    assert caught.value.why.endswith(why)
    assert caught.value.hint.startswith(remedy)


def test_the_bond_between_two_domains_is_named() -> None:
    with pytest.raises(hb.ModelError) as caught:
        two_parts("V.plus -> J.shaft").flatten()
    assert caught.value.code == "HB-M134"
    assert caught.value.where == "graph.bonds[1]"
    assert "joins 'V.plus' (electrical) to 'J.shaft' (rotational)" in caught.value.why


def test_an_input_among_parameters_is_told_its_place() -> None:
    with pytest.raises(hb.ModelError) as caught:
        two_parts("V.plus -> s.plus", gate="time > 1").flatten()
    assert (caught.value.code, caught.value.where) == ("HB-M107", "s.gate")
    assert caught.value.hint == "it is an input: give it under inputs"
    with pytest.raises(hb.ModelError) as caught:
        two_parts("V.plus -> s.plus", inputs={"R_on": "1 ohm"}).flatten()
    assert (caught.value.code, caught.value.where) == ("HB-M111", "s.R_on")
    assert caught.value.hint == "it is a parameter: give it under parameters"
