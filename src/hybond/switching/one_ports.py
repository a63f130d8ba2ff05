"""Switches with one bond: switched source, resistor behind a Boolean MTF, modulated R, C and I."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.constructors import TF, One, R
from hybond.model.kinds import STORAGES
from hybond.model.parts import Part, Value
from hybond.switching.drawn import (
    DrawnBond,
    add_all,
    bonds_of,
    choice,
    states_of,
    switch_on,
)


def switched_source(
    m: Model, name: str, *, bonds: str, machine: str, on: str | Sequence[str]
) -> None:
    """Add a switched source: a null effort source while ON, a null flow source while OFF.

    In series, at a 1-junction, it lets the flow through or stops it; in parallel, at a 0-junction,
    it shorts the effort or leaves it alone. Both are what a controlled junction with a single bond
    says (ON: its efforts sum to zero; OFF: zero flow), so that is what is added. At a 1-junction
    the result equals making that junction itself a controlled one.

    Parameters
    ----------
    m : Model
    name : str
        ``name.e`` is the effort that the open switch blocks, whichever way the arrow points;
        ``name.f`` the flow through the closed one, along the arrow.
    bonds : str
        Its bond as drawn, ``"i -> sw"`` or ``"sw -> i"``.
    machine : str
        A machine that exists already.
    on : str or sequence of str
        The states in which it is a null effort source.

    Raises
    ------
    ModelError
        HB-M190 if not one bond is drawn, HB-M144 for a machine or state that does not exist.

    Notes
    -----
    J.-E. Strömberg, J. Top and U. Söderman, *Variable causality in bond graphs caused by discrete
    effects*, ICBGM 1993; J. Buisson, H. Cormerais and P.-Y. Richard, *Analysis of the bond graph
    model of hybrid physical systems with ideal switches*, 2002. Causality is dynamic: the stroke of
    its bond turns with the state. It costs one node and one bond.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("coil", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), R=hb.R("5 ohm"), L=hb.I("1 H", f="2 A"), i=hb.One())
    >>> m.bond("V -> i -> L", "i -> R")
    >>> m.machine("S", states={"closed": [], "open": []}, start="closed",
    ...           rules=["closed -> open when time >= 1"])
    >>> hb.switching.switched_source(m, "sw", bonds="i -> sw", machine="S", on="closed")
    >>> run = hb.simulate(m, until=2)
    >>> run["L.f"].at(0.5), run["L.f"].at(1.5), run["sw.e"].at(1.5)
    (2.0, 0.0, 10.0)
    """
    states = states_of(m, machine, on, name)
    add_all(m, {name: One()}, bonds_of(name, bonds, count=1))
    switch_on(m, machine, states, name)


def boolean_mtf_resistor(
    m: Model,
    name: str,
    *,
    bonds: str,
    machine: str,
    on: str | Sequence[str],
    resistance: Value | Part,
    off: Literal["open", "short"] = "open",
) -> None:
    """Add a switch as a resistor behind a transformer whose modulus is 1 or 0.

    While ON the resistor stands there; while OFF nothing flows (``off="open"``: the port of the
    zero flow faces the model) or no effort is left (``"short"``: the other one). The resistor
    takes the change of causality, so no stroke turns: all modes have one causality, and one
    structure of equations, wherever the junction's effort (``"short"``: flow) is given by others.
    It equals the same resistor behind a controlled junction, exactly.

    Parameters
    ----------
    m : Model
    name : str
        The transformer; the resistor is ``name_r``.
    bonds : str
        Its bond as drawn, ``"node -> sw"``.
    machine, on
        See `switched_source`.
    resistance : number, quantity, expression or Part
        The ON resistance, or the resistor itself, ``hb.R("1 ohm", domain="electrical")``.
    off : {"open", "short"}

    Raises
    ------
    ModelError
        HB-M190, HB-M144 as for `switched_source`; HB-M191 for another `off`.

    Notes
    -----
    G. Dauphin-Tanguy and C. Rombaut, 1997; W. Borutzky, *Bond Graph Methodology*, Springer 2010,
    chapter 7. Static causality; stiff if the resistance is small.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("discharge", domain="electrical")
    >>> m.add(c=hb.C("1 F", e="1 V"), node=hb.Zero())
    >>> m.bond("node -> c")
    >>> m.machine("S", states={"open": [], "closed": []}, start="open",
    ...           rules=["open -> closed when time >= 1"])
    >>> hb.switching.boolean_mtf_resistor(m, "sw", bonds="node -> sw", machine="S", on="closed",
    ...                                   resistance="1 ohm")
    >>> run = hb.simulate(m, until=2)
    >>> run["c.e"].at(1.0), round(run["c.e"].at(2.0), 6)
    (1.0, 0.367879)
    """
    states = states_of(m, machine, on, name)
    outer, inner = ("2", "1") if choice(off, ("open", "short"), name) == "open" else ("1", "2")
    (bond,) = bonds_of(name, bonds, count=1)
    resistor = resistance if isinstance(resistance, Part) else R(resistance)
    parts = {name: TF(1.0), f"{name}_r": resistor}
    behind = DrawnBond("", f"{name}.{inner}", f"{name}_r")
    add_all(m, parts, [bond.moved(name, f"{name}.{outer}"), behind])
    switch_on(m, machine, states, name)


def modulated_resistor(
    m: Model,
    name: str,
    *,
    bonds: str,
    machine: str,
    on: str | Sequence[str],
    r_on: Value,
    r_off: Value,
) -> None:
    """Add a resistor with one value while ON and another while OFF.

    As a model of an ideal switch it is an approximation: its error falls with the first power of
    `r_on` and of ``1/r_off``, and its equations get stiffer by as much. As a model of a part that
    does have these resistances it is exact.

    Parameters
    ----------
    m : Model
    name : str
    bonds, machine, on
        See `switched_source`.
    r_on, r_off : number, quantity or expression of parameters
        They become the parameters ``name_on`` and ``name_off`` of the model.

    Raises
    ------
    ModelError
        HB-M190, HB-M144 as for `switched_source`.

    Notes
    -----
    J. U. Thoma, *Simulation by Bondgraphs*, Springer 1990; P. Dransfield. Static causality. Choose
    the resistances by the tolerance wanted; a solver for stiff models (``solver="radau"``) helps.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("lamp", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), lamp=hb.R("10 ohm"), i=hb.One())
    >>> m.bond("V -> i -> lamp")
    >>> m.machine("S", states={"closed": [], "open": []}, start="closed",
    ...           rules=["closed -> open when time >= 1"])
    >>> hb.switching.modulated_resistor(m, "sw", bonds="i -> sw", machine="S", on="closed",
    ...                                 r_on="1 mohm", r_off="1 Mohm")
    >>> run = hb.simulate(m, until=2)
    >>> round(run["lamp.f"].at(0.5), 6), round(run["lamp.f"].at(1.5), 6)
    (0.9999, 1e-05)
    """
    states = states_of(m, machine, on, name)
    drawn_bonds = bonds_of(name, bonds, count=1)
    closed = " or ".join(f'{machine}.state == "{s}"' for s in states)
    values = {f"{name}_on": r_on, f"{name}_off": r_off}
    for parameter in values:
        m._new_name(parameter)
    add_all(m, {name: R(f"if {closed} then {name}_on else {name}_off")}, drawn_bonds)
    m.parameter(**values)


def switched_storage(
    m: Model, name: str, *, bonds: str, machine: str, on: str | Sequence[str], element: Part
) -> None:
    """Add a C or I that exists while ON; while OFF its stored quantity is held at zero.

    Opening throws away what is stored, all at once: the charge of a C, the flux or momentum of an
    I. The record of that step says how much, ``lost 2 J``, and through which bond it went. It
    equals a controlled junction in front of the element: a 0-junction (no effort while OFF) for a
    C, a 1-junction (no flow) for an I. To *keep* a capacitor's charge, use `switched_bond`.

    Parameters
    ----------
    m : Model
    name : str
    bonds, machine, on
        See `switched_source`.
    element : Part
        ``hb.C(...)`` or ``hb.I(...)``, with its start value.

    Raises
    ------
    ModelError
        HB-M190, HB-M144 as for `switched_source`; HB-M191 for an element that stores nothing.

    Notes
    -----
    P. J. Gawthrop, *Hybrid bond graphs using switched I and C components*, 1997: the components ISW
    and CSW of MTT. MTT's third logic value, open while the state would be negative, is a rule, such
    as ``"closed -> open when L.f < 0"``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("coil", domain="electrical")
    >>> m.add(i=hb.One(), R=hb.R("1 ohm"))
    >>> m.bond("i -> R")
    >>> m.machine("S", states={"closed": [], "open": []}, start="closed",
    ...           rules=["closed -> open when time >= 1 ms"])
    >>> hb.switching.switched_storage(m, "L", bonds="i -> L", machine="S", on="closed",
    ...                               element=hb.I("1 H", f="2 A"))
    >>> run = hb.simulate(m, until="2 ms")
    >>> round(run.events[1].steps[0].energy.lost, 3), run["L.p"].at(2e-3)
    (1.996, 0.0)
    """
    states = states_of(m, machine, on, name)
    if not isinstance(element, Part) or element.kind not in STORAGES:
        raise ModelError(
            f"{getattr(element, 'kind', element)!r} stores nothing",
            code="HB-M191",
            where=name,
            hint="give hb.C(...) or hb.I(...)",
        )
    add_all(m, {name: element}, bonds_of(name, bonds, count=1))
    switch_on(m, machine, states, name)
