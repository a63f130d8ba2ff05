"""Bad models get one clear refusal: a code, a place, a reason and a remedy."""

from collections.abc import Callable

import pytest

import hybond as hb
from hybond.model.parts import Part


def circuit() -> hb.Model:
    m = hb.Model("circuit", domain="electrical", parameters={"r": "1 ohm"})
    m.add(V=hb.Se("10 V"), C=hb.C("1 mF"), R=hb.R("r"), n=hb.Zero(), s=hb.One())
    m.bond("V -> s -> n -> C", "s -> R")
    return m


def machine(m: hb.Model, *rules: str, **states: list[str]) -> None:
    states = states or {"a": [], "b": ["s"]}
    m.machine("k", states=states, start=next(iter(states)), rules=rules)


def unknown_element(m: hb.Model) -> None:
    m.bond("n -> Cx")


def unknown_parameter(m: hb.Model) -> None:
    m.add(R2=hb.R("rr"))
    m.bond("n -> R2")


def wrong_unit(m: hb.Model) -> None:
    m.add(R2=hb.R("1 N/m"))
    m.bond("n -> R2")


def dangling(m: hb.Model) -> None:
    m.add(R2=hb.R("1 ohm"))


def double_bond(m: hb.Model) -> None:
    m.bond("n -> R")


def self_bond(m: hb.Model) -> None:
    m.bond("n -> n")


def guard_unknown(m: hb.Model) -> None:
    machine(m, "a -> b when C.ee > 1")


def guard_equality(m: hb.Model) -> None:
    machine(m, "a -> b when C.e == 1")


def guard_units(m: hb.Model) -> None:
    machine(m, "a -> b when C.e > 1 A")


def guard_number(m: hb.Model) -> None:
    machine(m, "a -> b when C.e")


def guard_state(m: hb.Model) -> None:
    machine(m, 'a -> b when k.state == "zz"')


def rule_text(m: hb.Model) -> None:
    machine(m, "a -> b if C.e > 1")


def rule_state(m: hb.Model) -> None:
    machine(m, "a -> bb when C.e > 1")


def state_element(m: hb.Model) -> None:
    machine(m, a=[], b=["sx"])


def fieldless_without_exit(m: hb.Model) -> None:
    m.add(hit=hb.Sf("-pre(C.e)*1 [S]"), g=hb.Zero())
    m.bond("n -> g -> hit")
    machine(m, "a -> b when C.e > 5 V", a=[], b=["g"])


def fieldless_a_posteriori_exit(m: hb.Model) -> None:
    m.add(hit=hb.Sf("-pre(C.e)*1 [S]"), g=hb.Zero())
    m.bond("n -> g -> hit")
    machine(m, "a -> b when C.e > 5 V", "b -> a when C.e < 1 V", a=[], b=["g"])


def always_fieldless(m: hb.Model) -> None:
    m.add(hit=hb.Sf("-pre(C.e)*1 [S]"))
    m.bond("n -> hit")


def negative_storage(m: hb.Model) -> None:
    m.add(D=hb.C("-1 mF"))
    m.bond("n -> D")


def zero_storage(m: hb.Model) -> None:
    m.add(D=hb.C("0 F"))
    m.bond("n -> D")


def wrong_start(m: hb.Model) -> None:
    m.add(D=Part("C", "1 F", {"p": 1.0}))
    m.bond("n -> D")


def start_unit(m: hb.Model) -> None:
    m.add(D=hb.C("1 F", e="1 A"))
    m.bond("n -> D")


def one_way_transformer(m: hb.Model) -> None:
    m.add(T=hb.TF(2), D=hb.C("1 F"))
    m.bond("n -> T", "D -> T")


def mixed_domains(m: hb.Model) -> None:
    m.add(mass=hb.I("1 kg", domain="translational"), L=hb.I("1 H", domain="electrical"))
    m.bond("n -> mass", "n -> L")


def unknown_domain(m: hb.Model) -> None:
    m.add(mass=hb.I(1, domain="pneumatic"))
    m.bond("n -> mass")


def signal_cycle(m: hb.Model) -> None:
    m.signal(x="y + 1", y="x + 1")
    machine(m, "a -> b when x > 1")


def parameter_cycle(m: hb.Model) -> None:
    m.parameter(p="q + 1", q="p + 1")


def code_in_a_law(m: hb.Model) -> None:
    m.add(R2=hb.R("__import__('os').system('true')"))
    m.bond("n -> R2")


def field_shape(m: hb.Model) -> None:
    m.add(L=hb.I([["1 H", "0.1 H"]]))
    m.bond("n -> L.1", "n -> L.2")


def asymmetric_field(m: hb.Model) -> None:
    m.add(L=hb.I([[1, 0.5], [0.1, 1]]))
    m.bond("n -> L.1", "n -> L.2")


def two_masters(m: hb.Model) -> None:
    machine(m, a=[], b=["s"])
    m.machine("k2", states={"a": ["s"]}, start="a")


def empty_table(m: hb.Model) -> None:
    m.input(u=hb.Input(table=[]))


