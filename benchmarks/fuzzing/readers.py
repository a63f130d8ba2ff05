"""Readers: each makes a changed input of a seed in a folder and has it read."""

from __future__ import annotations

import io
import json
import random
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import hybond as hb
from fuzzing import corpus
from fuzzing.judging import WrongError
from fuzzing.mutations import VALUES, changed_bytes, changed_text, changed_tree
from fuzzing.running import LIMITS, finite
from hybond.files.check import check_plain
from hybond.fitting.data import read_data
from hybond.measures.asked import read_measure
from hybond.model.expressions import parse
from hybond.model.expressions.text import to_text
from hybond.model.fingerprint import fingerprint_of
from hybond.model.graph import FlatGraph
from hybond.sweep.collect import collectors_of
from hybond.sweep.folder import Folder
from hybond.sweep.part import Part
from hybond.units import parse_quantity

Case = Callable[[random.Random, Path], None]


def toml(draw: random.Random, folder: Path) -> None:
    texts = list(corpus.models().values())
    text = changed_text(draw, draw.choice(texts), draw.sample(texts, 3))
    _model(folder / "m.toml", text.encode("utf-8", "surrogatepass"))


def toml_bytes(draw: random.Random, folder: Path) -> None:
    text = draw.choice(list(corpus.models().values()))
    _model(folder / "m.toml", changed_bytes(draw, text.encode()))


def toml_tree(draw: random.Random, folder: Path) -> None:
    trees = list(corpus.trees().values())
    tree = changed_tree(draw, draw.choice(trees), draw.sample(trees, 3))
    text = corpus.toml_of(tree)
    _model(folder / "m.toml", text.encode("utf-8", "surrogatepass"))


def json_tree(draw: random.Random, folder: Path) -> None:
    trees = list(corpus.trees().values())
    tree = changed_tree(draw, draw.choice(trees), draw.sample(trees, 3))
    _model(folder / "m.json", json.dumps(tree).encode())


def json_text(draw: random.Random, folder: Path) -> None:
    tree = draw.choice(list(corpus.trees().values()))
    text = changed_text(draw, json.dumps(tree, indent=draw.choice((None, 1))))
    _model(folder / "m.json", text.encode("utf-8", "surrogatepass"))


def submodels(draw: random.Random, folder: Path) -> None:
    """Files that name each other, also themselves, others' and none."""
    names = ["m.toml", "a.toml", "b.json", "../m.toml", "/etc/hostname", "sub/c.toml", "m", ""]
    (folder / "sub").mkdir()
    for name in ("m.toml", "a.toml", "b.json", "sub/c.toml"):
        tree = changed_tree(draw, draw.choice(list(corpus.trees().values())))
        if not isinstance(tree.get("elements"), dict):
            tree["elements"] = {}
        for k in range(draw.choice((0, 1, 2))):
            tree["elements"][f"part{k}"] = {"submodel": draw.choice(names)}
        text = json.dumps(tree) if name.endswith("json") else corpus.toml_of(tree)
        (folder / name).write_bytes(text.encode("utf-8", "surrogatepass"))
    _use(hb.load(folder / "m.toml"), folder)


