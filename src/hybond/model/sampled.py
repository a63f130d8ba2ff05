"""What is set at instants and held between them: sampled signals, and blocks of signals."""

from __future__ import annotations

from hybond.errors import ModelError, UnitError
from hybond.model.dimensions import Loose
from hybond.model.expressions import Expr, If, Number
from hybond.model.graph import Sample
from hybond.model.hierarchy import Opened, Scope, constant, literal
from hybond.model.parts import Value
from hybond.model.resolve import Resolver, is_condition
from hybond.names import join
from hybond.units import Dimension, parse_unit

_TIME = parse_unit("s")[1]


def samples_of(
    opened: Opened, resolver: Resolver, dimensions: dict[str, Dimension | None]
) -> tuple[Sample, ...]:
    """Return all that is sampled; `dimensions` learns the units of sampled signals.

    Raises
    ------
    ModelError
        HB-M151 for times that are none.
    UnitError
        HB-U102, HB-U103 for what is in another unit than it should be.
    """
    number = {path: k for k, path in enumerate(opened.integrals)}
    plain = []
    for path, (scope, part) in opened.sampled.items():
        where = f"signals.{path}"
        every, phase = _times(part.every, part.phase, scope, where)
        value = _read(part.value, resolver, scope, f"{where}.sample")
        plain.append(Sample((number[path],), (value,), every, phase, path))
    for sample in plain:
        path = sample.path
        at = f"s:{number[path]}"
        where = f"signals.{path}.sample"
        own = resolver.dimension(sample.values[0], dimensions, where)
        certain = resolver.dimension(sample.values[0], dimensions, where, certain=True)
        if certain is not None and dimensions[at] not in (None, own):
            raise UnitError(
                f"the start is in {dimensions[at]}, what is sampled in {own}",
                code="HB-U102",
                where=f"signals.{path}.start",
                hint=f"give it in {own}",
            )
        if own is not None and certain is None:
            own = Loose(own.exponents)
        dimensions[at] = dimensions[path] = dimensions[at] or own
    return *plain, *_blocks(opened, resolver, dimensions, number)


def _blocks(
    opened: Opened,
    resolver: Resolver,
    dimensions: dict[str, Dimension | None],
    number: dict[str, int],
) -> list[Sample]:
    found = []
    for path, (scope, part) in opened.blocks.items():
        where = f"blocks.{path}"
        every, phase = _times(part.every, part.phase, scope, where)
        wanted = {name: parse_unit(unit)[1] for name, unit in part.units.items()}
        values = []
        for name, text in part.inputs.items():
            value = _read(text, resolver, scope, f"{where}.inputs.{name}")
            given = resolver.dimension(value, dimensions, f"{where}.inputs.{name}")
            _fits(given, wanted.get(name), f"{where}.inputs.{name}")
            values.append(value)
        parameters = {}
        for name, text in part.parameters.items():
            at = f"{where}.parameters.{name}"
            quantity = constant(text, scope.parameters, at)
            _fits(quantity.dimension, wanted.get(name), at)
            parameters[name] = quantity.value
        signals = tuple(number[join(path, output)] for output in part.outputs)
        found.append(Sample(signals, tuple(values), every, phase, path, part, parameters))
    return found


def _times(every: Value, phase: Value, scope: Scope, where: str) -> tuple[float, float]:
    found = []
    for name, value in (("every", every), ("phase", phase)):
        given = constant(value, scope.parameters, f"{where}.{name}")
        _fits(given.dimension, _TIME, f"{where}.{name}")
        found.append(given.value)
    if found[0] <= 0.0 or found[1] < 0.0:
        raise ModelError(
            f"every = {found[0]:g} s, phase = {found[1]:g} s",
            code="HB-M151",
            where=where,
            hint="a positive period, and a first instant that is not before the start",
        )
    return found[0], found[1]


def _fits(given: Dimension | None, wanted: Dimension | None, where: str) -> None:
    if given is not None and wanted is not None and given != wanted:
        raise UnitError(
            f"it is in {given}; this place wants {wanted}",
            code="HB-U103",
            where=where,
            hint=f"give it in {wanted}",
        )


def _read(value: Value, resolver: Resolver, scope: Scope, where: str) -> Expr:
    tree = resolver.resolve(literal(value, where), scope, where)
    return If(tree, Number(1.0), Number(0.0)) if is_condition(tree) else tree
