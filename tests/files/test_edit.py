"""Saving over a file touches what changed and leaves the comments, order and spelling."""

from collections.abc import Callable
from pathlib import Path

import pytest

from hybond.files import dumps, load, save, to_data
from hybond.files.edit import edit_toml
from hybond.model.builder import Model
from hybond.model.constructors import C, I, One, R, Se, Zero
from hybond.model.parts import InputPart, Integral, Submodel

BALL = """\
# A ball and a floor.
hybond = 1
title  = 'Ball'      # the title
domain = "generic"   # the default, written all the same

# --- numbers
[parameters]
m = "1 kg"   # mass
g = 9.810
# the end of the parameters

[elements]
weight  = { Se = "-m*g" }      # up is positive
ball    = { I = "m", f = '2 m/s' }
pad.C   = "1 mm/N"
v       = { junction = 1 }

# the bonds
[graph]
bonds = [
  "weight -> v -> ball",  # first
  # a comment on the contact
  "contact -> v",
  "x -> y",               # last
]

[signals]
h = { integral = "v.f", start = 0.0 }

[machines.floor]
states = { away = [], touching = ["contact"] }  # states
start  = "away"
rules  = [
  "away -> touching when h <= 0",
  "touching -> away when contact.e < 0",        # the floor pushes
]

# what to run
[experiment]
until = "3 s"
plot = ["h", "contact.e"] # plots

# places
[layout]
ball = [2, 0]
v = [0x1, 1_000.0]
"""

Change = Callable[[Model], object]


def edited(tmp_path: Path, change: Change, text: str = BALL) -> str:
    """Return the text after a load, a change and a save; check that it says what it should."""
    path = tmp_path / "ball.toml"
    path.write_bytes(text.encode())
    model = load(path)
    change(model)
    save(model, path)
    assert to_data(load(path)) == to_data(model)
    return path.read_bytes().decode()


def difference(old: str, new: str) -> tuple[list[str], list[str]]:
    """Return the lines that are only in the one and only in the other."""
    a, b = old.split("\n"), new.split("\n")
    return [x for x in a if x not in b], [x for x in b if x not in a]


def put(group: str, **entries: object) -> Change:
    return lambda m: getattr(m, group).update(entries)


CHANGES: dict[str, tuple[Change, list[str], list[str]]] = {
    "nothing": (lambda m: None, [], []),
    "a value": (put("parameters", m=2.0), ['m = "1 kg"   # mass'], ["m = 2.0   # mass"]),
    "its type": (put("layout", ball=(2.0, 0)), ["ball = [2, 0]"], ["ball = [2.0, 0]"]),
    "the title": (
        lambda m: setattr(m, "title", "New"),
        ["title  = 'Ball'      # the title"],
        ['title  = "New"      # the title'],
    ),
    "a default key": (
        lambda m: setattr(m, "domain", "electrical"),
        ['domain = "generic"   # the default, written all the same'],
        ['domain = "electrical"   # the default, written all the same'],
    ),
    "the name": (lambda m: setattr(m, "name", "n"), [], ['name = "n"']),
    "a new parameter": (put("parameters", k=1e-9), [], ["k = 1e-09"]),
    "a new element": (put("elements", c=Zero()), [], ["c = { junction = 0 }"]),
    "an element's value": (
        put("elements", weight=Se("-m")),
        ['weight  = { Se = "-m*g" }      # up is positive'],
        ['weight  = { Se = "-m" }      # up is positive'],
    ),
    "an element's kind": (
        put("elements", weight=R(1, impulsive=True)),
        ['weight  = { Se = "-m*g" }      # up is positive'],
        ["weight  = { R = 1, impulsive = true }      # up is positive"],
    ),
    "an element out": (
        lambda m: m.elements.pop("weight"),
        ['weight  = { Se = "-m*g" }      # up is positive'],
        [],
    ),
    "a dotted element": (put("elements", pad=C(1)), ['pad.C   = "1 mm/N"'], ["pad.C   = 1"]),
    "an option out": (
        put("elements", ball=I("m")),
        ["ball    = { I = \"m\", f = '2 m/s' }"],
        ['ball    = { I = "m" }'],
    ),
    "a bond changed": (
        lambda m: m.bonds.__setitem__(1, "c -> v"),
        ['  "contact -> v",'],
        ['  "c -> v",'],
    ),
    "a bond in front": (lambda m: m.bonds.insert(0, "n -> m"), [], ['  "n -> m",']),
    "a bond between": (lambda m: m.bonds.insert(1, "n -> m"), [], ['  "n -> m",']),
    "a bond behind": (lambda m: m.bond("n -> m"), [], ['  "n -> m",']),
    "a start": (
        put("signals", h=Integral("v.f", "3 m")),
        ['h = { integral = "v.f", start = 0.0 }'],
        ['h = { integral = "v.f", start = "3 m" }'],
    ),
    "an experiment": (put("experiment", rtol=1e-9), [], ["rtol = 1e-09"]),
    "a plot": (
        lambda m: m.experiment["plot"].append("z"),
        ['plot = ["h", "contact.e"] # plots'],
        ['plot = ["h", "contact.e", "z"] # plots'],
    ),
    "a place": (put("layout", w=(1, 2.5)), [], ["w = [1, 2.5]"]),
    "a new machine": (
        lambda m: m.machine("b", states={"a": ["v"]}, start="a"),
        [],
        ["[machines.b]", 'states = { a = ["v"] }', 'start = "a"'],
    ),
    "a new section": (
        put("inputs", u=InputPart(table=[(0, 1), ("1 s", 2.0)], linear=True)),
        [],
        ["[inputs]", 'u = { table = [[0, 1], ["1 s", 2.0]], linear = true }'],
    ),
}


