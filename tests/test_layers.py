"""The rooms of the package import leftwards only; no text is ever run as code; import is light."""

import ast
import functools
import graphlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src"
FILES = sorted((SOURCE / "hybond").rglob("*.py"))
TEXTS = {path: path.read_text(encoding="utf-8") for path in FILES}

LAYERS = [
    ["_version"],
    ["calls", "chronicle", "errors", "names", "options", "records", "uncollected", "units"],
    ["model"],
    ["blocks"],
    ["files"],
    ["library"],
    ["causality", "hints"],
    ["equations", "switching"],
    ["progress", "runs", "translate"],
    ["engine"],
    ["report"],
    ["measures", "one_run", "result", "scripts", "simulation", "tabled"],
    ["draw"],
    ["circuits", "export", "testing"],
    ["analysis", "sweep"],
    ["fitting"],
    ["studio"],
    ["cli"],
]
LAYER = {room: index for index, rooms in enumerate(LAYERS) for room in rooms}

ENGINE = [
    ["algebra", "complementarity", "expressions"],
    ["reasons"],
    ["inputs"],
    ["mode.rows"],
    ["mode.nonlinear"],
    ["mode.left_free"],
    ["mode.digits"],
    ["mode.comparisons"],
    ["mode"],
    ["constraints"],
    ["impacts", "surfaces"],
    ["jumps"],
    ["methods.tolerances"],
    ["methods.explicit"],
    ["methods.linear"],
    ["methods.implicit"],
    ["methods.quantised"],
    ["methods"],
    ["guards", "planar"],
    ["laws"],
    ["instant"],
    ["checks", "contacts", "sliding", "timestepping"],
    ["looking", "run"],
    ["tables"],
    ["compiled"],
    ["interpreted"],
    ["outcome"],
]
"""The rooms of the engine, leftmost first. What a run is made of may be read by all of them."""
ENGINE_LAYER = {room: index for index, rooms in enumerate(ENGINE) for room in rooms}

# Display methods that import rightwards when they are called: the function, the rooms it may use.
# and the one place where a model asks for a ready part by its name, which is a file to read.
DISPLAY: dict[str, set[str]] = {
    "hybond.model.hierarchy.submodel_of": {"library"},
    "hybond.causality.report.CausalityReport._repr_svg_": {"draw"},
    "hybond.model.builder.Model.draw": {"draw"},
    "hybond.model.builder.Model.check": {"hints"},
    "hybond.result.Result.plot": {"draw"},
    "hybond.measures.measuring.Measuring.plot_losses": {"draw"},
    "hybond.measures.measuring.Measuring.sankey": {"draw"},
}

EXEMPT = {"hybond", "hybond.__main__"}

HOLD_STATEMENTS = (ast.stmt, ast.excepthandler, ast.match_case)
"""Imports are among these; what is said in expressions need not be walked through."""

HEAVY = ["scipy", "matplotlib", "typer", "rich", "tomlkit", "pandas"]


def module_name(path: Path) -> str:
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(tree: ast.Module, package: str) -> Iterator[tuple[str, int, str]]:
    """Yield (qualified name of the enclosing function, line, imported dotted name)."""

    def visit(node: ast.AST, scope: str) -> Iterator[tuple[str, int, str]]:
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield scope, node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")
            base = parts[: len(parts) - node.level + 1] if node.level else []
            base = [*base, *(node.module.split(".") if node.module else [])]
            for alias in node.names:
                yield scope, node.lineno, ".".join([*base, alias.name])
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            scope = f"{scope}.{node.name}"
        for child in ast.iter_child_nodes(node):
            if isinstance(child, HOLD_STATEMENTS):
                yield from visit(child, scope)

    yield from visit(tree, "")


@functools.cache
def imports_in(source: str, package: str) -> list[tuple[str, int, str]]:
    """List the imports of a file."""
    return list(imports(ast.parse(source), package))


def rightward(source: str, path: Path) -> list[tuple[str, int, str]]:
    """List the (scope, line, room) of imports in a file that do not go leftwards."""
    module = module_name(path)
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    own = LAYER[module.split(".")[1]]
    found = []
    for scope, line, name in imports_in(source, package):
        top, _, rest = name.partition(".")
        room = rest.partition(".")[0]
        # `import hybond` itself, or a public name of it, is an import from the far right.
        if top == "hybond" and LAYER.get(room, len(LAYERS)) > own:
            found.append((module + scope, line, room))
    return found


def test_every_room_has_a_layer() -> None:
    rooms = {module_name(path).split(".")[1] for path in FILES if module_name(path) not in EXEMPT}
    assert rooms <= LAYER.keys()


