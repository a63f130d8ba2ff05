"""Plans of many runs as the page writes them: what they ask for, what is wrong, and where."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hybond.errors import HybondError, UsageError
from hybond.measures.asked import FUNCTIONS, split_arguments
from hybond.measures.naming import names_of
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.parts import Part, Value
from hybond.model.paths import settable, with_parts
from hybond.runs.ends import Until, ended, ends_of
from hybond.runs.times import end_of
from hybond.sweep.collect import COLLECTORS, WORDS, Collector, collectors_of
from hybond.sweep.draws import METHODS
from hybond.sweep.factors import Factor, factor_of
from hybond.sweep.job import Job
from hybond.sweep.plan import Plan
from hybond.sweep.runner import checked
from hybond.sweep.sweeping import job_of
from hybond.units import try_quantity

WAYS: Mapping[str, str] = {
    "grid": "all combinations of levels, the last factor fastest",
    "together": "levels side by side",
    **METHODS,
}
"""How members come about, each with a line that says what it is."""
MOST = 1_000_000
"""Members of a sweep of the page."""
ROOM = 25_000_000
"""Numbers that may be kept of one: they are in memory."""
ROWS = 200
"""Paths and names that are offered at the most, of each kind."""
EVEN = 11
"""Levels that are proposed."""
WHETHER = ("on", "off")
_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
Wrong = dict[str, dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a plan asks for, as it was typed.

    Parameters
    ----------
    factors : tuple of (str, str)
        Paths, and what they take.
    way : str
        One of `WAYS`.
    count, seed : str
        Of a sample.
    until : str
        What ends runs, a time or conditions and a time with commas; empty for what the model says.
    collect : str
    """

    factors: tuple[tuple[str, str], ...]
    way: str
    count: str
    seed: str
    until: str
    collect: str

    @property
    def sample(self) -> str | None:
        """The sample as a `Plan` takes it."""
        if self.way in ("grid", "together"):
            return None
        return "ends" if self.way == "ends" else f"{self.way}:{self.count}"

    @property
    def ends(self) -> Until:
        """What ends runs, as `hybond.simulate` takes it."""
        words = split_arguments(self.until) or [self.until.strip()]
        found: list[float | str] = [w for w in words if w]
        return None if not found else found[0] if len(found) == 1 else found

    def plan(self) -> Plan:
        """Return the plan.

        Raises
        ------
        UsageError
            HB-P101, HB-P102.
        """
        if not self.seed.strip().isdecimal():
            raise _seed(self)
        twice = [p for k, (p, _) in enumerate(self.factors) if p in dict(self.factors[:k])]
        if twice:
            raise UsageError(
                f"{twice[0]} is varied twice", code="HB-P101", where=twice[0], hint="each path once"
            )
        return Plan(
            dict(self.factors),
            sample=self.sample,
            seed=int(self.seed),
            together=self.way == "together",
        )

    def job(self, model: Model) -> Job:
        """Return the job; what is wrong with it is refused, at its place.

        Raises
        ------
        HybondError
        """
        return job_of(model, self.plan(), self.collect, self.ends, None, "", {})

    def command(self, file: str) -> str:
        """Return the command that runs the same in a terminal, and keeps it in a folder."""
        words = ["hybond", "sweep", file]
        for path, values in self.factors:
            words += ["--vary", f"{path}={values}"]
        if self.way == "together":
            words.append("--together")
        elif self.sample is not None:
            words += ["--sample", self.sample, "--seed", self.seed.strip()]
        ends = self.ends
        for one in ends if isinstance(ends, list) else [] if ends is None else [ends]:
            words += ["--until", str(one)]
        words += ["--collect", self.collect, "--out", f"{Path(file).stem}_sweep"]
        return shlex.join(words)


def wanted_of(message: Mapping[str, Any]) -> Wanted:
    """Return the plan of a message.

    Examples
    --------
    >>> mu = {"path": "mu", "values": "0.2:0.3:0.05"}
    >>> wanted = wanted_of({"factors": [mu], "way": "grid", "collect": "sequence"})
    >>> wanted.plan(), wanted.command("rod.toml")
    (<Plan: 3 members, grid of mu>, 'hybond sweep rod.toml --vary mu=0.2:0.3:0.05 \
--collect sequence --out rod_sweep')
    """
    factors = tuple(
        (str(f.get("path") or "").strip(), str(f.get("values") or "").strip())
        for f in message.get("factors") or ()
    )
    way = str(message.get("way") or "grid")
    if way not in WAYS:
        raise UsageError(
            f"there is no way {way!r} to draw", code="HB-P102", where="way", hint=", ".join(WAYS)
        )
    words = {k: str(message.get(k) or "") for k in ("count", "until", "collect")}
    return Wanted(factors, way, seed=str(message.get("seed") or "0"), **words)


def _seed(wanted: Wanted) -> UsageError:
    return UsageError(
        f"seed = {wanted.seed!r}", code="HB-P102", where="seed", hint="a whole number, 0 or more"
    )


