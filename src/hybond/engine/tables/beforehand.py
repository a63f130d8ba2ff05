"""What is known beforehand: time, inputs but for functions in Python, and integrals of these."""

from __future__ import annotations

from graphlib import CycleError, TopologicalSorter

from hybond.engine.inputs.calls import CALLED
from hybond.engine.tables.columns import ModelTables
from hybond.model.expressions import Expr, names, uses_pre


class Beforehand:
    """Which names of a model stand for what is known before the run comes there."""

    def __init__(self, tables: ModelTables) -> None:
        self._inputs = tables.ints["input_kind"]
        self._rates = {
            f"s:{k}": tables.values.all[number]
            for k, number in enumerate(tables.ints["integral_rate"])
        }
        self._known: dict[str, bool] = {}
        """Of each signal but those that read themselves, or others that do."""
        self._learn()

    def _learn(self) -> None:
        """Look at each signal behind those that its rate reads: once, however many there are."""
        rates = self._rates
        sorter = TopologicalSorter({s: names(rates[s]) & rates.keys() for s in rates})
        try:
            sorter.prepare()
        except CycleError:
            pass  # signals of a cycle, and those that read them, are never ready
        while sorter.is_active():
            for name in sorter.get_ready():
                rate = rates[name]
                known = not uses_pre(rate) and all(self.is_known(n) for n in names(rate))
                self._known[name] = known
                sorter.done(name)

    def rate_of(self, signal: str) -> Expr:
        """Return the rate of an integrated signal."""
        return self._rates[signal]

    def goes_round(self, signal: str) -> bool:
        """Whether an integrated signal, or one that it is made of, reads itself by its rate."""
        return signal not in self._known

    def is_known(self, name: str) -> bool:
        """Whether all is known of it beforehand."""
        kind, _, index = name.partition(":")
        if kind in ("u", "du"):
            return self._inputs[int(index)] != CALLED
        if kind == "s":
            return self._known.get(name, False)
        return kind in ("time", "on", "in", "at")

    def moves(self, name: str) -> bool:
        """Whether a name stands for what goes on with time while nothing happens."""
        return name == "time" or (name.startswith(("u:", "s:")) and self.is_known(name))

    def covers(self, e: Expr) -> bool:
        """Whether all that an expression reads is known beforehand."""
        return all(self.is_known(n) for n in names(e)) and not uses_pre(e)