def test_imports_go_left() -> None:
    found = [
        (path, *row)
        for path, text in TEXTS.items()
        if module_name(path) not in EXEMPT
        for row in rightward(text, path)
    ]
    wrong = [
        f"{path}:{line}: {scope} imports from {room or 'the package itself'}"
        for path, scope, line, room in found
        if room not in DISPLAY.get(scope, ())
    ]
    assert not wrong, "\n".join(wrong)
    used = {(scope, room) for _, scope, _, room in found}
    listed = {(scope, room) for scope, rooms in DISPLAY.items() for room in rooms}
    assert listed <= used, f"listed for nothing: {sorted(listed - used)}"


def engine_imports() -> dict[str, set[str]]:
    """Return what each module of the engine reads of the engine: `room.module`, or a module."""
    texts = {module_name(p): text for p, text in TEXTS.items()}
    start = "hybond.engine."
    own = {name.removeprefix(start) for name in texts if name.startswith(start)}
    found: dict[str, set[str]] = {}
    for module in own - ENGINE_LAYER.keys():
        names = imports_in(texts[start + module], f"{start}{module}".rpartition(".")[0])
        read = [name.removeprefix(start) for _, _, name in names if name.startswith(start)]
        found[module] = {n if n in own else n.rpartition(".")[0] for n in read}
    return found


def made_of(read: dict[str, set[str]]) -> set[str]:
    """Return the modules that a run is made of: records of `engine.Engine`, and theirs."""
    found, waiting = {"answers"}, ["engine"]
    while waiting:
        module = waiting.pop()
        if module not in found:
            found.add(module)
            waiting += sorted(read[module])
    return found


def upward(read: dict[str, set[str]]) -> list[str]:
    """List the imports among rooms of the engine that do not go left, records left out."""
    records = made_of(read)
    found = []
    for module, others in read.items():
        own = ENGINE_LAYER.get(module.rpartition(".")[0], 0)
        for other in others - records:
            room = other if other in ENGINE_LAYER else other.rpartition(".")[0]
            same = room == module.rpartition(".")[0]
            if not same and ENGINE_LAYER.get(room, len(ENGINE)) >= own:
                found.append(f"{module} reads {other}")
    return sorted(found)


def test_rooms_of_the_engine_read_leftwards() -> None:
    read = engine_imports()
    assert {m.rpartition(".")[0] for m in read if "." in m} == ENGINE_LAYER.keys()
    wrong = upward(read)
    assert not wrong, "\n".join(wrong)
    # what a run is made of are records, and what these are made of, left of all equations
    for module in made_of(read):
        room, _, name = module.rpartition(".")
        below = ENGINE_LAYER.get(room, -1) < ENGINE_LAYER["mode.rows"]
        assert below or name.endswith(("_records", "_room")), module


def test_the_test_of_the_engine_sees() -> None:
    read = engine_imports()
    for module, other in (
        ("mode.nonlinear.newton", "surfaces.values"),
        ("mode.nonlinear.newton", "mode.digits.sizes"),
        ("guards.locate", "instant.settle"),
    ):
        more = {**read, module: read[module] | {other}}
        assert upward(more) == [f"{module} reads {other}"]


def test_folders_of_a_room_read_one_way() -> None:
    """The engine's are held to an order, by the tests before."""
    read: dict[str, set[str]] = {}
    for path, text in TEXTS.items():
        package = module_name(path if path.name == "__init__.py" else path.parent / "__init__.py")
        room = package.split(".")[1] if "." in package else "engine"
        for _, _, name in imports_in(text, package) if room != "engine" else ():
            parts = name.split(".")
            while not (SOURCE.joinpath(*parts)).is_dir() and len(parts) > 1:
                parts.pop()
            other = ".".join(parts)
            if other != package and other.startswith(f"hybond.{room}"):
                read.setdefault(package, set()).add(other)
    graphlib.TopologicalSorter(read).prepare()  # raises where they go round
    read["hybond.analysis.linear"] = {"hybond.analysis.periodic"}
    with pytest.raises(graphlib.CycleError):
        graphlib.TopologicalSorter(read).prepare()


def files(*, mapped: bool) -> set[str]:
    """Return the files that the map of the engine is about, or all that docs/rooms.md is about."""
    package = SOURCE / "hybond"
    paths = {p.relative_to(package).with_suffix("").as_posix() for p in package.rglob("*.py")}
    engine = re.compile(r"engine/(?!tables|compiled|interpreted|outcome)")
    named = {p for p in paths if "__" not in p and p != "_version"}
    return {p for p in named if bool(engine.match(p)) == mapped}


def test_the_map_of_the_engine_names_every_file_in_its_room() -> None:
    room, named = "", set()
    for line in TEXTS[SOURCE / "hybond" / "engine" / "__init__.py"].splitlines():
        if head := re.fullmatch(r" {4}(\w+)/", line):
            room = head[1]
        elif head := re.fullmatch(r" {8}(\w+)/", line):
            room = f"{room.partition('/')[0]}/{head[1]}"
        elif row := re.match(r" {8}(?: {4})?(\w+(?:, \w+)*) {2}", line):
            named |= {f"engine/{room}/{name}" for name in row[1].split(", ")}
    whole = {
        "engine",
        "model",
        "answers",
        "words",
        "work",
        "method_numbers",
    }  # its first lines have these
    assert named == files(mapped=True) - {f"engine/{name}" for name in whole}


