"""What is refused of arrays: with a code, the line of the file, and a remedy."""

from __future__ import annotations

import pytest

import hybond as hb

FRAME = """hybond = 1
parameters = {{ n = 3, h = 2.5, m = "2 kg" }}
[elements]
node = {{ junction = 0 }}
{elements}
[graph]
bonds = [{bonds}]
{rest}
"""
C = '"c[1..n]" = { C = 1 }'


@pytest.mark.parametrize(
    ("elements", "bonds", "rest", "code", "line", "says", "remedy"),
    [
        ('"c[1..h]" = { C = 1 }', "", "", "HB-M152", 5, "'h' is 2.5", "whole numbers"),
        ('"c[1..m]" = { C = 1 }', "", "", "HB-M152", 5, "'m' is 2 kg", "whole"),
        ('"c[1..-2]" = { C = 1 }', "", "", "HB-M152", 5, "is -2", "whole"),
        ('"c[3..1]" = { C = 1 }', "", "", "HB-M152", 5, "backwards, from 3 to 1", "[1..3]"),
        ('"c[1..20000]" = { C = 1 }', "", "", "HB-M152", 5, "20000 members", "fewer"),
        ('"c[1..10^9]" = { C = 1 }', "", "", "HB-M152", 5, "the limit is 10000", "fewer"),
        ('"c[1..k]" = { C = 1 }', "", "", "HB-M107", 5, "'k' is not a parameter", "known names"),
        ('"c[1..n]" = { C = [1, 2] }', "", "", "HB-M155", 5, "2 values for the 3", "one value"),
        ('"c[1..n]" = { C = 1, e = [1] }', "", "", "HB-M155", 5, "1 values", "one value"),
        ('"c[]" = { C = 1 }', "", "", "HB-M103", 5, "cannot be a name", "cell[1..10]"),
        ('"c[1..2..3]" = { C = 1 }', "", "", "HB-E101", 5, "", ""),
        ('"c[1.." = { C = 1 }', "", "", "HB-M103", 5, "cannot be a name", "cell[1..10]"),
        ('"1[1..2]" = { C = 1 }', "", "", "HB-M103", 5, "cannot be a name", ""),
        ('"pi[1..2]" = { C = 1 }', "", "", "HB-M103", 5, "cannot be a name", ""),
        ('"node[1..2]" = { C = 1 }', "", "", "HB-M104", 5, "used twice", "rename"),
        ('"c[1..2]" = { C = 1 }\n"c[2..n]" = { C = 1 }', "", "", "HB-M104", 6, "'c[2]'", "rename"),
        ('"c[1..2]" = { C = 1 }\nc = { C = 1 }', "", "", "HB-M104", None, "'c'", "rename"),
        ('"n[1..2]" = { C = 1 }', "", "", "HB-M104", 5, "used twice", "rename"),
        ('"c[h = 1..2]" = { C = "h" }', "", "", "HB-M104", 5, "so is a parameter", "c[k = 1..2]"),
        (C, '"node -> c[1..4]"', "", "HB-M154", 7, "members 1 to 3, no 4", "c[3]"),
        (C, '"node -> c[0]"', "", "HB-M154", 7, "members 1 to 3, no 0", "c[1]"),
        (C, '"node -> c"', "", "HB-M154", 7, "'c' is an array", "c[1]"),
        (C, '"node[1] -> c[1]"', "", "HB-M154", 7, "'node' is no array", ""),
        (C, '"c[1..n] -> c[1..2]"', "", "HB-M153", 7, "[1..n] has 3, [1..2] has 2", "1..n-1"),
        (C, '"b: node -> c[1..n]"', "", "HB-M109", 7, "3 bonds", "on its own"),
        (C, '"node -> c[1..h]"', "", "HB-M152", 7, "'h' is 2.5", "whole"),
        (C, '"node -> c[1..n]"', 'signals = { s = "c[4].q" }', "HB-M154", 8, "no 4", "c[3]"),
        (C, '"node -> c[1..n]"', 'signals = { s = "c[1..n].q" }', "HB-M153", 8, "several", "sum"),
        (C, '"node -> c[1..n]"', 'signals = { s = "c.q" }', "HB-M154", 8, "is an array", "c[1]"),
        (C, '"node -> c[1..n]"', 'signals = { s = "sum(c[1].q)" }', "HB-E104", 8, "sum", "range"),
        (
            C,
            '"node -> c[1..n]"',
            'signals = { s = "max(c[1..0].q)" }',
            "HB-M153",
            8,
            "no members",
            "",
        ),
        (
            C,
            '"node -> c[1..n]"',
            'signals = { s = "node[m/s]" }',
            "HB-M154",
            8,
            "no array",
            "[m/s]",
        ),
        (C, '"node -> c[1..n]"', 'signals = { s = "(h) [furlong]" }', "HB-E102", 8, "unit", ""),
        ("c = { C = [1, 2] }", "", "", "HB-F112", 5, "a list is needed", "array"),
        ("c = { Se = [1, 2] }", "", "", "HB-F112", 5, "a list of 2", "array"),
    ],
)
def test_refusals_say_where_and_what_to_try(
    elements: str, bonds: str, rest: str, code: str, line: int | None, says: str, remedy: str
) -> None:
    # inline tables of sections come before the first header
    head, _, tail = FRAME.format(elements=elements, bonds=bonds, rest="").partition("\n[elements]")
    text = f"{head}\n{rest}\n[elements]{tail}" if rest else f"{head}\n[elements]{tail}"
    if rest and line is not None:
        line = 3 if line == 8 else line + 1
    with pytest.raises(hb.HybondError) as caught:
        hb.loads(text, where="a.toml").flatten()
    error = caught.value
    assert error.code == code
    assert says in error.why
    assert remedy in (error.hint or "")
    if line is not None:
        assert error.line == line