def _model(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    _use(hb.load(path), path.parent)


def _use(model: hb.Model, folder: Path) -> FlatGraph:
    """Flatten a model that could be read, write it and read it again."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        graph = model.flatten()
    for format in ("toml", "json"):
        text = hb.dumps(model, format=format)
        again = hb.loads(text, format=format, base=folder, where=model.name)
        if fingerprint_of(again.flatten()) != fingerprint_of(graph):
            raise WrongError(f"read as another model from {format}:\n{text[:3000]}")
    return graph


def netlist(draw: random.Random, folder: Path) -> None:
    texts = list(corpus.netlists().values())
    text = changed_text(draw, draw.choice(texts), draw.sample(texts, 3))
    data = text.encode("utf-8", "surrogatepass")
    if draw.random() < 0.1:
        data = changed_bytes(draw, data)
    _circuit(folder / "n.cir", data)


def schematic(draw: random.Random, folder: Path) -> None:
    texts = list(corpus.schematics().values())
    text = changed_text(draw, draw.choice(texts), texts)
    _circuit(folder / "n.asc", text.encode("utf-8", "surrogatepass"))


def _circuit(path: Path, data: bytes) -> None:
    path.write_bytes(data)
    found = hb.read_circuit(path)
    for notice in found.warnings:
        str(notice)
    _use(found.model, path.parent)


def graph(draw: random.Random, folder: Path) -> None:
    texts = list(corpus.graphs().values())
    text = changed_text(draw, draw.choice(texts), texts)
    data = text.encode("utf-8", "surrogatepass")
    if draw.random() < 0.2:
        data = changed_bytes(draw, data)
    (folder / "g.bg").write_bytes(data)
    _use(hb.read_bond_graph(folder / "g.bg").model, folder)


def unit(draw: random.Random, folder: Path) -> None:
    """A functional mock-up unit: its description changed, its archive, names, sizes."""
    text = draw.choice((corpus.UNIT, corpus.UNIT3))
    if draw.random() < 0.8:
        text = changed_text(draw, text)
    data = text.encode("utf-8", "surrogatepass")
    name = draw.choice(
        ["modelDescription.xml"] * 9 + ["../x", "modeldescription.xml", "/x", "a" * 70]
    )
    match draw.randrange(12):
        case 0:
            data = data.replace(b">", b">" + b" " * draw.choice((10**5, 2 * 10**7)), 1)
        case 1:
            entities = b'<!DOCTYPE x [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>'
            data = data.replace(b"<fmi", entities + b"<fmi")
        case 2:
            data = data.decode("utf-8", "replace").encode(
                draw.choice(("utf-16", "latin1", "utf-32")), "replace"
            )
    packed = io.BytesIO()
    way = draw.choice(
        (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA)
    )
    with zipfile.ZipFile(packed, "w", way) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(draw.choice((1, 1, 1, 2))):
            archive.writestr(name, data)
        for k in range(draw.choice((0, 0, 1, 300))):
            archive.writestr(f"../../out{k}", b"x")
        if draw.random() < 0.05:
            archive.writestr("resources/big", bytes(5 * 10**7))
    found = packed.getvalue()
    if draw.random() < 0.3:
        found = changed_bytes(draw, found)
    (folder / "g.fmu").write_bytes(found)
    every = draw.choice((1, "10 ms", "1e-3"))
    m = hb.Model()
    m.add(r=hb.R(1), s=hb.Se(1), j=hb.One())
    m.bond("s -> j", "j -> r")
    m.block(
        g=hb.FMU(
            folder / "g.fmu", every=every, inputs={"u": "time"} if draw.random() < 0.5 else None
        )
    )
    m.flatten()


def state(draw: random.Random, folder: Path) -> None:
    if draw.random() < 0.5:
        tree = changed_tree(draw, json.loads(corpus.STATE))
        data = json.dumps(tree).encode()
    else:
        data = changed_text(draw, corpus.STATE).encode("utf-8", "surrogatepass")
    if draw.random() < 0.1:
        data = changed_bytes(draw, data)
    (folder / "s.json").write_bytes(data)
    found = hb.load_state(folder / "s.json")
    str(found)
    found.save(folder / "again.json")
    if hb.load_state(folder / "again.json").to_json() != found.to_json():
        raise WrongError("read as another state")


def state_of_run(draw: random.Random, folder: Path) -> None:
    """A state with memory that was changed, and a run from it."""
    model = hb.loads(corpus.SMALL)
    hb.simulate(model, "1.2 s").state().save(folder / "s.json")
    tree = changed_tree(draw, json.loads((folder / "s.json").read_text()))
    (folder / "s.json").write_bytes(json.dumps(tree).encode())
    start = hb.load_state(folder / "s.json")
    finite(hb.simulate(model, "1.5 s", start=start, on_error="return", limits=LIMITS))


def data(draw: random.Random, folder: Path) -> None:
    text = changed_text(draw, corpus.DATA)
    content = text.encode("utf-8", "surrogatepass")
    if draw.random() < 0.2:
        content = changed_bytes(draw, content)
    (folder / "d.csv").write_bytes(content)
    found = read_data(folder / "d.csv")
    if not np.all(np.isfinite(found.t)) or np.any(np.diff(found.t) < 0):
        raise WrongError(f"times {found.t}")


def expression(draw: random.Random, folder: Path) -> None:
    words = corpus.tokens()
    text = draw.choice(corpus.EXPRESSIONS) if draw.random() < 0.5 else draw.choice(words)
    if draw.random() < 0.95:
        text = changed_text(draw, text, words)
    found = parse(text, where="signals.x")
    said = to_text(found)
    if to_text(parse(said, where="signals.x")) != said:
        raise WrongError(f"{text[:200]!r} is said as {said[:200]!r}")


def quantity(draw: random.Random, folder: Path) -> None:
    text = changed_text(draw, draw.choice(corpus.QUANTITIES))
    try:
        found = parse_quantity(text)
    except hb.UnitError as error:
        error.where = error.where or "parameters.x"  # who asks knows it
        raise
    if not np.isfinite(found.value):
        raise WrongError(f"{text!r} is {found}")


ASKED = ("mean(L.f)", "ripple(v.f, from=1 s, to=2 s)", "rise_time(height, low=10 %, high=90%)")
ASKED += (
    "rms(x, period=1 ms, periods=3)",
    "thd(c.e, f=50 Hz)",
    "max(abs(x - 3)) ",
    "count(events)",
)
COLLECTED = ("final(ball.p), max(contact.e)", "count(events)", "at(x, 1 s)", "curve(x, 100)")
COLLECTED += ("mode", "sequence", "mode_time(M.on)", "first(M.on)", "ended", "mean(v.f)")
PLANNED = ("0.2:0.3:0.005", "1..2 kg:11", "log(1e-4, 1e-2, 50)", "normal(0.2, 0.01)", "1,2,3")
PLANNED += (
    "uniform(1, 2)",
    "1 kg, 2 kg",
    "lognormal(0, 1)",
    "10 mV..20 mV:3",
    "triangular(1, 2, 3)",
)


def asked(draw: random.Random, folder: Path) -> None:
    """Texts of measurements and collectors."""
    if draw.random() < 0.5:
        read_measure(changed_text(draw, draw.choice(ASKED)), where="measure")
    else:
        collectors_of(hb.loads(corpus.SMALL).flatten(), changed_text(draw, draw.choice(COLLECTED)))


def plan(draw: random.Random, folder: Path) -> None:
    """What varies in a sweep, as text and as data."""
    ways = ("random:5", "lhs:10", "sobol:8", "saltelli:4", "ends")
    factors = {}
    for path in draw.sample(("e", "ball.I", "height.start", "g", "x"), draw.choice((1, 2))):
        values = draw.choice(PLANNED)
        factors[path] = changed_text(draw, values) if draw.random() < 0.8 else draw.choice(VALUES)
    way = draw.choice((None, draw.choice(ways), changed_text(draw, draw.choice(ways))))
    seed = draw.choice((0, 0, -1, 2**70))
    found = hb.Plan(factors, sample=way, seed=seed, together=draw.random() < 0.3)
    rows = found.rows(0, min(len(found), 50))
    found.digest()
    for path, values in rows.items():
        array = np.asarray(values)
        if array.dtype.kind == "f" and not np.all(np.isfinite(array)):
            raise WrongError(f"{factors} gives {path} = {values}")


def folder_of_sweep(draw: random.Random, folder: Path) -> None:
    """A folder of a sweep in which a file was changed, and the same sweep again."""
    model = hb.loads(corpus.SMALL)
    again = {"collect": "final(height), mode", "out": folder / "s", "part": 2, "workers": 1}
    plan = {"e": [0.1, 0.5, 0.6]}
    table = hb.sweep(model, plan, **again).columns
    files = [p for p in (folder / "s").rglob("*") if p.is_file() and p.name != "lock"]
    for victim in draw.sample(files, draw.choice((1, 2))):
        content = victim.read_bytes()
        if victim.suffix == ".json" and draw.random() < 0.7:
            changed = json.dumps(changed_tree(draw, json.loads(content))).encode()
        elif victim.suffix == ".npz" and draw.random() < 0.7:
            changed = _part(draw, content)
        else:
            changed = changed_bytes(draw, content)
        victim.write_bytes(changed)
    found = hb.sweep(model, plan, **again).columns
    if str(found) != str(table):
        raise WrongError(f"{found} is not {table}")


def _part(draw: random.Random, content: bytes) -> bytes:
    """Return a part whose arrays were changed, of an archive that is whole."""
    packed = io.BytesIO()
    way = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(packed, "w", way) as new:
        victim = draw.choice(old.namelist())
        for name in old.namelist():
            array = old.read(name)
            if name == victim:
                array = changed_bytes(draw, array)
            new.writestr(name, array)
    return packed.getvalue()


def part(draw: random.Random, folder: Path) -> None:
    columns = {"ended": ["ok"], "final(x)": np.ones(1)}
    content = Part(4, ["ok"], np.array([1.0]), {0: ("a", "b", "c", "d")}, columns).to_bytes("k")
    content = _part(draw, content) if draw.random() < 0.5 else changed_bytes(draw, content)
    place = Folder(folder / "s")
    place.key = "k"
    place.place(4, 5).write_bytes(content)
    try:
        place.read(4, 5)
    finally:
        place.close()


def plain(draw: random.Random, folder: Path) -> None:
    """Plain data as the command line and the studio check them."""
    check_plain(changed_tree(draw, draw.choice(list(corpus.trees().values()))))


READERS: dict[str, Case] = {
    "toml": toml,
    "toml-bytes": toml_bytes,
    "toml-tree": toml_tree,
    "json-tree": json_tree,
    "json-text": json_text,
    "submodels": submodels,
    "netlist": netlist,
    "schematic": schematic,
    "graph": graph,
    "fmu": unit,
    "state": state,
    "state-run": state_of_run,
    "data": data,
    "expression": expression,
    "quantity": quantity,
    "asked": asked,
    "plan": plan,
    "sweep-folder": folder_of_sweep,
    "sweep-part": part,
}
