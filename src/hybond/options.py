"""What a run can be asked for: each option once, with its meaning, its default and its bounds.

Calls from Python, experiments in files, words of the command line, messages of the studio and
exports all take them from `OPTIONS`. `hybond.runs.policies` has those that belong together as
records, `hybond.runs.asked` what fits together.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from numbers import Real
from typing import Any, Literal, get_args

from hybond.errors import UnitError, UsageError
from hybond.names import did_you_mean
from hybond.records import dataclass
from hybond.units import parse_quantity, parse_unit, try_quantity

Choice = Literal["filippov", "hysteresis", "refuse"]
Impact = Literal["newton", "newton_simultaneous", "poisson", "lzb", "lzb_hertz"]

SOLVERS: dict[str, str] = {
    "auto": "exact for linear modes, else rk45, and radau where that is stiff; the default",
    "rk45": "explicit Runge-Kutta 5(4) of Dormand and Prince, adaptive",
    "radau": "implicit Runge-Kutta of order 5 (Radau IIA), adaptive; for stiff models",
    "exact": "exact propagation of linear modes by the exponential of a matrix; rk45 elsewhere",
    "rk4": "classical Runge-Kutta of order 4, fixed step",
    "euler": "forward Euler, fixed step; to reproduce published results",
    "qss1": "quantised states of order 1: constant between their events; for coarse tolerances",
    "qss2": "quantised states of order 2: lines between their events",
    "qss3": "quantised states of order 3: parabolas between their events; also named qss",
    "liqss1": "linearly implicit quantised states of order 1; stiff, for coarse tolerances",
    "liqss2": "linearly implicit quantised states of order 2, for stiff models; also named liqss",
    "liqss3": "linearly implicit quantised states of order 3, for stiff models",
}
"""Names of the solvers, each with a line that says what it is."""

STEPPING: dict[str, str] = {
    "moreau-jean": "time-stepping of Moreau and Jean: fixed steps, contacts and diodes within them",
}
"""Methods that replace the executive as well, each with a line that says what it is."""

FIXED = ("rk4", "euler")
"""Those with a fixed step."""

QUANTISED = ("qss1", "qss2", "qss3", "liqss1", "liqss2", "liqss3")
"""Those that quantise states."""

ALIASES: dict[str, str] = {"qss": "qss3", "liqss": "liqss2"}
"""Families of solvers by the member to begin with."""

ELSEWHERE: dict[str, str] = {
    **dict.fromkeys(("ode45", "ode23", "dopri5", "rk23", "dop853", "runge-kutta"), "rk45"),
    **dict.fromkeys(("ode15s", "ode23s", "ode23t", "bdf", "lsoda", "dassl", "cvode"), "radau"),
    **dict.fromkeys(("ida", "gear", "trap", "trapezoidal", "implicit", "stiff"), "radau"),
    **dict.fromkeys(("ode4", "runge-kutta-4"), "rk4"),
    **dict.fromkeys(("ode1", "forward-euler"), "euler"),
    **dict.fromkeys(("moreau", "time-stepping"), "moreau-jean"),
}
"""Names of methods in other programs, and the one here of the same kind."""

STEPPING_IMPACT = "newton_simultaneous"
"""The law of impacts that time-stepping has built in."""

RTOL = 1e-8
"""Default relative tolerance."""


@dataclass(frozen=True, slots=True)
class Option:
    """Something that a run can be asked for.

    Parameters
    ----------
    name : str
        In Python and in files; the command line has dashes in it.
    kind : {"word", "number", "time", "size", "count"}
        One of `choices`; a number in SI; a time, s; a number or a quantity of any unit; a whole
        number.
    part : {"method", "surfaces", "impacts", "limits", "experiment"}
        What it is about; those of ``"experiment"`` are said in files alone.
    said : str
        What it is, for a line of help.
    code : str
        Of the refusal of a value that is none.
    hint : str
        What to write.
    default : object
        None if there is none.
    choices : tuple of str
    bounds : tuple of float
        Between which values it lies, without these.
    ends : tuple of float
        Which of `bounds` are values, too.
    only : tuple of str
        The solvers that have it; empty for all.
    elsewhere : tuple of str
        Code and remedy where it is given to a solver that has it not.
    letter : str
        What stands for a value in help.
    """

    name: str
    kind: Literal["word", "number", "time", "size", "count"]
    part: Literal["method", "surfaces", "impacts", "limits", "experiment"]
    said: str
    code: str
    hint: str
    default: Any = None
    choices: tuple[str, ...] = ()
    bounds: tuple[float, float] = (0.0, math.inf)
    ends: tuple[float, ...] = ()
    only: tuple[str, ...] = ()
    elsewhere: tuple[str, str] = ("", "")
    letter: str = "X"

    def read(self, value: Any) -> Any:
        """Return a value as it is used: a name, or a number in SI.

        Raises
        ------
        UsageError
            If it is none, or out of bounds.

        Examples
        --------
        >>> OPTIONS["max_step"].read("2 ms"), OPTIONS["solver"].read("qss")
        (0.002, 'qss3')
        """
        if self.kind == "word":
            name = ALIASES.get(str(value), str(value))
            if name not in self.choices:
                same = ELSEWHERE.get(name.lower().replace("_", "-"), "")
                meant = f"{same!r} is of its kind" if same in self.choices else ""
                raise self.refused(value, meant or did_you_mean(name, self.choices))
            return name
        if self.kind == "count":
            if not isinstance(value, int) or isinstance(value, bool) or value < self.bounds[0]:
                raise self.refused(value)
            return value
        if self.kind == "time":
            number = seconds(value, self.name)
        elif isinstance(value, Real):
            number = float(value)
        else:
            quantity = try_quantity(str(value)) if self.kind == "size" else None
            if quantity is None:
                raise self.refused(value)
            number = quantity.value
        low, high = self.bounds
        if not (low < number < high or number in self.ends):
            raise self.refused(value)
        return number

    def refused(self, value: Any, meant: str = "") -> UsageError:
        """Return the refusal of a value."""
        what = f"no solver {value!r}" if self.name == "solver" else f"{self.name} = {value!r}"
        return UsageError(what, code=self.code, where=self.name, hint=meant or self.hint)


OPTIONS: Mapping[str, Option] = {
    o.name: o
    for o in (
        Option(
            "solver",
            "word",
            "method",
            "auto, rk45, radau, exact, rk4, euler, qss1-3, liqss1-3, moreau-jean",
            "HB-S101",
            "",
            default="auto",
            choices=(*SOLVERS, *STEPPING),
            letter="NAME",
        ),
        Option(
            "rtol",
            "number",
            "method",
            "relative tolerance",
            "HB-S107",
            "1e-12 to 1e-2",
            default=RTOL,
            bounds=(1e-14, 1.0),
            ends=(1e-14,),
            letter="R",
        ),
        Option(
            "atol",
            "number",
            "method",
            "absolute tolerance, SI",
            "HB-S107",
            "leave it out, or give a positive number in SI",
            ends=(0.0,),
            letter="A",
        ),
        Option(
            "step",
            "time",
            "method",
            "step of rk4, euler and moreau-jean",
            "HB-S102",
            'give a duration, such as step="1 ms"',
            only=(*FIXED, *STEPPING),
            elsewhere=(
                "HB-S104",
                'give max_step to bound it, or choose a fixed step: "rk4", "euler"',
            ),
            letter="H",
        ),
        Option(
            "theta",
            "number",
            "method",
            "of moreau-jean, 0.5 to 1: weight of a step's end",
            "HB-S112",
            "from 0.5 (of second order) to 1 (damps, never creates energy)",
            default=0.5,
            bounds=(0.5, 1.0),
            ends=(0.5, 1.0),
            only=(*STEPPING,),
            elsewhere=("HB-S112", 'solver = "moreau-jean"'),
            letter="W",
        ),
        Option(
            "max_step",
            "time",
            "method",
            "longest step",
            "HB-S103",
            "a positive time; leave it out to let the tolerances decide",
            ends=(math.inf,),
            letter="H",
        ),
        Option(
            "impact",
            "word",
            "impacts",
            "law of multiple impacts: " + ", ".join(get_args(Impact)),
            "HB-J205",
            ", ".join(get_args(Impact)),
            default="newton",
            choices=get_args(Impact),
            letter="NAME",
        ),
        Option(
            "sliding",
            "word",
            "surfaces",
            "where both sides push into a switching surface: " + ", ".join(get_args(Choice)),
            "HB-S111",
            ", ".join(get_args(Choice)),
            default="filippov",
            choices=get_args(Choice),
            letter="WAY",
        ),
        Option(
            "hysteresis",
            "size",
            "surfaces",
            "half the band of sliding hysteresis",
            "HB-S111",
            'half the width of the band, such as hysteresis = 1e-3 or "1 mm"',
            letter="H",
        ),
        Option(
            "max_events",
            "count",
            "limits",
            "stop there (default: 1,000,000)",
            "HB-S120",
            "a whole number, one or more",
            default=1_000_000,
            bounds=(1, math.inf),
            letter="N",
        ),
        Option(
            "max_steps",
            "count",
            "limits",
            "steps between two events (default: 4,000,000)",
            "HB-S120",
            "a whole number, one or more",
            default=4_000_000,
            bounds=(1, math.inf),
            letter="N",
        ),
        Option(
            "max_writes",
            "count",
            "experiment",
            "transitions after which an instant that does not end is refused",
            "HB-S120",
            "a whole number, one or more",
            default=10_000,
            bounds=(1, math.inf),
        ),
        Option(
            "event_tol",
            "size",
            "experiment",
            "how well events are located, as a part of the run's length",
            "HB-S107",
            "1e-14 to 1e-3",
            default=1e-12,
            bounds=(0.0, 1.0),
        ),
    )
}
"""All options by name."""

CALLED = tuple(o.name for o in OPTIONS.values() if o.part != "experiment")
"""Those of calls."""
MADE = tuple(o.name for o in OPTIONS.values() if o.part in ("method", "impacts"))
"""Those that say how motion is computed: of exports, too."""


def seconds(value: Any, where: str) -> float:
    """Return a time as it was given, s.

    Raises
    ------
    UsageError
        HB-S106 for what is none.

    Examples
    --------
    >>> seconds("200 ms", "until")
    0.2
    """
    if isinstance(value, Real):
        return float(value)
    text = str(value).strip()
    hint = "write 0.2 or '200 ms'"
    try:
        quantity = parse_quantity(text)
        if quantity.dimension in (parse_unit("s")[1], parse_unit("1")[1]):
            return quantity.value
        if quantity.dimension == parse_unit("m")[1] and text.endswith("m"):
            hint = f"write '{text}s' or '{text}in'"
    except UnitError as error:
        hint = _meant(text, error) or hint
    raise UsageError(f"{value!r} is not a time", code="HB-S106", where=where, hint=hint)


def _meant(text: str, error: UnitError) -> str:
    """Return a remedy for what has a unit that is none: '5u', '2 dayz', '1 year'."""
    given = try_quantity(f"{text}s")
    if given is not None and given.dimension == parse_unit("s")[1]:
        return f"write '{text}s'"
    named = re.findall("'([^']*)'", error.hint)
    units = [try_quantity(f"1 {name}") for name in named]
    if error.code != "HB-U101" or error.hint.startswith("known"):
        return ""
    times = all(u is not None and u.dimension == parse_unit("s")[1] for u in units)
    return error.hint if times else ""


def seconds_of(value: Any, where: str) -> float | None:
    """Return a time as it was given, s, if it was; raises as `seconds`."""
    return None if value is None else seconds(value, where)