@pytest.mark.parametrize("name", CHANGES)
def test_one_change(tmp_path: Path, name: str) -> None:
    change, gone, come = CHANGES[name]
    text = edited(tmp_path, change)
    assert difference(BALL, text) == (gone, come)
    # Undoing it by another save gives the data back.
    path = tmp_path / "ball.toml"
    original = tmp_path / "other" / "ball.toml"
    original.parent.mkdir()
    original.write_text(BALL)
    save(load(original), path)
    assert to_data(load(path)) == to_data(load(original))


@pytest.mark.parametrize(
    ("change", "line", "before"),
    [
        (put("parameters", k=1), "k = 1", "# the end of the parameters"),
        (put("elements", k=C(1)), "k = { C = 1 }", ""),
        (put("inputs", u=InputPart(1)), "[inputs]", "u = { constant = 1 }"),
        (lambda m: m.bond("n -> m"), '  "n -> m",', "]"),
    ],
)
def test_new_keys_come_last_in_their_section(
    tmp_path: Path, change: Change, line: str, before: str
) -> None:
    lines = edited(tmp_path, change).split("\n")
    assert lines[lines.index(line) + 1] == before


def test_new_sections_take_their_place_and_layout_stays_last(tmp_path: Path) -> None:
    def change(m: Model) -> None:
        inner = Model("motor")
        inner.add(j=One(), k=Zero())
        m.add(part=Submodel("motor"))
        m.models["motor"] = inner
        m.input(u=3)
        m.port(shaft="v")
        m.machine("b", states={}, start="a")

    text = edited(tmp_path, change)
    headers = [line for line in text.split("\n") if line.startswith("[")]
    assert headers == [
        "[parameters]",
        "[elements]",
        "[graph]",
        "[signals]",
        "[inputs]",
        "[machines.floor]",
        "[machines.b]",
        "[ports]",
        "[models.motor.elements]",
        "[experiment]",
        "[layout]",
    ]
    assert "\n# what to run\n[experiment]\n" in text
    assert "\n# places\n[layout]\n" in text
    assert "\n\n\n" not in text


def test_sections_within_submodels(tmp_path: Path) -> None:
    text = (
        "hybond = 1\n\n[models.a.elements]\nx = { C = 1 } # x\n\n"
        "[models.b.elements]\ny = { C = 1 } # y\n\n[layout]\nq = [1, 2]\n"
    )

    def change(m: Model) -> None:
        m.models["a"].signal(s="x.e")
        m.models["a"].add(z=C(2))
        m.models["b"].title = "The b"
        m.models["c"] = Model("c")

    found = edited(tmp_path, change, text)
    assert found == (
        "hybond = 1\n\n[models.a.elements]\nx = { C = 1 } # x\nz = { C = 2 }\n\n"
        '[models.a.signals]\ns = "x.e"\n\n'
        '[models.b]\ntitle = "The b"\n\n'
        "[models.b.elements]\ny = { C = 1 } # y\n\n"
        "[models.c]\n\n[layout]\nq = [1, 2]\n"
    )


