"""`read_bond_graph`: from a ``.bg`` file of BondGraphTools to a model.

Such a file is YAML: models, each a list of components (``name library/kind parameter=value``), a
netlist of bonds (``tail head``, with ports after a dot) and exposed ports. In BondGraphTools each
port counts its flow into the component, which decides the signs:

- ``R``, ``C``, ``I`` have the laws of hybond. ``Sf`` delivers its flow, ``f_0 = -f``.
- ``TF``: ``e_1 = r e_0`` and ``f_0 = -r f_1``, so port 1 is side 1 of hybond's TF of modulus r, and
  port 0 is side 2. ``GY``: ``e_1 = -R f_0``, ``e_0 = R f_1``: the same.
- A bond that leaves a 1-junction is at an inverting port, one that enters at a non-inverting one.
  The other way round it is a transformer of modulus -1.
- An exposed ``SS`` is the place where the inner bond and the outer one join: a 0-junction of two.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hybond.calls import called, named_file
from hybond.circuits.circuit import Conversion
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.notices import Notice
from hybond.circuits.wiring import chains
from hybond.errors import FileError, UsageError
from hybond.files import limits
from hybond.files.parse import read_text
from hybond.files.place import shortened
from hybond.model.builder import Model
from hybond.model.parts import InputPart, Part
from hybond.names import did_you_mean

VERSION = "0.1"
_DEFAULTS: Mapping[str, dict[str, float | None]] = {
    "base/0": {},
    "base/1": {},
    "base/R": {"r": 1000.0},
    "base/C": {"C": 1000.0},
    "base/I": {"L": 2000.0},
    "base/Se": {"e": None},
    "base/Sf": {"f": None},
    "base/TF": {"r": 1.0},
    "base/GY": {"R": 1.0},
    "base/SS": {"f": None, "e": None},
    "elec/Di": {"Is": None, "n": 1.0, "Vt": 0.0258563},
}
"""Kinds with a meaning here, and what their libraries give where the file gives nothing."""
_WITHOUT = {
    "base/PH": "a port-Hamiltonian component keeps its energy out of the file",
    "elec/BJT": "a transistor has no ideal meaning",
    "BioChem/Ce": "a chemical potential has no value at zero, and the file has no start values",
    "BioChem/Re": "it belongs to chemical potentials, which have no start values in the file",
    "BioChem/Y": "it belongs to chemical potentials, which have no start values in the file",
}


@dataclass
class _Node:
    """A component of the opened model: its name in the graph and what is free of its ports."""

    name: str
    kind: str
    ports: dict[str, str] = field(default_factory=dict)
    """Of a submodel: port to the node that stands for it."""


@called('hb.read_bond_graph("rc.bg")')
def read_bond_graph(path: str | os.PathLike[str], *, strict: bool = False) -> Conversion:
    r"""Read a ``.bg`` file of BondGraphTools.

    Parameters
    ----------
    path : str or path
    strict : bool
        Refuse what would be a warning.

    Returns
    -------
    Conversion

    Raises
    ------
    FileError
        HB-F145 (a warning, if `strict`), HB-F150 (not such a file), HB-F151 (a component without
        meaning here), HB-F152 (a bond or port that is not there).
    UsageError
        HB-F153 without PyYAML.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import hybond as hb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "rc.bg")
    ...     _ = path.write_text(
    ...         "version: '0.1'\nroot: rc\nmodels:\n  /:\n    components:\n"
    ...         "    - V base/Se e=5\n    - R base/R r=2\n    - C base/C C=0.1\n"
    ...         "    - i base/1\n    netlist:\n    - V i.non_inverting\n"
    ...         "    - i.inverting R\n    - i.inverting C\n")
    ...     rc = hb.read_bond_graph(path)
    >>> rc.model.bonds
    ['V -> i -> R', 'i -> C']
    """
    file = named_file(path, 'hb.read_bond_graph("rc.bg")')
    data = _read(read_text(file, str(file)), str(file))
    reader = _Reader(data, str(file))
    model = reader.run()
    if strict and reader.notices:
        raise FileError(
            reader.notices[0].what,
            code="HB-F145",
            where=reader.notices[0].where,
            hint="change the file, or convert without --strict",
        )
    return Conversion(model, tuple(reader.notices), reader.origins)


def _read(text: str, name: str) -> Any:
    try:
        import yaml
    except ImportError:
        raise UsageError(
            "files of BondGraphTools are YAML, and PyYAML is not installed",
            code="HB-F153",
            where=name,
            hint="pip install 'hybond[bg]'",
        ) from None

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        """Plain data, every key once, nothing by reference: a few lines stay a few lines."""

        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.events.AliasEvent):
                raise yaml.YAMLError("an alias")
            return super().compose_node(parent, index)

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            keys = [k.value for k, _ in node.value]
            twice = [k for k in keys if keys.count(k) > 1] if len(keys) < 1000 else []
            if twice or len(set(map(str, keys))) < len(keys):
                raise yaml.YAMLError(f"the key {(twice or ['?'])[0]!r} is there twice")
            return super().construct_mapping(node, deep)

    try:
        data = yaml.load(text, Loader=Loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        why = " ".join(str(error).split())
        raise FileError(
            f"not a file of BondGraphTools: {shortened(why, 200)}",
            code="HB-F150",
            where=name,
            hint="it is written by BondGraphTools.fileio.save",
        ) from None
    return data


class _Reader:
    def __init__(self, data: Any, name: str) -> None:
        self.file = name
        self.data = data
        self.names = GraphNames()
        self.notices: list[Notice] = []
        self.origins: dict[str, str] = {}
        self.elements: dict[str, Part] = {}
        self.bonds: list[tuple[str, str]] = []
        self.inputs: dict[str, InputPart] = {}
        self.exposed: set[str] = set()

    def refuse(self, why: str, where: str, code: str = "HB-F150", hint: str = "") -> FileError:
        hint = hint or "it is written by BondGraphTools.fileio.save"
        return FileError(why, code=code, where=f"{self.file}: {where}", hint=hint)

    def run(self) -> Model:
        data = self.data
        if not isinstance(data, dict) or not isinstance(data.get("models"), dict):
            raise self.refuse("there are no models", "models")
        if str(data.get("version")) != VERSION:
            raise self.refuse(
                f"version {data.get('version')!r} is not known", "version", hint="0.1 is known"
            )
        self.models: dict[str, Any] = data["models"]
        if "/" not in self.models:
            raise self.refuse("there is no model '/'", "models")
        self.open("/", "", ())
        title = str(data.get("root", "")) or Path(self.file).stem
        model = Model(self.stem(title), title=shortened(title, 200))
        self.join_exposed()
        model.elements.update(self.elements)
        model.inputs.update(self.inputs)
        model.bonds = chains(self.bonds, self.elements)
        return model

    def stem(self, title: str) -> str:
        return GraphNames().take(title or "model")

    def texts(self, uri: str, key: str, *, needed: bool = True) -> list[str]:
        model = self.models.get(uri)
        if not isinstance(model, dict):
            raise self.refuse(f"there is no model {uri!r}", "models", "HB-F152")
        found = model.get(key)
        if found is None and not needed:
            return []
        if not isinstance(found, list) or not all(isinstance(t, str) for t in found):
            raise self.refuse("a list of texts is needed", f"models.{uri}.{key}")
        return found

    def open(self, uri: str, prefix: str, within: tuple[str, ...]) -> dict[str, str]:
        """Add a model; return the node of each of its ports, by name and by number."""
        if uri in within or len(within) > limits.LEVELS:
            raise self.refuse(f"the model {uri!r} contains itself", f"models.{uri}", "HB-F152")
        nodes: dict[str, _Node] = {}
        where = f"models.{uri}.components"
        for text in self.texts(uri, "components"):
            words = text.split()
            if len(words) < 2:
                raise self.refuse(f"{text!r} is no component", where, "HB-F151")
            label = words[0]
            if label in nodes:
                raise self.refuse(f"the name {label!r} is used twice", where, "HB-F152")
            path = f"{prefix}{label}"
            if len(words) == 2 and words[1].startswith("/"):
                inner = self.open(words[1], f"{path}_", (*within, uri))
                nodes[label] = _Node(path, "", inner)
                continue
            if len(self.elements) >= limits.ELEMENTS:
                raise self.refuse(f"more than {limits.ELEMENTS} elements", where)
            nodes[label] = self.component(path, words, where)
        for text in self.texts(uri, "netlist", needed=False):
            self.bond(text, nodes, f"models.{uri}.netlist")
        ports: dict[str, str] = {}
        for number, text in enumerate(self.texts(uri, "ports", needed=False)):
            words = text.split()
            node = nodes.get(words[0]) if len(words) == 2 else None
            if node is None or node.kind != "base/SS":
                raise self.refuse(f"{text!r} exposes no SS", f"models.{uri}.ports", "HB-F152")
            self.exposed.add(node.name)
            ports[words[1]] = ports[str(number)] = node.name
        return ports

    def component(self, path: str, words: list[str], where: str) -> _Node:
        kind = words[1]
        if kind not in _DEFAULTS:
            why = _WITHOUT.get(kind, "the kind is not known")
            raise self.refuse(
                f"{words[0]} is {kind}: {why}",
                where,
                "HB-F151",
                did_you_mean(kind, _DEFAULTS) or "replace it",
            )
        values = dict(_DEFAULTS[kind])
        order = list(values)
        for k, word in enumerate(words[2:]):
            key, equals, text = word.rpartition("=")
            if not equals:
                if k >= len(order):
                    raise self.refuse(f"{word!r} is left over", where, "HB-F151")
                key = order[k]
            if key not in values:
                raise self.refuse(
                    f"{kind} has no parameter {key!r}", where, "HB-F151", did_you_mean(key, values)
                )
            try:
                values[key] = float(text)
            except ValueError:
                raise self.refuse(f"{text!r} is not a number", where, "HB-F151") from None
            if not math.isfinite(float(text)):
                raise self.refuse(f"{text!r} is not a number", where, "HB-F151")
        name = self.names.take(path)
        self.elements[name] = self.part(kind, name, values, where)
        self.origins[name] = " ".join(words)
        return _Node(name, kind)

    def part(self, kind: str, name: str, values: dict[str, float | None], where: str) -> Part:
        short = kind.split("/")[1]
        if short in ("0", "1"):
            return Part(short)
        if kind == "base/SS":
            return Part("0")
        if kind == "elec/Di":
            saturation, n, thermal = values["Is"], values["n"], values["Vt"]
            if saturation is None:
                raise self.refuse(f"{name} has no Is", where, "HB-F151", "give it a number")
            return Part("R", {"f": f"{saturation!r}*(exp(e/({n!r}*{thermal!r})) - 1)"})
        value = values[next(iter(values))]
        if value is None:
            given = self.names.take(f"u_{name}")
            self.inputs[given] = InputPart(constant=0.0)
            self.notices.append(
                Notice(
                    f"{self.file}: {where}", f"{name} has no value: it is the input {given!r}, 0"
                )
            )
            return Part(short, given)
        return Part(short, value)

    def bond(self, text: str, nodes: Mapping[str, _Node], where: str) -> None:
        words = text.split()
        if len(words) != 2:
            raise self.refuse(f"{text!r} is no bond", where, "HB-F152")
        ends: list[str] = []
        for word, leaves in zip(words, (True, False), strict=True):
            label, _, port = word.partition(".")
            node = nodes.get(label)
            if node is None:
                raise self.refuse(
                    f"the bond {text!r} ends at {label!r}, which is no component",
                    where,
                    "HB-F152",
                    did_you_mean(label, nodes),
                )
            ends.append(self.end(node, port, text, where, leaves=leaves))
        self.bonds.append((ends[0], ends[1]))

    def end(self, node: _Node, port: str, text: str, where: str, *, leaves: bool) -> str:
        """Return what a bond ends at in the graph."""
        if not node.kind:
            if port not in node.ports:
                raise self.refuse(
                    f"{node.name!r} has no port {port!r} ({text})",
                    where,
                    "HB-F152",
                    did_you_mean(port, node.ports),
                )
            return node.ports[port]
        kind = node.kind
        if kind == "base/1" and port in ("inverting", "non_inverting", ""):
            if not port or (port == "inverting") == leaves:
                return node.name
            turn = self.names.take(f"{node.name}_turn")
            self.elements[turn] = Part("TF", -1)
            self.bonds.append((node.name, f"{turn}.1") if leaves else (f"{turn}.2", node.name))
            return f"{turn}.2" if leaves else f"{turn}.1"
        if kind in ("base/TF", "base/GY") and port in ("0", "1"):
            return f"{node.name}.{2 if port == '0' else 1}"
        if kind not in ("base/TF", "base/GY", "base/1") and port in ("", "0"):
            if kind == "base/Sf" and not leaves:
                # the flow that it delivers runs against the arrow
                part = self.elements[node.name]
                turned = f"-{part.value}" if isinstance(part.value, str) else -part.value
                self.elements[node.name] = Part("Sf", turned)
            return node.name
        if kind == "base/0":
            return node.name
        raise self.refuse(
            f"{node.name!r} has no port {port!r} ({text})", where, "HB-F152", "see its library"
        )

    def join_exposed(self) -> None:
        """Check what is left of SS: exposed ones with a bond on either side."""
        at: dict[str, list[int]] = {}
        for k, pair in enumerate(self.bonds):
            for end in pair:
                at.setdefault(end.split(".")[0], []).append(k)
        gone: set[int] = set()
        for name, origin in self.origins.items():
            words = origin.split()
            if words[1] != "base/SS":
                if self.elements[name].kind not in ("0", "1") and not at.get(name):
                    raise self.refuse(f"{name!r} has no bond", "models", "HB-F152", "connect it")
                continue
            if name not in self.exposed:
                raise self.refuse(
                    f"{name!r} is a source sensor that no port exposes: what it imposes is open",
                    "models",
                    "HB-F151",
                    "replace it by Se or Sf",
                )
            self.straighten(name, at, gone)
        self.bonds = [pair for k, pair in enumerate(self.bonds) if k not in gone]

    def straighten(self, name: str, at: dict[str, list[int]], gone: set[int]) -> None:
        """Take an exposed SS out where one bond enters and the other leaves."""
        bonds = at.get(name, [])
        if len(bonds) != 2:
            raise self.refuse(
                f"the port {name!r} has {len(bonds)} bonds, not one inside and one outside",
                "models",
                "HB-F152",
                "connect it",
            )
        first, second = bonds
        for a, b in ((first, second), (second, first)):
            if self.bonds[a][1] == name and self.bonds[b][0] == name:
                head = self.bonds[b][1]
                self.bonds[a] = (self.bonds[a][0], head)
                gone.add(b)
                ends = at[head.split(".")[0]]
                ends[ends.index(b)] = a
                del self.elements[name]
                return
