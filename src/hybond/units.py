"""Units: SI dimensions, prefixes, quantities as text, and the domains of bond graphs.

Conversion is exact (rational numbers) until the last step: ``"4.7 uF"`` is the float 4.7e-06 and
not its neighbour.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache, lru_cache

from hybond.errors import UnitError
from hybond.names import did_you_mean
from hybond.records import dataclass


@dataclass(frozen=True, slots=True, repr=False)
class Dimension:
    """Exponents of kg, m, s, A, K, mol, cd. The radian is dimensionless.

    Examples
    --------
    >>> print(parse_unit("V")[1] * parse_unit("A")[1], parse_unit("rad/s")[1])
    W 1/s
    """

    exponents: tuple[Fraction | int, ...] = (0,) * 7  # whole ones as int: they add ten times faster

    def __mul__(self, other: Dimension) -> Dimension:
        # most exponents are zero, and fractions add slowly
        pairs = zip(self.exponents, other.exponents, strict=True)
        return Dimension(tuple([a + b if a and b else a or b for a, b in pairs]))

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other**-1

    def __pow__(self, power: int | Fraction) -> Dimension:
        power = _whole(power)
        return Dimension(tuple([_whole(a * power) if a else a for a in self.exponents]))

    def __str__(self) -> str:
        symbols = _symbols()
        if self in symbols:
            return symbols[self]
        sides: tuple[list[str], list[str]] = ([], [])
        for name, n in zip(_BASE, self.exponents, strict=True):
            power = f"^{abs(n)}" if n.denominator == 1 else f"^({abs(n)})"
            if n:
                sides[n < 0].append(name + (power if abs(n) != 1 else ""))
        above, below = ("*".join(side) or "1" for side in sides)
        return above + ("/" + (f"({below})" if len(sides[1]) > 1 else below)) * bool(sides[1])

    def __repr__(self) -> str:
        return f"<Dimension {self}>"


def _whole(n: int | Fraction) -> int | Fraction:
    return n.numerator if n.denominator == 1 else n


class Worded(Dimension):
    """A dimension in the words in which a value of it was given: a torque in N*m is no energy.

    It is equal to the dimension without them; products of it have none.

    Examples
    --------
    >>> torque = parse_quantity("3 kN*m").dimension
    >>> print(torque, torque * torque, torque == parse_unit("J")[1])
    N*m kg^2*m^4/s^4 True
    """

    __slots__ = ("word",)
    word: str

    def __init__(self, exponents: tuple[Fraction | int, ...], word: str) -> None:
        super().__init__(exponents)
        object.__setattr__(self, "word", word)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dimension) and self.exponents == other.exponents

    def __hash__(self) -> int:
        return hash(Dimension(self.exponents))

    def __str__(self) -> str:
        return self.word

    def __reduce__(self) -> tuple[type[Worded], tuple[object, ...]]:
        return Worded, (self.exponents, self.word)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A value in SI units and its dimension."""

    value: float
    dimension: Dimension


@dataclass(frozen=True, slots=True)
class Domain:
    """Units and dimensions of effort and flow (None: any); `pseudo`: e times f is no power."""

    name: str
    effort_unit: str
    flow_unit: str
    effort: Dimension | None
    flow: Dimension | None
    pseudo: bool = False


DIMENSIONLESS = Dimension()
_BASE = ("kg", "m", "s", "A", "K", "mol", "cd")
_Unit = tuple[Fraction, Dimension]
_ONE: _Unit = (Fraction(1), DIMENSIONLESS)
_Units = dict[str, _Unit | tuple[str, str]]
"""Units by their names; those that are a number and other units are solved when asked for."""
_PLAIN: _Units = {"1": _ONE}  # these take no prefix
_PREFIXED: _Units = {"rad": _ONE, "g": ("1/1000", "kg")}
for _name in _BASE:
    _one = Dimension(tuple(int(_name == base) for base in _BASE))
    _PREFIXED[_name] = (Fraction(1), _one)
_PLAIN["kg"] = _PREFIXED.pop("kg")