def test_machines_and_inputs_of_arrays_are_refused_where_they_stand() -> None:
    text = """hybond = 1
[elements]
V = { Se = 1 }
"j[1..2]" = { junction = 1 }
"r[1..2]" = { R = 1 }
n = { junction = 0 }
[graph]
bonds = ["V -> n -> j[1..2] -> r[1..2]"]
[machines."m[1..3]"]
states = { off = [], on = ["j[i]"] }
start = "off"
rules = ["off -> on when time > i"]
"""
    with pytest.raises(hb.HybondError) as caught:
        hb.loads(text, where="m.toml").flatten()
    assert caught.value.code == "HB-M141"
    assert caught.value.line is not None
    assert "j[3]" in caught.value.why


def test_a_count_that_is_no_whole_number_is_refused_when_it_is_set() -> None:
    m = hb.Model("c", parameters={"n": 2})
    m.add({"c[1..n]": hb.C(1)}, a=hb.Zero(), b=hb.Se(1))
    m.bond("b -> a", "a -> c[1..n]")
    for value, code in ((2.5, "HB-M152"), ("3 kg", "HB-M152"), (3, "")):
        try:
            hb.simulate(m, "1 s", parameters={"n": value})
            found = ""
        except hb.HybondError as error:
            found = error.code
        assert found == code


def test_hints_know_what_counts_and_what_ranges_read() -> None:
    m = hb.Model("c", parameters={"n": 2, "k": 1, "unused": 3})
    m.add({"c[1..n]": hb.R("g[i]"), "v[k..n]": hb.Zero()}, b=hb.Se(1), r=hb.R("sum(w[1..n])"))
    m.input({"g[1..n]": 1, "w[1..n]": 2, "idle[1..n]": 3})
    m.bond("b -> r", "c[1..n] -> v[k..n]")
    checked = m.check()
    assert checked.error is None
    assert sorted((h.code, h.where) for h in checked) == [
        ("HB-H101", "elements.c[1]"),
        ("HB-H103", "elements.v[1]"),
        ("HB-H106", "parameters.unused"),
        ("HB-H108", "inputs.idle[1..n]"),
    ]


HOSTILE = 'hybond = 1\n[elements]\na = { junction = 0 }\n"c[1..100]" = { C = 1 }\n'
BONDS = '[graph]\nbonds = ["a -> c[1..100]"]\n'


@pytest.mark.parametrize(
    ("rest", "code"),
    [
        ("[graph]\nbonds = [" + '"a -> c[1..100]", ' * 9 + "]", "HB-F103"),
        ("[signals]\n" + "".join(f'"s{k}[1..100]" = "1"\n' for k in range(9)), "HB-F103"),
        ("[ports]\n" + "".join(f'"s{k}[1..100]" = "a"\n' for k in range(9)), "HB-F103"),
        ('[machines."m[1..9]"]\nstates = { on = ["c[1..100]"] }\nstart = "on"', "HB-F103"),
        (BONDS + '[signals]\ns = "sum(c[1..99].q) + sum(c[1..99].q)"', "HB-E107"),
        (BONDS + '[signals]\ns = "sum(c[1..99].q*sum(c[1..99].q))"', "HB-E107"),
        (BONDS + '[signals]\ns = "sum(c[1..99].q)"', ""),
    ],
    ids=["bonds", "signals", "ports", "machines", "sums", "sums of sums", "a sum"],
)
def test_a_short_text_cannot_make_more_than_the_limits_say(
    rest: str, code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hybond.model.hierarchy.OPENED", 800)
    for room in ("indices", "resolve"):
        monkeypatch.setattr(f"hybond.model.{room}.MAX_NODES", 200)
    try:
        hb.loads(HOSTILE + rest).flatten()
        found = ""
    except hb.HybondError as error:
        found = error.code
    assert found == code
