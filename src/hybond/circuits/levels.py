"""The levels on which sources rest, those that compute included, and sums of sources."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product

from hybond.circuits.behaviour import PLACE
from hybond.circuits.formulas import evaluate, names_in
from hybond.circuits.leaves import Leaf
from hybond.model.expressions import Compare, Expr, Name, Number, transform

ONE = -1
OPEN = -2
"""In a sum by source, what stands for a constant, and for what nothing is known of."""
MOST = 4096
"""Ways to put the levels of sources together, ..."""
COMPARISONS = 8
"""... and comparisons in a formula, each of which holds or does not."""
SAME = 1e-12
"""Two levels are one if they differ by less, as a part of the largest term."""
_RESTING = {"pulse": slice(0, 2), "exp": slice(0, 2), "pwl": slice(1, None, 2)}


class Levels:
    """The levels of each source.

    Parameters
    ----------
    values : mapping
        Parameters, which formulas are written with.
    """

    def __init__(self, leaves: Sequence[Leaf], values: Mapping[str, float]) -> None:
        self.leaves, self.values = leaves, values
        self.known: dict[int, tuple[float, ...] | None] = {}
        """Of a source that computes; None if it is not one of some levels."""
        self.truths: set[int] = set()
        """Those that compare what is solved for."""
        self.with_truths = False
        """Whether there may be such: not before all is found that is given without them."""

    def of_source(self, k: int) -> tuple[float, ...] | None:
        """Return the levels of a source, none if it always moves, None if nothing says."""
        if k in self.known:
            return self.known[k]
        leaf = self.leaves[k]
        if leaf.branch.wave is None:  # brought up at the start
            return (0.0, leaf.branch.value.number if leaf.branch.value else 0.0)
        name, given = leaf.branch.wave
        part = _RESTING.get(name)
        return () if part is None else tuple(value.number for value in given[part])

    def of_sum(self, terms: Mapping[int, float]) -> tuple[float, ...] | None:
        """Return the levels of a sum: all that its sources make together.

        `terms` are by source, beside `ONE` and `OPEN`.
        """
        constant = terms.get(ONE, 0.0)
        each = []
        ways = 1
        unknown = OPEN in terms
        for k, factor in terms.items():
            if k < 0:
                continue
            levels = self.of_source(k)
            if levels == ():
                return ()
            if levels is None:
                unknown = True
                continue
            each.append(sorted({factor * level for level in levels}))
            ways *= len(each[-1])
        if unknown or ways > MOST:
            return None
        sizes = [abs(constant), *(abs(x) for levels in each for x in levels)]
        found: list[float] = []
        for value in sorted(constant + math.fsum(some) for some in product(*each)):
            if not found or value - found[-1] > SAME * max(sizes):
                found.append(value)
        return tuple(found)

    def computed(self, k: int, reads: Sequence[Mapping[int, float] | None]) -> bool:
        """Return whether a source that computes is given, and find its levels.

        Parameters
        ----------
        reads : sequence
            What its formula reads as sums of sources, None for what is solved for. A comparison of
            that is a truth, which leaves a level at once.
        """
        law = self.leaves[k].branch.law
        assert law is not None
        solved = {f"{PLACE}{n}" for n, terms in enumerate(reads) if terms is None}
        each: dict[str, tuple[float, ...]] = {}
        for n, terms in enumerate(reads):
            levels = None if terms is None else self.of_sum(terms)
            if levels:
                each[f"{PLACE}{n}"] = levels
        rests = each.keys() | self.values.keys()
        truths: dict[Compare, str] = {}

        def marked(e: Expr) -> Expr:
            if not isinstance(e, Compare) or rests.issuperset(names_in(e)):
                return e
            name = truths.setdefault(e, f"truth#{len(truths)}")
            each[name] = (0.0, 1.0)
            return Compare(">", Name(name), Number(0.5))

        formula = transform(law.formula, marked)
        undecided = any(not solved.isdisjoint(names_in(e)) for e in truths)
        if not solved.isdisjoint(names_in(formula)) or (undecided and not self.with_truths):
            return False
        if undecided or any(t is not None and not self.truths.isdisjoint(t) for t in reads):
            self.truths.add(k)
        self.known[k] = None if len(truths) > COMPARISONS else self._found(formula, each)
        return True

    def _found(
        self, formula: Expr, each: Mapping[str, tuple[float, ...]]
    ) -> tuple[float, ...] | None:
        """Return the levels of a formula of names that have levels, None if others are left."""
        left = list(dict.fromkeys(names_in(formula)))
        names = [name for name in left if name in each]
        rest = [name for name in left if name not in each]
        if not self.values.keys() >= set(rest):  # time, or what has no levels
            return None
        if math.prod(len(each[name]) for name in names) > MOST:
            return None
        fixed = {name: self.values[name] for name in rest}
        found: set[float] = set()
        for values in product(*(each[name] for name in names)):
            try:
                found.add(evaluate(formula, fixed | dict(zip(names, values, strict=True))))
            except (ArithmeticError, ValueError, KeyError):
                return None
        return tuple(sorted(found))