_ENGINEERING = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_POWERS = {p: n for n, p in _ENGINEERING.items() if p} | {"u": -6, "μ": -6, "da": 1, "h": 2}
_POWERS |= {"c": -2, "d": -1, "f": -15, "a": -18, "z": -21, "y": -24, "P": 15, "E": 18}
_PREFIX = {p: Fraction(10) ** n for p, n in (_POWERS | {"Z": 21, "Y": 24}).items()}

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)", re.ASCII)
_POWER = r"(?:\s*(?:\^|\*\*)\s*(?P<power>-?\d{1,2}(?:\.[05]0*)?(?![\d.])|\(-?\d/[1-9]\)))?"
_TOKEN = re.compile(
    rf"\s*(?:(?P<symbol>°?[^\W\d_]+|[%°℃]|1(?![\w.])|(?P<close>\))){_POWER}|(?P<mark>[*·/(]))"
)
_SUPERSCRIPT = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


_MEANT = {
    **dict.fromkeys(("ohm", "ohms"), "ohm"),
    **{"kohm": "kohm", "mohm": "Mohm", "volt": "V", "ampere": "A", "amp": "A", "farad": "F"},
    **{"henry": "H", "henrie": "H", "newton": "N", "pascal": "Pa", "joule": "J", "watt": "W"},
    **{"meter": "m", "metre": "m", "second": "s", "sec": "s", "msec": "ms", "usec": "us"},
    **{"kilogram": "kg", "kilo": "kg", "gramm": "g", "hour": "h", "minute": "min", "hr": "h"},
    **{
        "pound": "lb",
        "feet": "ft",
        "in": "inch",
        "hertz": "Hz",
        "radian": "rad",
        "degree": "deg",
        "kelvin": "K",
        "liter": "L",
        "litre": "L",
    },
    **{
        "nm": "N*m",
        "nms": "N*m*s",
        "ns": "N*s",
        "pas": "Pa*s",
        "vs": "V*s",
        "as": "A*s",
        "rps": "rev/s",
        "cfm": "ft^3/min",
    },
    **{"coulomb": "C", "tesla": "T", "weber": "Wb", "siemen": "S", "millisecond": "ms"},
}
"""What words mean that are no units."""
_SEVERAL = {
    **dict.fromkeys(("hp", "horsepower"), "1 hp is 745.7 W (mechanical) or 735.49875 W (metric)"),
    **dict.fromkeys(("cal", "calorie"), "1 cal is 4.184 J or 4.1868 J"),
    **{"kcal": "1 kcal is 4184 J or 4186.8 J", "btu": "1 BTU is 1055.056 J"},
    **dict.fromkeys(("gal", "gallon"), "1 gal is 3.785411784 L (US) or 4.54609 L (imperial)"),
    **{"gpm": "1 gpm is 3.785411784 L/min (US)", "lpm": "write L/min", "ccm": "write cm^3"},
    **dict.fromkeys(("psia", "psig", "barg"), "write psi or bar: whether it is gauge is yours"),
    **dict.fromkeys(("year", "yr", "month"), "a year has 365 or 365.25 day"),
    **{"va": "write W", "var": "write W", "rot": "write rev"},
    **{"mil": "1 mil is 25.4 um: write thou", "poise": "1 poise is 0.1 Pa*s"},
}
"""What to write for words that mean several units, or none."""


_CELSIUS = (Fraction("273.15"), Fraction(1))
_FAHRENHEIT = (Fraction("459.67") * 5 / 9, Fraction(5, 9))
_OFFSET = dict.fromkeys(("degC", "°C", "℃", "celsius", "Celsius"), _CELSIUS)
_OFFSET |= dict.fromkeys(("degF", "°F"), _FAHRENHEIT)
"""Scales of temperature: where their zero is, and how large a degree is, K."""


def _solved(units: _Units, symbol: str) -> _Unit:
    number, unit = units[symbol]
    if isinstance(number, Fraction) and isinstance(unit, Dimension):
        return number, unit
    factor, dimension = _exact(str(unit))
    units[symbol] = found = (Fraction(number) * factor, dimension)
    return found


def _resolve(symbol: str) -> _Unit:
    if symbol in _PLAIN or symbol in _PREFIXED:
        return _solved(_PLAIN if symbol in _PLAIN else _PREFIXED, symbol)
    for cut in (2, 1):
        if symbol[:cut] in _PREFIX and symbol[cut:] in _PREFIXED:
            factor, dimension = _solved(_PREFIXED, symbol[cut:])
            return _PREFIX[symbol[:cut]] * factor, dimension
    if symbol in _OFFSET:
        why = f"{symbol!r} has an offset and is not a unit"
        raise UnitError(why, code="HB-U105", hint="write kelvin: 20 degC is 293.15 K")
    known = [*_PLAIN, *_PREFIXED, *(p + u for p in "kmMuc" for u in _PREFIXED)]
    one = symbol.removesuffix("s")
    meant = _MEANT.get(symbol.lower()) or _MEANT.get(one.lower())
    meant = meant or (one if len(one) > 1 and one in known else None)
    hint = f"did you mean {meant!r}?" if meant else did_you_mean(symbol, known)
    hint = _SEVERAL.get(symbol.lower()) or _SEVERAL.get(one.lower()) or hint
    raise UnitError(f"unknown unit {symbol[:40]!r}", code="HB-U101", hint=hint)


