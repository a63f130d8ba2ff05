"""The unit of a signal: that reads itself, or is some times what has a word of its own."""

import pytest

import hybond as hb


def test_a_filter_has_the_unit_that_its_rate_says() -> None:
    m = hb.Model("filter", domain="electrical")
    m.add(a=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), n=hb.Zero())
    m.bond("n -> a", "n -> r")
    m.signal(x=hb.Integral("(a.e - x)/(1 [s])", start="0 V"))
    run = hb.simulate(m, until=1.0)
    # x' = 2 exp(-t) - x from 0
    assert run["x"].at(1.0) == pytest.approx(2.0 * 0.36787944117144233, rel=1e-7)
    assert run["x"].unit in ("V", "")


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("d.torque*2", "N*m"),
        ("-d.torque/3 + 1", "N*m"),
        ("0.5*d.torque*k", "N*m"),
        ("d.torque*sin(angle)", "N*m"),
        ("d.torque*(J.speed/w)", "N*m"),
        ("d.torque*angle", "J"),
        ("d.torque*J.speed", "W"),
        ("d.torque*(2 [1/s])", "W"),
        ("d.torque/(2 [s])", "W"),
        ("0.5*J.body.p*J.body.f", "J"),
        ("J.speed*2", "rad/s"),
        ("2*angle", "rad"),
        ("d.torque/r", ""),
    ],
)
def test_some_times_a_torque_is_a_torque_and_its_work_is_none(text: str, unit: str) -> None:
    m = hb.Model("shaft", domain="rotational", parameters={"k": 3, "r": "2 N*m", "w": "1 rad/s"})
    m.add(
        J=hb.Submodel("rotational.inertia", w="1 rad/s"),
        d=hb.Submodel("rotational.damper"),
        f=hb.Submodel("rotational.frame"),
    )
    m.bond("J.shaft -> d.left", "d.right -> f.shaft")
    m.signal(angle=hb.Integral("J.speed"), asked=text)
    assert hb.simulate(m, until=1)["asked"].unit == unit


@pytest.mark.parametrize("bond", ["drive -> w", "w -> drive"])
@pytest.mark.parametrize(
    ("given", "kind", "law", "unit"),
    [
        ("2 J", "Se", "u", "N*m"),
        ("2 J", "Se", "-2*u + brake", "N*m"),
        ("2 J", "Se", "if time < 1 then u else brake", "N*m"),
        ("3 [1/s]", "Sf", "u", "rad/s"),
        ("2 J", "Se", "u*w.f/(1 [rad/s])", "J"),
        ("2 N*m", "Se", "u*w.f/(1 [rad/s])", "N*m"),
    ],
)
def test_an_input_is_what_the_source_gives_that_it_drives(
    bond: str, given: str, kind: str, law: str, unit: str
) -> None:
    m = hb.Model("shaft", domain="rotational", parameters={"brake": "1 N*m"})
    m.add(drive=getattr(hb, kind)(law), w=hb.One(), r=hb.R("1 N*m*s"), J=hb.I("1 kg*m^2"))
    m.bond(bond, "w -> r", *(["w -> J"] if kind == "Se" else []))
    m.input(u=given)
    if kind == "Sf":
        del m.elements["J"]
    assert hb.simulate(m, until="1 s")["u"].unit == unit


def test_a_set_point_is_in_the_unit_of_what_it_is_compared_with() -> None:
    m = hb.Model("shaft", domain="rotational")
    m.add(drive=hb.Se("gain*error"), w=hb.One(), J=hb.I("1 kg*m^2"))
    m.bond("drive -> w -> J")
    m.parameter(gain="1 N*m*s")
    m.input(wanted="3 rad/s", heat="2 J", clock="2 1/s")
    m.signal(error="wanted - w.f", warm="heat*2")
    run = hb.simulate(m, until="1 s")
    assert [run[n].unit for n in ("wanted", "heat", "clock")] == ["rad/s", "J", "1/s"]


