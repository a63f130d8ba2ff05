"""Regions of dynamic causality: eliminating switch variables where they meet.

Switch variables that appear in each other's closing rows form a region. In each combination of
its machines' states (few: a region is local) the region's variables are eliminated:

* from the closing rows, if those give them: the region is *explicit*, no causality of storage
  changes there;
* else from the rates of the storage that the region reaches: that storage is in derivative
  causality in this combination, its rate row gives way to the constraint that was left over, and
  its rate appears in other rows (the pseudo-state of Margetts & Ngwompo).

What cannot be eliminated so, because the region is large, or because in some combination nothing
determines a variable (a floating node) or two sources contradict each other, is *kept*: the
variable joins the states, with its closing row. That is never wrong, only less compact.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from hybond.equations.element_rows import Closing
from hybond.equations.patterns import MOST_PATTERNS, Space, space_of
from hybond.equations.ring import Ring, Row, substituted
from hybond.equations.switch_form import SwitchForm
from hybond.model.joined import Joined

T = TypeVar("T")


@dataclass(slots=True)
class Region(Generic[T]):
    """Some switch variables and tears with the rows that close them, eliminated together."""

    space: Space
    """The combinations of machine states that matter to it."""
    switches: tuple[int, ...]
    tears: tuple[int, ...]
    constraints: tuple[int, ...]
    """Positions in `SwitchForm.constraints`."""
    values: list[dict[int, Row[T]]] = field(default_factory=list)
    """Per combination: each variable as a row of knowns and, if storage gave way, rates."""
    replaced: list[dict[int, Row[T]]] = field(default_factory=list)
    """Per combination: target columns whose row gives way, to the constraint that takes its
    place."""
    undetermined: list[tuple[int, ...]] = field(default_factory=list)
    void: dict[int, str] = field(default_factory=dict)
    """Combinations in which sources contradict each other, or nothing determines what a rate reads,
    with the reason: the eliminated form has no rows there."""
    why_kept: str = ""
    """Empty if it was eliminated."""

    @property
    def variables(self) -> tuple[int, ...]:
        """Switch variables and tears."""
        return self.switches + self.tears


class _Stuck(Exception):
    """A combination in which the region's variables cannot be eliminated."""


class _Void(_Stuck):
    """A combination that has no solution, or too many, whatever is eliminated."""


def regions_of(form: SwitchForm[T], *, compact: bool = False) -> list[Region[T]]:
    """Group the switch variables of `form` into regions and eliminate what can be.

    Regions that cannot be eliminated by themselves (other switches reach the same storage, a
    pivot vanishes) are joined with their neighbours, as long as the result is small.

    Parameters
    ----------
    compact : bool
        Whether a region may be eliminated though some of its combinations have no solution
        (`Region.void`); else it is kept.
    """
    groups = _groups(form)
    touched = _touched(form)
    owner = {v: k for k, g in enumerate(groups) if g is not None for v in (*g.switches, *g.tears)}
    found: dict[int, Region[T]] = {}
    waiting = deque(range(len(groups)))
    while waiting:
        k = waiting.popleft()
        group = groups[k]
        if group is None:
            continue
        region = _region(form, group)
        found[k] = region
        if region.why_kept:
            continue
        mine = set(region.variables)
        exclusive = {
            target
            for v in region.variables
            for target in touched.get(v, ())
            if touching(touched, target) <= mine
        }
        try:
            near = {t for v in region.variables for t in touched.get(v, ())}
            _eliminate(form, region, near, exclusive, compact=compact)
        except _Stuck as stuck:
            # another region reaches the same storage: eliminate both together
            others = _neighbours(group, touched, owner, k)
            joined = _joined(form, groups, k, others)
            if joined is None:
                region.why_kept = str(stuck)
                region.values, region.replaced, region.void = [], [], {}
                continue
            groups[k] = joined
            owner.update((v, k) for v in (*joined.switches, *joined.tears))
            for other in others:
                groups[other] = None
                found.pop(other, None)
            waiting.appendleft(k)
    return [found[k] for k in sorted(found)]


@dataclass(slots=True)
class _Group:
    switches: list[int]
    tears: list[int]
    constraints: list[int]


class _Touch(dict[int, set[int]]):
    """Variable to targets, with the reverse beside it."""

    def __init__(self) -> None:
        super().__init__()
        self.back: dict[int, set[int]] = {}


def touching(touched: _Touch, target: int) -> set[int]:
    """Return the switch variables and tears in the row of a target."""
    return touched.back.get(target, set())


