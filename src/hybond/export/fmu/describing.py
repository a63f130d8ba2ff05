"""``modelDescription.xml`` of FMI 2.0.4 (section 2.2) and of FMI 3.0.2 (section 2.4)."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from hybond._version import __version__
from hybond.export.fmu.interface import Interface, Shown
from hybond.units import Dimension

_BASE = ("kg", "m", "s", "A", "K", "mol", "cd")


def describe(interface: Interface, version: str) -> str:
    """Return the model description for ``"2.0"`` or ``"3.0"``."""
    return _two(interface) if version == "2.0" else _three(interface)


def _two(own: Interface) -> str:
    root = ElementTree.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=own.name,
        guid=own.token,
        description=own.title,
        generationTool=f"hybond {__version__}",
        variableNamingConvention="flat",
        numberOfEventIndicators=str(own.indicators),
    )
    variables = _begin(root, own)

    def add(reference: int, shown: Shown, real: dict[str, str], **attributes: str) -> None:
        own_words = {"name": shown.name, "valueReference": str(reference)}
        all_words = {**own_words, **attributes, **_about(shown)}
        scalar = ElementTree.SubElement(variables, "ScalarVariable", all_words)
        ElementTree.SubElement(scalar, "Real", {**_unit(shown), **real})

    time = Shown("time", own.dimensions["s"])
    add(0, time, {}, causality="independent", variability="continuous")
    for k, v in own.numbered("parameters"):
        add(k, v, _start(v), variability="fixed", **_parameter(v))
    for k, v in own.numbered("inputs"):
        add(k, v, {"start": repr(v.start)}, causality="input", variability="continuous")
    for k, v in own.numbered("outputs"):
        add(k, v, {}, causality="output", variability="continuous", initial="calculated")
    for k, v in own.numbered("states"):
        add(k, v, {}, causality="local", variability="continuous", initial="calculated")
    first = own.first("states") + 1  # indices count from 1, references from 0
    for n, (k, v) in enumerate(own.numbered("derivatives")):
        of = {"derivative": str(first + n)}
        add(k, v, of, causality="local", variability="continuous", initial="calculated")
    structure = ElementTree.SubElement(root, "ModelStructure")
    for group, names in (
        ("Outputs", ["outputs"]),
        ("Derivatives", ["derivatives"]),
        ("InitialUnknowns", ["parameters", "outputs", "states", "derivatives"]),
    ):
        unknowns = [k for name in names for k, v in own.numbered(name) if _unknown(name, v)]
        if unknowns:
            listed = ElementTree.SubElement(structure, group)
            for k in unknowns:
                ElementTree.SubElement(listed, "Unknown", index=str(k + 1))
    return _text(root)


def _three(own: Interface) -> str:
    root = ElementTree.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=own.name,
        instantiationToken=own.token,
        description=own.title,
        generationTool=f"hybond {__version__}",
        variableNamingConvention="flat",
    )
    variables = _begin(root, own)

    def add(reference: int, shown: Shown, **attributes: str) -> None:
        own_words = {"name": shown.name, "valueReference": str(reference)}
        all_words = {**own_words, **attributes, **_unit(shown), **_about(shown)}
        ElementTree.SubElement(variables, "Float64", all_words)

    time = Shown("time", own.dimensions["s"])
    add(0, time, causality="independent", variability="continuous")
    for k, v in own.numbered("parameters"):
        add(k, v, variability="fixed", **_parameter(v), **_start(v))
    for k, v in own.numbered("inputs"):
        add(k, v, causality="input", variability="continuous", start=repr(v.start))
    for k, v in own.numbered("outputs"):
        add(k, v, causality="output", variability="continuous", initial="calculated")
    for k, v in own.numbered("states"):
        add(k, v, causality="local", variability="continuous", initial="calculated")
    first = own.first("states")
    for n, (k, v) in enumerate(own.numbered("derivatives")):
        at = {"causality": "local", "variability": "continuous", "initial": "calculated"}
        add(k, v, **at, derivative=str(first + n))
    indicators = 1 + sum(len(getattr(own, g)) for g in ("parameters", "inputs", "outputs"))
    indicators += 2 * len(own.states)
    for n in range(own.indicators):
        add(
            indicators + n,
            Shown(f"event_indicator[{n + 1}]"),
            causality="local",
            initial="calculated",
        )
    structure = ElementTree.SubElement(root, "ModelStructure")
    for what, names in (
        ("Output", ["outputs"]),
        ("ContinuousStateDerivative", ["derivatives"]),
        ("InitialUnknown", ["parameters", "outputs", "states", "derivatives"]),
    ):
        for name in names:
            for k, v in own.numbered(name):
                if _unknown(name, v):
                    ElementTree.SubElement(structure, what, valueReference=str(k))
    for n in range(own.indicators):
        ElementTree.SubElement(structure, "EventIndicator", valueReference=str(indicators + n))
    return _text(root)


def _begin(root: ElementTree.Element, own: Interface) -> ElementTree.Element:
    """Say what is the same in both versions; return where the variables go."""
    ElementTree.SubElement(
        root,
        "ModelExchange",
        modelIdentifier=own.identifier,
        canBeInstantiatedOnlyOncePerProcess="false",
    )
    ElementTree.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=own.identifier,
        canHandleVariableCommunicationStepSize="true",
        canBeInstantiatedOnlyOncePerProcess="false",
    )
    _units(root, own)
    _experiment(root, own)
    variables = ElementTree.SubElement(root, "ModelVariables")
    return variables


def _parameter(shown: Shown) -> dict[str, str]:
    """Return what a parameter is: one that is set, or one that follows from others."""
    if shown.follows:
        return {"causality": "calculatedParameter", "initial": "calculated"}
    return {"causality": "parameter", "initial": "exact"}


def _start(shown: Shown) -> dict[str, str]:
    return {} if shown.follows else {"start": repr(shown.start)}


_UNIT_TOKEN = re.compile(r"[*/()]|[^*/()\s]+")


def _unknown(group: str, shown: Shown) -> bool:
    """Whether a variable has its first value from an initialization."""
    return group != "parameters" or shown.follows


def _units(root: ElementTree.Element, own: Interface) -> None:
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for name, dimension in own.dimensions.items():
        if _whole(dimension):
            unit = ElementTree.SubElement(units, "Unit", name=name)
            powers = {b: str(n) for b, n in zip(_BASE, dimension.exponents, strict=True) if n}
            angle = _radians(name)
            if angle:
                powers["rad"] = str(angle)
            ElementTree.SubElement(unit, "BaseUnit", powers)


def _radians(name: str) -> int:
    """Return the power of the radian in a unit: a dimension says nothing of it, the standard does.

    Examples
    --------
    >>> [_radians(name) for name in ("rad/s", "N*m/rad", "N*m*s/rad^2", "kg/(m*rad)", "m/s")]
    [1, -1, -2, -1, 0]
    """
    power, sign, signs = 0, 1, [1]
    for token in _UNIT_TOKEN.findall(name):
        if token == "(":
            signs.append(signs[-1] * sign)
            sign = 1
        elif token == ")":
            signs.pop()
        elif token in "*/":
            sign = 1 if token == "*" else -1
        else:
            symbol, _, exponent = token.partition("^")
            power += signs[-1] * sign * int(exponent or 1) if symbol == "rad" else 0
            sign = 1
    return power


def _whole(dimension: Dimension) -> bool:
    """Whether the standard has words for a unit: its powers are whole."""
    return all(n.denominator == 1 for n in dimension.exponents)


def _about(shown: Shown) -> dict[str, str]:
    return {"description": shown.about} if shown.about else {}


def _unit(shown: Shown) -> dict[str, str]:
    known = shown.dimension is not None and _whole(shown.dimension)
    return {"unit": shown.unit} if known else {}


def _experiment(root: ElementTree.Element, own: Interface) -> None:
    ElementTree.SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(own.until),
        tolerance=repr(own.rtol),
    )


def _text(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"