def drive(**signals: object) -> hb.Model:
    """Return a voltage `u` made of the speed of a rotor, that ends at 0.05 rad/s after 1 s."""
    m = hb.Model("drive", domain="electrical")
    m.add(V=hb.Se("u"), i=hb.One(), R=hb.R(1))
    m.add(T=hb.Se(0.1, domain="rotational"), w=hb.One(domain="rotational"), J=hb.I(2.0))
    m.bond("V -> i -> R", "T -> w -> J")
    m.signal(**signals)
    return m


LOOSE = {
    "integral": ({"s": hb.Integral("4*w.f"), "u": "0.3*w.f + s"}, 0.3 * 0.05 + 4 * 0.025),
    "alone": ({"s": hb.Integral("4*w.f"), "u": "s"}, 4 * 0.025),
    "with a start": ({"s": hb.Integral("4*w.f", "2 V"), "u": "3*w.f + s"}, 2.25),
    "twice": ({"s": hb.Integral("6*w.f"), "z": hb.Integral("s"), "u": "z"}, 0.3 / 6),
    "limited": (
        {
            "s": hb.Integral("4*w.f + 20*(u - a)"),
            "a": "0.3*w.f + s",
            "u": "max(-12, min(12, a))",
        },
        0.3 * 0.05 + 4 * 0.025,
    ),
    "sampled": ({"s": hb.Sampled("4*w.f", every="0.3 s"), "u": "2*w.f + s"}, 0.1 + 4 * 0.045),
    "sampled, with a start": (
        {"s": hb.Sampled("4*w.f", every="0.3 s", start="1 V"), "u": "s"},
        4 * 0.045,
    ),
}


@pytest.mark.parametrize("name", LOOSE)
def test_plain_gains_of_a_controller_may_have_any_unit(name: str) -> None:
    """Numbers fit everywhere, in the integral of a PI controller, too."""
    signals, volts = LOOSE[name]
    run = hb.simulate(drive(**signals), 1.0)
    assert run["V.e"].at(1.0) == pytest.approx(volts, rel=1e-7)


@pytest.mark.parametrize(
    ("signals", "code"),
    [
        ({"s": hb.Integral("w.f"), "u": "s"}, "HB-U103"),
        ({"s": hb.Integral("w.f", "2 V"), "u": "s"}, "HB-U102"),
        ({"s": hb.Integral("4 [V*s]*w.f"), "u": "w.f + s"}, "HB-U102"),
        ({"s": hb.Sampled("w.f", every="0.1 s"), "u": "s"}, "HB-U103"),
        ({"s": hb.Integral("4*w.f"), "u": "w.f + s"}, "HB-U103"),
    ],
)
def test_what_has_no_plain_factor_has_a_unit(signals: dict[str, object], code: str) -> None:
    with pytest.raises(hb.UnitError) as refused:
        hb.simulate(drive(**signals), 1.0)
    assert refused.value.code == code


def test_a_number_with_a_unit_says_that_of_the_sum() -> None:
    m = drive(s=hb.Integral("4*w.f"), z="s + 1 [A]", turned="s + 1 [rad]", u="0")
    run = hb.simulate(m, 1.0)
    assert (run["z"].unit, run["turned"].unit) == ("A", "rad")


@pytest.mark.parametrize("bond", ["n -> C", "C -> n"])
@pytest.mark.parametrize(
    ("value", "named"),
    [
        ("R.f + C.q", "'R.f' in A and 'C.q' in C"),
        ("n.f + C.e", "'n.f' in A and 'C.e' in V"),
        ("pace + C.e", "'pace' in V*s"),
        ("flows + C.e", "'flows' in A and 'C.e' in V"),
    ],
)
def test_what_does_not_add_up_is_named_as_it_was_written(value: str, named: str, bond: str) -> None:
    m = hb.Model("m", domain="electrical")
    m.add(V=hb.Se("10 V"), R=hb.R("1 ohm"), C=hb.C("1 F"), D=hb.Se(value), n=hb.One())
    m.bond("V -> n -> R", bond, "D -> n")
    m.signal(pace=hb.Integral("R.e"), flows="R.f")
    with pytest.raises(hb.UnitError) as refused:
        m.flatten()
    assert refused.value.where == "elements.D.Se"
    assert named in refused.value.why
    assert ":" not in refused.value.why


