"""The other ways to write a switch in a bond graph, each made of controlled junctions.

Every function takes a `Model`, the name of the new part, how it is bonded (``bonds``, as bonds are
drawn, with the part's name in them) and which states of which machine switch it ON. What it adds
are ordinary nodes, bonds and lists of a machine, so the model can be drawn, saved and analysed
like any other.
"""

from hybond.switching.automaton import global_automaton
from hybond.switching.causality_resistance import (
    CausalityResistance,
    StiffMode,
    add_causality_resistance,
)
from hybond.switching.impulses import (
    BondImpulse,
    ImpulseBondGraph,
    impulse_bond_graph,
)
from hybond.switching.junctions import (
    switched_bond,
    switched_power_junction,
    time_dependent_junction,
)
from hybond.switching.one_ports import (
    boolean_mtf_resistor,
    modulated_resistor,
    switched_source,
    switched_storage,
)
from hybond.switching.petri import petri_net
from hybond.switching.two_ports import boolean_mtf

__all__ = [
    "BondImpulse",
    "CausalityResistance",
    "ImpulseBondGraph",
    "StiffMode",
    "add_causality_resistance",
    "boolean_mtf",
    "boolean_mtf_resistor",
    "global_automaton",
    "impulse_bond_graph",
    "modulated_resistor",
    "petri_net",
    "switched_bond",
    "switched_power_junction",
    "switched_source",
    "switched_storage",
    "time_dependent_junction",
]
