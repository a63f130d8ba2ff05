"""Random models survive every way of being written: text, file, edit of another model's file."""

import json
import string
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.files import dumps, from_data, load, loads, save, to_data
from hybond.files.edit import same
from hybond.files.schema import ELEMENTS
from hybond.model.builder import RESERVED

names = st.text(string.ascii_letters + string.digits + "_", min_size=1, max_size=5).filter(
    lambda s: not s[0].isdigit() and s not in RESERVED
)
texts = st.one_of(
    st.sampled_from(
        ["1 kg", "-m*g", "a -> b", 'say "x"', "C:\\x", "# no comment", "Ω\t\n\x7f\x00"]
    ),
    st.text(st.characters(exclude_categories=["Cs"]), max_size=12),
)
numbers = st.one_of(
    st.integers(-(2**63) + 1, 2**63 - 1),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([0, 0.0, -0.0, 1, 1.0, 1e-300, 5e-324, 1e22, 0.1]),
)
scalars = numbers | texts


def tables(values: Any, most: int = 3) -> Any:
    return st.dictionaries(names, values, max_size=most)


def some(**keys: Any) -> Any:
    return st.fixed_dictionaries({}, optional=keys)


law_table = st.integers(2, 4).flatmap(
    lambda n: st.fixed_dictionaries(
        {"table": st.lists(st.lists(numbers, min_size=n, max_size=n), min_size=2, max_size=2)},
        optional={"extrapolate": st.sampled_from(["error", "linear"])},
    )
)
law = scalars | law_table | st.lists(scalars | law_table, min_size=1, max_size=2)
matrix = st.integers(1, 3).flatmap(
    lambda n: st.lists(st.lists(scalars, min_size=n, max_size=n), min_size=n, max_size=n)
)
start = scalars | st.lists(scalars, max_size=2)


def element(kind: str) -> Any:
    options: dict[str, Any] = {"domain": texts}
    sides = {"C": ["e"], "I": ["f"], "R": ["e", "f"], "G": ["e", "f"]}.get(kind, [])
    value = scalars
    if sides:
        value |= matrix | st.one_of([st.fixed_dictionaries({s: law}) for s in sides])
    if kind in ("R", "G"):
        options["impulsive"] = st.booleans()
    if kind == "junction":
        value = st.sampled_from([0, 1])
    if kind == "submodel":
        value, options = names, {"parameters": tables(scalars).filter(bool)}
    one = st.fixed_dictionaries({kind: value}, optional=options)
    starts = {"C": ["e", "q"], "I": ["f", "p"]}.get(kind, [])
    return st.one_of(one, *[st.builds(lambda a, v, s=s: {**a, s: v}, one, start) for s in starts])


signal = texts | st.fixed_dictionaries(
    {"integral": texts}, optional={"start": scalars.filter(lambda v: repr(v) != "0.0")}
)
waveform = st.one_of(
    st.fixed_dictionaries({"constant": scalars}),
    st.fixed_dictionaries(
        {"table": st.lists(st.lists(scalars, min_size=2, max_size=2), min_size=1, max_size=3)},
        optional={"linear": st.just(True)},
    ),
    st.fixed_dictionaries(
        {
            "pwm": st.fixed_dictionaries(
                {"period": scalars, "duty": scalars},
                optional={"high": scalars, "low": scalars, "phase": scalars},
            )
        }
    ),
)
machine = st.fixed_dictionaries(
    {"states": st.dictionaries(texts, st.lists(texts, max_size=2), max_size=3), "start": texts},
    optional={"rules": st.lists(texts, min_size=1, max_size=3)},
)
experiment = some(
    until=scalars,
    solver=texts,
    rtol=numbers,
    atol=numbers,
    plot=st.lists(texts, max_size=3),
    outputs=st.lists(texts, max_size=3),
    max_writes=st.integers(1, 10**6),
    max_events=st.integers(1, 10**9),
    max_steps=st.integers(1, 10**9),
    event_tol=scalars,
    sliding=st.sampled_from(["filippov", "hysteresis", "refuse"]),
    hysteresis=scalars,
    impact=st.sampled_from(["newton", "newton_simultaneous", "poisson", "lzb", "lzb_hertz"]),
    points=st.integers(2, 1000),
)
causality = some(
    pins=st.dictionaries(texts, texts, min_size=1, max_size=3),
    reference=st.dictionaries(texts, texts, min_size=1, max_size=3),
)
NAMED = ("parameters", "elements", "signals", "inputs", "machines")


