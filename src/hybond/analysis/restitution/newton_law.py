"""Write the simplified model: a compliant contact replaced by Newton's law of restitution.

What the contact compresses is taken out; a source of flow ``-eps*pre(v)`` takes its place on the
contact's junction, in a state that is left as soon as its jump is written (a pinnacle). Source:
Mosterman & Biswas 2002, equation (15); Margetts & Ngwompo, section 2.2, for where eps comes from.
"""

from __future__ import annotations

import re
from itertools import pairwise

from hybond.analysis.restitution.branches import Branch, opens, trees_at
from hybond.analysis.restitution.closing_speed import cannot, closing_speed
from hybond.analysis.restitution.contact import Contact, find_contact
from hybond.analysis.restitution.contact_phase import compressive_sign, directional
from hybond.calls import called
from hybond.errors import HybondError, ModelError, UsageError
from hybond.model.builder import Model
from hybond.model.constructors import Sf
from hybond.model.graph import FlatGraph, Machine
from hybond.model.parts import Integral, MachinePart, Part, Sampled, SubmodelPart, Value


@called('hb.newton_law_model(model, "contact", 0.9)')
def newton_law_model(model: Model, junction: str, eps: Value, *, state: str | None = None) -> Model:
    """Return the model with the compliant contact at `junction` replaced by an impact law.

    Everything else is kept: names, parameters, signals, inputs, other machines, layout. The
    parameter ``eps`` is new (or ``eps_<junction>`` if there is one), and the source ``rebound``;
    the state of contact is called ``collide``.

    Parameters
    ----------
    model : Model
    junction : str
        A controlled 0-junction of the model itself, not of a submodel.
    eps : float or str
        The coefficient of restitution, a number or an expression (``"1/1.1"``).
    state : str, optional
        The state that makes contact, if several do.

    Raises
    ------
    ModelError
        HB-A206 if the contact cannot be taken out, with the reason; HB-A201, HB-A202 or HB-A205
        if there is none.
    UsageError
        HB-A207 for a negative restitution.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.restitution.newton_law import newton_law_model
    >>> m = hb.Model("drop", domain="translational")
    >>> m.add(ball=hb.I("1 kg", f="-1 m/s"), v=hb.One(), contact=hb.Zero(), squeeze=hb.One(),
    ...       pad=hb.C("1 mm/N"), damper=hb.G("10 m/(N*s)"))
    >>> m.bond("contact -> v -> ball", "contact -> squeeze -> pad", "squeeze -> damper")
    >>> m.signal(height=hb.Integral("v.f", start="1 m"))
    >>> m.machine("floor", states={"away": [], "touching": ["contact"]}, start="away",
    ...           rules=["away -> touching when height <= 0 and v.f < 0",
    ...                  "touching -> away when contact.e < 0"])
    >>> simple = newton_law_model(m, "contact", 0.9)
    >>> simple.elements["rebound"].value, simple.bonds
    ('-eps*pre(ball.f)', ['contact -> v -> ball', 'rebound -> contact'])
    >>> simple.machines["floor"].rules
    ('away -> collide when height <= 0 and v.f < 0', 'collide -> away when pre(ball.f) >= 0')
    >>> round(hb.simulate(simple, until="1.5 s")["v.f"].at(1.5), 9)
    0.9
    """
    graph = model.flatten()
    contact = find_contact(graph, junction, state=state)
    part = _own_machine(model, graph, contact)
    removed = _removed(model, graph, contact)
    new = _copy(model, removed)
    eps_name = _free(new, "eps", contact.junction)
    new.parameters[eps_name] = eps
    speed, turned = closing_speed(graph, contact)
    source = _free(new, "rebound", contact.junction)
    new.elements[source] = Sf(f"-{eps_name}*pre({speed})")
    new.bonds.append(
        f"{source} -> {contact.junction}" if turned else f"{contact.junction} -> {source}"
    )
    beside = [b.node.path.partition(".")[0] for b in trees_at(graph, contact.node, contact.mode)]
    for name in (*beside, *removed):
        if name in removed and name in model.layout:
            new.layout[source] = model.layout[name]
            break
    _read_elsewhere(new, contact)
    new.machines[contact.machine] = _machine(new, graph, contact, part, speed, turned=turned)
    try:
        small = new.flatten()
    except ModelError as error:
        raise cannot(
            f"without {', '.join(removed)}: {error.why}",
            error.where or contact.junction,
            "what the contact compresses is gone; say it in terms of what stays",
        ) from error
    if not small.parameters[eps_name] >= 0.0:
        raise UsageError(
            f"a restitution of {eps!r}",
            code="HB-A207",
            where="eps",
            hint="from 0 (plastic) to 1 (elastic)",
        )
    _keep_readable(new, small)
    return new