@pytest.mark.parametrize(
    "text",
    [
        'hybond = 1\nparameters = { m = 1 }\nelements = { a = { C = "m" } } # all inline\n',
        'hybond = 1\nparameters.m = 1\nelements.a.C = "m" # dotted\n',
        "hybond = 1\n[elements.a]\nC = 'm' # own tables\n[parameters]\nm = 1\n",
        "hybond = 1\n[parameters]\n[elements]\n[elements.a]\nC = 1 # empty tables\n",
        "hybond = 1\n[elements.a]\nC=1 # out of order\n[parameters]\nm = 1\n[elements.b]\nC=1\n",
        '"hybond" = 1\n["parameters"]\n"m" = 1 # quoted keys\n',
        "hybond = 1 # bare",
    ],
)
def test_other_ways_of_writing(tmp_path: Path, text: str) -> None:
    def change(m: Model) -> None:
        m.parameter(m=2, k="3 N")
        m.elements["a"] = C(7, e=1)
        m.add(new=One())
        m.bond("a -> new")
        m.signal(s="a.e")

    found = edited(tmp_path, change, text)
    assert text.partition("#")[2].split("\n")[0] in found


def test_multiline_text_and_strange_spacing_survive(tmp_path: Path) -> None:
    text = (
        "hybond=1\n"
        'title="""\n[layout]\nk = 3 # no comment\n"""\n\n\n'
        "  [ parameters ]   # spaced\n\tm\t=\t1\n"
        "[elements]\n"
        "f = { C = [ [1, 2], # row\n"
        "  [3, 4],\n ] }\n"
    )
    found = edited(tmp_path, put("parameters", k=2), text)
    assert difference(text, found) == ([], ["k = 2"])
    assert found.index("k = 2") < found.index("[elements]")


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_windows_line_ends_and_byte_order_marks_survive(tmp_path: Path, mark: str) -> None:
    text = mark + BALL.replace("\n", "\r\n")
    found = edited(tmp_path, put("parameters", k=2), text)
    assert found.replace("k = 2\r\n", "") == text
    assert edited(tmp_path, lambda m: None, text) == text


def test_a_name_that_is_written_stays_written(tmp_path: Path) -> None:
    text = 'hybond = 1\nname = "x" # name\n'
    assert edited(tmp_path, lambda m: None, text) == text
    found = edited(tmp_path, lambda m: setattr(m, "name", "ball"), text)
    assert found == 'hybond = 1\nname = "ball" # name\n'


def test_a_name_like_the_file_is_not_written(tmp_path: Path) -> None:
    save(Model("one"), tmp_path / "one.toml")
    save(Model("one"), tmp_path / "two.toml")
    assert (tmp_path / "one.toml").read_text() == "hybond = 1\n"
    assert (tmp_path / "two.toml").read_text() == 'hybond = 1\nname = "one"\n'


def test_a_model_that_is_wrong_is_put_right_with_its_comments(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    right = BALL.replace("start = 0.0", "start = 1.0").replace('"generic"', '"electrical"')
    path.write_text(right)
    model = load(path)
    wrong = right.replace("{ junction = 1 }", "{ junction = 7 }  # why not").replace(
        "until", "utnil"
    )
    path.write_text(wrong)
    save(model, path)
    gone, come = difference(wrong, path.read_text())
    assert gone == ["v       = { junction = 7 }  # why not", 'utnil = "3 s"']
    assert come == ["v       = { junction = 1 }  # why not", 'until = "3 s"']


def test_an_empty_file_is_filled(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("\n")
    save(Model("b"), path)
    assert load(path).name == "b"


def test_a_long_list_gets_a_line_per_item(tmp_path: Path) -> None:
    model = Model("a")
    model.bond(*(f"element_{k} -> junction_{k}" for k in range(6)))
    assert '\n  "element_5 -> junction_5",\n]' in dumps(model)
    path = tmp_path / "a.toml"
    path.write_text('hybond = 1\n[graph]\nbonds = ["x -> y"] # here\n')
    save(model, path)
    assert load(path).bonds == model.bonds
    assert "# here" in path.read_text()


def test_editing_is_a_function_of_its_arguments() -> None:
    old, new = {"a": [1, 2, 3]}, {"a": [1, 9, 3, 4]}
    assert edit_toml("a = [1, 2, 3]\n", old, new) == "a = [1, 9, 3, 4]\n"
    assert edit_toml("a = [1, 2, 3]\n", old, new, finely=False) == "a = [1, 9, 3, 4]\n"
