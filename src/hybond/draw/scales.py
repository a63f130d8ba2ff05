"""The axes of plots: engineering prefixes, which signals share them, how they look."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
# A prefix goes before a plain symbol; before kg, a power or a number it would mislead.
_TAKES_PREFIX = re.compile(r"(?!kg|1|rad)[^\W\d_]+(?![\^²³\d])")
_FEW, _MANY = 1e-3, 1e6
"""Between these a number needs no power of ten where there is no prefix."""
_POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def axis_scale(unit: str, largest: float, *, least: float = 0.1) -> tuple[float, str]:
    """Return the factor and the unit with which an axis is best read.

    Parameters
    ----------
    unit : str
        The SI unit of the values.
    largest : float
        The largest absolute value on the axis.
    least : float
        Values down to here need no prefix.

    Returns
    -------
    factor : float
        Multiply values by it.
    label : str
        The unit with its prefix, as it is printed; with a power of ten where there is no prefix.

    Examples
    --------
    >>> axis_scale("A", 0.02)
    (1000.0, 'mA')
    >>> axis_scale("m/s", 0.5), axis_scale("N*m", 5e4), axis_scale("m^3/s", 1e-5)
    ((1.0, 'm/s'), (0.001, 'kN·m'), (1000000.0, '10⁻⁶ m³/s'))
    >>> axis_scale("A", 1e-18), axis_scale("K", 5e4), axis_scale("", 0.02)
    ((1e+18, '10⁻¹⁸ A'), (0.001, 'kK'), (1.0, ''))
    """
    power = 0
    if math.isfinite(largest) and largest > 0 and not least <= largest < 2000.0:
        # The largest value becomes a number of one to three digits before the point.
        power = 3 * math.floor(math.log10(largest) / 3 + 1e-3)
    plain = not _TAKES_PREFIX.match(unit)
    if plain and _FEW <= largest < _MANY:
        power = 0
    elif plain or power not in _PREFIXES:
        raised = f"10{str(power).translate(_POWERS)} " if power else ""
        return float(f"1e{-power}"), (raised + printed(unit)).strip()
    return float(f"1e{-power}"), _PREFIXES[power] + printed(unit)


def time_scale(longest: float) -> tuple[float, str]:
    """Return the factor and the unit with which an axis of time is best read.

    Nobody counts in kiloseconds: from 2000 s on these are minutes, then hours, then days.

    Examples
    --------
    >>> time_scale(0.02), time_scale(1500.0), time_scale(3600.0)
    ((1000.0, 'ms'), (1.0, 's'), (0.016666666666666666, 'min'))
    >>> time_scale(86400.0)[1], time_scale(30 * 86400.0)[1]
    ('h', 'd')
    """
    if not 2000.0 <= longest < math.inf:
        return axis_scale("s", longest, least=0.5)
    for seconds, unit in ((60.0, "min"), (3600.0, "h")):
        if longest <= 240.0 * seconds:
            return 1.0 / seconds, unit
    return 1.0 / 86400.0, "d"


def printed(unit: str) -> str:
    """Return a unit as it is printed.

    Examples
    --------
    >>> printed("m^3/(N*s)")
    'm³/(N·s)'
    """
    raised = re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_POWERS), unit)
    return raised.replace("*", "·")


def by_unit(names: Iterable[str], unit_of: Callable[[str], str | None]) -> dict[str, list[str]]:
    """Return signals, each once, by their unit: those of one unit share axes.

    Examples
    --------
    >>> by_unit(["c.e", "l.f", "r.e", "c.e"], {"c.e": "V", "r.e": "V", "l.f": "A"}.get)
    {'V': ['c.e', 'r.e'], 'A': ['l.f']}
    """
    found: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        found.setdefault(unit_of(name) or "", []).append(name)
    return found


def plain_axes(ax: Axes, lines: Literal["x", "y", "both"] = "y") -> None:
    """Give axes small numbers and faint lines across them, and no frame above and at the right."""
    ax.tick_params(labelsize=8)
    ax.grid(visible=True, axis=lines, color="#e6e6e6", linewidth=0.6)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
