"""Fractions with a comma, other arrows and other names of sections are told what they are here."""

import pytest

import hybond as hb

RIGHT = """
hybond = 1
domain = "electrical"
[parameters]
r = "1.5 kohm"
[elements]
V = { Se = "2.5*(1 [V]) + 1 V" }
R = { R = "r" }
C = { C = "1 mF" }
i = { junction = 1 }
[graph]
bonds = ["V -> i -> R", "i -> C"]
[signals]
v = "C.e"
[machines.S]
states = { on = ["i"], off = [] }
start = "on"
rules = ["on -> off when v > 1 V"]
[experiment]
until = "1 s"
"""


def refused(old: str, new: str) -> str:
    assert RIGHT.count(old) == 1
    with pytest.raises(hb.HybondError) as caught:
        hb.loads(RIGHT.replace(old, new)).flatten()
    return str(caught.value)


@pytest.mark.parametrize(
    "old, new, meant",
    [
        ("1.5 kohm", "1,5 kohm", "1.5"),
        ("1.5 kohm", "1,5e3 ohm", "1.5e3"),
        ("2.5*(1 [V])", "2,5*(1 [V])", "2.5"),
        ("v > 1 V", "v > 1,25 [V]", "1.25"),
    ],
)
def test_a_fraction_with_a_comma_is_told_the_point(old: str, new: str, meant: str) -> None:
    """It was told to take out what stands from the comma on: another number."""
    assert f"a decimal fraction has a point: {meant}" in refused(old, new)


@pytest.mark.parametrize("arrow", ["=>", "==>", "-->", "→", "to", ">"])
@pytest.mark.parametrize("when", ["when", "if", ":"])
def test_a_rule_with_another_arrow_is_told_as_it_is_to_be(arrow: str, when: str) -> None:
    """It was told a rule of a switch that the model does not have."""
    if (arrow, when) == ("-->", "when"):
        return  # that is a rule
    said = refused("on -> off when", f"on {arrow} off {when}")
    assert "HB-M145" in said and 'write "on -> off when v > 1 V"' in said
    assert "on -> off when v > 1 V" in RIGHT  # which is right


@pytest.mark.parametrize(
    "section, meant",
    [("simulation", "experiment"), ("components", "elements"), ("connections", "graph"),
     ("constants", "parameters"), ("switches", "machines")],
)  # fmt: skip
def test_a_section_of_another_tool_is_told_its_name(section: str, meant: str) -> None:
    said = refused("[experiment]", f"[{section}]")
    assert "HB-F109" in said and f"did you mean '{meant}'?" in said


@pytest.mark.parametrize("key", ["until", "outputs", "measure", "rtol"])
def test_a_key_of_the_experiment_above_all_sections_is_told_where_it_stands(key: str) -> None:
    said = refused("hybond = 1", f"hybond = 1\n{key} = 1")
    assert "HB-F109" in said and f"{key} = ... stands below [experiment]" in said


def test_what_is_left_over_behind_an_expression_is_still_told_so() -> None:
    assert "take out what stands from ',' on" in refused("1.5 kohm", "r1, 5")