def _bad(text: str, why: str) -> UnitError:
    hint = "write '1 mH', '5 N/m', '10 m/(N*s)' or '9.81 m/s^2'"
    return UnitError(f"{text[:40]!r} {why}", code="HB-U104", hint=hint)


def _no_unit(text: str, at: int) -> UnitError:
    """Refuse a text that is no unit from a place on: of `m2`, say, where its ``^`` belongs."""
    # powers that units in use have, up to the K^4 of radiation and the m^4 of a bent beam
    raised = re.sub(r"(?<=[^\W\d_])(?=-?[1-4](?!\w))", "^", text)
    if raised != text and len(text) <= 40:  # a longer one is quoted only in part
        try:
            _exact(raised)
        except UnitError:
            pass
        else:
            hint = f"did you mean {raised!r}?"
            return UnitError(f"unknown unit {text!r}", code="HB-U101", hint=hint)
    return _bad(text, f"is not a unit from column {at + 1} on")


@lru_cache(1024)
def _exact(text: str) -> _Unit:
    """Return the exact factor and the dimension of a product of units."""
    source = re.sub("[⁻⁰¹²³⁴-⁹]+", lambda m: "^" + m[0].translate(_SUPERSCRIPT), text.strip())
    factor, dimension = _ONE
    sign, complete, at, raised = 1, not source, 0, False
    around: list[tuple[_Unit, int]] = []
    while at < len(source):
        match = _TOKEN.match(source, at)
        if match is None or (not complete and match["mark"] in ("*", "·", "/")) or at > 100:
            raise _no_unit(text, at)
        if match["close"] and not complete:
            raise _no_unit(text, at)
        at = match.end()
        if match["mark"] == "(":
            around.append(((factor, dimension), sign))
            (factor, dimension), sign, complete = _ONE, 1, False
        elif match["mark"]:
            complete, sign = False, -1 if match["mark"] == "/" else 1
        else:
            power = Fraction(match["power"].strip("()") if match["power"] else 1)
            if match["close"]:
                if not around:
                    raise _bad(text, "closes a parenthesis that is not open")
                base, unit = factor, dimension
                (factor, dimension), sign = around.pop()
                if raised and power != 1:
                    raise _bad(text, "has the power of a power")
                raised = raised or power != 1
            else:
                base, unit = _resolve(match["symbol"])
            if abs(power) > 12 or (power.denominator > 1 and base != 1):
                raise _bad(text, f"has the power {power}, which is out of range")
            power *= sign
            factor, dimension = factor * base**power.numerator, dimension * unit**power
            complete, sign = True, 1
    if not complete or around:
        raise _bad(text, "is not a complete unit")
    return factor, dimension


@lru_cache(1024)
def parse_unit(text: str) -> tuple[float, Dimension]:
    """Return the factor to SI and the dimension of a unit.

    Examples
    --------
    >>> parse_unit("cm^2")
    (0.0001, <Dimension m^2>)
    """
    return _scaled("1", text)


def _scaled(number: str, unit: str) -> tuple[float, Dimension]:
    factor, dimension = _exact(unit)
    value = float(number)
    try:  # a huge exponent must not reach exact arithmetic; the float is 0 or infinite then
        value = float(Fraction(number) * factor) if value and math.isfinite(value) else value
    except OverflowError:
        value = math.inf
    if math.isinf(value):
        raise _bad(f"{number} {unit}", "is larger than a float can be")
    return value, dimension


