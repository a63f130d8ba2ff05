"""Switches with two bonds: the Boolean transformer."""

from __future__ import annotations

from collections.abc import Sequence

from hybond.model.builder import Model
from hybond.model.constructors import TF
from hybond.model.parts import Value
from hybond.switching.drawn import add_all, bonds_of, states_of, switch_on


def boolean_mtf(
    m: Model,
    name: str,
    *,
    bonds: str | Sequence[str],
    machine: str,
    on: str | Sequence[str],
    modulus: Value = 1.0,
) -> None:
    """Add a transformer whose modulus is `modulus` while ON and zero while OFF.

    With ``e1 = m*e2, f2 = m*f1`` a zero modulus shorts side 1 (no effort) and opens side 2 (no
    flow). It is therefore *two* controlled junctions around a transformer, a 0-junction on side 1
    and a 1-junction on side 2, and is not symmetric: with a voltage source on side 2 and a coil on
    side 1 it is the ideal cell of a converter, switch and freewheeling path in one. With the source
    on side 1 the switch would short it, and hybond says so.

    Parameters
    ----------
    m : Model
    name : str
    bonds : str or sequence of str
        Its two bonds as drawn, ``"a -> sw -> b"``: the half arrow enters side 1. Or
        ``["a -> sw.2", "sw.1 -> b"]``, with ports in any direction.
    machine, on
        See `switched_source`.
    modulus : number, quantity or expression
        The modulus while ON.

    Raises
    ------
    ModelError
        HB-M190, HB-M144 as for `switched_source`.

    Notes
    -----
    A. Castelain, J.-P. Ducreux, G. Dauphin-Tanguy and C. Rombaut, *Modelling and analysis of power
    electronic networks by bond graph*, IMACS TC1 1990. Causality is dynamic in general.

    Examples
    --------
    A buck cell at a duty of one half:

    >>> import hybond as hb
    >>> m = hb.Model("buck", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), supply=hb.Zero(), i=hb.One(), L=hb.I("1 H"), R=hb.R("1 ohm"))
    >>> m.bond("V -> supply", "i -> L", "i -> R")
    >>> m.input(gate=hb.Input(pwm={"period": "2 s", "duty": 0.5}))
    >>> m.machine("S", states={"low": [], "high": []}, start="low",
    ...           rules=["low -> high when gate > 0.5", "high -> low when gate < 0.5"])
    >>> hb.switching.boolean_mtf(m, "cell", bonds=["supply -> cell.2", "cell.1 -> i"],
    ...                          machine="S", on="high")
    >>> run = hb.simulate(m, until=2)
    >>> round(run["L.f"].at(1.0), 5), round(run["L.f"].at(2.0), 5)
    (6.32121, 2.32544)
    """
    states = states_of(m, machine, on, name)
    add_all(m, {name: TF(modulus)}, bonds_of(name, bonds, count=2))
    switch_on(m, machine, states, name)
