"""What a functional mock-up unit (FMU) says of itself: reading it runs none of its code.

An FMU is a ZIP file with a ``modelDescription.xml`` (FMI 2.0.4, section 2.2; FMI 3.0.2, section
2.4). Only scalar numbers matter here: those that a block of signals can take and give.
"""

from __future__ import annotations

import math
import os
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from hybond.errors import FileError
from hybond.units import Dimension

XML_BYTES = 16 * 2**20
"""How large a model description may be."""
UNPACKED_BYTES = 2**30
"""How large an FMU may be when it is unpacked."""
FILES = 10_000
"""Files that an FMU may have."""
REFERENCES = 2**32
"""References to values are smaller."""
POWER = 12
"""The highest power of a base unit, as in model files."""
_NUMBERS = {"Real": "Real", "Integer": "Integer", "Boolean": "Boolean"} | {
    name: name
    for name in ("Float64", "Float32", "Boolean")
    + tuple(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64))
}
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,254}")
_EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of an FMU: what one of it is in SI, ``factor*value + offset``."""

    name: str
    dimension: Dimension
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Variable:
    """A scalar variable of an FMU."""

    name: str
    reference: int
    kind: str
    """``"Real"``, ``"Integer"``, ``"Boolean"``, ``"Float64"``, ``"Int32"``, ..."""
    causality: str
    unit: Unit | None = None
    start: float | None = None


@dataclass(frozen=True, slots=True)
class Description:
    """An FMU for co-simulation."""

    path: Path
    version: str
    """``"2.0"`` or ``"3.0"``."""
    name: str
    identifier: str
    token: str
    """The GUID, or the instantiation token."""
    variables: Mapping[str, Variable]

    def of(self, causality: str) -> dict[str, Variable]:
        """Return the variables of a causality, ``"input"``, ``"output"``, ``"parameter"``."""
        return {v.name: v for v in self.variables.values() if v.causality == causality}


def read_description(path: str | os.PathLike[str], where: str = "") -> Description:
    """Return what an FMU says of itself.

    Raises
    ------
    FileError
        HB-F160 not an FMU, HB-F161 one that cannot be a block: for model exchange only, or of
        another version of FMI.
    """
    file = Path(path)
    where = where or str(path)
    try:
        if file.exists() and not file.is_file():
            raise _refused("it is not an ordinary file", where)
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            size = sum(m.file_size for m in members)
            if len(members) > FILES or size > UNPACKED_BYTES:
                raise _refused("it is too large", where)
            about = archive.getinfo("modelDescription.xml")
            if about.file_size > XML_BYTES:
                raise _refused("its description is too large", where)
            if about.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                # others may ask for gigabytes to unpack a line
                raise _refused(f"it is packed by method {about.compress_type}, not deflate", where)
            text = archive.read("modelDescription.xml")
        if b"<!ENTITY" in text or b"<!DOCTYPE" in text:
            raise _refused("its description declares entities", where)
        root = ElementTree.fromstring(text)
    except FileNotFoundError:
        raise FileError(
            f"there is no file {str(path)!r}",
            code="HB-F160",
            where=where,
            hint="check the path; in a model file it counts from the folder of that file",
        ) from None
    except OSError as error:
        raise _refused(error.strerror or str(error), where) from None
    except KeyError:
        raise _refused("it has no modelDescription.xml", where) from None
    except (MemoryError, FileError):
        raise
    except Exception as error:  # ways of packing and encodings have errors of their own
        raise _refused(str(error) or type(error).__name__, where) from None
    return _description(root, file.resolve(), where)


def _description(root: ElementTree.Element, file: Path, where: str) -> Description:
    version = root.get("fmiVersion", "")
    if not version.startswith(("2.", "3.")):
        raise FileError(
            f"it is of FMI version {version[:20] or '(none)'}",
            code="HB-F161",
            where=where,
            hint="export it again with FMI 2.0 or 3.0",
        )
    cosimulation = root.find("CoSimulation")
    if cosimulation is None:
        raise FileError(
            "it is not for co-simulation",
            code="HB-F161",
            where=where,
            hint="export it again for co-simulation, with its own solver inside",
        )
    try:
        units = {u.name: u for e in root.iterfind("UnitDefinitions/Unit") if (u := _unit(e))}
    except ValueError as error:
        raise _refused(f"a unit of it is not one: {error}", where) from None
    types = {
        t.get("name", ""): next(iter(t), t).get("unit") or t.get("unit")
        for t in root.iterfind("TypeDefinitions/*")
    }
    read = _scalar2 if version.startswith("2.") else _scalar3
    identifier = cosimulation.get("modelIdentifier", "")
    if not _IDENTIFIER.fullmatch(identifier):
        # it becomes a part of a path, and of the names of functions
        raise _refused(f"its modelIdentifier is {identifier[:40]!r}, no C name", where)
    try:
        found = [v for e in root.iterfind("ModelVariables/*") if (v := read(e, units, types))]
    except KeyError as error:
        raise _refused(f"a variable has no {error}", where) from None
    except ValueError as error:
        raise _refused(f"a variable of it is not one: {error}", where) from None
    return Description(
        file,
        version[0] + ".0",
        root.get("modelName", file.stem),
        identifier,
        root.get("guid") or root.get("instantiationToken") or "",
        {v.name: v for v in found},
    )


def _scalar2(
    e: ElementTree.Element, units: Mapping[str, Unit], types: Mapping[str, str | None]
) -> Variable | None:
    for kind in e:
        if kind.tag in _NUMBERS:
            return _variable(e, kind, units, types)
    return None


def _scalar3(
    e: ElementTree.Element, units: Mapping[str, Unit], types: Mapping[str, str | None]
) -> Variable | None:
    if e.tag not in _NUMBERS or e.find("Dimension") is not None:
        return None
    return _variable(e, e, units, types)


def _variable(
    e: ElementTree.Element,
    kind: ElementTree.Element,
    units: Mapping[str, Unit],
    types: Mapping[str, str | None],
) -> Variable:
    unit = kind.get("unit") or types.get(kind.get("declaredType", ""))
    reference = int(e.attrib["valueReference"])
    if not 0 <= reference < REFERENCES:
        raise ValueError("a valueReference beyond 32 bits")
    return Variable(
        e.attrib["name"],
        reference,
        kind.tag,
        e.get("causality", "local"),
        units.get(unit or ""),
        _number(kind.get("start")),
    )


def _number(text: str | None) -> float | None:
    if text is None:
        return None
    value = {"true": 1.0, "false": 0.0}.get(text)
    return _finite(text) if value is None else value


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]!r} is not finite")
    return value


def _unit(e: ElementTree.Element) -> Unit | None:
    """Return a unit, None if the FMU does not say what it is in SI."""
    base = e.find("BaseUnit")
    if base is None:
        return None
    powers = tuple(int(base.get(s, "0")) for s in _EXPONENTS)
    if max(map(abs, powers)) > POWER:
        raise ValueError(f"a power beyond {POWER}")
    factor, offset = _finite(base.get("factor", "1")), _finite(base.get("offset", "0"))
    if factor == 0.0:
        raise ValueError("its factor is 0")
    return Unit(e.get("name", ""), Dimension(powers), factor, offset)


def _refused(why: str, where: str) -> FileError:
    return FileError(
        f"this is no FMU: {why}",
        code="HB-F160",
        where=where,
        hint="an FMU is a ZIP file with a modelDescription.xml",
    )
