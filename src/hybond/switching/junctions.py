"""Switched bonds, and junctions that change: selected by a machine, or by time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.constructors import One, Zero
from hybond.model.parts import Part, SubmodelPart, Value
from hybond.switching.drawn import (
    DrawnBond,
    add_all,
    bonds_of,
    choice,
    drawn,
    kind_at,
    states_of,
    switch_on,
)

_JUNCTION = {"0": Zero, "1": One}
_ALONE = {"0": "1", "C": "1", "Se": "1", "1": "0", "I": "0", "Sf": "0"}
"""The controlled junction that leaves a node as if the bond were not there: a 1-junction takes no
flow from what keeps an effort, a 0-junction no effort from what keeps a flow."""


def switched_bond(
    m: Model,
    name: str,
    *,
    bonds: str,
    machine: str,
    on: str | Sequence[str],
    absent: Literal["no flow", "no effort"] | None = None,
) -> None:
    """Add a bond that is present while ON and absent while OFF.

    Without the bond a 0-junction at its end is given no flow and a 1-junction no effort. So the
    bond is a controlled junction with two bonds: a 1-junction if that is what both ends need, a
    0-junction if both need the other, and one of each, ``name_f`` and ``name_e``, in a bond between
    a 0- and a 1-junction. (A single controlled 1-junction there would hold the flow of the whole
    1-junction at zero.) C and Se count as 0-junctions, I and Sf as 1-junctions; R, TF and GY take
    what the other end needs.

    Parameters
    ----------
    m : Model
    name : str
        The controlled junction.
    bonds : str
        The bond as drawn without the switch, ``"a -> b"``; both ends exist already.
    machine, on
        See `switched_source`.
    absent : {"no flow", "no effort"}, optional
        What holds at both ends while OFF, where the ends do not tell, or against what they tell.

    Raises
    ------
    ModelError
        HB-M190 if not one bond is drawn, HB-M144 for a machine or state that does not exist,
        HB-M191 if neither end tells what absence means.

    Notes
    -----
    J. F. Broenink and K. C. J. Wijbrans, *Describing discontinuities in bond graphs*, ICBGM 1993.
    Causality is dynamic. It costs one junction, between unlike ends two.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("tanks", domain="hydraulic")
    >>> m.add(a=hb.C("1 m^3/Pa", e="4 Pa"), b=hb.C("1 m^3/Pa"), left=hb.Zero(), right=hb.Zero())
    >>> m.bond("left -> a", "right -> b")
    >>> m.machine("valve", states={"shut": [], "open": []}, start="shut",
    ...           rules=["shut -> open when time >= 1"])
    >>> hb.switching.switched_bond(m, "pipe", bonds="left -> right", machine="valve", on="open")
    >>> run = hb.simulate(m, until=2)
    >>> m.elements["pipe"].kind, run["a.e"].at(0.5), run["b.e"].at(2.0)
    ('1', 4.0, 2.0)
    """
    states = states_of(m, machine, on, name)
    found = drawn(bonds, name)
    if len(found) != 1:
        raise ModelError(
            f"a switched bond is one bond, {len(found)} are drawn",
            code="HB-M190",
            where=name,
            hint='draw "a -> b"; give each bond of a chain its own name',
        )
    (bond,) = found
    if absent is not None:
        choice(absent, ("no flow", "no effort"), name)
        tail = head = "1" if absent == "no flow" else "0"
    else:
        ends = [_ALONE.get(kind_at(m, end), "") for end in (bond.tail, bond.head)]
        tail, head = ends[0] or ends[1], ends[1] or ends[0]
        if not tail:
            raise ModelError(
                f"neither {bond.tail!r} nor {bond.head!r} tells what an absent bond leaves there",
                code="HB-M191",
                where=name,
                hint='say absent="no flow" or absent="no effort", and add both ends first',
            )
    names = {"1": f"{name}_f", "0": f"{name}_e"} if tail != head else {tail: name}
    nodes = [names[k] for k in dict.fromkeys((tail, head))]
    add_all(m, {n: _JUNCTION[k]() for k, n in names.items()}, bond.cut(bond.head, *nodes))
    switch_on(m, machine, states, *nodes)


def switched_power_junction(
    m: Model,
    name: str,
    *,
    kind: Literal["0", "1"],
    machine: str,
    active: Mapping[str, str | Sequence[str]],
    bonds: str | Sequence[str] = (),
) -> None:
    """Add a junction with several deciding bonds, of which one is active at a time.

    The active bond decides the effort of a 0-junction (the flow of a 1-junction) and takes up the
    flows (efforts) of the others; the rest of the deciding bonds carry no power. Each deciding bond
    is a controlled junction of the other kind, and the machine is the selector: one hot, by
    construction.

    Parameters
    ----------
    m : Model
    name : str
        The junction; the deciding bonds get ``name_1``, ``name_2``, ...
    kind : {"0", "1"}
    machine : str
        The selector; a machine that exists already.
    active : mapping
        Each deciding bond as drawn, ``"V1 -> j"``, to the states in which it is active.
    bonds : str or sequence of str
        The other bonds.

    Raises
    ------
    ModelError
        HB-M192 for a state of the machine that selects none of the deciding bonds (gap) or more
        than one (overlap); HB-M190, HB-M144, HB-M191 as for the others.

    Notes
    -----
    A. C. Umarikar and L. Umanand, *Modelling of switching systems in bond graphs using the concept
    of switched power junctions*, J. Franklin Inst. 342, 2005. The paper asks the modeller for
    exclusive switch variables; here they are the states of one machine, and checked. Causality:
    dynamic at the deciding bonds only.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("leg", domain="electrical")
    >>> m.add(high=hb.Se("5 V"), low=hb.Se("-5 V"), load=hb.R("1 ohm"))
    >>> m.machine("gate", states={"up": [], "down": []}, start="up",
    ...           rules=["up -> down when time >= 1"])
    >>> hb.switching.switched_power_junction(
    ...     m, "leg", kind="0", machine="gate", bonds="leg -> load",
    ...     active={"high -> leg": "up", "low -> leg": "down"})
    >>> run = hb.simulate(m, until=2)
    >>> run["load.e"].at(0.5), run["load.e"].at(1.5)
    (5.0, -5.0)
    """
    choice(kind, ("0", "1"), name)
    switch = _JUNCTION["1" if kind == "0" else "0"]
    parts: dict[str, Part | SubmodelPart] = {name: _JUNCTION[kind]()}
    chains: list[DrawnBond] = []
    selects: dict[str, list[str]] = {}
    gates: list[tuple[str, tuple[str, ...]]] = []
    for k, (text, on) in enumerate(active.items(), 1):
        states = states_of(m, machine, on, name)
        (bond,) = bonds_of(name, text, count=1)
        gate = f"{name}_{k}"
        parts[gate] = switch()
        chains += bond.cut(name, gate)
        gates.append((gate, states))
        for state in states:
            selects.setdefault(state, []).append(text)
    known = m.machines[machine].states if active else ()
    wrong = [s for s in known if len(selects.get(s, ())) != 1]
    if wrong or not active:
        chosen = selects.get(wrong[0], []) if wrong else []
        what = " and ".join(repr(c) for c in chosen) or "no bond"
        raise ModelError(
            f"the state {wrong[0]!r} of {machine!r} makes {what} decide; it must be one"
            if wrong
            else "no bond can decide",
            code="HB-M192",
            where=name,
            hint="name each state of the machine at exactly one deciding bond",
        )
    chains += bonds_of(name, bonds, count=None) if bonds else []
    add_all(m, parts, chains)
    for gate, states in gates:
        switch_on(m, machine, states, gate)


def time_dependent_junction(
    m: Model,
    name: str,
    *,
    bonds: str | Sequence[str],
    schedule: Sequence[tuple[Value, str]],
) -> None:
    """Add a junction whose type is a function of time: 0, 1 or off.

    A junction that is only switched on and off is one controlled junction, ``name``. One that turns
    from 0 into 1 and back is ``name_0`` and ``name_1``, controlled junctions of which one is ON,
    with a 1-junction (``name_b1``, ...) at each bond and a controlled 0-junction between it and
    ``name_1``. The times are timed events, hit exactly, of the machine ``name_clock``.

    Parameters
    ----------
    m : Model
    name : str
    bonds : str or sequence of str
        All its bonds as drawn.
    schedule : sequence of (time, type)
        From each time on the junction is ``"0"``, ``"1"`` or ``"off"``; the first time is the
        start, the others are numbers, quantities or expressions of parameters, in order.

    Raises
    ------
    ModelError
        HB-M191 for another type, or ``"off"`` beside both 0 and 1 (would it be a short or an open
        circuit?); HB-M190 for a bond that does not end here.

    Notes
    -----
    J. U. Thoma, *Simulation by Bondgraphs*, Springer 1990. The field names the junction without
    saying what its bonds do in between; here they do what a junction of the new type says, and
    what was stored jumps as on entering any mode. Causality is dynamic.

    Examples
    --------
    Two resistors, first in series, then in parallel:

    >>> import hybond as hb
    >>> m = hb.Model("heater", domain="electrical")
    >>> m.add(V=hb.Se("12 V"), a=hb.R("2 ohm"), b=hb.R("4 ohm"))
    >>> hb.switching.time_dependent_junction(
    ...     m, "j", bonds=["V -> j -> a", "j -> b"], schedule=[(0, "1"), ("1 s", "0")])
    >>> run = hb.simulate(m, until=2)
    >>> run["V.f"].at(0.5), run["V.f"].at(1.5)
    (2.0, 9.0)
    """
    found = bonds_of(name, bonds, count=None)
    types = [choice(what, ("0", "1", "off"), name) for _, what in schedule]
    kinds = sorted(set(types) - {"off"})
    if not kinds or (len(kinds) == 2 and "off" in types):
        raise ModelError(
            "the schedule has no type" if not kinds else "off beside both types is ambiguous",
            code="HB-M191",
            where=name,
            hint='use "0" and "1", or one of them and "off"',
        )
    clock = f"{name}_clock"
    states = [f"t{k}" for k in range(len(types))]
    rules = [
        f"{states[k - 1]} -> {states[k]} when time >= {schedule[k][0]}"
        for k in range(1, len(schedule))
    ]
    parts: dict[str, Part | SubmodelPart] = {}
    chains: list[DrawnBond] = []
    switched: dict[str, list[str]] = {k: [f"{name}_{k}"] for k in kinds}
    if len(kinds) == 1:
        switched = {kinds[0]: [name]}
        parts[name] = _JUNCTION[kinds[0]]()
        chains = found
    else:
        parts = {f"{name}_0": Zero(), f"{name}_1": One()}
        for k, bond in enumerate(found, 1):
            at, gate = f"{name}_b{k}", f"{name}_d{k}"
            parts[at], parts[gate] = One(), Zero()
            chains.append(bond.moved(name, at))
            bare = DrawnBond("", bond.tail, bond.head)
            inside = bare.moved(bare.other(name), at)
            chains.append(inside.moved(name, f"{name}_0"))
            chains += inside.moved(name, f"{name}_1").cut(f"{name}_1", gate)
            switched["1"].append(gate)
    m._new_name(clock)
    add_all(m, parts, chains)
    m.machine(
        clock,
        states={s: switched.get(t, []) for s, t in zip(states, types, strict=True)},
        start=states[0],
        rules=rules,
    )