def _variables(form: SwitchForm[T]) -> set[int]:
    return set(form.switches) | set(form.tears)


def _touched(form: SwitchForm[T]) -> _Touch:
    variables = _variables(form)
    found = _Touch()
    for target, row in form.targets.items():
        inside = {k for k in row if k in variables}
        if inside:
            found.back[target] = inside
            for k in inside:
                found.setdefault(k, set()).add(target)
    return found


def _groups(form: SwitchForm[T]) -> list[_Group | None]:
    """Return connected groups: variables that share a closing row or a constraint."""
    variables = _variables(form)
    joined: Joined[object] = Joined()
    for s in form.switches:
        closer = form.closer(s)
        space = _space(form, [s])
        inside: set[object] = {s}
        for states in space.states():
            at = dict(zip(space.machines, states, strict=True))
            row = form.closing(s, tuple(at[m] for m in closer.machines))
            inside |= {k for k in row if k in variables}
        joined.join(inside)
    targets = {_storage_column(form, t): t for t in form.targets}
    for k, row in enumerate(form.constraints):
        name = ("constraint", k)
        joined.join([name, *(j for j in row if j in variables)])
        for column in row:
            # the tear that the constraint's storage would give way to
            target = targets.get(column)
            if target is not None:
                joined.join([name, *(v for v in form.targets[target] if v in form.tears)])
    groups: dict[object, _Group] = {}
    for s in form.switches:
        groups.setdefault(joined.root(s), _Group([], [], [])).switches.append(s)
    for t in form.tears:
        groups.setdefault(joined.root(t), _Group([], [], [])).tears.append(t)
    for k in range(len(form.constraints)):
        groups.setdefault(joined.root(("constraint", k)), _Group([], [], [])).constraints.append(k)
    return list(groups.values())


def _storage_column(form: SwitchForm[T], target: int) -> int:
    """Return the column of what a target's element imposes: the other half of its port."""
    own = form.column(target)
    assert own is not None
    kind = "storage" if own.kind == "rate" else "resistor"
    return form.partner[(kind, own.index, own.port)]


def _space(form: SwitchForm[T], switches: list[int]) -> Space:
    at_machine: dict[int, list[Closing[T]]] = {}
    for s in switches:
        closer = form.closer(s)
        for machine in closer.machines:
            at_machine.setdefault(machine, []).append(closer)

    def key(machine: int, state: int) -> object:
        return tuple(
            closer.key((state,)) if len(closer.machines) == 1 else state
            for closer in at_machine[machine]
        )

    return space_of(form.graph, sorted(at_machine), key)


def _region(form: SwitchForm[T], group: _Group) -> Region[T]:
    space = _space(form, group.switches)
    region = Region[T](space, tuple(group.switches), tuple(group.tears), tuple(group.constraints))
    if space.count > MOST_PATTERNS:
        region.why_kept = f"{len(group.switches)} switches meet here"
    elif len(group.tears) != len(group.constraints):
        region.why_kept = "the structure determines too little here, or too much"
    return region


def _neighbours(group: _Group, touched: _Touch, owner: dict[int, int], k: int) -> list[int]:
    """Return the groups that reach the same storage as group k."""
    reach = {t for v in (*group.switches, *group.tears) for t in touched.get(v, ())}
    return sorted({owner[v] for t in reach for v in touching(touched, t)} - {k})


def _joined(
    form: SwitchForm[T], groups: list[_Group | None], k: int, others: list[int]
) -> _Group | None:
    parts = [g for j in (k, *others) if (g := groups[j]) is not None]
    if len(parts) == 1:
        return None
    joined = _Group(
        sorted(s for g in parts for s in g.switches),
        sorted(t for g in parts for t in g.tears),
        sorted(c for g in parts for c in g.constraints),
    )
    return joined if _space(form, joined.switches).count <= MOST_PATTERNS else None


# -- elimination within one region


def _eliminate(
    form: SwitchForm[T],
    region: Region[T],
    near: set[int],
    exclusive: set[int],
    *,
    compact: bool,
) -> None:
    region.values, region.replaced, region.undetermined, region.void = [], [], [], {}
    for pattern, states in enumerate(region.space.states()):
        at = dict(zip(region.space.machines, states, strict=True))
        rows = [
            form.closing(s, tuple(at[m] for m in form.closer(s).machines)) for s in region.switches
        ]
        rows += [form.constraints[k] for k in region.constraints]
        solved, left = _gauss(form.ring, rows, set(region.variables))
        open_ = [v for v in region.variables if v not in solved]
        replaced: dict[int, Row[T]] = {}
        lost: tuple[int, ...] = ()
        if open_ or left:
            try:
                lost = _give_way(form, solved, left, open_, replaced, near, exclusive)
            except _Void as void:
                if not compact or len(region.void) + 1 == region.space.count:
                    raise
                region.void[pattern] = str(void)
                solved, replaced = {}, {}
        region.values.append(solved)
        region.replaced.append(replaced)
        region.undetermined.append(lost)


