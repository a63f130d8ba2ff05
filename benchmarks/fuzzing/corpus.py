"""Good inputs: the examples, netlists and files of tests that the changes begin with."""

from __future__ import annotations

import json
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from hybond.circuits import deck  # noqa: F401 - here, so that each child has it
from hybond.files.toml_text import toml_text

ROOT = Path(__file__).parents[2]
UNIT = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="g" guid="{g}">
<CoSimulation modelIdentifier="g"/>
<UnitDefinitions><Unit name="V"><BaseUnit kg="1" m="2" s="-3" A="-1" factor="1" offset="0"/></Unit>
</UnitDefinitions>
<TypeDefinitions><SimpleType name="U"><Real unit="V"/></SimpleType></TypeDefinitions>
<ModelVariables>
<ScalarVariable name="u" valueReference="1" causality="input"><Real unit="V" start="0"/>
</ScalarVariable>
<ScalarVariable name="k" valueReference="2" causality="parameter"><Real start="1"/></ScalarVariable>
<ScalarVariable name="n" valueReference="3" causality="parameter"><Integer start="1"/>
</ScalarVariable><ScalarVariable name="y" valueReference="0" causality="output">
<Real declaredType="U"/></ScalarVariable></ModelVariables><ModelStructure/></fmiModelDescription>
"""
UNIT3 = """<fmiModelDescription fmiVersion="3.0" modelName="g" instantiationToken="g">
<CoSimulation modelIdentifier="g"/>
<UnitDefinitions><Unit name="m/s"><BaseUnit m="1" s="-1" factor="1"/></Unit></UnitDefinitions>
<TypeDefinitions><Float64Type name="U" unit="m/s"/></TypeDefinitions>
<ModelVariables><Float64 name="u" valueReference="1" causality="input" start="0"/>
<Float64 name="a" valueReference="4" causality="output"><Dimension start="3"/></Float64>
<Boolean name="b" valueReference="2" causality="parameter" start="true"/>
<Float64 name="y" valueReference="0" causality="output" declaredType="U"/></ModelVariables>
<ModelStructure/></fmiModelDescription>
"""
STATE = """{"format": "hybond state 1", "model": "ball", "t": 1.0, "stored": {"ball.p": -9.0},
"signals": {"height": 0.5}, "machines": {"impact": "away"}, "landed": [],
"units": {"ball.p": "N*s"}, "memory": {"model": "abc", "span": 1.0, "deep": true,
"numbers": [1.0, "inf"], "places": [1, 2]}}"""
DATA = "time,side,height [mm],v\n0,right,5,0\n0.1,right,4.5,-1\n0.2,right,,\n0.3,right,3,-2.5\n"
SMALL = """\
hybond = 1
title = "A ball that loses speed at each bounce"
domain = "translational"
[parameters]
e = 0.5
g = "10 m/s^2"
[inputs]
push = { table = [["0 s", "0 N"], ["1 s", "1 N"], ["2 s", "0 N"]], linear = true }
[elements]
weight = { Se = "-g*(1 kg) + push" }
ball = { I = "1 kg", f = "-1 m/s" }
floor = { Sf = "-e*pre(v.f)" }
v = { junction = 1 }
contact = { junction = 0 }
[graph]
bonds = ["weight -> v -> ball", "contact -> v", "floor -> contact"]
[signals]
height = { integral = "v.f", start = "5 m" }
half = "height/2"
[machines.impact]
states = { away = [], hits = ["contact"] }
start = "away"
rules = ["away -> hits when height <= 0 and v.f < 0", "hits -> away when pre(v.f) >= 0"]
[experiment]
until = "1.5 s"
plot = ["height"]
"""
EXPRESSIONS = (
    "-m*g",
    "height <= 0 and v.f < 0",
    "pre(L.f) > I_th or not (time >= 5 ms)",
    "10 V*sin(314*time/(1 s))",
    "if(x > 0, x^2, -sqrt(abs(x)))",
    "min(a, b, 3)*max(1, x)/(1 + exp(-x/(2 mV)))",
    "table(x, [[0, 0], [1, 2]])",
    "1 kohm + 3.3e-3 [N*m/A]",
    "sum(c[1..3].e) - sign(x)*tanh(y)",
    "time_since(M) > 1 ms and M == on",
)
QUANTITIES = (
    "1 kg",
    "10 mN/m",
    "-3.5e3 N*m/A^2",
    "5 %",
    "20 degC",
    "1 1/s",
    "2 kg*m^2*s^-3",
    "1e3",
)


@cache
def models() -> dict[str, str]:
    """Return the texts of model files by name: examples, ready parts, and a small one."""
    found = {p.stem: p for p in sorted((ROOT / "examples").glob("**/*.toml"))}
    parts = sorted((ROOT / "src/hybond/library").glob("**/*.toml"))
    found.update({f"part_{p.parent.name}_{p.stem}": p for p in parts[::6]})
    texts = {name: path.read_text(encoding="utf-8") for name, path in found.items()}
    return {"small": SMALL, **{k: v for k, v in texts.items() if len(v) < 20_000}}


@cache
def trees() -> dict[str, Any]:
    """Return the same as plain data."""
    return {name: tomllib.loads(text) for name, text in models().items()}


@cache
def netlists() -> dict[str, str]:
    """Return the texts of netlists by name, with those in tests and pages."""
    places = [
        *(ROOT / "examples/netlists").glob("*.cir"),
        *(ROOT / "benchmarks/converters").glob("*.cir"),
        *(ROOT / "benchmarks/decks").glob("*.cir"),
    ]
    found = {p.stem: p.read_text(encoding="utf-8", errors="replace") for p in sorted(places)}
    for path in sorted((ROOT / "tests/circuits").glob("test_*.py")):
        texts = re.findall(r'"""\\?\n(.*?)"""', path.read_text(encoding="utf-8"), re.DOTALL)
        for k, text in enumerate(texts):
            if re.search(r"^\.(tran|end|model|subckt)\b|^[RVLC]\w* \w+ 0 ", text, re.M | re.I):
                found[f"{path.stem}_{k}"] = text
    return found


@cache
def schematics() -> dict[str, str]:
    """Return the texts of schematics of LTspice by name."""
    numbers = {"top": 16, "bottom": 96, "first": 16, "second": 96, "x": 0, "y": 0, "turn": "R0"}
    numbers |= {"rx": 48, "ry": 0, "rturn": "R0"}
    found = {}
    for path in sorted((ROOT / "tests/circuits").glob("test_*.py")):
        text = path.read_text(encoding="utf-8")
        for k, sheet in enumerate(re.findall(r'"""(Version 4.*?)"""', text, re.DOTALL)):
            for word, number in numbers.items():
                sheet = sheet.replace(f"{{{word}}}", str(number))
            found[f"{path.stem}_{k}"] = sheet.replace("\\\\n", "\\n")
    return found


@cache
def graphs() -> dict[str, str]:
    """Return the texts of files of BondGraphTools by name."""
    return {p.stem: p.read_text() for p in sorted((ROOT / "tests/circuits/files").glob("*.bg"))}


@cache
def tokens() -> tuple[str, ...]:
    """Return what stands in models: names, paths, laws, guards, quantities."""
    found: set[str] = set()
    stack: list[Any] = list(trees().values())
    while stack:
        node = stack.pop()
        if isinstance(node, dict):
            found.update(map(str, node))
            stack.extend(node.values())
        elif isinstance(node, list):
            stack.extend(node)
        elif isinstance(node, str) and len(node) < 200:
            found.add(node)
    return tuple(sorted(found))


def toml_of(tree: Any) -> str:
    """Return a model as TOML; what is no model at all as one table on one line."""
    try:
        return toml_text(tree)
    except (AttributeError, TypeError, RecursionError):
        return f"elements = {json.dumps(tree).replace(':', ' =')}"


def json_of(tree: Any) -> str:
    return json.dumps(tree)