def parse_quantity(text: str) -> Quantity:
    """Parse ``"1 mH"``, ``"10 m/(N*s)"``, ``"0.2 1/s"``, ``"9.81 [m/s^2]"`` or ``"5"``.

    Raises
    ------
    UnitError
        HB-U101 unknown unit, HB-U104 no quantity at all, HB-U105 a scale with an offset.

    Examples
    --------
    >>> parse_quantity("2 kN*m")
    Quantity(value=2000.0, dimension=<Dimension N*m>)
    """
    match = _NUMBER.match(text)
    if match is None:
        raise _bad(text, "does not begin with a number")
    unit = text[match.end() :].strip()
    unit = unit[1:-1] if re.fullmatch(r"\[.*\]", unit) else unit
    try:
        value, dimension = _scaled(match[1], unit)
    except UnitError as error:
        if error.code == "HB-U105":
            error.hint = _in_kelvin(match[1], unit) or error.hint
        raise
    return Quantity(value, _worded(unit, dimension))


def _in_kelvin(number: str, unit: str) -> str:
    """Return what a temperature, or a difference of temperatures, is in kelvin.

    Examples
    --------
    >>> _in_kelvin("20", "degC"), _in_kelvin("32", "°F")
    ('20 degC is 293.15 K, as a difference 20 K', '32 °F is 273.15 K, as a difference 17.7778 K')
    """
    if unit not in _OFFSET:
        return ""
    zero, size = _OFFSET[unit]
    at, many = float(Fraction(number) * size + zero), float(Fraction(number) * size)
    return f"{number} {unit} is {at:.9g} K, as a difference {many:.6g} K"


_SHARED = {"J": "N", "1/s": "rad|Hz", "1": "rad"}
"""Dimensions of several kinds of quantity by their symbols, each with a unit that tells which."""


@lru_cache(1024)
def _worded(unit: str, dimension: Dimension) -> Dimension:
    """Return a dimension in the words of a unit, where its own symbol is none or another's."""
    symbol = _symbols().get(dimension)
    if symbol is not None and symbol not in _SHARED:
        return dimension
    word = _in_si(unit)
    told = symbol is None or re.search(rf"\b({_SHARED[symbol]})\b", word)
    if not told or word == symbol:
        return dimension
    try:
        same = parse_unit(word)[1] == dimension
    except UnitError:
        same = False  # what stands for it in SI has a power of a power
    return Worded(dimension.exponents, word) if same else dimension


def _in_si(unit: str) -> str:
    """Return a unit with each symbol in SI: ``kN*cm`` as ``N*m``."""
    plain = re.sub("[⁻⁰¹²³⁴-⁹]+", lambda m: "^" + m[0].translate(_SUPERSCRIPT), unit)
    plain = re.sub(r"\s+", "", plain).replace("**", "^").replace("·", "*")
    word = re.sub(r"°?[^\W\d_]+|[%°]", lambda m: f"({_symbol_in_si(m[0])})", plain)
    word = re.sub(r"\(([^\W\d_]+|1)\)", r"\1", word)
    word = re.sub(r"\(([^\W\d_]+\^\d)\)(?!\^)", r"\1", word)
    return word[1:-1] if re.fullmatch(r"\([^()]*\)", word) else word


def _symbol_in_si(symbol: str) -> str:
    for cut in (0, 2, 1):  # a name of its own before one with a prefix, as where it is resolved
        head, rest = symbol[:cut], symbol[cut:]
        if (cut == 0 and rest in _PLAIN) or ((not head or head in _PREFIX) and rest in _PREFIXED):
            break
    if rest in ("rev", "deg", "°"):
        return "rad"
    if rest == "rpm":
        return "rad/s"
    number, dimension = _resolve(rest)
    return rest if number == 1 else str(dimension)


def try_quantity(text: str) -> Quantity | None:
    """Return the quantity, or None where `text` is something else, such as ``"-m*g"``."""
    return _tried(text) if len(text) <= SHORT else _tried.__wrapped__(text)


SHORT = 80
"""Characters of a text up to which its quantity is remembered: an edit reads all values again."""


@lru_cache(4096)
def _tried(text: str) -> Quantity | None:
    try:
        return parse_quantity(text)
    except UnitError:
        return None