def _gauss(
    ring: Ring[T], rows: list[Row[T]], variables: set[int]
) -> tuple[dict[int, Row[T]], list[Row[T]]]:
    """Solve `rows` for `variables`: the solved ones, and rows that are left without any."""
    solved: dict[int, Row[T]] = {}
    left: list[Row[T]] = []
    for row in sorted(rows, key=len):
        reduced = substituted(ring, row, solved)
        inside = {k: c for k, c in reduced.items() if k in variables}
        if not inside:
            if reduced:
                left.append(reduced)
            continue
        pivot = _pivot(ring, inside)
        c = reduced[pivot]
        value = {k: -d / c for k, d in reduced.items() if k != pivot}  # type: ignore[operator]
        for k in solved:
            if pivot in solved[k]:
                solved[k] = substituted(ring, solved[k], {pivot: value})
        solved[pivot] = value
    return solved, left


def _pivot(ring: Ring[T], inside: Row[T]) -> int:
    sizes = {k: ring.size(c) for k, c in inside.items()}
    biggest = max(sizes.values())
    fit = [k for k in inside if sizes[k] >= 0.1 * biggest > 0.0]
    if not fit:
        raise _Stuck("a pivot vanishes at the model's own values")
    return min(fit, key=lambda k: (not ring.steady(inside[k]), ring.cost(inside[k]), k))


def _give_way(
    form: SwitchForm[T],
    solved: dict[int, Row[T]],
    left: list[Row[T]],
    open_: list[int],
    replaced: dict[int, Row[T]],
    near: set[int],
    exclusive: set[int],
) -> tuple[int, ...]:
    """Eliminate `open_` from rate rows; the rows in `left` take the place of those used.

    Returns the variables that nothing determines and no rate reads.
    """
    ring = form.ring
    all_rates = {t: substituted(ring, form.targets[t], solved) for t in sorted(near)}
    rates = {t: row for t, row in all_rates.items() if t in exclusive}
    reads = {v for row in all_rates.values() for v in row}
    lost = [v for v in open_ if v not in reads]
    constrained = {c for row in left for c in row}
    used: list[int] = []
    for v in open_:
        if v in lost:
            continue
        holders = [t for t in rates if t not in used and v in rates[t]]
        if not holders and any(v in substituted(ring, r, solved) for r in all_rates.values()):
            raise _Stuck("storage that several switches reach would have to give way")
        if not holders:
            lost.append(v)
            continue
        target = min(
            holders,
            key=lambda t: (
                form.column(t).kind != "intake",  # type: ignore[union-attr]
                _storage_column(form, t) not in constrained,
                not ring.steady(rates[t][v]),
                ring.cost(rates[t][v]),
                t,
            ),
        )
        # target = value: so v = (target - rest) / c
        c = rates[target][v]
        value = {k: -d / c for k, d in rates[target].items() if k != v}  # type: ignore[operator]
        value[target] = ring.one / c  # type: ignore[operator]
        for k in solved:
            solved[k] = substituted(ring, solved[k], {v: value})
        solved[v] = value
        for t in rates:
            if t != target:
                rates[t] = substituted(ring, rates[t], {v: value})
        used.append(target)
    if len(used) != len(left):
        if any(_is_law(form, c) for row in left for c in row):
            raise _Stuck("a nonlinear law decides here")
        raise _Void(
            "nothing determines a switch variable"
            if len(used) > len(left)
            else "sources contradict each other"
        )
    open_rows = list(left)
    for target in used:
        own = _storage_column(form, target)
        row = next((r for r in open_rows if own in r), open_rows[0])
        open_rows.remove(row)
        replaced[target] = row
    for v in lost:
        for k in solved:
            solved[k].pop(v, None)
        solved[v] = {}
    return tuple(lost)


def _is_law(form: SwitchForm[T], column: int) -> bool:
    own = form.column(column)
    return own is not None and own.kind == "law"


def space_of_switch(form: SwitchForm[T], switch: int) -> Space:
    """Return the combinations of machine states that matter to one switch variable."""
    return _space(form, [switch])