@st.composite
def sections(draw: Any, depth: int = 2) -> dict[str, Any]:
    data = draw(
        some(
            title=texts.filter(bool),
            domain=texts.filter(lambda t: t != "generic"),
            indeterminate=st.just("least leakage"),
            parameters=tables(scalars),
            elements=tables(st.one_of([element(kind) for kind in ELEMENTS]), 5),
            graph=st.fixed_dictionaries({"bonds": st.lists(texts, min_size=1, max_size=5)}),
            signals=tables(signal),
            inputs=tables(waveform),
            machines=tables(machine),
            causality=causality,
            ports=tables(texts),
            experiment=experiment,
            layout=st.dictionaries(texts, st.lists(numbers, min_size=2, max_size=2), max_size=3),
        )
    )
    taken: set[str] = set()
    for section in NAMED:
        for name in list(data.get(section, ())):
            if name in taken:
                del data[section][name]
            taken.add(name)
    if depth and draw(st.booleans()):
        data["models"] = draw(tables(sections(depth - 1), 2))
    return {key: value for key, value in data.items() if value or not isinstance(value, dict)}


@st.composite
def files(draw: Any) -> dict[str, Any]:
    return {"hybond": 1, "name": draw(texts.filter(bool)), **draw(sections())}


few = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@pytest.mark.slow
@few
@given(files())
def test_data_round_trips_exactly(data: dict[str, Any]) -> None:
    model = from_data(data)
    assert same(to_data(model), data)
    assert same(to_data(loads(dumps(model))), data)
    assert same(to_data(loads(dumps(model, format="json"), format="json")), data)
    # The text is stable, in the order of the data, and an independent parser reads the same.
    assert dumps(loads(dumps(model))) == dumps(model)
    assert same(tomllib.loads(dumps(model)), data)
    assert same(json.loads(dumps(model, format="json")), data)


@pytest.mark.slow
@few
@given(files(), st.sampled_from([".toml", ".json"]))
def test_files_round_trip_exactly(data: dict[str, Any], suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "one" + suffix)
        save(from_data(data), path)
        assert same(to_data(load(path)), data)
        before = path.read_bytes()
        save(load(path), path)
        assert path.read_bytes() == before


@pytest.mark.slow
@few
@given(files(), files())
def test_one_model_saved_over_another_keeps_the_comments_it_can(
    old: dict[str, Any], new: dict[str, Any]
) -> None:
    text, goal = dumps(from_data(old)), dumps(from_data(new))
    lines = [f"{line}  # kept" if line else line for line in text.split("\n")]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "one.toml")
        path.write_bytes("\n".join(lines).encode())
        save(from_data(new), path)
        assert same(to_data(load(path)), new)
        edited = path.read_bytes().decode().split("\n")
    in_goal = set(goal.split("\n"))
    for line in text.split("\n"):
        if not line or line.startswith((" ", "]")) or line not in in_goal:
            continue
        once = text.count(line) == 1 == goal.count(line)
        if once and in_same_table(line, text) == in_same_table(line, goal):
            assert f"{line}  # kept" in edited, line


def in_same_table(line: str, text: str) -> str:
    """Return the header above a line."""
    above = text.split("\n")
    above = above[: above.index(line) + 1]
    return next((x for x in reversed(above) if x.startswith("[") and x.endswith("]")), "")


@pytest.mark.parametrize("value", [1, 1.0, "1", True, 0.1 + 0.2, 1e22, 5e-324])
def test_numbers_stay_what_they_are(value: Any) -> None:
    data = {"hybond": 1, "name": "n", "elements": {"r": {"R": {"e": "f"}, "impulsive": True}}}
    if value is not True:
        data["parameters"] = {"p": value}
    for format in ("toml", "json"):
        found = to_data(loads(dumps(from_data(data), format=format), format=format))
        assert same(found, data)


@pytest.mark.parametrize("number", [1, 2.5, -1e-3])
@pytest.mark.parametrize("form", ["toml", "json"])
def test_a_signal_may_be_a_plain_number(number: float, form: str) -> None:
    text = 'hybond = 1\n[elements]\nS = { Se = "2*cap" }\nr = { R = 1 }\n'
    text += f'[graph]\nbonds = ["S -> r"]\n[signals]\ncap = {number}\n'
    read = hb.loads(text)
    made = hb.Model("made")
    made.add(S=hb.Se("2*cap"), r=hb.R(1))
    made.bond("S -> r")
    made.signal(cap=number)
    for model in (read, made):
        again = hb.loads(hb.dumps(model, format=form), format=form)
        assert again.signals == {"cap": number}
        assert hb.simulate(again, until=1.0)["r.f"].at(0.5) == 2 * number
        assert f"cap={number!r}" in hb.export(again, to="python")
        for to in ("modelica", "latex"):
            assert "cap" in hb.export(again, to=to)
