"""The state of a run at one time, as a record: what another run can begin with."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

from hybond.calls import called, named_file
from hybond.errors import UnitError, UsageError
from hybond.records import dataclass
from hybond.units import format_quantity, parse_unit

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = "hybond state 1"
LARGEST = 64 * 2**20
"""Bytes of a file that is read."""
NUMBERS = 4_000_000
"""Numbers in one."""


@dataclass(frozen=True, slots=True)
class Memory:
    """What a run knows beside what its model means: numbers for one that goes on from it.

    Parameters
    ----------
    fingerprint : str
        Of the model that they belong to.
    span : float
        What thresholds of time are parts of in it, s.
    number, place : tuple
        As the engine takes them.
    deep : bool
        Whether they hold all that the run had seen; else time, state and mode.
    """

    fingerprint: str
    span: float
    number: tuple[float, ...]
    place: tuple[int, ...]
    deep: bool


@dataclass(frozen=True, slots=True)
class State:
    """Where a run was at a time; prints, can be saved and read, and a run can start from it.

    Parameters
    ----------
    model : str
        Name of the model.
    t : float
        s.
    stored : mapping
        Stored quantities by path, SI.
    signals : mapping
        Integrated and sampled signals by path, SI.
    machines : mapping
        The state of each machine by path.
    landed : tuple of str
        Machines that stay in their pinnacle state: what was hit lies still there.
    units : mapping
        Of stored quantities and signals.
    memory : Memory or None
        For a run of the same model, which then goes on as if it had not been interrupted.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> print(hb.simulate(m, "1 s").state())
    rc at t = 1 s
      c.q  3.67879 mC
    """

    model: str
    t: float
    stored: Mapping[str, float]
    signals: Mapping[str, float] = field(default_factory=dict)
    machines: Mapping[str, str] = field(default_factory=dict)
    landed: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    memory: Memory | None = field(default=None, repr=False)

    def save(self, path: str | Path) -> None:
        """Write it as JSON.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        from hybond.files.whole import write_whole

        write_whole(path, self.to_json())

    def to_json(self) -> str:
        """Return it as JSON; every number is read back bit for bit."""
        import json

        record: dict[str, Any] = {
            "format": FORMAT,
            "model": self.model,
            "t": self.t,
            "stored": dict(self.stored),
            "signals": dict(self.signals),
            "machines": dict(self.machines),
            "landed": list(self.landed),
            "units": dict(self.units),
        }
        if self.memory is not None:
            m = self.memory
            record["memory"] = {
                "model": m.fingerprint,
                "span": m.span,
                "deep": m.deep,
                "numbers": [_text_of(x) for x in m.number],
                "places": list(m.place),
            }
        return json.dumps(record, indent=1, allow_nan=False, ensure_ascii=False) + "\n"

    def __str__(self) -> str:
        rows = {**self.stored, **self.signals}
        width = max(map(len, [*rows, *self.machines]), default=0)
        lines = [f"{self.model} at t = {self.t:.9g} s"]
        for path, value in rows.items():
            said = format_quantity(value, self.units.get(path) or "1")
            lines.append(f"  {path:{width}}  {said}")
        for path, state in self.machines.items():
            rest = ", at rest" if path in self.landed else ""
            lines.append(f"  {path:{width}}  {state}{rest}")
        return "\n".join(lines)


def _text_of(x: float) -> float | str:
    """Return a number for JSON, which has no word for what is not finite."""
    return x if math.isfinite(x) else repr(x)


@called('hb.load_state("state.json")')
def load_state(path: str | os.PathLike[str]) -> State:
    """Return a state that was saved.

    Raises
    ------
    UsageError
        HB-S135 if there is no such file, or it is no state.

    Examples
    --------
    >>> import tempfile, hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     hb.simulate(m, "1 s").state().save(f"{folder}/state.json")
    ...     state = hb.load_state(f"{folder}/state.json")
    >>> hb.simulate(m, "2 s", start=state).t_begin
    1.0
    """
    import json

    try:
        data = _bytes_of(named_file(path, 'hb.load_state("state.json")'))
    except OSError as error:
        raise _no_state(path, f"cannot be read: {error.strerror}") from None
    try:
        record = json.loads(data.decode("utf-8"))
        if rb"\ud" in data.lower():
            json.dumps(
                record, ensure_ascii=False
            ).encode()  # half a character, which could not be saved again
        return state_of_record(record)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise _no_state(path, f"is no state of a run: {error}") from None


def _bytes_of(path: Path) -> bytes:
    from hybond.files.parse import read_regular

    data = read_regular(path, LARGEST + 1)
    if len(data) > LARGEST:
        raise _no_state(path, f"has more than {LARGEST} bytes")
    return data


def _no_state(path: object, why: str) -> UsageError:
    return UsageError(
        f"{str(path)!r} {why}",
        code="HB-S135",
        where="start",
        hint="take a file that run.state().save(path) or hybond run --save-state wrote",
    )


def state_of_record(record: Any) -> State:
    """Return a state from data as JSON has it.

    Raises
    ------
    ValueError, KeyError, TypeError
        If it is something else.
    """
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise ValueError(f"its format is not {FORMAT!r}")
    memory = None
    if "memory" in record:
        m = record["memory"]
        if len(m["numbers"]) + len(m["places"]) > NUMBERS:
            raise ValueError(f"it has more than {NUMBERS} numbers")
        memory = Memory(
            str(m["model"]),
            _number(m["span"]),
            tuple(float(x) if isinstance(x, str) else _any_number(x) for x in m["numbers"]),
            tuple(_whole(k) for k in m["places"]),
            m["deep"] is True,
        )
    texts = record["machines"].items()
    if not all(isinstance(v, str) for _, v in texts):
        raise ValueError("a machine's state is a text")
    landed = tuple(str(path) for path in record.get("landed", ()))
    units = {str(k): str(v) for k, v in record.get("units", {}).items()}
    for unit in units.values():
        try:
            parse_unit(unit or "1")
        except UnitError as error:
            raise ValueError(error.why) from None
    return State(
        str(record["model"]),
        _number(record["t"]),
        {str(k): _number(v) for k, v in record["stored"].items()},
        {str(k): _number(v) for k, v in record["signals"].items()},
        {str(k): v for k, v in texts},
        landed,
        units,
        memory,
    )


def _shortened(value: Any) -> str:
    from hybond.files.place import shortened

    return shortened(repr(value))


def _any_number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{_shortened(value)} is not a number")
    try:
        return float(value)
    except OverflowError:
        raise ValueError("a number of it is larger than a float can be") from None


def _number(value: Any) -> float:
    found = _any_number(value)
    if not math.isfinite(found):
        raise ValueError(f"{value} is not finite")
    return found


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise ValueError(f"{_shortened(value)} is not a whole number of 32 bits")
    return value
