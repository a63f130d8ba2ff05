"""What holds for every part of the library, whoever wrote it."""

import re
import tomllib
from pathlib import Path

import pytest
from listed import listed
from part_sheets import sheet_of

import hybond as hb
from hybond.files import dumps, loads, to_data
from hybond.files.edit import same

ROOT = Path(__file__).parents[2]
NAMES = hb.library.names()
TESTS = "\n".join(
    page.read_text(encoding="utf-8")
    for page in sorted(Path(__file__).parent.glob("test_*.py"))
    if page.name != Path(__file__).name
)
SHARED = {"effort": {"electrical", "hydraulic", "thermal", "thermal_pseudo", "magnetic"}}
SHARED["flow"] = {"translational", "rotational"}


def test_there_are_parts() -> None:
    assert {"electrical.diode", "electrical.resistor", "electrical.switch"} <= set(NAMES)


@listed("name", NAMES)
def test_a_part_says_what_it_is(name: str) -> None:
    sheet = sheet_of(name)
    assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*\.[a-z][a-z0-9]*(_[a-z0-9]+)*", name)
    assert re.fullmatch(r"[A-Z0-9][^\n]*[^.\s]", sheet.title)
    assert len(sheet.about) > 40
    for line in (*sheet.parameters, *sheet.inputs):
        assert line.about, f"{line.name} has no comment"
        assert not line.about.endswith("."), line.name
    assert sheet.signals, "nothing to plot"


@listed("name", NAMES)
def test_ports_are_junctions_that_share_what_nodes_of_their_domain_share(name: str) -> None:
    model = hb.library.part(name)
    assert bool(model.ports) == (not name.startswith("control.")), "control carries no power"
    for port in sheet_of(name).ports:
        assert port.shares, f"{port.name} is no junction"
        assert port.domain in SHARED[port.shares], port.name


@listed("name", NAMES)
@pytest.mark.slow
def test_every_node_has_its_place(name: str) -> None:
    graph = hb.library.part(name).flatten()
    nodes = {n.path for n in graph.nodes if not (n.hidden or n.implied)}
    assert nodes <= set(graph.layout)
    assert len({graph.layout[n] for n in nodes}) == len(nodes), "two nodes in one place"
    assert set(hb.library.part(name).layout) <= {*nodes, *hb.library.part(name).elements}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("first", range(8))
def test_a_part_survives_being_written(first: int) -> None:
    for name in NAMES[first::8]:
        model = hb.library.part(name)
        for format in ("toml", "json"):
            again = loads(dumps(model, format=format), format=format)
            assert same(to_data(again), to_data(model)), name
            assert again.flatten().nodes == model.flatten().nodes, name


@listed("name", NAMES)
def test_a_part_has_no_experiment_and_needs_no_name(name: str) -> None:
    text = sheet_of(name).text
    assert not {"experiment", "name", "models"} & set(tomllib.loads(text))
    assert "\t" not in text and text.endswith("\n")


@listed("name", NAMES)
def test_a_part_is_tried_in_a_test(name: str) -> None:
    assert f'"{name}"' in TESTS
