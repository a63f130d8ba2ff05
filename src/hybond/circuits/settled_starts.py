"""What has no memory begins as it is, before what has any looks at it.

At the start all machines of a model fire together, from the states that are written for them. A
switch with a hysteresis that follows a comparison, or another switch, would see first what that has
in its written state, and keep what it made of it. So comparisons, and switches without hysteresis,
are written in the states that they have while the others stand as the netlist says.
"""

from __future__ import annotations

import re
from copy import copy
from dataclasses import replace

from hybond.errors import HybondError
from hybond.model.builder import Model
from hybond.model.parts import MachinePart

_COMPARED = re.compile(r" (?:<=|>=|<|>) ")
AT_ONCE = 1e-15
"""How long the run is that settles them, s: only its first instant is looked at."""


def settle_starts(model: Model) -> None:
    """Let machines of a model without memory begin in the states that they would go to at once.

    Where these are not found the run will say why, and nothing is changed.
    """
    free = {name for name, machine in model.machines.items() if not remembers(machine)}
    kept = model.machines.keys() - free
    if not free or not kept:
        return
    from hybond.simulation import simulate

    held = copy(model)
    held.machines = {
        name: machine if name in free else replace(machine, rules=())
        for name, machine in model.machines.items()
    }
    try:
        run = simulate(held, until=AT_ONCE)
    except HybondError:
        return
    last = run.events[0].steps[-1].mode
    for machine, state in zip(run.graph.machines, last, strict=True):
        if machine.path in free:
            found = machine.states[state]
            model.machines[machine.path] = replace(model.machines[machine.path], start=found)


def remembers(machine: MachinePart) -> bool:
    """Whether a machine of a netlist may be in either state at some level.

    It has two thresholds, or keeps from where it came to its only one.

    Examples
    --------
    >>> remembers(MachinePart({"a": (), "b": ()}, "a", ["a -> b when v > 2", "b -> a when v <= 2"]))
    False
    >>> remembers(MachinePart({"a": (), "b": ()}, "a", ["a -> b when v > 2", "b -> a when v < 1"]))
    True
    """
    if len(machine.rules) != 2:
        return True
    there, back = (rule.partition(" when ")[2] for rule in machine.rules)
    return _COMPARED.sub(" ? ", there) != _COMPARED.sub(" ? ", back)