def test_the_page_of_rooms_names_every_other_file_in_its_room() -> None:
    page = (SOURCE.parent / "docs" / "rooms.md").read_text(encoding="utf-8")
    wanted = files(mapped=False)
    rooms, named = list[str](), list[str]()
    for line in page.splitlines():
        first = line.split("|")[1] if line.startswith("|") else ""
        words = re.findall(r"`([\w/]+)`", first)
        if first.startswith(" files of "):
            rooms = ["" if word == "hybond/" else word for word in words]
        elif not first:
            rooms = []
        elif rooms:
            found = [f"{room}{word}" for word in words for room in rooms if room + word in wanted]
            assert len(found) == len(words), line
            named += found
    assert sorted(named) == sorted(wanted)


@pytest.mark.parametrize(
    ("text", "file", "rooms"),
    [
        ("from ..causality import assign", "model/a.py", ["causality"]),
        ("from ..causality import assign", "cli/a.py", []),
        ("from ...draw import svg", "model/__init__.py", []),  # leaves the package: not ours
        ("from .. import draw, errors", "model/a.py", ["draw"]),
        ("from . import b", "model/a.py", []),
        ("from .cli.main import main", "errors.py", ["cli"]),
        ("import hybond.draw.svg as s", "model/a.py", ["draw"]),
        ("import hybond", "cli/a.py", [""]),
        ("from hybond import Model", "cli/a.py", ["Model"]),
        ("from .names import suggest", "units.py", []),
        ("from .result import Result", "simulation.py", []),
        ("class M:\n    def plot(self):\n        from ..draw import p", "model/a.py", ["draw"]),
    ],
)
def test_the_import_test_sees(text: str, file: str, rooms: list[str]) -> None:
    found = rightward(text, SOURCE / "hybond" / file)
    assert [room for _, _, room in found] == rooms
    if text.startswith("class"):
        assert found[0][0] == "hybond.model.a.M.plot"


def runs_text(source: str) -> list[str]:
    """List what in a file could run text or data as code."""
    modules = {"pickle", "cPickle", "_pickle", "dill", "cloudpickle", "marshal", "shelve"}
    if not re.search(r"pickle|dill|marshal|shelve|\b(eval|exec)\b", source):
        return []  # parsing takes most of the time
    found = []
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name.split(".")[0] for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            names = [node.module.split(".")[0]]
        if modules & set(names):
            found.append(f"line {node.lineno}: imports {', '.join(names)}")
        if isinstance(node, ast.Name) and node.id in {"eval", "exec"}:
            found.append(f"line {node.lineno}: {node.id}")
        elif isinstance(node, ast.Attribute):
            if ast.unparse(node) in {"builtins.eval", "builtins.exec"}:
                found.append(f"line {node.lineno}: {ast.unparse(node)}")
            if node.attr in {"read_pickle", "to_pickle"}:
                found.append(f"line {node.lineno}: {node.attr}")
        elif isinstance(node, ast.keyword) and node.arg == "allow_pickle":
            refused = isinstance(node.value, ast.Constant) and node.value.value is False
            if not refused:
                found.append(f"line {node.value.lineno}: allow_pickle")
    return found


def test_no_text_is_run_as_code() -> None:
    found = [f"{path}: {what}" for path, text in TEXTS.items() for what in runs_text(text)]
    assert not found, "\n".join(found)


def test_the_text_test_sees() -> None:
    for text in (
        "eval('1')",
        "f = exec",
        "import builtins\nbuiltins.eval('1')",
        "import pickle",
        "def f():\n    from pickle import loads",
        "np.load(p, allow_pickle=True)",
        "pd.read_pickle(p)",
    ):
        assert len(runs_text(text)) == 1, text
    assert not runs_text("model.evaluate(x)\nre.compile('eval')\nnp.load(p, allow_pickle=False)")


def test_import_hybond_is_light() -> None:
    paths = [str(SOURCE), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-c", "import sys, hybond; print(hybond.__file__, *sys.modules)"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not set(HEAVY) & set(done.stdout.split())


def test_a_run_by_the_library_imports_no_engine() -> None:
    text = (
        "import sys, hybond as hb\n"
        "m = hb.Model('rc', domain='electrical')\n"
        "m.add(c=hb.C('1 mF', e='10 V'), r=hb.R('1 kohm'), node=hb.Zero())\n"
        "m.bond('node -> c', 'node -> r')\n"
        "hb.simulate(m, until='1 s')\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.split())
    if "hybond.engine.interpreted.run" not in loaded:  # there is a library
        rooms = {"hybond.engine.run.motion", "hybond.files", "hybond.causality", "msgspec"}
        assert not rooms & loaded
