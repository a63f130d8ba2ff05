"""`Measurement`: a number with its unit, the window it is of, and how it came about."""

from __future__ import annotations

from typing import Any

from hybond.errors import UnitError
from hybond.records import dataclass
from hybond.units import format_quantity, parse_unit


@dataclass(frozen=True, slots=True)
class About:
    """What a measurement says besides its number.

    Parameters
    ----------
    unit : str
        SI; empty if it has none, or is not known.
    start, end : float
        The window, s.
    t : float or None
        Of an extreme: when it is taken, s.
    side : str
        There: ``"left"`` or ``"right"`` if it is a limit at a jump, else empty.
    impulses : float
        The sum of the areas that it includes.
    how : str
        How it came about, where that needs saying: impulses that were included or left out.
    """

    unit: str
    start: float
    end: float
    t: float | None = None
    side: str = ""
    impulses: float = 0.0
    how: str = ""


class Measurement(float):
    """A number that was measured, in SI; it counts as a float, and knows more.

    Examples
    --------
    >>> m = Measurement(0.0025, About("A", 0.0, 1.0))
    >>> m + 1.0, str(m), m.unit
    (1.0025, '2.5 mA', 'A')
    """

    about: About

    def __new__(cls, value: float, about: About) -> Measurement:
        """Make it of a value and what is to be said of it."""
        made = super().__new__(cls, value)
        made.about = about
        return made

    def __reduce__(self) -> tuple[type[Measurement], tuple[float, About]]:
        return Measurement, (float(self), self.about)

    @property
    def unit(self) -> str:
        """Its SI unit, empty if it has none or is not known."""
        return self.about.unit

    @property
    def start(self) -> float:
        """Where the window begins, s."""
        return self.about.start

    @property
    def end(self) -> float:
        """Where the window ends, s."""
        return self.about.end

    @property
    def t(self) -> float | None:
        """Of an extreme: when it is taken, s."""
        return self.about.t

    @property
    def side(self) -> str:
        """Of an extreme: which limit, where it is one at a jump."""
        return self.about.side

    @property
    def impulses(self) -> float:
        """The sum of the areas of impulses that it includes."""
        return self.about.impulses

    @property
    def how(self) -> str:
        """How it came about, where that needs saying."""
        return self.about.how

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        own = self.about
        found: dict[str, Any] = {"value": float(self), "unit": own.unit}
        found |= {"start": own.start, "end": own.end}
        if own.t is not None:
            found["t"] = own.t
        if own.side:
            found["side"] = own.side
        if own.how:
            found |= {"impulses": own.impulses, "how": own.how}
        return found

    def __str__(self) -> str:
        return shown(float(self), self.unit)


def shown(value: float, unit: str) -> str:
    """Return a value with its unit for people.

    Examples
    --------
    >>> shown(-0.0993262, "V*s"), shown(2.0, "")
    ('-0.0993262 V·s', '2')
    """
    try:
        return format_quantity(value, unit or "1")
    except UnitError:
        return f"{value:.6g} {unit}".rstrip()


def integral_unit(unit: str) -> str:
    """Return the unit of a signal's integral over time; empty if it is not known.

    Examples
    --------
    >>> integral_unit("W"), integral_unit("V*s"), integral_unit("m/s"), integral_unit("")
    ('J', 'V*s*s', 'm', '')
    """
    if not unit:
        return ""
    try:
        found = str(parse_unit(unit)[1] * parse_unit("s")[1])
    except UnitError:
        return ""
    # one that has a name of its own, or the words of the domain
    return found if "kg" not in found or "/" in unit else f"{unit}*s"