CASES: list[tuple[Callable[[hb.Model], None], str, str]] = [
    (unknown_element, "HB-M101", "graph.bonds"),
    (unknown_parameter, "HB-M120", "elements.R2"),
    (wrong_unit, "HB-U103", "elements.R2"),
    (dangling, "HB-M130", "R2"),
    (double_bond, "HB-M130", "R"),
    (self_bond, "HB-M132", "graph.bonds"),
    (guard_unknown, "HB-M120", "machines.k.rules[0]"),
    (guard_equality, "HB-M123", "machines.k.rules[0]"),
    (guard_units, "HB-U102", "machines.k.rules[0]"),
    (guard_number, "HB-M146", "machines.k.rules[0]"),
    (guard_state, "HB-M120", "machines.k.rules[0]"),
    (rule_text, "HB-M145", "machines.k.rules[0]"),
    (rule_state, "HB-M144", "machines.k.rules[0]"),
    (state_element, "HB-M141", "machines.k.states.b"),
    (fieldless_without_exit, "HB-M172", "machines.k.states.b"),
    (fieldless_a_posteriori_exit, "HB-M171", "machines.k.states.b"),
    (always_fieldless, "HB-M170", "elements.hit"),
    (negative_storage, "HB-M163", "elements.D"),
    (zero_storage, "HB-M163", "elements.D"),
    (wrong_start, "HB-M165", "elements.D"),
    (start_unit, "HB-U103", "elements.D.e"),
    (one_way_transformer, "HB-M131", "T"),
    (mixed_domains, "HB-M134", "elements.mass.domain"),
    (unknown_domain, "HB-M133", "mass"),
    (signal_cycle, "HB-M122", "signals"),
    (parameter_cycle, "HB-M108", "p"),
    (code_in_a_law, "HB-E1", "elements.R2"),
    (field_shape, "HB-M161", "elements.L"),
    (asymmetric_field, "HB-M163", "elements.L"),
    (two_masters, "HB-M142", "machines.k2"),
    (empty_table, "HB-M150", "inputs.u"),
]


@pytest.mark.parametrize(
    ("spoil", "code", "where"), CASES, ids=lambda c: getattr(c, "__name__", "")
)
def test_refusal(spoil: Callable[[hb.Model], None], code: str, where: str) -> None:
    m = circuit()
    spoil(m)
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    error = caught.value
    assert error.code.startswith(code), error
    assert where in error.where, error
    assert error.why
    assert error.hint


@pytest.mark.parametrize("guard", ["true", "not false", "time >= 0 s", 'k.state == "b"'])
def test_an_exit_that_waits_for_no_jump_is_told_what_does(guard: str) -> None:
    """Where a jump keeps the sign of a speed, only the state itself says that it was written."""

    def leaves(guard: str) -> hb.Model:
        m = circuit()
        m.add(hit=hb.Sf("0.5*pre(C.e)*1 [S]"), g=hb.Zero())
        m.bond("n -> g -> hit")
        machine(m, "a -> b when C.e > 5 V", f"b -> a when {guard}", a=[], b=["g"])
        return m

    with pytest.raises(hb.ModelError) as caught:
        leaves(guard).flatten()
    assert caught.value.code == "HB-M171"
    told = 'pre(k.state == "b")'
    assert caught.value.hint.endswith(told)
    assert leaves(told).flatten().machines


@pytest.mark.parametrize(
    ("value", "told"), [("A", "1/A"), ("A + A", "1/(A + A)"), ("12 cm^2", "1/(12 cm^2)")]
)
def test_a_modulus_that_is_the_other_way_round_is_told(value: str, told: str) -> None:
    """A cylinder's area is flow per speed, the modulus of its transformer pressure per force."""
    m = hb.Model("cylinder", domain="hydraulic", parameters={"A": "12 cm^2"})
    m.add(p=hb.Se("2 bar"), n=hb.Zero(), ram=hb.TF(value), mass=hb.I("3 kg"))
    m.add(v=hb.One(domain="translational"))
    m.bond("p -> n -> ram -> v -> mass")
    with pytest.raises(hb.UnitError) as caught:
        m.flatten()
    assert f"write {told}," in caught.value.hint


def test_the_sound_model_is_accepted() -> None:
    assert len(circuit().flatten().bonds) == 4


def test_did_you_mean_names_the_nearest() -> None:
    m = circuit()
    m.machine(
        "k", states={"a": [], "b": ["s"]}, start="a", rules=["a -> b when C.q > 1 and Cc.e > 1"]
    )
    with pytest.raises(hb.ModelError, match=r"C\.e"):
        m.flatten()


def test_a_unit_without_its_brackets_is_told_from_a_name() -> None:
    m = circuit()
    m.machine("k", states={"a": [], "b": ["s"]}, start="a", rules=["a -> b when C.q > 1 A/s"])
    with pytest.raises(hb.ModelError, match=r"2 \[m/s\]") as caught:
        m.flatten()
    assert caught.value.code == "HB-M120"
    m.machines["k"] = m.machines["k"].__class__(
        states={"a": [], "b": ["s"]}, start="a", rules=("a -> b when C.q > nothing",)
    )
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M120" and "[" not in str(caught.value.hint)