def faults(model: Model, graph: FlatGraph, wanted: Wanted) -> tuple[int, Wrong]:
    """Return how many members a plan has, 0 if it has none, and what is wrong with it.

    Places are ``path.0`` and ``values.0`` of a factor by its number, ``way``, ``seed``, ``until``
    and ``collect``.
    """
    wrong: Wrong = {}

    def note(place: str, error: HybondError) -> None:
        wrong.setdefault(place, error.to_dict())

    if not wanted.seed.strip().isdecimal():
        note("seed", _seed(wanted))
    for k, (path, values) in enumerate(wanted.factors):
        try:
            factor = factor_of(path, values)
        except HybondError as error:
            note(f"values.{k}" if path else f"path.{k}", error)
            continue
        try:
            _take(model, factor)
        except HybondError as error:
            if error.code == "HB-M107":
                note(f"path.{k}", error)
            elif error.code.startswith("HB-U"):
                note(f"values.{k}", error)
            # a value without a meaning is the row of a member
    members = 0
    try:
        ended(graph, ends_of(wanted.ends, model.experiment).conditions)
        end_of(wanted.ends, model.experiment)
    except HybondError as error:
        note("until", error)
    if not wrong:
        try:
            members = len(wanted.plan())
        except HybondError as error:
            note(_place(wanted, error), error)
    try:
        if wrong:
            collectors_of(graph, wanted.collect)
        else:
            _fits(members, checked(wanted.job(model))[1])
    except HybondError as error:
        note("way" if error.code == "HB-W103" else "collect", error)
    return members, wrong


def _fits(members: int, collectors: tuple[Collector, ...]) -> None:
    wide = sum(max(c.points, 1) for c in collectors)
    if members > MOST or members * wide > ROOM:
        raise UsageError(
            f"{members} members with {wide} values each are too many for the page",
            code="HB-W103",
            where="way",
            hint="the command below keeps them in a folder",
        )


def _take(model: Model, factor: Factor) -> None:
    """Refuse a path that there is not, or a value of another dimension."""
    middle = factor.quantile(np.array([0.5]))[0]
    value: Value = factor.shown(float(middle)) if factor.is_number else middle
    changed, left = with_parts(model, {factor.path: value})
    changed.flatten(parameters=left)


def _place(wanted: Wanted, error: HybondError) -> str:
    """Return where on the form a plan is wrong whose factors are right one by one."""
    paths = [path for path, _ in wanted.factors]
    if error.where in paths:  # varied twice: the later one is too many
        return f"path.{len(paths) - 1 - paths[::-1].index(error.where)}"
    return "way"


def offered(model: Model, graph: FlatGraph) -> dict[str, Any]:
    """Return what a form may say: paths with what they might take, ways, what can be collected."""
    paths = list(settable(model))
    switched = dict.fromkeys(
        f"{graph.nodes[n].path}.{s}" for m in graph.machines for n in m.controls for s in WHETHER
    )
    states = [f"{m.path}.{s}" for m in graph.machines for s in m.states]
    plotted = model.experiment.get("plot")
    first = [n for n in plotted if isinstance(n, str)] if isinstance(plotted, list) else []
    first = (first or names_of(graph))[:1]
    collect = [*(["sequence"] if graph.machines else []), *(f"final({name})" for name in first)]
    return {
        "paths": paths[:ROWS],
        "values": {p: around(v) for p in paths[:ROWS] if (v := _now(model, p)) is not None},
        "ways": WAYS,
        "collectors": {**{k: f"{k}(x): {v[2]}" for k, v in FUNCTIONS.items()}, **COLLECTORS},
        "words": [
            *WORDS,
            *(f"{name}(" for name in {**COLLECTORS, **FUNCTIONS} if name not in WORDS),
            *names_of(graph)[:ROWS],
            *("events", *(m.path for m in graph.machines), *states, *switched),
        ],
        "collect": ", ".join(collect) or "count(events)",
    }


def _now(model: Model, path: str) -> str | None:
    """Return what a parameter or an element has now, None if it is no plain number."""
    value: Any = model.parameters.get(path)
    if value is None:
        name, _, key = path.rpartition(".")
        part = model.elements.get(name)
        value = part.value if isinstance(part, Part) and part.kind == key else None
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    return str(value) if try_quantity(str(value)) is not None else None


def around(value: str) -> str:
    """Return levels from half of a value to twice of it, in its unit.

    Examples
    --------
    >>> around("3 kg"), around("0.3"), around("-2 V"), around("0 m")
    ('1.5 kg..6 kg:11', '0.15..0.6:11', '-4 V..-1 V:11', '-1 m..1 m:11')
    """
    found = _NUMBER.match(value)
    if found is None:
        return ""
    number, unit = float(found[0]), value[found.end() :].strip()
    low, high = sorted((0.5 * number, 2.0 * number)) if number else (-1.0, 1.0)
    ends = (f"{end:.6g} {unit}".strip() for end in (low, high))
    return f"{'..'.join(ends)}:{EVEN}"
