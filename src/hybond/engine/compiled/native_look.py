"""Values of a finished run, by the library: signals, powers and energies at points of its motion.

The log of a run has states and modes. All else follows from them, by the equations that the run
itself was made with: here they are asked.
"""

from __future__ import annotations

import ctypes
import functools
from typing import Any

import numpy as np

from hybond.engine.compiled.answering import Answering, Calls
from hybond.engine.compiled.look import Look, Motion, Motions
from hybond.engine.compiled.native import NativeModel, begun, library
from hybond.engine.compiled.points import Numbers, Points, PointsRecord, Vector, Within, address
from hybond.engine.compiled.refusal import refusal_of
from hybond.engine.compiled.sliced import OK, RAISED, SPENT
from hybond.errors import NumericsError

ASKED = ("values", "parts", "powers", "energies")


@functools.cache
def _looking() -> ctypes.CDLL:
    """Return the library with the functions used here declared."""
    found = library()
    handle, number = ctypes.c_void_p, ctypes.c_int
    points = ctypes.POINTER(PointsRecord)
    arguments: dict[str, list[Any]] = {
        "into": [
            *(handle, ctypes.c_double, handle, handle, number, handle),
            *(number, number, handle, ctypes.c_double),
        ],
        "from": [handle, number, number, handle, handle],
        "modes": [handle, handle],
        "at": [handle, number, points, number, handle, handle, handle, handle],
        "along": [
            *(handle, number, points, number, handle, handle, number, handle, handle, handle),
            *(handle, ctypes.c_double, number, handle),
        ],
        "stored": [handle, number, handle, handle],
        "sources": [handle, handle, handle],
        "by_knowns": [handle, number, handle, handle],
    }
    for name, types in arguments.items():
        getattr(found, f"hybond_look_{name}").argtypes = types
    return found


class NativeLook(Look):
    """Looks into the motion of finished runs of a model, by the library.

    Raises
    ------
    Unavailable
        If there is no library.
    MemoryError

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.compiled.native import NativeRun
    >>> from hybond.engine.compiled.points import Steps
    >>> from hybond.engine.tables import tables_of
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> model = NativeModel(tables_of(m.flatten(), until="1 s", rtol=1e-10))
    >>> (rows,) = NativeRun(model).slices(steps=-1)
    >>> look = NativeLook(model)
    >>> look.into(0.0, [], energy=2.0)
    >>> power = Within(Steps.of(rows), [0.0, 1.0])
    >>> look.powers(power).tolist()
    [[0.0, 4.0], [0.0, 0.541341133]]
    """

    def __init__(self, model: NativeModel) -> None:
        super().__init__(model.tables)
        self.model = model
        self._library = _looking()
        self._handle = begun(self, model, looking=True)
        self._answering: Answering | None = None
        if model.tables.numbers["called"]:
            self._answering = Answering(Calls(model.tables, looking=True))
            self._answering.of(self._library, self._handle)

    def _enter(self, motion: Motion) -> int:
        m = motion
        self._check(
            self._library.hybond_look_into(
                *(self._handle, m.t, address(m.state), address(m.landed)),
                *(len(m.surfaces), address(m.surfaces), int(m.product)),
                *(len(m.modes), address(m.modes), m.energy),
            )
        )
        return int(self._library.hybond_look_modes(self._handle, None))

    def _follow(self, when: Vector, roots: Vector) -> None:
        many, wide = roots.shape
        given = self._handle, many, wide, address(when), address(roots)
        self._check(self._library.hybond_look_from(*given))

    def _modes(self) -> Numbers:
        found = np.zeros((self._parts, self.model.record.machines), dtype=np.intc)
        self._library.hybond_look_modes(self._handle, address(found))
        return found

    def _ask(
        self,
        what: str,
        points: Points | Within,
        first: int,
        last: int,
        outs: tuple[Vector, ...],
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        self._check(
            self._library.hybond_look_at(
                *(self._handle, ASKED.index(what), ctypes.byref(points.record(first, last))),
                *((0, None) if slots is None else (len(slots), address(slots))),
                *(None if end is None else address(end), address(outs[0])),
                address(outs[1]) if len(outs) > 1 else None,
            )
        )

    def _along(
        self,
        what: str,
        motions: Motions,
        points: Within,
        out: Vector,
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        m = motions
        self._check(
            self._library.hybond_look_along(
                *(self._handle, ASKED.index(what), ctypes.byref(points.record(0, len(points.t)))),
                *((0, None) if slots is None else (len(slots), address(slots))),
                *(None if end is None else address(end), len(m.t), address(m.first)),
                *(address(m.t), address(m.state), address(m.landed), m.energy),
                *(out.shape[1], address(out)),
            )
        )

    def _stored(self, y: Vector) -> Vector:
        out = np.zeros(len(y))
        given = self._handle, len(y), address(y), address(out)
        self._check(self._library.hybond_look_stored(*given))
        return out

    def _sources(self) -> tuple[Numbers, Numbers] | None:
        source, rated = np.zeros((2, max(self.model.record.most_sources, 1)), dtype=np.intc)
        given = self._handle, address(source), address(rated)
        many = self._library.hybond_look_sources(*given)
        return None if many < 0 else (source[:many], rated[:many])

    def _by_knowns(self, known: Vector) -> Vector:
        out = np.zeros((len(known), 2 * self.model.record.bonds))
        given = self._handle, len(known), address(known), address(out)
        self._check(self._library.hybond_look_by_knowns(*given))
        return out

    def _check(self, status: int) -> None:
        if status == OK:
            return
        if status == SPENT:
            self._parts = 0
            raise MemoryError
        if status == RAISED and self._answering is not None:
            raise self._answering.taken()
        fault = refusal_of(self._library, self._handle, 0)
        why = f"{fault.why}, at t = {fault.t:.9g} s"
        hint = "look at the values just before: what is asked for has none there"
        raise NumericsError(why, code=fault.code, where=fault.place, hint=hint)