def format_quantity(value: float, unit: Dimension | str, digits: int = 6) -> str:
    """Write an SI value with `digits` digits, and a prefix where the unit is one symbol.

    Examples
    --------
    >>> format_quantity(0.04932851, "J"), format_quantity(-0.0993262, "V*s")
    ('49.3285 mJ', '-0.0993262 V·s')
    >>> format_quantity(-0.0, "A")
    '0 A'
    """
    symbol, prefix = str(unit), ""
    shown = value / parse_unit(symbol)[0] + 0.0  # no minus before a zero
    if symbol in _PREFIXED and symbol != "g" and shown and math.isfinite(shown):
        exponent = int(f"{shown:.{digits - 1}e}".split("e")[1])
        power = min(max(exponent // 3 * 3, -12), 12)
        shown, prefix = shown / 10.0**power, _ENGINEERING[power]
    name = "" if symbol == "1" else prefix + symbol.replace("*", "·")
    return f"{shown:.{digits}g} {name}".rstrip()


def _define(table: _Units, entries: str) -> None:
    for entry in entries.split(";"):
        names, number, unit = entry.split(",")
        table |= dict.fromkeys(names.split(), (number, unit))


_define(_PREFIXED, "Hz,1,1/s;N,1,kg*m/s^2;Pa,1,N/m^2;J,1,N*m;W,1,J/s;C,1,A*s;V,1,W/A;F,1,C/V")
_define(_PREFIXED, "ohm Ω Ω,1,V/A;S,1,A/V;Wb,1,V*s;T,1,Wb/m^2;H,1,Wb/A;L l,1/1000,m^3")
_define(_PREFIXED, "bar,100000,Pa;eV,1.602176634e-19,J;Wh,3600,J;Ah,3600,C;gram,1/1000,kg")
_define(_PLAIN, "min,60,s;h,3600,s;t tonne,1000,kg;atm,101325,Pa;%,1/100,1")
_define(_PLAIN, "day days,86400,s;week,7,day;inch,0.0254,m;ft foot,12,inch;yd,3,ft;mile,1760,yd")
_define(_PLAIN, "nmi,1852,m;knot,1,nmi/h;mph,1,mile/h;lb lbm,0.45359237,kg;lbf,9.80665,lb*m/s^2")
_define(_PLAIN, "kgf kp,9.80665,N;psi,1,lbf/inch^2;torr Torr,1/760,atm;mmHg,133.322387415,Pa")
_define(_PLAIN, "ppm,1/1000000,1;ksi,1000,psi;kip,1000,lbf;thou,1/1000,inch;oz,1/16,lb")
_define(_PLAIN, "slug,1,lbf*s^2/ft;cP,1/1000,Pa*s;inHg,25.4,mmHg")
_TURN = 2 * Fraction(math.pi)
_define(_PLAIN, f"rev,{_TURN},1;rpm,{_TURN / 60},1/s;deg °,{_TURN / 360},1")

# The first name of a dimension wins: J before N*m, V*s before Wb.
_NAMED = """1 1/s N Pa J W C V F ohm S H T V*s m/s m/s^2 m^2 m^3 m^3/s N/m N*s N*s/m m/N m/(N*s)
Pa*s Pa*s/m^3 m^3/Pa Pa*s^2/m^3 N*m*s W/K J/K K/W kg kg*m^2 kg/m^3 m s A K mol cd"""


@cache
def _symbols() -> dict[Dimension, str]:
    found: dict[Dimension, str] = {}
    for name in _NAMED.split():
        found.setdefault(parse_unit(name)[1], name)
    return found


def _of_unit(unit: str) -> Dimension:
    """Return the dimension of a unit in its own words: an angular velocity is told in rad/s."""
    return _worded(unit, parse_unit(unit)[1])


_POWER_PAIRS = "electrical V A;translational N m/s;rotational N*m rad/s;hydraulic Pa m^3/s;"
_POWER_PAIRS += "thermal K W/K;thermal_pseudo K W;magnetic A V"
DOMAINS: Mapping[str, Domain] = {
    name: Domain(name, e, f, _of_unit(e), _of_unit(f), name.endswith("pseudo"))
    for name, e, f in map(str.split, _POWER_PAIRS.split(";"))
} | {
    "generic": Domain("generic", "", "", None, None),
    "generic_pseudo": Domain("generic_pseudo", "", "", None, None, True),
}
"""Units of effort and flow by domain; ``generic`` and ``generic_pseudo`` leave both open."""


def is_of(quantity: Quantity, unit: str) -> bool:
    """Return whether a quantity can stand for a value of a unit; a number without one always can.

    Examples
    --------
    >>> is_of(try_quantity("5 mV"), "V"), is_of(try_quantity("5 V"), "ohm")
    (True, False)
    >>> is_of(try_quantity("5"), "ohm"), is_of(try_quantity("5 V"), "")
    (True, True)
    """
    plain = quantity.dimension == DIMENSIONLESS
    return plain or not unit or quantity.dimension == parse_unit(unit)[1]
