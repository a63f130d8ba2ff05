"""What is known of the end of a run, in numbers, beside its code, reason and place.

Only where somebody puts it into words: `tells` of the model. The numbers of each code, in order:

HB-C101    the states of the mode; the difference; of each source: its column, its element
HB-J101    the rule, or ``-1 - k`` for integrated signal k
HB-J102    the rule; when (1 at the instant, 2 before it); bond variables that are open;
           the rule or ``-1 - k`` for the gap of port k; 3; integrated signals that are open
HB-J110/2  0 impulses, 1 finite values; the ports that take part
HB-J111    the rules that held, in the order in which they were found
HB-M205    the port; how fast its gap opens; how fast its bonds close
HB-N201    the step, s; the state that dominates the error, or -1; how soon it settles, s, if soon
HB-N202    the step, s, 0 at the start of a motion; the state whose rate has no value, or -1
HB-N203    the bond variable; its value
HB-N301    the states of the mode; its elements that have laws
HB-N302    the states of the mode; the element, NO_ELEMENT or OVERFLOW; its value;
           of a guard that compares what is no number as HB-J101
HB-N303/4  the states of the mode
HB-N305    the signal; its value
HB-N405    the surfaces
HB-N406    the rules that hold
HB-N407    the machine; the limit; that of breaking loose
HB-N408    1 if no end of a slip is found, 0 if no step follows it; the machines that slip
HB-N409    the mean step, s; how many steps lead nowhere, if that is why
HB-N410    the integrated signal whose rate jumps; nothing if it is another that does
HB-N412    the machine; the restitution
HB-N415    the machine; the surfaces slid on
HB-N417    the port; the surfaces
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import grow_block
from hybond.engine.answers import stored_name
from hybond.engine.complementarity.law_roles import ONE_SIDED, TWO_SIDED
from hybond.engine.engine import REFUSED, Engine, Fault, say_fault
from hybond.engine.laws.law_records import Laws
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Text

NO_ELEMENT: Final = -1
"""In place of an element: the derivative of a constraint has no value."""
OVERFLOW: Final = -2
"""The equations as a whole have none."""


def add_fact(f: Fault, number: float) -> None:
    """Add a number to what is known of a fault."""
    grow_block(f.about, f.many + 1)
    f.about.at[f.many] = number
    f.many += 1


def add_mode(e: Engine, mode: Mode) -> None:
    """Add the states of machines in a mode to what is known."""
    for k in range(e.model.machines):
        add_fact(e.fault, float(mode.state[k]))


def copy_fault(f: Fault, g: Fault) -> None:
    """Make `g` what `f` is."""
    g.code = f.code
    g.why = f.why
    g.place = f.place
    g.t = f.t
    g.many = 0
    for k in range(f.many):
        add_fact(g, f.about.at[k])


def disagree(e: Engine, mode: Mode, r: int, difference: float, why: Text) -> int:
    """Refuse sources that prescribe one variable differently, by row r of the mode's agreements."""
    m = e.model
    say_fault(e, "HB-C101", why, "")
    add_mode(e, mode)
    add_fact(e.fault, difference)
    for i in range(mode.agreements.first.at[r], mode.agreements.first.at[r + 1]):
        column = mode.agreements.column.at[i]
        source = mode.source[column - m.storages]
        if source >= 0:
            add_fact(e.fault, float(column))
            add_fact(e.fault, float(m.source_node[source]))
    return REFUSED


def refuse_jump(e: Engine, mode: Mode, code: Text, why: Text) -> int:
    """Refuse a mode into which no jump leads."""
    say_fault(e, code, why, "")
    add_mode(e, mode)
    return REFUSED


def tell_laws(e: Engine, mode: Mode) -> None:
    """Tell the mode, and its elements whose laws are evaluated."""
    m = e.model
    add_mode(e, mode)
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            add_fact(e.fault, float(m.dynamic_node[mode.dynamic[i]]))


def tell_law(e: Engine, mode: Mode, element: int, number: float) -> None:
    """Tell the mode, and the element whose law has that value, or no finite slope."""
    add_mode(e, mode)
    add_fact(e.fault, float(element))
    add_fact(e.fault, number)


def no_sample(e: Engine, signal: int, number: float, why: Text) -> int:
    """Refuse a value that a signal cannot be set to."""
    say_fault(e, "HB-N305", why, stored_name(e.model, e.model.storages + signal))
    add_fact(e.fault, float(signal))
    add_fact(e.fault, number)
    return REFUSED


def tell_ports(e: Engine, r: Laws, impulses: bool) -> None:
    """Tell which laws of junctions, taking part, have no solution."""
    add_fact(e.fault, 0.0 if impulses else 1.0)
    for k in range(e.model.ports):
        takes = r.role[k] == ONE_SIDED or r.role[k] == TWO_SIDED
        if takes if impulses else r.able[k] != 0:
            add_fact(e.fault, float(k))
