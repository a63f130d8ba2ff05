"""The page of the format and the published schema say what the code does."""

import json
import re
import tomllib
from pathlib import Path
from typing import Any, get_type_hints

import msgspec
import pytest

from hybond.files import dumps, load, loads, schema, to_data
from hybond.files.edit import same
from hybond.model.kinds import JUNCTIONS, KINDS

PAGE = Path(__file__).parents[2] / "docs" / "model_files.md"
TEXT = PAGE.read_text(encoding="utf-8")
EXAMPLES = [
    block for block in re.findall(r"```toml\n(.*?)```", TEXT, re.S) if "hybond = 1" in block
]
SCHEMA = Path(schema.__file__).with_name("model.schema.json")


@pytest.mark.parametrize("text", EXAMPLES)
def test_examples_load(text: str, tmp_path: Path) -> None:
    for block in EXAMPLES:  # the parts that an example refers to are examples themselves
        if name := re.match(r"# (\S+\.toml)\n", block):
            (tmp_path / name[1]).write_text(block, encoding="utf-8")
    model = loads(text, base=tmp_path)
    assert same(to_data(loads(dumps(model), base=tmp_path)), to_data(model))
    (tmp_path / "example.toml").write_text(text, encoding="utf-8")
    assert load(tmp_path / "example.toml").elements == model.elements


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 5


def test_every_key_is_on_the_page() -> None:
    shapes = [s for s in vars(schema).values() if isinstance(s, type) and s is not msgspec.Struct]
    shapes = [s for s in shapes if issubclass(s, msgspec.Struct)]
    keys = {key for shape in shapes for key in get_type_hints(shape)}
    keys = {key for key in keys if not key.startswith("__")}
    assert {key for key in keys if f"`{key}`" not in TEXT} == set()


def test_every_kind_can_be_written() -> None:
    assert set(schema.ELEMENTS) == {*KINDS} - {*JUNCTIONS} | {"junction", "submodel"}


def test_the_schema_is_up_to_date() -> None:
    # If not: json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n" is what it should be.
    assert json.loads(SCHEMA.read_text(encoding="utf-8")) == schema.json_schema()


def test_the_schema_refers_to_itself_only() -> None:
    text = SCHEMA.read_text(encoding="utf-8")
    definitions = json.loads(text)["$defs"]
    assert set(re.findall(r'"\$ref": "#/\$defs/(\w+)"', text)) <= definitions.keys()
    assert set(re.findall(r'"\$ref": "([^#])', text)) == set()


@pytest.mark.slow
def test_the_schema_accepts_the_examples_and_refuses_faults() -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    check = jsonschema.Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))
    for text in EXAMPLES:
        check.validate(tomllib.loads(text))
    wrong: list[dict[str, Any]] = [
        {},
        {"hybond": 2},
        {"hybond": 1, "elemnts": {}},
        {"hybond": 1, "elements": {"a": {"Cx": 1}}},
        {"hybond": 1, "elements": {"a": {"C": 1, "I": 1}}},
        {"hybond": 1, "elements": {"a": {"junction": 2}}},
        {"hybond": 1, "inputs": {"u": {}}},
        {"hybond": 1, "experiment": {"utnil": 1}},
    ]
    for data in wrong:
        assert not check.is_valid(data), data
