"""Models of diodes and switches as ideal parts: a drop, a resistance, thresholds."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hybond.circuits.notices import Notices
from hybond.circuits.opened import Branch, Value
from hybond.model.expressions import Number

THERMAL_VOLTAGE = 1.380649e-23 * 300.15 / 1.602176634e-19
"""k T / q at 27 degrees Celsius, the temperature of SPICE."""
OPEN = 1e6
"""Ohm: from here on the resistance of an open switch is that of none; a smaller one is kept."""
_DIODE = {"is": 1e-14, "n": 1.0, "rs": 0.0}
_BREAKDOWN = ("bv", "ibv", "nbv")
_IBV = 1e-3
"""Current at BV where a card says none, A: that of SPICE."""
_SWITCHES = {
    "sw": ("s", "vt", "vh"),
    "vswitch": ("s", "von", "voff"),
    "aswitch": ("a", "cntl_on", "cntl_off"),
    "csw": ("w", "it", "ih"),
    "iswitch": ("w", "ion", "ioff"),
}


@dataclass(frozen=True, slots=True)
class IdealDiode:
    """What stands in series with the ideal diode, in V and ohm, and a resistance beside it."""

    drop: float
    resistance: float
    beside: float = math.inf
    emission: float = 0.0
    """N Vt, V, if the line is a tangent; else zero."""
    breakdown: IdealDiode | None = None
    """What conducts backward, beside it."""


def ideal_diode(branch: Branch, current: float, back: float, notices: Notices) -> IdealDiode:
    """Return the straight line that stands for the characteristic of a diode.

    It is the tangent at `current`, of ``v = N Vt ln(1 + i/IS) + RS i``, and backward, at `back`,
    of ``v = BV + NBV Vt ln(i/IBV) + RS i``; a card with ``Ron`` or ``Vfwd`` is a straight line
    already.

    Raises
    ------
    FileError
        HB-F136 (a model of another type), HB-F140 (values that cannot be).
    """
    model = branch.model
    assert model is not None
    if model.type != "d":
        raise branch.line.refuse(
            f"the model {model.name!r} is of type {model.type.upper()}, not D",
            code="HB-F136",
            hint="a diode needs a .model of type D",
        )
    given = {key: value.number for key, value in branch.parameters.items()}
    if any(key in given for key in ("ron", "roff", "vfwd")):
        return _straight(branch, given, notices)
    values = {key: given.get(key, default) for key, default in _DIODE.items()}
    area = 1.0 if branch.value is None else branch.value.number
    if min(values["is"], values["n"], area) <= 0.0 or values["rs"] < 0.0:
        raise branch.line.refuse(
            f"IS, N and the area are positive, RS is not negative; here IS={values['is']:g}, "
            f"N={values['n']:g}, RS={values['rs']:g}, area {area:g}",
            code="HB-F140",
            hint=f"see the model in line {model.line.number}",
        )
    left = sorted(set(given) - set(_DIODE) - set(_BREAKDOWN) - {"level"})
    if left:
        notices.add(
            model.line,
            f"{model.name}: {', '.join(k.upper() for k in left)} left out: an ideal diode has no "
            "capacitance and no temperature",
        )
    saturation, resistance = values["is"] * area, values["rs"] / area
    slope = values["n"] * THERMAL_VOLTAGE / (current + saturation)
    forward = values["n"] * THERMAL_VOLTAGE * math.log1p(current / saturation)
    found = IdealDiode(
        _rounded(forward - slope * current),
        _rounded(slope + resistance),
        emission=values["n"] * THERMAL_VOLTAGE,
        breakdown=_breakdown(branch, given, area, back),
    )
    said = (
        f"{model.name}: ideal diode with a drop of {found.drop:g} V and {found.resistance:g} "
        f"ohm, the tangent at {current:g} A"
    )
    if found.breakdown is not None:
        line = found.breakdown
        said += f"; backward {line.drop:g} V and {line.resistance:g} ohm, that at {back:g} A"
    notices.add(model.line, said)
    return found


def _breakdown(
    branch: Branch, given: dict[str, float], area: float, current: float
) -> IdealDiode | None:
    """Return what conducts backward above BV, None of a card without."""
    bv = given.get("bv", math.inf)
    if math.isinf(bv):
        return None
    emission = given.get("nbv", given.get("n", 1.0)) * THERMAL_VOLTAGE
    knee = given.get("ibv", _IBV) * area
    if min(bv, emission, knee) <= 0.0:
        raise branch.line.refuse(
            f"BV, IBV and NBV are positive; here BV={bv:g}, IBV={knee / area:g}, "
            f"NBV={emission / THERMAL_VOLTAGE:g}",
            code="HB-F140",
            hint="BV is written without a sign; take it out of a diode that has no breakdown",
        )
    drop = bv + emission * (math.log(current / knee) - 1.0)
    resistance = emission / current + given.get("rs", 0.0) / area
    return IdealDiode(_rounded(max(drop, 0.0)), _rounded(resistance), emission=emission)


def _straight(branch: Branch, given: dict[str, float], notices: Notices) -> IdealDiode:
    model = branch.model
    assert model is not None
    area = 1.0 if branch.value is None else branch.value.number
    if area <= 0.0:
        raise branch.line.refuse(
            f"the area is {area:g}", code="HB-F140", hint="it is positive, and 1 if left out"
        )
    resistance, drop = given.get("ron", 1.0) / area, given.get("vfwd", 0.0)
    beside = given.get("roff", math.inf) / area
    if resistance < 0.0 or beside <= resistance:
        raise branch.line.refuse(
            f"Ron = {resistance:g} ohm, Roff = {beside:g} ohm",
            code="HB-F140",
            hint="Ron is not negative, Roff is larger",
        )
    left = sorted(k for k in given if k not in ("ron", "roff", "vfwd", "vrev", "rrev"))
    if left:
        notices.add(
            model.line, f"{model.name}: {', '.join(k.upper() for k in left)} left out of the diode"
        )
    if OPEN <= beside < math.inf:
        notices.add(model.line, f"{model.name}: Roff = {beside:g} ohm is taken as none")
        beside = math.inf
    line = None
    if "vrev" in given:
        line = IdealDiode(given["vrev"], given.get("rrev", resistance * area) / area)
        if line.drop < 0.0 or line.resistance < 0.0:
            raise branch.line.refuse(
                f"Vrev = {line.drop:g} V, Rrev = {line.resistance:g} ohm",
                code="HB-F140",
                hint="neither is negative",
            )
    return IdealDiode(drop, resistance, beside, breakdown=line)


@dataclass(frozen=True, slots=True)
class IdealSwitch:
    """Thresholds as written (closed above `on`, open below `off`), and resistances in ohm."""

    threshold: Value
    other: Value | None
    window: bool
    """Whether `other` is half a hysteresis around the threshold, and not a second threshold."""
    on: float
    off: float
    resistance: Value | None
    """The smaller one, which is in series."""
    beside: float
    """The larger one."""
    inverted: bool
    """Whether the larger one is that above `on`: there it opens."""
    leak: float
    """The larger one as it is written, where `beside` takes it as none."""


def ideal_switch(branch: Branch, notices: Notices) -> IdealSwitch:
    """Return the thresholds and resistances of a switch.

    Raises
    ------
    FileError
        HB-F136 (a model of another type), HB-F140 (values that cannot be).
    """
    model = branch.model
    assert model is not None
    if model.type not in _SWITCHES or _SWITCHES[model.type][0] != branch.kind:
        wanted = "SW" if branch.kind == "s" else "CSW"
        raise branch.line.refuse(
            f"the model {model.name!r} is of type {model.type.upper()}, not {wanted}",
            code="HB-F136",
            hint=f"this switch needs a .model of type {wanted}",
        )
    _, first, second = _SWITCHES[model.type]
    known = {first, second, "ron", "roff"}
    given = dict(branch.parameters)
    if model.type == "aswitch":
        given.pop("log", None)
        named = {"r_on": "ron", "r_off": "roff"}
        given = {named.get(key, key): value for key, value in given.items()}
    for key in given:
        if key not in known:
            raise model.line.refuse(
                f"the parameter {key.upper()} of a switch is not understood",
                code="HB-F136",
                hint=f"known: {', '.join(sorted(known)).upper()}; take it out",
            )
    window = model.type in ("sw", "csw")
    zero = Value(Number(0.0), 0.0)
    threshold = given.get(first, zero if window else Value(Number(1.0), 1.0))
    other = given.get(second, None if window else zero)
    if window:
        half = 0.0 if other is None else other.number
        if half < 0.0:
            notices.add(
                model.line,
                f"{model.name}: VH < 0 is a smooth transition in LTspice; here it is a hysteresis",
            )
            half = -half
            other = Value(Number(half), half)
        on, off = threshold.number + half, threshold.number - half
    else:
        assert other is not None
        on, off = threshold.number, other.number
    if on < off:
        raise branch.line.refuse(
            f"it closes above {on:g} and opens below {off:g}: between them it does both",
            code="HB-F140",
            hint="a hysteresis that is not negative; swap the nodes of a switch that opens",
        )
    resistance = given.get("ron", Value(Number(1.0), 1.0))
    larger = given.get("roff", Value(Number(1e12), 1e12))
    inverted = resistance.number > larger.number
    if inverted:
        resistance, larger = larger, resistance
    beside = leak = larger.number
    if resistance.number < 0.0 or beside == resistance.number:
        low, high = ("ROFF", "RON") if inverted else ("RON", "ROFF")
        raise branch.line.refuse(
            f"{low} = {resistance.number:g} ohm, {high} = {beside:g} ohm",
            code="HB-F140",
            hint="neither is negative, and one is larger",
        )
    if inverted:
        notices.add(model.line, f"{model.name}: RON is larger than ROFF, so it opens above {on:g}")
    if beside >= OPEN:
        notices.add(
            model.line,
            f"{model.name}: ideal switch with {resistance.number:g} ohm; "
            f"{'RON' if inverted else 'ROFF'} = {beside:g} ohm is taken as none",
        )
        beside = math.inf
    if not window:
        notices.add(model.line, f"{model.name}: its smooth transition is taken as a hysteresis")
    return IdealSwitch(
        threshold,
        other,
        window,
        on,
        off,
        resistance if resistance.number or resistance.parametric else None,
        beside,
        inverted,
        leak,
    )


def _rounded(value: float) -> float:
    """Return a value to five digits: no straight line is closer to a diode."""
    return float(f"{value:.5g}")
