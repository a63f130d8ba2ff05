"""Arrays in files, scripts, drawings and the studio: they stay as they are written."""

from __future__ import annotations

import json
import runpy
import tomllib
from pathlib import Path

import pytest

import hybond as hb
from hybond.draw import draw
from hybond.export.identifiers import distinct, slot_name, spoken
from hybond.files.load import from_data
from hybond.files.schema import json_schema
from hybond.studio.edits import apply, cut_out
from hybond.studio.of_runs import numbers_of
from hybond.studio.problems import place_of
from hybond.studio.strokes import meaning, strokes
from hybond.studio.view import view

TEXT = """\
hybond = 1
title  = "Three gaps"
domain = "electrical"

[parameters]
n = 3

[elements]
"c[1..n]" = { C = "(i) [uF]", e = ["1 V", "2 V", "3 V"] }   # each its own
"gap[1..n]" = { junction = 1 }
"top[0..n]" = { junction = 0 }
"r[k = 1..n]" = { submodel = "electrical.resistor", parameters = { R = "(10*k) [ohm]" } }
"d[1..n]" = { junction = 1, law = "coulomb", limit = ["1 V", "2 V", "3 V"] }
ground = { Se = 0 }

[graph]
bonds = [
  "top[0..n-1] -> gap[1..n] -> top[1..n]", "gap[1..n] -> c[1..n]",
  "top[1..n] -> r[1..n].plus", "r[1..n].minus -> top[0]", "ground -> top[0]",
  "top[1..n] -> d[1..n] -> top[0]",
]

[signals]
"u[1..n]" = "top[i].e - top[i-1].e"
all_up = "sum(u[1..n])"

[inputs]
"g[1..n]" = { table = [[0, 0], ["(i) [ms]", 1]] }

[machines."spark[1..n]"]
states = { off = [], on = ["gap[i]"] }
start = "off"
rules = ["off -> on when g[i] > 0.5"]

[experiment]
until = "5 ms"
plot  = ["u[n]", "all_up"]
"""


@pytest.fixture(scope="module")
def model() -> hb.Model:
    return hb.loads(TEXT)


def test_a_round_trip_keeps_the_compact_form(model: hb.Model, tmp_path: Path) -> None:
    for form in ("toml", "json"):
        text = hb.dumps(model, format=form)
        again = hb.loads(text, format=form)
        for section in ("elements", "bonds", "signals", "inputs", "machines", "experiment"):
            assert getattr(again, section) == getattr(model, section)
        assert text.count("top[0..n-1]") == 1
        assert hb.dumps(again, format=form) == text
    file = tmp_path / "gaps.toml"
    file.write_text(TEXT)
    changed = hb.load(file)
    changed.parameter(n=5)
    hb.save(changed, file)
    assert file.read_text() == TEXT.replace("n = 3", "n = 5")


def test_the_published_schema_knows_lists_of_values() -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    check = jsonschema.Draft202012Validator(json_schema())
    data = tomllib.loads(TEXT)
    assert list(check.iter_errors(data)) == []
    data["elements"]["c[1..n]"]["C"] = ["1 uF", ["2 uF"]]
    assert list(check.iter_errors(data)) == []
    data["elements"]["c[1..n]"]["C"] = [{"e": "q"}]
    assert list(check.iter_errors(data)) != []


def test_a_script_makes_the_same_model(model: hb.Model, tmp_path: Path) -> None:
    script = tmp_path / "gaps.py"
    script.write_text(hb.export(model, to="python"))
    made = runpy.run_path(str(script))["model"]()
    a, b = (m.flatten() for m in (made, model))
    assert [n.path for n in a.nodes] == [n.path for n in b.nodes]
    assert [x.start for x in a.storages] == [x.start for x in b.storages] == [1.0, 2.0, 3.0]
    assert made.elements == model.elements


def test_names_of_members_become_identifiers_that_differ(model: hb.Model) -> None:
    graph = model.flatten()
    said = [spoken(graph, f"x:{s.index}") for s in graph.storages]
    assert said == ["c[1].q", "c[2].q", "c[3].q"]
    assert distinct(map(slot_name, said), ()) == ["C_1_Q", "C_2_Q", "C_3_Q"]
    text = hb.export(model, to="modelica")
    assert all(f"Real c_{k}_q(start = {k * k}e-06" in text for k in (1, 2, 3))
    assert "constant Real n = 3" in text  # a tool must not offer to change it