@pytest.mark.parametrize("name", ["V.e - R.f", "-(R.f - V.e)", "max(C.q, R.f)", "pre(R.e) + R.f"])
def test_a_run_is_not_asked_for_what_does_not_add_up(name: str) -> None:
    m = hb.Model("m", domain="electrical")
    m.add(V=hb.Se("10 V"), R=hb.R("1 ohm"), C=hb.C("1 F"), n=hb.One())
    m.bond("V -> n -> R", "n -> C")
    run = hb.simulate(m, 1.0)
    with pytest.raises(hb.UnitError, match="HB-U102"):
        run[name]
    assert run["V.e - R.e - C.e"].at(1.0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("given", "asked", "unit"),
    [
        ("60 kN*cm", "T", "N*m"),
        ("60 kN*cm", "-2*T + w.e", "N*m"),
        ("60 J", "T", "J"),
        ("300 rpm", "T", "rad/s"),
        ("50 Hz", "T", "Hz"),
        ("1 bar/(L/min)^2", "T", "Pa/(m^3/s)^2"),
        ("1 bar/(L/min)^2", "max(T, 2*T)", "Pa/(m^3/s)^2"),
        ("20 N*m/rad", "T", "N*m/rad"),
        ("2 kohm", "T", "ohm"),
        ("2 V/A", "T", "ohm"),
        ("60 N*m", "T*T", "kg^2*m^4/s^4"),
    ],
)
def test_what_is_made_of_a_parameter_has_the_unit_that_it_was_given_in(
    given: str, asked: str, unit: str
) -> None:
    m = hb.Model("shaft", domain="rotational", parameters={"T": given})
    m.add(drive=hb.Se("1 N*m"), w=hb.Zero(), r=hb.R("1 N*m*s"))
    m.bond("drive -> w -> r")
    m.signal(asked=asked)
    assert hb.simulate(m, until="1 s")["asked"].unit == unit


@pytest.mark.parametrize("bond", ["u -> w", "w -> u"])
@pytest.mark.parametrize(
    ("law", "unit"),
    [("T", "N*m"), ("-T", "N*m"), ("T + 1 [N*m]", "N*m"), ("2*T", "J"), ("T*w.f/(1 [rad/s])", "J")],
)
def test_what_a_controller_gives_to_a_drive_is_a_torque(law: str, unit: str, bond: str) -> None:
    m = hb.Model("drive", domain="rotational", parameters={"K": "2 N*m*s", "set": "100 rpm"})
    m.add(J=hb.I("1 kg*m^2"), b=hb.R("0.1 N*m*s"), u=hb.Se(law), w=hb.One())
    m.bond(bond, "w -> J", "w -> b")
    m.signal(err="set - w.f", T="K*err")
    run = hb.simulate(m, 0.1)
    assert (run["T"].unit, run["err"].unit) == (unit, "rad/s")


@pytest.mark.parametrize("bonds", [["T -> w -> J"], ["T -> w", "J -> w"]])
@pytest.mark.parametrize(
    "rule, said",
    [
        ("w.f > 3 V", "'w.f' in rad/s"),
        ("J.e > 1 A", "'J.e' in N*m"),
        ("J.f + T.f > 1 V", "in rad/s"),
    ],
)
def test_what_does_not_compare_with_a_turning_is_told_in_its_units(
    bonds: list[str], rule: str, said: str
) -> None:
    """An angular velocity was in 1/s there, a torque in J."""
    m = hb.Model("shaft", domain="rotational")
    m.add(T=hb.Se("2 N*m"), w=hb.One(), J=hb.I("0.1 kg*m^2"))
    m.bond(*bonds)
    m.machine("m", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {rule}"])
    with pytest.raises(hb.UnitError, match="HB-U102") as caught:
        m.flatten()
    assert said in caught.value.why
