"""One entry of [elements] to a `Part` or `SubmodelPart`."""

from __future__ import annotations

from typing import Any

from hybond.files.check import check, describe
from hybond.files.place import Place, quoted
from hybond.files.schema import ELEMENTS
from hybond.model.parts import Part, SubmodelPart
from hybond.names import did_you_mean

_MEANT = {
    **dict.fromkeys(("capacitor", "capacitance", "spring", "tank", "compliance"), "'C'"),
    **dict.fromkeys(("inductor", "inductance", "mass", "inertia", "coil"), "'I'"),
    **dict.fromkeys(("resistor", "resistance", "damper", "friction"), "'R'"),
    **dict.fromkeys(("source", "voltage", "force", "battery"), "'Se' (effort) or 'Sf' (flow)"),
    **dict.fromkeys(("current", "velocity"), "'Sf'"),
    **dict.fromkeys(("transformer", "lever", "gear"), "'TF'"),
    **dict.fromkeys(("gyrator", "motor"), "'GY'"),
    **dict.fromkeys(("0", "1", "zero", "one", "node"), "'junction' = 0 or 'junction' = 1"),
    **dict.fromkeys(("model", "part", "library"), "'submodel'"),
    **dict.fromkeys(("switch", "sw", "diode"), "'junction', which a machine or a law switches"),
}
"""What words mean that are no kinds."""


def read_element(data: Any, place: Place, *, array: bool = False) -> Part | SubmodelPart:
    """Return the element that `data` describes; in an array a list has a value for each member.

    Raises
    ------
    FileError
        HB-F113 (not exactly one kind), HB-F114 (a value that the kind cannot have), and those
        of `check`.

    Examples
    --------
    >>> from hybond.files.place import Source
    >>> read_element({"I": "m", "f": "2 m/s"}, Place(Source("ball.toml")))
    Part(kind='I', value='m', options={'f': '2 m/s'})
    """
    if not isinstance(data, dict):
        raise place.refuse(
            f"{describe(data)}, where a table is needed",
            code="HB-F112",
            hint='write the kind of the element: { C = "1 mm/N" }',
        )
    kind = _kind(data, place)
    value = data[kind]
    if kind == "junction" and (type(value) is not int or value not in (0, 1)):
        raise (place / kind).refuse(
            f"a junction is 0 (common effort) or 1 (common flow), not {describe(value)}",
            code="HB-F114",
            hint="junction = 0 or junction = 1",
        )
    if not array:
        _check_single(data, kind, place)
    check(data, ELEMENTS[kind], place)
    if kind == "submodel":
        return SubmodelPart(value, dict(data.get("parameters", {})), dict(data.get("inputs", {})))
    options = {key: option for key, option in data.items() if key != kind}
    if kind == "junction":
        return Part(str(value), None, options)
    _check_value(value, place / kind)
    if len(starts := [key for key in options if key in ("e", "f", "q", "p")]) > 1:
        raise place.refuse(
            f"it starts from {starts[0]} and from {starts[1]}",
            code="HB-F114",
            hint="give one of them: the other follows from the law",
        )
    return Part(kind, value, options)


def _kind(data: dict[str, Any], place: Place) -> str:
    kinds = [key for key in data if key in ELEMENTS]
    if len(kinds) == 1:
        return kinds[0]
    if len(kinds) > 1:
        raise place.refuse(
            f"two kinds in one element: {' and '.join(kinds)}",
            code="HB-F113",
            hint="an element has one kind; write two elements",
        )
    if not data:
        raise place.refuse(
            "the element has no kind", code="HB-F113", hint="kinds: " + ", ".join(ELEMENTS)
        )
    options = {"domain", "impulsive", "parameters", "inputs", "e", "f", "q", "p"}
    strange = next((key for key in data if key not in options), next(iter(data)))
    if strange in options:
        raise place.refuse(
            f"the element has no kind, only {strange!r}",
            code="HB-F113",
            hint="kinds: " + ", ".join(ELEMENTS),
        )
    meant = _MEANT.get(strange.lower())
    raise (place / strange).refuse(
        f"{quoted(strange)} is not a kind of element",
        code="HB-F113",
        hint=f"did you mean {meant}?" if meant else did_you_mean(strange, ELEMENTS),
    )


def _check_single(data: dict[str, Any], kind: str, place: Place) -> None:
    """Refuse lists of values where there are no members to have one each."""
    hint = 'a list of values is for an array: "cell[1..3]" = ...'
    value = data[kind]
    if kind in ("C", "I", "R", "G") and isinstance(value, list) and value:
        if not isinstance(value[0], list):
            raise (place / kind / 0).refuse(
                f"{describe(value[0])}, where a list is needed",
                code="HB-F112",
                hint=f"a field takes [[a, b], [c, d]]; {hint}",
            )
        return
    given = [(place / kind, value)] if kind in ("Se", "Sf", "TF", "GY") else []
    if kind == "junction":
        given += [(place / key, option) for key, option in data.items()]
    for section in ("parameters", "inputs") if kind == "submodel" else ():
        inner = data.get(section)
        if isinstance(inner, dict):
            given += [(place / section / key, value) for key, value in inner.items()]
    for at, value in given:
        if isinstance(value, list):
            raise at.refuse(
                f"{describe(value)}, where a number or text is needed", code="HB-F112", hint=hint
            )


def _check_value(value: Any, place: Place) -> None:
    if isinstance(value, list):
        if value and not any(isinstance(row, list) for row in value):
            return  # of an array
        if (
            not all(isinstance(row, list) for row in value)
            or not value
            or any(len(row) != len(value) for row in value)
        ):
            raise place.refuse(
                "the matrix of a field is square, with a row for each port",
                code="HB-F114",
                hint="for two ports: [[a, b], [c, d]]",
            )
    elif isinstance(value, dict):
        if len(value) != 1:
            raise place.refuse(
                f"a law gives e or f, one of them; this is {describe(value)}",
                code="HB-F114",
                hint='{ e = "..." } or { f = "..." }',
            )
        ((side, law),) = value.items()
        if law == []:
            raise (place / side).refuse("a field has at least one port", code="HB-F114")
        for given in law if isinstance(law, list) else [law]:
            if isinstance(given, dict):
                x, y = given["table"]
                if len(x) != len(y) or len(x) < 2:
                    raise (place / side / "table").refuse(
                        f"{len(x)} arguments and {len(y)} values",
                        code="HB-F114",
                        hint="two rows of equal length, of two points or more",
                    )
