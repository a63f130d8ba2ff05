"""Machines that fill, empty and join capacitors at once, in exact arithmetic.

Each capacitor has a constant current, so that charges are straight lines between events; rates,
levels and thresholds are halves, so that much happens at once. What is written here follows the
procedure of mode selection in docs/semantics.md and nothing of the engine: a state that is left as
soon as its values are known writes nothing, one that is left by ``pre()`` does.

A charge is a pair: its value and what it moves by just behind the instant, compared one after the
other. So a strict comparison holds where it is passed, and not where a reset has put the charge.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction

import hybond as hb

LEVELS = [Fraction(k, 2) for k in range(-2, 3)]
MOST = 300
"""Modes tried at an instant."""
AT_ONCE = 40
"""Instants without time between that are no run to compare."""
NAMES = "ABC"

Charge = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Guard:
    """``and`` or ``or`` of others, a charge against a level, the time, or a state of a machine."""

    kind: str
    place: int = 0
    above: bool = True
    level: Fraction = Fraction(0)
    state: str = ""
    parts: tuple[Guard, ...] = ()

    def text(self) -> str:
        """Return it as a rule of a model has it."""
        match self.kind:
            case "and" | "or":
                return f" {self.kind} ".join(part.text() for part in self.parts)
            case "charge":
                return f"c{self.place}.q {'>' if self.above else '<'} {float(self.level)}"
            case "time":
                return f"time >= {float(self.level)!r}"
        asked = f"{NAMES[self.place]}.state == '{self.state}'"
        return f"pre({asked})" if self.kind == "pre" else asked

    def atoms(self) -> list[Guard]:
        """Return what it compares."""
        return [a for part in self.parts for a in part.atoms()] if self.parts else [self]


@dataclass(frozen=True)
class Switch:
    """What puts a capacitor onto a voltage, or two onto one."""

    place: int
    voltage: Fraction | None


@dataclass(frozen=True)
class Machine:
    """States with the switches that are on there, and rules: from, to, when."""

    on: dict[str, tuple[int, ...]]
    rules: tuple[tuple[str, str, Guard], ...]


@dataclass(frozen=True)
class Net:
    """Capacitors with their currents and first charges, switches, machines."""

    capacity: tuple[Fraction, ...]
    current: tuple[Fraction, ...]
    charge: tuple[Fraction, ...]
    switches: tuple[Switch, ...]
    machines: tuple[Machine, ...]


@dataclass(frozen=True)
class Piece:
    """Charges at its begin, and their rates."""

    begin: Fraction
    end: Fraction
    charge: tuple[Fraction, ...]
    rate: tuple[Fraction, ...]


class NoRun(Exception):
    """Time cannot advance, sources disagree, or instants crowd: nothing to compare."""


def drawn(seed: int) -> Net:
    """Return a random net."""
    r = random.Random(seed)
    n = r.randint(1, 3)
    switches = [Switch(k, r.choice(LEVELS)) for k in range(n) if r.random() < 0.7]
    if n > 1 and r.random() < 0.4:
        switches.append(Switch(0, None))
    owned = list(range(len(switches)))
    r.shuffle(owned)
    many = r.randint(1, 3)
    machines = [_machine(r, j, many, n, owned[j::many]) for j in range(many)]
    return Net(
        tuple(r.choice([Fraction(1), Fraction(2), Fraction(1, 2)]) for _ in range(n)),
        tuple(r.choice([k for k in (-2, -1, 0, 1, 2)]) * Fraction(1, 2) for _ in range(n)),
        tuple(r.choice(LEVELS) for _ in range(n)),
        tuple(switches),
        tuple(machines),
    )


def _machine(r: random.Random, own: int, many: int, charges: int, switches: list[int]) -> Machine:
    names = [f"s{k}" for k in range(r.choice([2, 2, 3]))]
    on: dict[str, tuple[int, ...]] = {name: () for name in names}
    for s in switches:
        on[r.choice(names[1:])] += (s,)

    def charge() -> Guard:
        return Guard("charge", r.randrange(charges), r.random() < 0.5, r.choice(LEVELS))

    def other(state: str) -> Guard:
        return Guard("state", r.choice([k for k in range(many) if k != own]), state=state)

    def guard(name: str) -> Guard:
        if on[name] and r.random() < 0.8:
            return Guard("pre", own, state=name)
        kind = r.random()
        if kind < 0.25:
            return Guard(r.choice(["and", "or"]), parts=(charge(), charge()))
        if kind < 0.35:  # sevenths: nothing else is there
            return Guard(
                "and", parts=(Guard("time", level=Fraction(r.randint(1, 27), 7)), charge())
            )
        if kind < 0.55 and many > 1:
            return Guard("and", parts=(other(r.choice(["s0", "s1"])), charge()))
        return other("s1") if kind < 0.65 and many > 1 else charge()

    rules = [
        (name, r.choice([k for k in names if k != name]), guard(name))
        for name in names
        for _ in range(r.choice([1, 1, 1, 1, 2]))
    ]
    return Machine(on, tuple(rules))


def model_of(net: Net, seed: int) -> hb.Model:
    """Return the net as a model, some bonds turned round."""
    r = random.Random(seed)
    m = hb.Model("net")
    for k, capacity in enumerate(net.capacity):
        m.add(**{f"c{k}": hb.C(float(capacity), q=float(net.charge[k]))})
        m.add(**{f"z{k}": hb.Zero(), f"i{k}": hb.Sf(float(net.current[k]))})
        m.bond(f"i{k} -> z{k}", f"z{k} -> c{k}")
    for s, switch in enumerate(net.switches):
        m.add(**{f"w{s}": hb.One()})
        if switch.voltage is None:
            m.bond(f"z0 -> w{s}", f"w{s} -> z1")
            continue
        m.add(**{f"g{s}": hb.Se(float(switch.voltage))})
        ends = [f"z{switch.place}", f"w{s}", f"g{s}"]
        ends = ends if r.random() < 0.5 else ends[::-1]
        m.bond(f"{ends[0]} -> {ends[1]}", f"{ends[1]} -> {ends[2]}")
    for j, machine in enumerate(net.machines):
        states = {name: [f"w{s}" for s in on] for name, on in machine.on.items()}
        rules = [f"{a} -> {b} when {guard.text()}" for a, b, guard in machine.rules]
        m.machine(NAMES[j], states=states, start="s0", rules=rules)
    return m


class Run:
    """The net in motion: charges, and states of the machines."""

    def __init__(self, net: Net) -> None:
        self.net = net
        self.t = Fraction(0)
        self.x: list[Charge] = [(q, Fraction(0)) for q in net.charge]
        self.state = ["s0"] * len(net.machines)

    def pieces(self, end: Fraction) -> list[Piece]:
        """Return the whole motion; NoRun if there is none."""
        found: list[Piece] = []
        self.settle()
        at_once = 0
        while True:
            rate = self.rates()
            self.x = [(q, v) for (q, _), v in zip(self.x, rate, strict=True)]
            if self.enabled(self.x, self.state):  # just behind the instant
                at_once += 1
                if at_once > AT_ONCE or len(found) > 100:
                    raise NoRun
                self.settle()
                continue
            begin, x = self.t, tuple(q for q, _ in self.x)
            self.t = self.next_level(rate, end)
            found.append(Piece(begin, self.t, x, tuple(rate)))
            way = self.t - begin
            self.x = [(q + v * way, v) for q, v in zip(x, rate, strict=True)]
            if self.t == end:
                return found
            if self.enabled(self.x, self.state):
                at_once = 0
                self.settle()

    def next_level(self, rate: list[Fraction], end: Fraction) -> Fraction:
        """Return when a charge comes to a level that is asked for, or a time; or `end`."""
        first = end
        for machine, state in zip(self.net.machines, self.state, strict=True):
            for atom in (a for s, _, g in machine.rules if s == state for a in g.atoms()):
                at = self.t
                if atom.kind == "time":
                    at = atom.level
                elif atom.kind == "charge" and rate[atom.place] != 0:
                    at += (atom.level - self.x[atom.place][0]) / rate[atom.place]
                first = min(first, at) if at > self.t else first
        return first

    def settle(self) -> None:
        """Find the mode to stay in, and write what the modes on the way write."""
        before = list(self.state)
        after = self.entered(self.x, self.state)
        seen = set()
        while True:
            fired = False
            while taken := self.enabled(after, before):
                self.state = [taken.get(j, s) for j, s in enumerate(self.state)]
                after = self.entered(self.x, self.state)
                fired = True
                here = (*self.state, *self.x, *after, *before)
                if here in seen or len(seen) > MOST:
                    raise NoRun
                seen.add(here)
            if not fired and after == self.x:
                return
            self.x, before = after, list(self.state)

    def enabled(self, x: list[Charge], before: list[str]) -> dict[int, str]:
        """Return the machines that have a rule which holds, and where its first one leads."""
        taken: dict[int, str] = {}
        for j, machine in enumerate(self.net.machines):
            for source, target, guard in machine.rules:
                if source == self.state[j] and self.holds(guard, x, before):
                    taken[j] = target
                    break
        return taken

    def holds(self, guard: Guard, x: list[Charge], before: list[str]) -> bool:
        """Whether a guard holds; `before` are the states that ``pre()`` reads."""
        match guard.kind:
            case "and":
                return all(self.holds(part, x, before) for part in guard.parts)
            case "or":
                return any(self.holds(part, x, before) for part in guard.parts)
            case "charge":
                level = (guard.level, Fraction(0))
                return x[guard.place] > level if guard.above else x[guard.place] < level
            case "time":
                return self.t >= guard.level
        states = before if guard.kind == "pre" else self.state
        return states[guard.place] == guard.state

    def on(self) -> list[Switch]:
        """Return the switches that are on."""
        pairs = zip(self.net.machines, self.state, strict=True)
        return [self.net.switches[s] for machine, state in pairs for s in machine.on[state]]

    def entered(self, x: list[Charge], state: list[str]) -> list[Charge]:
        """Return the charges on entering the mode: they are conserved, or put onto a source."""
        x = list(x)
        c = self.net.capacity
        held = {s.place: s.voltage for s in self.on() if s.voltage is not None}
        joined = any(s.voltage is None for s in self.on())
        if joined and held.get(0, held.get(1)) != held.get(1, held.get(0)):
            raise NoRun
        if joined and not held.keys() & {0, 1}:
            value, moved = ((x[0][k] + x[1][k]) / (c[0] + c[1]) for k in (0, 1))
            x[0], x[1] = ((c[k] * value, c[k] * moved) for k in (0, 1))
        elif joined:
            held[0] = held[1] = held.get(0, held.get(1, Fraction(0)))
        for k, voltage in held.items():
            x[k] = (c[k] * voltage, Fraction(0))
        return x

    def rates(self) -> list[Fraction]:
        """Return how fast charges move in the mode."""
        c = self.net.capacity
        rate = list(self.net.current)
        held = {s.place for s in self.on() if s.voltage is not None}
        if any(s.voltage is None for s in self.on()):
            if held & {0, 1}:
                held |= {0, 1}
            else:
                both = (rate[0] + rate[1]) / (c[0] + c[1])
                rate[0], rate[1] = c[0] * both, c[1] * both
        return [Fraction(0) if k in held else v for k, v in enumerate(rate)]