def _own_machine(model: Model, graph: FlatGraph, contact: Contact) -> MachinePart:
    """Return the machine as written, if it is one that only opens and closes this contact."""
    where = f"machines.{contact.machine}"
    if contact.junction not in model.elements or contact.machine not in model.machines:
        raise cannot(
            f"the contact {contact.junction!r} or its machine is inside a submodel or an element",
            contact.junction,
            "call this for the submodel's own Model",
        )
    machine = _flat_machine(graph, contact)
    part = model.machines[contact.machine]
    compressed = {b.node.index for branch, _ in contact.behind for b in branch.walk()}
    if len(machine.states) != 2 or not machine.controls <= {contact.node} | compressed:
        raise cannot(
            f"the machine {contact.machine!r} does more than to open and close "
            f"{contact.junction!r}",
            where,
            "give the contact a machine of its own with two states",
        )
    if part.start == contact.state:
        raise cannot(
            f"the machine {contact.machine!r} starts in contact",
            where,
            "an impact needs an approach: start in the other state",
        )
    return part


def _flat_machine(graph: FlatGraph, contact: Contact) -> Machine:
    return next(m for m in graph.machines if m.path == contact.machine)


# -- what goes


def _removed(model: Model, graph: FlatGraph, contact: Contact) -> list[str]:
    """Return the elements of the model that only serve the compression."""
    paths: list[str] = []
    ends = {branch.node.index for branch, _ in contact.behind}
    machine = _flat_machine(graph, contact).index

    def collect(branch: Branch) -> bool:
        """Add what is compressed; return whether nothing else is in the branch."""
        if branch.node.index in ends:
            paths.extend(b.node.path for b in branch.walk())
            _only_compressed(branch, machine)
            return True
        if not opens(branch):
            return False
        alone = [collect(c) for c in branch.children]
        if branch.children and all(alone):
            paths.append(branch.node.path)
            return True
        return False

    for branch in trees_at(graph, contact.node, contact.mode):
        collect(branch)
    found: dict[str, None] = {}
    for path in sorted(paths, key=lambda p: graph.by_path[p]):
        top = path.partition(".")[0]
        if isinstance(model.elements[top], SubmodelPart):
            inside = {n.path for n in graph.nodes if n.path.startswith(f"{top}.")}
            if not inside <= set(paths):
                raise cannot(
                    f"only a part of the submodel {top!r} is compressed",
                    path,
                    "build the contact from elements of its own",
                )
        found[top] = None
    return list(found)


def _only_compressed(branch: Branch, machine: int) -> None:
    for b in branch.walk():
        kept = b.kind == "I" or (b.kind in ("Se", "Sf") and not b.node.is_junction)
        if kept or b.node.machine not in (None, machine):
            raise cannot(
                f"{b.node.path!r} is part of what is compressed and would be lost",
                b.node.path,
                "an impact law replaces springs and dampers only",
            )


def _copy(model: Model, removed: list[str]) -> Model:
    """Return a copy without the elements `removed` and their bonds."""
    title = f"{model.title or model.name}, by Newton's law of collision"
    new = Model(f"{model.name}_newton", title=title, domain=model.domain)
    gone = set(removed)
    new.parameters = dict(model.parameters)
    new.elements = {k: v for k, v in model.elements.items() if k not in gone}
    new.bonds = [kept for text in model.bonds for kept in _without(text, gone)]
    new.signals, new.inputs = dict(model.signals), dict(model.inputs)
    new.machines, new.ports = dict(model.machines), dict(model.ports)
    new.models, new.experiment = dict(model.models), dict(model.experiment)
    new.layout = {k: v for k, v in model.layout.items() if k.partition(".")[0] not in gone}
    new.indeterminate = model.indeterminate
    for port, target in model.ports.items():
        if target.partition(".")[0] in gone:
            raise cannot(
                f"the port {port!r} leads to {target!r}, which is compressed",
                f"ports.{port}",
                "a contact that is connected outside the model stays as it is",
            )
    return new


