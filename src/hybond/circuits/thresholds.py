"""The machine of a switch, and its side while what it follows rests at its only threshold.

Two thresholds keep a switch as it was at either of them. One threshold has no third side: what
comes back to it, as a gate of 0 V and 5 V to the default of 0 V, has left the side above, and what
comes up to it as its highest level has left the side below. A gate of -5, 0 and 5 V does both: such
a switch remembers from where it came, as in ngspice. Only what is given has such machines, for what
a switch has an effect on may slide along its threshold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybond.circuits.given import Given
from hybond.circuits.ideal import IdealSwitch
from hybond.circuits.levels import SAME
from hybond.circuits.opened import Branch
from hybond.model.parts import MachinePart

FALLEN = "at_threshold_from_above"
RISEN = "at_threshold_from_below"


@dataclass(frozen=True, slots=True)
class Rest:
    """What a switch with one threshold does there."""

    up: str = ">"
    down: str = "<="
    """The comparisons by which it goes above its threshold, and below it."""
    remembers: bool = False
    """Whether it does so by where it came from."""
    told: bool = False
    """Whether its signal is known to rest there."""


def rest_of(branch: Branch, ideal: IdealSwitch, given: Given) -> Rest:
    """Return what a switch with one threshold does there."""
    if branch.kind == "w":
        terms = given.current(branch.senses[0])
    else:
        terms = given.voltage(*branch.senses[:2])
    if terms is None:
        return Rest()
    levels = given.levels.of_sum(terms)
    decided = given.levels.truths.isdisjoint(terms)
    if levels is None:  # computed, or no sum of sources: it may come to rest anywhere
        return Rest(remembers=decided and not given.levels.truths)
    near = SAME * max((abs(x) for x in (*levels, ideal.on)), default=0.0)
    if not any(abs(x - ideal.on) <= near for x in levels):
        return Rest()
    above = any(x > ideal.on + near for x in levels)
    below = any(x < ideal.on - near for x in levels)
    if above and below:
        return Rest(remembers=decided, told=True)
    return Rest(">=", "<", told=True) if below else Rest(told=above)


def opens_again(ideal: IdealSwitch, name: str) -> str:
    """Return what is told of a switch that looks at its own voltage, if it opens once it closes."""
    if ideal.inverted or ideal.off <= 0.0:
        return ""
    flow = ""
    if ideal.resistance is not None and ideal.resistance.number:
        flow = f" below {ideal.off / ideal.resistance.number:.5g} A"
    return (
        f"{name} follows its own voltage: closed it opens again at once{flow}, as then less than "
        f"{ideal.off:g} V is across it; VT=0 without VH makes it an ideal diode"
    )


def machine_of(
    sensed: str, on: str | float, off: str | float, junction: str, ideal: IdealSwitch, rest: Rest
) -> MachinePart:
    """Return the machine of a switch that is below its thresholds."""
    above, below = ("open", "closed") if ideal.inverted else ("closed", "open")
    if ideal.on != ideal.off:
        rest = Rest(">", "<")
    states: dict[str, Sequence[str]] = {"open": (), "closed": (junction,)}
    if not rest.remembers:
        rules = (
            f"{below} -> {above} when {sensed} {rest.up} {on}",
            f"{above} -> {below} when {sensed} {rest.down} {off}",
        )
        return MachinePart(states, below, rules)
    states |= {RISEN: states[above], FALLEN: states[below]}
    remembering = (
        f"{below} -> {above} when {sensed} > {on}",
        f"{below} -> {RISEN} when {sensed} >= {on}",
        f"{above} -> {below} when {sensed} < {on}",
        f"{above} -> {FALLEN} when {sensed} <= {on}",
        *(f"{at} -> {above} when {sensed} > {on}" for at in (RISEN, FALLEN)),
        *(f"{at} -> {below} when {sensed} < {on}" for at in (RISEN, FALLEN)),
    )
    return MachinePart(states, FALLEN, remembering)


def started(machine: MachinePart, ideal: IdealSwitch, state: str) -> str:
    """Return the state in which a switch begins of which a netlist says ``on``, ``off`` or nothing.

    One that is at its threshold at the start has not come from anywhere: it is as it is said to be.
    """
    if len(machine.states) > 2:
        return RISEN if state == "on" else FALLEN
    return "closed" if (state == "on") != ideal.inverted else "open"
