"""Coupled coils as elements of a bond graph: a field of inertances, or transformers on a core."""

from __future__ import annotations

from typing import Any

import numpy as np

from hybond.circuits.coils import Magnetics
from hybond.circuits.numerals import quantity
from hybond.circuits.texts import Texts
from hybond.circuits.woven import Woven
from hybond.model.parts import Part


class Windings:
    """Hangs coils onto junctions; what they share is made with the first of them.

    Parameters
    ----------
    idle : set of int
        Branches that no current can pass.
    """

    def __init__(self, out: Woven, texts: Texts, idle: set[int]) -> None:
        self.out, self.texts = out, texts
        self.leaves = out.leaves
        self._open = idle
        self._cores: dict[str, str] = {}

    def _wound(self, core: Magnetics) -> list[int]:
        """Return the coils of a core that have a current, by their place."""
        open_keys = {self.leaves[k].branch.key for k in self._open}
        legs = core.tied or tuple((key,) for key in core.coils)
        return [i for i, leg in enumerate(legs) if not open_keys.issuperset(leg)]

    def _port(self, core: Magnetics, index: int) -> str:
        """Return the port of a coil at the field of its core; a single coil needs none."""
        kept = self._wound(core)
        return "" if len(kept) == 1 else f".{kept.index(index) + 1}"

    def open(self, k: int) -> None:
        """Let a coil without current see what the others of its core induce."""
        winding = self.leaves[k].winding
        assert winding is not None
        core = self._cores.get(winding.core.name)
        leg, turns = winding, 1.0
        if core is None and winding.core.leg is not None:
            # none of its leg has one: each sees the same for each of its turns
            leg, turns = winding.core.leg, winding.core.turns[winding.index]
            core = self._cores.get(leg.core.name)
        if core is None:
            return  # none of them has a current
        if leg.core.matrix is not None:
            # e = M i' of the coils with a current, so i' = M^-1 e, which induces m i' here
            kept = self._wound(leg.core)
            numbers = np.array(leg.core.numbers)
            parts = np.linalg.solve(numbers[np.ix_(kept, kept)], numbers[kept, leg.index])
            terms = (
                f"{turns * float(c)!r}*{core}{self._port(leg.core, i)}.e"
                for c, i in zip(parts, kept, strict=True)
            )
            name = self.out.own[k]
            self.out.signals[name] = " + ".join(terms)
            self.out.drops[k] = ((1, name),)
        elif winding.index == 0:
            self.out.drops[k] = ((1, f"{core}.e"),)
        else:
            name = self.out.element(k, "TF", winding.core.ratios[winding.index][0])
            nothing = self.out.names.take(f"{name}_open")
            self.out.elements[nothing] = Part("Sf", "0 A")
            self.out.bond(nothing, name)
            self.out.bond(name, core)
            self.out.drops[k] = ((1, f"{name}.1.e"),)

    def _core(self, core: Magnetics, host: str = "") -> str:
        """Return the element or junction that coils share; a `host` becomes that junction."""
        known = self._cores.get(core.name)
        if known is not None:
            return known
        name = self._cores[core.name] = host or self.out.names.take(core.name)
        keys = {leaf.branch.key: leaf for leaf in self.leaves if leaf.winding is not None}
        if core.matrix is not None:
            options: dict[str, Any] = {}
            kept = self._wound(core)
            given = [self._start(core, i) for i in kept]
            if any(given):
                options["f"] = given if len(kept) > 1 else given[0]
            rows: Any = [[core.matrix[i][j] for j in kept] for i in kept]
            value = rows if len(kept) > 1 else rows[0][0]
            self.out.elements[name] = Part("I", value, options)
        else:
            if not host:
                self.out.junction("0", name)
            if core.leg is not None:
                field = self._core(core.leg.core)
                self.out.bond(name, f"{field}{self._port(core.leg.core, core.leg.index)}")
            if core.inductance is None or core.leg is not None:
                return name
            index = next(k for k, x in enumerate(self.leaves) if x.branch.key == core.coils[0])
            inductance = self.out.own[index]
            starts = [keys[c].start for c in core.coils]
            total = sum(
                m * (0.0 if s is None else s.number)
                for m, s in zip(core.turns, starts, strict=True)
            )
            options = {"f": quantity(total, "A")} if total else {}
            self.out.elements[inductance] = Part("I", core.inductance, options)
            self.out.lines[inductance] = self.leaves[index].branch.line
            self.out.bond(name, inductance)
        if not host:
            self.out.lines[name] = core.line
        return name

    def _start(self, core: Magnetics, i: int) -> str | float:
        """Return the current that a coil of a field begins with: that of all turns on its leg."""
        leaves = {leaf.branch.key: leaf for leaf in self.leaves}
        leg = [leaves[key] for key in (core.tied[i] if core.tied else (core.coils[i],))]
        starts = [leaf.start for leaf in leg]
        if not any(s is not None and s.number for s in starts):
            return 0.0
        if len(leg) == 1 and starts[0] is not None:
            return self.texts.value(starts[0], "A")
        winding = leg[0].winding
        assert winding is not None
        pairs = zip(winding.core.turns, starts, strict=True)
        return quantity(sum(m * s.number for m, s in pairs if s is not None), "A")

    def on_one(self, k: int, host: str, sign: int) -> None:
        """Hang a coil onto a 1-junction."""
        winding = self.leaves[k].winding
        assert winding is not None
        core = self._core(winding.core)
        self.out.currents[k] = ((sign, f"{host}.f"),)
        if winding.core.matrix is not None:
            port = f"{core}{self._port(winding.core, winding.index)}"
            self.out.drops[k] = ((1, f"{port}.e"),)
            if sign > 0:
                self.out.bond(host, port)
                return
            between = self.out.junction("0", self.out.names.take(f"u_{self.out.own[k]}"))
            self.out.bond(between, host)
            self.out.bond(between, port)
            return
        if winding.index == 0:
            self.out.bond(host, core, sign)
            self.out.drops[k] = ((1, f"{core}.e"),)
            return
        ahead, back = winding.core.ratios[winding.index]
        name = self.out.element(k, "TF", ahead if sign > 0 else back)
        self.out.bond(host, name, sign)
        self.out.bond(name, core, sign)
        self.out.drops[k] = ((1, f"{name}.{1 if sign > 0 else 2}.e"),)

    def on_zero(self, k: int, host: str, sign: int) -> None:
        """Hang a coil onto a 0-junction; against its sign, by a 1-junction of its own."""
        winding = self.leaves[k].winding
        assert winding is not None
        rigid = winding.core.matrix is None
        if sign < 0:
            between = self.out.junction("1", self.out.names.take(f"i_{self.out.own[k]}"))
            self.out.bond(between, host)
            self.on_one(k, between, 1)
        elif rigid and winding.index == 0 and winding.core.name not in self._cores:
            # the node of the first winding is the core: its voltage is that of the turns
            self._core(winding.core, host)
            self.out.drops[k] = ((1, f"{host}.e"),)
        elif rigid and winding.index == 0:
            between = self.out.junction("1", self.out.names.take(f"i_{self.out.own[k]}"))
            self.out.bond(host, between)
            self.on_one(k, between, 1)
        else:
            self.on_one(k, host, 1)
            port = self._cores[winding.core.name]
            if not rigid:
                port += self._port(winding.core, winding.index)
            own = f"{self.out.own[k]}.1" if rigid else port
            self.out.currents[k] = ((1, f"{own}.f"),)