def _without(text: str, gone: set[str]) -> list[str]:
    """Return what is left of a chain of bonds."""
    label, colon, chain = text.rpartition(":")
    ends = [e.strip() for e in chain.split("->")]
    runs: list[list[str]] = [[]]
    for a, b in pairwise(ends):
        if {a.partition(".")[0], b.partition(".")[0]} & gone:
            runs.append([])
        elif runs[-1]:
            runs[-1].append(b)
        else:
            runs[-1] = [a, b]
    if runs == [ends]:
        return [text]
    return [f"{label}{colon} {' -> '.join(run)}".strip() for run in runs if run]


def _keep_readable(new: Model, graph: FlatGraph) -> None:
    """Take what can no longer be read out of the lists of signals to plot and to write."""
    assert graph.read is not None
    for key in ("plot", "outputs"):
        kept = []
        for name in new.experiment.get(key, ()):
            try:
                graph.read(str(name))
            except HybondError:
                continue
            kept.append(name)
        if key in new.experiment:
            new.experiment[key] = kept


# -- what comes


def _machine(
    new: Model, graph: FlatGraph, contact: Contact, part: MachinePart, speed: str, *, turned: bool
) -> MachinePart:
    """Return the machine of the impact: in on approach, out as soon as the jump is written."""
    sign = compressive_sign(graph, contact) * (-1 if turned else 1)
    if sign == 0:
        raise cannot(
            f"the rules of {contact.machine!r} do not tell in which direction the contact closes",
            f"machines.{contact.machine}",
            'say it: "away -> touching when height <= 0 and v.f < 0"',
        )
    away = next(s for s in part.states if s != contact.state)
    elsewhere = f"{contact.machine}.state"
    others = [t for k, t in _texts(new) if not k.startswith(f"machines.{contact.machine}.")]
    free = "collide" not in part.states and not any(elsewhere in t for t in others)
    collide = "collide" if free else contact.state
    machine = _flat_machine(graph, contact)
    rules = []
    for rule, text in zip(machine.rules, part.rules, strict=True):
        if machine.states[rule.source] != away or rule.source == rule.target:
            continue
        guard = text.split(" when ", 1)[1] if " when " in text else rule.text
        if not directional(graph, contact, rule):
            # after the jump the bodies still touch: only the direction keeps them from colliding
            guard = f"({guard})" if re.search(r"\b(or|if)\b", guard) else guard
            guard += f" and {speed} {'>' if sign > 0 else '<'} 0"
        rules.append(f"{away} -> {collide} when {guard}")
    if not rules:
        raise cannot(
            f"no rule of {contact.machine!r} makes contact",
            f"machines.{contact.machine}",
            'add "away -> touching when ..."',
        )
    rules.append(f"{collide} -> {away} when pre({speed}) {'<=' if sign > 0 else '>='} 0")
    states = {
        collide if k == contact.state else k: tuple(n for n in listed if n in new.elements)
        for k, listed in part.states.items()
    }
    return MachinePart(states, away, tuple(rules))


def _texts(model: Model) -> list[tuple[str, str]]:
    """Return every expression of the model's own level with its place."""
    found = []
    for name, signal in model.signals.items():
        match signal:
            case Integral():
                text = signal.rate
            case Sampled():
                text = signal.value
            case _:
                text = str(signal)
        found.append((f"signals.{name}", text))
    for name, machine in model.machines.items():
        found += [(f"machines.{name}.rules[{k}]", str(r)) for k, r in enumerate(machine.rules)]
    for name, part in model.elements.items():
        if isinstance(part, Part):
            found.append((f"elements.{name}", str(part.value)))
    return found


def _read_elsewhere(new: Model, contact: Contact) -> None:
    """Refuse what reads the net flow of the junction: it now contains the source's flow."""
    for place, text in _texts(new):
        if re.search(rf"(?<![\w.]){re.escape(contact.junction)}\.f\b", text):
            raise cannot(
                f"{text!r} reads {contact.junction}.f, which the impact law changes",
                place,
                "write the velocities of the bodies",
            )


def _free(model: Model, name: str, junction: str) -> str:
    taken = {*model.elements, *model.signals, *model.inputs, *model.machines, *model.parameters}
    for candidate in (name, f"{name}_{junction}", *(f"{name}_{k}" for k in range(2, 99))):
        if candidate not in taken:
            return candidate
    raise AssertionError("a hundred names are taken")
