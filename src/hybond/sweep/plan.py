"""`Plan`: which members a sweep has, each a number for every factor, made part after part."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.calls import called
from hybond.errors import UsageError
from hybond.sweep.draws import Draws, draws_of
from hybond.sweep.factors import Factor, factor_of
from hybond.sweep.laws import from_name

Vector = NDArray[np.float64]

MEMBERS = 10**10
"""Members that a plan may have."""
LOOKED = 32
"""Members at both ends that are looked at, to see whether two machines draw the same."""


class Plan:
    """The members of a sweep: a grid, values side by side, or a sample.

    Parameters
    ----------
    factors : mapping of path to values
        What varies. A path is one of ``hybond.simulate(parameters=)``: a parameter, the value of
        an element (``ball.I``), a start (``ball.f``, ``height.start``), an input. Values are a
        text (``"0.2:0.3:0.005"``, ``"1..2 kg:11"``, ``"log(1e-4, 1e-2, 50)"``,
        ``"normal(0.2, 0.01)"``), a sequence, or a frozen distribution of SciPy.
    sample : str, optional
        ``"random:N"``, ``"lhs:N"``, ``"sobol:N"``, ``"saltelli:N"`` or ``"ends"``: how members
        are drawn. Levels are then drawn with equal parts. By default all combinations of levels,
        the last factor fastest.
    seed : int
        Of the sample.
    together : bool
        Whether the first levels of all factors make the first member, and so on: no grid.

    Raises
    ------
    UsageError
        HB-P101 for values that mean nothing, HB-P102 for a sample that is none, or a distribution
        without one.

    Examples
    --------
    >>> plan = Plan({"mu": "0.2:0.3:0.05", "J": [1.0, 2.0]})
    >>> plan, {path: values.tolist() for path, values in plan.rows(1, 4).items()}
    (<Plan: 6 members, grid of mu, J>, {'mu': [0.2, 0.25, 0.25], 'J': [2.0, 1.0, 2.0]})
    >>> len(Plan({"mu": "normal(0.2, 0.01)"}, sample="lhs:1000", seed=7))
    1000
    """

    @called('hb.Plan({"mu": "0.2:0.3:0.005"}, sample="lhs:1000", seed=7)')
    def __init__(
        self,
        factors: Mapping[str, Any],
        *,
        sample: str | None = None,
        seed: int = 0,
        together: bool = False,
    ) -> None:
        if not isinstance(factors, Mapping) or not factors:
            raise UsageError(
                "nothing is varied",
                code="HB-P101",
                where="factors",
                hint='hb.Plan({"mu": "0.2:0.3:0.005"})',
            )
        self.factors: tuple[Factor, ...] = tuple(factor_of(p, v) for p, v in factors.items())
        if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
            raise _refusal(f"seed = {seed!r}", "seed", "a whole number, 0 or more")
        self.sample = sample
        self.seed = seed
        self.together = together
        self._draws: Draws | None = None
        if sample is not None:
            if together:
                raise _refusal(
                    "a sample of values side by side", "together", "leave one of them out"
                )
            self._draws = draws_of(sample, len(self.factors), seed)
        else:
            for factor in self.factors:
                if factor.levels is None:
                    raise _refusal(
                        f"{factor.path} = {factor.text!r} is a distribution, and no sample",
                        "sample",
                        f"--sample lhs:1000, or levels of {factor.path}",
                    )
        if together:
            lengths = {f.many for f in self.factors}
            if len(lengths) > 1:
                said = ", ".join(f"{f.path} has {f.many}" for f in self.factors)
                raise _refusal(f"values side by side differ in number: {said}", "together", "")
        if len(self) > MEMBERS:
            raise _refusal(f"{len(self)} members", "factors", f"at most {MEMBERS}")

    def __len__(self) -> int:
        if self._draws is not None:
            return self._draws.members
        if self.together:
            return self.factors[0].many
        return math.prod(f.many for f in self.factors)

    @property
    def paths(self) -> tuple[str, ...]:
        """What varies."""
        return tuple(f.path for f in self.factors)

    @property
    def way(self) -> str:
        """How members come about: ``grid``, ``together``, or the sample as it was asked for."""
        return self.sample or ("together" if self.together else "grid")

    def rows(self, first: int, last: int) -> dict[str, Any]:
        """Return the values of the members from `first` to `last` - 1, by path.

        Returns
        -------
        dict of path to array or list
            Numbers in SI, shape (members,); a list as written where one level is no number.
        """
        if self._draws is not None:
            drawn = self._draws.part(first, last)
            return {f.path: f.quantile(drawn[:, k]) for k, f in enumerate(self.factors)}
        members = np.arange(first, last, dtype=np.int64)
        if self.together:
            return {f.path: f.of_level(members) for f in self.factors}
        found: dict[str, Any] = {}
        for factor in reversed(self.factors):
            members, level = np.divmod(members, factor.many)
            found[factor.path] = factor.of_level(level)
        return {f.path: found[f.path] for f in self.factors}

    def digest(self) -> str:
        """Return a text that differs where members do: of the first and the last of them.

        SciPy says how they are drawn, and another version of it may say otherwise.
        """
        many = len(self)
        parts = [self.rows(0, min(LOOKED, many)), self.rows(max(many - LOOKED, 0), many)]
        text = repr([[p, list(rows[p])] for rows in parts for p in self.paths])
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def to_dict(self) -> dict[str, Any]:
        """Return the plan as plain data."""
        return {
            "factors": {f.path: f.text if f.law is not None else _levels(f) for f in self.factors},
            "units": {f.path: str(f.dimension) for f in self.factors if f.dimension is not None},
            "sample": self.sample,
            "seed": self.seed,
            "together": self.together,
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Plan:
        """Return the plan that `to_dict` has told of.

        Examples
        --------
        >>> plan = Plan({"m": "normal(1 kg, 50 g)", "k": ["2 N/m", 3.0]}, sample="lhs:5", seed=7)
        >>> again = Plan.from_dict(plan.to_dict())
        >>> all((plan.rows(0, 5)[p] == again.rows(0, 5)[p]).all() for p in plan.paths)
        True
        """
        units = data["units"]
        factors = {}
        for path, given in data["factors"].items():
            if isinstance(given, str) and given.startswith("scipy."):
                name, _, words = given.removeprefix("scipy.").rstrip(")").partition("(")
                parts = [w.partition("=") for w in words.split(", ") if w]
                args = [float(key) for key, equals, _ in parts if not equals]
                options = {key: float(value) for key, equals, value in parts if equals}
                given = from_name(name, args, options)
            elif not isinstance(given, str) and path in units:
                given = [f"{value!r} {units[path]}" for value in given]
            factors[path] = given
        return Plan(factors, sample=data["sample"], seed=data["seed"], together=data["together"])

    def __repr__(self) -> str:
        return f"<Plan: {len(self)} members, {self.way} of {', '.join(self.paths)}>"


def _levels(factor: Factor) -> list[Any]:
    levels: Sequence[Any] | Vector = factor.levels if factor.levels is not None else ()
    return list(levels.tolist() if isinstance(levels, np.ndarray) else levels)


def _refusal(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-P102", where=where, hint=hint or "lhs:1000")