@pytest.mark.slow
def test_members_of_an_array_stand_in_a_row() -> None:
    two = hb.loads(TEXT.replace("n = 3", "n = 2").replace(', "3 V"]', "]"))
    parts = {g.key for g in two.draw(schematic=True).scene.groups if g.name == "part"}
    assert {"r[1]", "r[2]", "c[2]"} <= parts
    m = hb.loads(TEXT)
    m.layout = {
        "top[0..n]": (0, 0),
        "gap[1..n]": (1, 0),
        "c[1]": (1, 1),
        "c[3]": (5, 3),
        "r[1..n]": (0, 5),
        "d[1..n]": (0, 8),
        "ground": (0, 1),
    }
    m.models["wide"] = hb.library.part("electrical.resistor")
    m.models["wide"].layout["minus"] = (6, 0)
    m.elements["r[k = 1..n]"] = hb.Submodel("wide")
    at = draw(m.flatten(), simplify=False).positions
    assert [at[f"top[{k}]"] for k in range(4)] == [(2 * k, 0) for k in range(4)]
    assert [at[f"gap[{k}]"] for k in (1, 2, 3)] == [(1, 0), (3, 0), (5, 0)]
    assert at["c[2]"] == (3, 2)
    # a part of six cells, and two between
    assert [at[f"r[{k}].i"] for k in (1, 2, 3)] == [(1, 5), (9, 5), (17, 5)]


def test_the_studio_shows_an_array_as_one_node() -> None:
    data = tomllib.loads(TEXT)
    seen = view(data, "")
    assert seen is not None
    assert [n["name"] for n in seen["nodes"]] == list(data["elements"])
    ends = [(b["key"], b["tail"], b["head"]) for b in seen["bonds"]]
    assert ends[:3] == [
        ("0.0", "top[0..n]", "gap[1..n]"),
        ("0.1", "gap[1..n]", "top[0..n]"),
        ("1.0", "gap[1..n]", "c[1..n]"),
    ]
    assert next(n for n in seen["nodes"] if n["name"] == "gap[1..n]")["machine"] == "spark[1..n]"
    known = meaning(data, base=None, where="gaps.toml")
    told = strokes(known, None, "")
    assert set(told["bonds"]) == {key for key, _, _ in ends}
    assert told["nodes"]["gap[1..n]"] == {"controlled": True, "off": True}
    inside = strokes(known, None, "r[k = 1..n]")
    assert inside["nodes"]["r"]["says"] == "10 Ω"
    graph = known.graph
    assert graph is not None
    shown = {key: graph.bonds[k].name for key, k in numbers_of(known, "").items()}
    assert shown["0.0"] == "top[0] -> gap[1]"
    assert shown["0.1"] == "gap[1] -> top[1]"
    assert shown["1.0"] == "gap[1] -> c[1]"
    assert set(shown) == set(told["bonds"])
    assert numbers_of(known, "r[k = 1..n]").keys() == inside["bonds"].keys() != set()
    assert place_of(data, "elements.c[2].C") == {"nodes": ["c[1..n]"]}


def test_edits_keep_arrays_and_their_ranges() -> None:
    data = tomllib.loads(TEXT)
    after = apply(data, {"do": "rename", "old": "top[0..n]", "new": "node[0..n]"})
    assert after["graph"]["bonds"][0] == "node[0..n-1] -> gap[1..n] -> node[1..n]"
    assert after["signals"]["u[1..n]"] == "node[i].e - node[i-1].e"
    from_data(after).flatten()
    after = apply(data, {"do": "remove", "names": ["c[1..n]"]})
    assert "gap[1..n] -> c[1..n]" not in after["graph"]["bonds"]
    assert len(after["graph"]["bonds"]) == len(data["graph"]["bonds"]) - 1
    names = {"gap[1..n]", "c[1..n]"}
    after = apply(data, {"do": "paste", "data": cut_out(data, "", names)})
    assert "gap[1..n] -> c[1..n]" in after["graph"]["bonds"]
    assert {"gap1[1..n]", "c1[1..n]"} <= after["elements"].keys()
    assert after["machines"]["spark[1..n]"]["states"]["on"] == ["gap[i]"]
    with pytest.raises(hb.HybondError, match="an array stays one"):
        apply(data, {"do": "rename", "old": "c[1..n]", "new": "q"})


def test_data_of_a_model_says_it_as_written(model: hb.Model) -> None:
    data = json.loads(hb.dumps(model, format="json"))
    assert data["elements"]["c[1..n]"] == {"C": "(i) [uF]", "e": ["1 V", "2 V", "3 V"]}
    assert list(data["machines"]) == ["spark[1..n]"]


def test_a_range_in_a_list_of_signals_is_each_of_its_members(model: hb.Model) -> None:
    again = hb.loads(TEXT.replace('["u[n]", "all_up"]', '["c[1..n].e", "sum(u[1..n])", "u[n]"]'))
    listed = ["c[1].e", "c[2].e", "c[3].e", "sum(u[1..n])", "u[3]"]
    assert again.flatten().experiment["plot"] == listed
    assert hb.simulate(again)["sum(u[1..n])"].at(0.0) == 0.0
    assert again.experiment["plot"][0] == "c[1..n].e"
    assert model.flatten(parameters={"n": 3}).experiment["plot"] == ["u[3]", "all_up"]
