"""Random hybrid models: bond graphs with machines, impacts, steps of sources and junction laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from dense_events import Run
from dense_oracle import Net, random_net
from hybrid_models import Atom, Guard, Hybrid, Law, Machine, Rule

import hybond as hb


def hybrid(seed: int, *, impacts: bool = True, laws: bool = False) -> Hybrid:
    """Return a random hybrid model with at least one thing that can happen."""
    for attempt in range(1000):
        rng = np.random.default_rng([seed, attempt])
        h = _draw(rng, impacts=impacts, laws=laws)
        if h is not None:
            return h
    raise AssertionError("no model found")


def _draw(rng: np.random.Generator, *, impacts: bool, laws: bool) -> Hybrid | None:
    size = int(rng.integers(2, 7))
    net = random_net(
        int(rng.integers(1 << 30)),
        size,
        rings=int(rng.integers(3)),
        controlled=0.0 if laws else 0.6,
        sources=0.8,
        timed=0.75,
        resistors=0.6,
    )
    if not 2 <= len(net.of("C", "I")) <= 8:
        return None
    switched = list(net.controlled)
    found: dict[str, Law] = {}
    if laws:
        junctions = [n for n in net.of("0", "1") if net.ends(n)]
        picked = [str(j) for j in rng.permutation(junctions)][: int(rng.integers(1, 5))]
        split = int(rng.integers(1, len(picked) + 1))
        for j in picked[:split]:
            if rng.random() < 0.3:
                limit = _number(rng, 0.2, 1.5)
                found[j] = Law("coulomb", limit, round(limit * float(rng.uniform(1, 1.5)), 3))
            else:
                found[j] = Law("diode")
        switched = picked[split:]
    net = replace(net, controlled=[*switched, *found])
    machines: list[Machine] = []
    integrals: dict[str, tuple[tuple[tuple[float, str], ...], float]] = {}
    prior: dict[str, tuple[tuple[float, str], ...]] = {}
    if impacts and rng.random() < 0.5:
        net, contact = _contact(rng, net, integrals, prior)
        if contact is not None:
            machines.append(contact)
    left = [j for j in switched if net.ends(j)]
    while left:
        count = min(len(left), int(rng.integers(1, 3)))
        mine, left = left[:count], left[count:]
        machines.append(_machine(rng, net, f"m{len(machines)}", mine, integrals, switched))
    steps = {}
    for s in net.of("Se", "Sf"):
        if s not in prior and rng.random() < 0.3:
            steps[s] = (_number(rng, 0.2, 1.8), _number(rng, -1.5, 1.5))
    if not machines and not found:
        return None
    h = Hybrid(net, tuple(machines), integrals, prior, steps, found, bool(rng.random() < 0.3))
    return _within_reach(rng, h)


def _within_reach(rng: np.random.Generator, h: Hybrid) -> Hybrid | None:
    """Move most thresholds to values that the signals take while the model stays in its start mode.

    A model whose start mode has no motion is kept now and then: it is to be refused.
    """
    still = Run(replace(h, machines=tuple(replace(m, rules=()) for m in h.machines)), 1.0)
    outcome = still.run()
    if outcome.end is None:
        return h if rng.random() < 0.1 else None
    event = outcome.events[0]
    mode = still.mode(event.visits[-1].mode, 0.0, 1, event.visits[-1].branches)
    points = [mode.state(event.after, 0.0)]
    for _ in range(150):
        points.append(mode.hop @ points[-1])
    path = np.array(points)

    def spread(a: Atom) -> tuple[float, float]:
        values = path @ mode.row([(c, n) for c, n, _ in a.terms])[0]
        return float(values.min()), float(values.max())

    def moved(g: Guard) -> Guard:
        if g.atom is None:
            return replace(g, parts=tuple(moved(p) for p in g.parts))
        low, high = spread(g.atom) if g.atom.terms[0][1] != "time" else (0.0, 0.0)
        if high - low < 0.05 or rng.random() < 0.2:
            return g
        return replace(g, atom=replace(g.atom, bound=_number(rng, low, high)))

    machines = []
    for m in h.machines:
        if m.name == "pair":
            machines.append(m)
        elif (
            len(m.rules) == 2
            and [r.guard.atom and r.guard.atom.op for r in m.rules] == [">", "<"]
            and m.rules[0].guard.atom.terms == m.rules[1].guard.atom.terms
        ):
            # hysteresis keeps its two thresholds apart
            low, high = spread(next(m.rules[0].guard.atoms()))
            if high - low < 0.05:
                machines.append(m)
                continue
            a = _number(rng, low, high)
            b = round(a + max(0.2 * (high - low), 0.03), 3)
            machines.append(
                replace(
                    m,
                    rules=tuple(
                        replace(
                            r,
                            guard=replace(
                                r.guard,
                                atom=replace(r.guard.atom, bound=b if r.target == "s1" else a),
                            ),
                        )
                        for r in m.rules
                    ),
                )
            )
        else:
            machines.append(
                replace(m, rules=tuple(replace(r, guard=moved(r.guard)) for r in m.rules))
            )
    if len(machines) > 1 and rng.random() < 0.3:
        _copy_a_guard(rng, machines)
    return replace(h, machines=tuple(machines))


def _number(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 3)


def _contact(rng, net: Net, integrals, prior) -> tuple[Net, Machine | None]:
    """Let two junctions with inertia of their own strike each other."""
    moving: dict[str, str] = {}
    for i in net.of("I"):
        ((b, _, _),) = net.ends(i)
        tail, head = net.bonds[b]
        j = head if tail == i else tail
        if net.nodes.get(j, ("",))[0] == "1" and j not in net.controlled and j not in moving:
            moving[j] = i
    if len(moving) < 2:
        return net, None
    a, b = (str(j) for j in rng.choice(list(moving), 2, replace=False))
    nodes = dict(net.nodes)
    nodes["hit"] = ("0", None)
    nodes["back"] = ("Sf", (0.0, 1.0, 0.0))
    eps = _number(rng, 0.3, 1.0)
    toward = bool(rng.random() < 0.5)
    bonds = [*net.bonds, (a, "hit"), ("hit", b), ("hit", "back") if toward else ("back", "hit")]
    # flow balance: a = b + back, or a + back = b; afterwards a - b = -eps * (a - b before)
    s = -eps if toward else eps
    prior["back"] = ((s, f"{moving[a]}.f"), (-s, f"{moving[b]}.f"))
    integrals["gap"] = (((1.0, f"{b}.f"), (-1.0, f"{a}.f")), _number(rng, 0.02, 0.5))
    closed = _atom((1.0, "gap"), "<=", 0.0)
    nearing = Guard("atom", atom=Atom(((1.0, f"{a}.f", False), (-1.0, f"{b}.f", False)), ">", 0.0))
    leaving = Guard(
        "atom",
        atom=Atom(((1.0, f"{moving[a]}.f", True), (-1.0, f"{moving[b]}.f", True)), "<=", 0.0),
    )
    machine = Machine(
        "pair",
        {"apart": (), "collide": ("hit",)},
        "apart",
        (
            Rule("apart", "collide", Guard("and", (closed, nearing))),
            Rule("collide", "apart", leaving),
        ),
    )
    return replace(net, nodes=nodes, bonds=bonds, controlled=[*net.controlled, "hit"]), machine


def _atom(term: tuple[float, str], op: str, bound: float, prior: bool = False) -> Guard:
    return Guard("atom", atom=Atom(((*term, prior),), op, bound))


def _signal(rng, net: Net, mine: list[str]) -> tuple[str, bool]:
    """Return a signal that a guard may read, and whether it is stored or a co-energy variable."""
    r = rng.random()
    if r < 0.4:
        n = str(rng.choice(net.of("C", "I")))
        kind = net.nodes[n][0]
        if rng.random() < 0.5:
            return n + (".q" if kind == "C" else ".p"), True
        return n + (".e" if kind == "C" else ".f"), True
    if r < 0.75:
        j = str(rng.choice(mine))
        return j + (".e" if rng.random() < 0.5 else ".f"), False
    if r < 0.9:
        j = str(rng.choice([n for n in net.of("0", "1") if net.ends(n) and n != "hit"]))
        return j + (".e" if net.nodes[j][0] == "0" else ".f"), False
    n = str(rng.choice(net.of("C", "I", "R", "G")))
    return n + (".e" if rng.random() < 0.5 else ".f"), False


def _guard(rng, net: Net, mine: list[str], depth: int = 0) -> Guard:
    r = rng.random()
    if depth < 2 and r < 0.25:
        word = str(rng.choice(["and", "or"]))
        return Guard(word, tuple(_guard(rng, net, mine, depth + 1) for _ in range(2)))
    if depth < 2 and r < 0.3:
        return Guard("not", (_guard(rng, net, mine, 2),))
    if r < 0.42:
        return _atom((1.0, "time"), ">=" if rng.random() < 0.8 else "<", _number(rng, 0.1, 1.7))
    name, stored = _signal(rng, net, mine)
    op = str(rng.choice(["<", ">", "<=", ">="]))
    bound = 0.0 if rng.random() < 0.25 else _number(rng, -0.8, 0.8)
    c = 1.0 if rng.random() < 0.8 else _number(rng, -2.0, 2.0)
    return _atom((c, name), op, bound, bool(rng.random() < (0.4 if stored else 0.1)))


def _machine(rng, net: Net, name: str, mine: list[str], integrals, switched) -> Machine:
    """Return a machine; some switch on a threshold and back on another one."""
    states = {"s0": tuple(mine[:1]), "s1": tuple(mine[1:])}
    if rng.random() < 0.4:
        states = {"s0": (), "s1": tuple(mine)}
    if len(mine) > 1 and rng.random() < 0.4:
        states["s2"] = tuple(mine)
    names = list(states)
    start = str(rng.choice(names))
    rules: list[Rule] = []
    way = rng.random()
    if way < 0.45 and len(names) == 2:
        # a switch with hysteresis on something stored
        n = str(rng.choice(net.of("C", "I")))
        quantity = {"C": ("q", "e"), "I": ("p", "f")}[net.nodes[n][0]]
        signal = f"{n}.{quantity[int(rng.integers(2))]}"
        low = _number(rng, -0.5, 0.3)
        high = round(low + float(rng.uniform(0.05, 0.4)), 3)
        prior = bool(rng.random() < 0.3)
        rules = [
            Rule("s0", "s1", _atom((1.0, signal), ">", high, prior)),
            Rule("s1", "s0", _atom((1.0, signal), "<", low, prior)),
        ]
    elif way < 0.6 and len(mine) == 1:
        # the rules of an ideal diode, one way or the other
        j = mine[0]
        states = {"s0": (), "s1": (j,)}
        on, off = (".e", ".f") if net.nodes[j][0] == "1" else (".f", ".e")
        a, b = (">", "<") if rng.random() < 0.5 else ("<", ">")
        rules = [
            Rule("s0", "s1", _atom((1.0, j + on), a, 0.0)),
            Rule("s1", "s0", _atom((1.0, j + off), b, 0.0)),
        ]
    else:
        for source in names:
            for target in names:
                if source != target and rng.random() < 0.8:
                    rules.append(Rule(source, target, _guard(rng, net, mine)))
        order = rng.permutation(len(rules))
        rules = [rules[k] for k in order]
    return Machine(name, states, start if start in states else "s0", tuple(rules))


def _copy_a_guard(rng, machines: list[Machine]) -> None:
    """Let two machines read one threshold, one of them in other words."""
    a, b = rng.choice(len(machines), 2, replace=False)
    if machines[a].name == "pair" or machines[b].name == "pair":
        return
    if not machines[a].rules or not machines[b].rules:
        return
    guard = machines[a].rules[0].guard
    if guard.atom is None or guard.atom.terms[0][1] == "time":
        return
    k = 2.0 if rng.random() < 0.5 else -3.0
    at = guard.atom
    op = at.op if k > 0 else at.op.translate(str.maketrans("<>", "><"))
    other = Atom(tuple((k * c, n, p) for c, n, p in at.terms), op, k * at.bound)
    first = machines[b].rules[0]
    rule = Rule(first.source, first.target, Guard("atom", atom=other))
    machines[b] = replace(machines[b], rules=(rule, *machines[b].rules[1:]))


# -- as a model of the package ---------------------------------------------------------------------


def model(h: Hybrid) -> hb.Model:
    """Return a hybrid model as the package reads it."""
    net = h.net
    m = hb.Model("net")
    if h.least_leakage:
        m.indeterminate = "least leakage"
    for name, (kind, value) in net.nodes.items():
        if name in h.laws:
            junction = hb.Zero if kind == "0" else hb.One
            law = h.laws[name]
            if law.kind == "diode":
                part = junction(law="diode")
            else:
                part = junction(law="coulomb", limit=law.limit, breakaway=law.breakaway)
        elif name in h.prior:
            text = " + ".join(f"({c!r})*pre({n})" for c, n in h.prior[name])
            part = hb.Se(text) if kind == "Se" else hb.Sf(text)
        elif name in h.steps:
            a, b, c = value
            at, change = h.steps[name]
            m.input(**{f"u_{name}": hb.Input(table=[[0.0, a], [at, a + change]])})
            text = f"u_{name} + ({b!r})*sin({c!r}*time)" if b else f"u_{name}"
            part = hb.Se(text) if kind == "Se" else hb.Sf(text)
        else:
            part = net._part(name, kind, value)
        m.add(**{name: part})
    m.bond(*(f"{a} -> {b}" for a, b in net.bonds))
    for name, (terms, start) in h.integrals.items():
        text = " + ".join(f"({c!r})*{n}" for c, n in terms)
        m.signal(**{name: hb.Integral(text, start=start)})
    for machine in h.machines:
        m.machine(
            machine.name,
            states={s: list(on) for s, on in machine.states.items()},
            start=machine.start,
            rules=[str(r) for r in machine.rules],
        )
    return m
