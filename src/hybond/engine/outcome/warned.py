"""What the library warns of, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from hybond.engine.compiled.rows import Rows
from hybond.engine.outcome.explain import SLIDING, Explaining
from hybond.engine.outcome.unsound import LOOP, violation
from hybond.engine.tables.contacts import contacts_of
from hybond.model.graph import FlatGraph, Mode
from hybond.runs.trace import Violation

if TYPE_CHECKING:
    from hybond.engine.outcome.records import Instants
    from hybond.equations.surfaces import Surface

NOT_UNIQUE, NO_WAY_ON, TWIN_SURFACES, LOST_BETWEEN, THROWS_BACK = 1, 2, 3, 4, 5
SECOND_ANSWER, IMPULSIVE, LEFT_OPEN, FAR_APART, UNREST = 6, 7, 8, 9, 10
WITHOUT_END, SHARES_OPEN, FIRES_ALWAYS, NEXT_DECIDES, UNSOUND, HELD_AT_REST = 11, 12, 13, 14, 15, 16
MODULUS_JUMPS, IMPULSE_LEFT_OUT, COURSE_UNSEEN, MADE_BY_STEPS, SWINGS = 17, 18, 19, 20, 21
GUARD_AT_REST, UNRESOLVED, ROOT, ANOTHER, RATES_APART = 22, 23, 24, 25, 26
"""Kinds of warnings: as in `hybond.engine.reasons.warned`."""
TIMELESS = (
    *(TWIN_SURFACES, IMPULSIVE, LEFT_OPEN, FAR_APART, MODULUS_JUMPS),
    IMPULSE_LEFT_OUT,
)
"""Those whose text does not say when: once said, they are said."""
SLIDES, ABOVE = 0, 1
UNBOUNDED, LOST = 0, 2
"""Why what time does is not seen: as in `hybond.engine.run.courses_ahead`."""
REBOUNDS, NO_SOLUTION, NO_SIGN, OPEN = 0, 1, 2, 3
"""Why a contact cannot rest: as in `hybond.engine.contacts.unrest`."""
CREATED = 1e-9
"""Energy of a jump is rounding below this part of the largest in the run: as in the audit."""
MYTHICAL, STEP = 0, 5
"""The kind of a visit that writes nothing, the cause of an instant that is the end of a step: as in
`hybond.engine.instant.instant`."""
TAKEN = (
    "the branches that were taken before",
    "which carries least",
    "the nearest to the branches before",
    "the first by name",
)
"""Why one of several answers is taken: as in `hybond.engine.complementarity.all_branches`."""
LEFT_OUT = (
    "gives none of its own, though by its value it would: a jump takes at their word multiples of "
    "what is read, by parameters, inputs and time; say `impulsive = true` if it holds in jumps "
    "too, `impulsive = false` if it is finite",
    "is declared impulsive, but gives another one than its value says, by its slopes before the "
    "jump; write it as a multiple of what it reads",
    "gives none of its own, since of an impulse its value has no meaning; say `impulsive = false` "
    "if it is finite, else put what limits the impulse into the model",
)
"""What a source is taken for in a jump: as in `hybond.engine.instant.left_out`."""
TAKES = (
    "nothing says which, and the run goes on by the one that Newton's method came to",
    "this solver follows none of them: it may go over from one to another",
    "none of them is followed along surfaces: the run may go over from one to another",
    "of laws that jump, and beside hidden constraints, none is followed: the run may go over from "
    "one to another",
)
"""What a run does where there are several solutions: as in `hybond.engine.run.others_told`."""
REBOUND = "its rebounds do not vanish"


class Warnings:
    """The warnings of one run; `elements` are the nodes of the elements of the engine."""

    def __init__(self, graph: FlatGraph, explain: Explaining, elements: Sequence[int] = ()) -> None:
        self.graph = graph
        self._elements = elements
        self.unsound: list[Violation] = []
        """Laws that were found not to hold."""
        self.roots: list[tuple[float, list[float]]] = []
        """Of laws with several solutions: points of the one that was followed."""
        self.made = ""
        """What steps of a fixed length have made or lost, if that is much."""
        self.explain = explain
        self.unrest: tuple[int, int, float, int] | None = None
        """Of the contact that ended the run: why, the reaction, what it is, the sign it had."""
        self._ports = [
            law.node for m in graph.machines if m.law is not None for law in m.law.junctions
        ]
        self._states = [
            m.states for m in graph.machines if m.law is not None for _ in m.law.junctions
        ]
        self._said: set[tuple[float, ...]] = set()
        self._creates = False
        """Whether it was said that a jump creates energy."""
        self._written_by = {
            k: m.fieldless
            for k, m in enumerate(graph.machines)
            if m.law is None and any(m.fieldless)
        }
        """Of machines with impact laws: which of their states have to write a jump."""
        self._on_trial: set[tuple[int, int]] = set()
        """Those of them of which it was said that one did not."""

    def texts(self, rows: Rows) -> Iterator[str]:
        """Yield the warnings of a slice."""
        for k, kind in enumerate(rows.warn.tolist()):
            about = rows.about[rows.warn_first[k] : rows.warn_first[k + 1]].tolist()
            if kind in TIMELESS or kind == SECOND_ANSWER:
                # what laws may do is said of each set of them, however often it is asked
                key = (kind, *about)
                if key in self._said:
                    continue
                self._said.add(key)
            if kind == ROOT:
                self.roots.append((float(rows.warn_time[k]), about))
                continue
            if kind == UNREST:
                _, why, reaction, force, sign = about
                self.unrest = int(why), int(reaction), force, int(sign)
                continue
            if kind == UNSOUND:
                t = float(rows.warn_time[k])
                self.unsound.append(violation(self.graph, self._elements, t, about))
                continue
            if kind == MADE_BY_STEPS:
                self.made = _of_made(*about)
                continue
            yield self._text(kind, float(rows.warn_time[k]), about)

    def of_created(self, found: Instants, many: int, largest: float) -> Iterator[str]:
        """Yield a warning of the first jump of a run that creates energy.

        Of the instants of a slice the first `many` are looked at; `largest` is the largest energy
        of the run so far, J. What sources supply is not created.
        """
        if self._creates:
            return
        visits = int(found.visit[many])
        rows = found.rows
        before, after, given = rows.visit_energy[:visits].T
        # energy beyond all numbers is not made of nothing: laws are held elsewhere
        with np.errstate(invalid="ignore"):
            made = after - before - given
        size = np.maximum.reduce([np.full(visits, largest), np.abs(after), np.abs(given)])
        told = (rows.visit[:visits, 4] != 0) & (rows.visit[:visits, 0] != MYTHICAL)
        # what a step of fixed length creates is counted with the steps
        in_step = rows.instant_place[:many, 0] == STEP
        told &= ~np.repeat(in_step, np.diff(found.visit[: many + 1]))
        for v in np.flatnonzero(told & (made > CREATED * size))[:1].tolist():
            self._creates = True
            k = int(np.searchsorted(found.visit, v, side="right")) - 1
            mode = found.before(k)
            for step in range(int(found.visit[k]), v + 1):
                mode = self.explain.entered(found, step, mode)
            yield (
                f"at t = {rows.instant_time[k, 0]:.9g} s the jump into mode "
                f"({self.graph.mode_text(mode)}) creates {made[v]:.6g} J that no source "
                "supplies: an impact law says so, by pre() or by its coefficients (the first that "
                "does)"
            )

    def of_unwritten(self, found: Instants, many: int) -> Iterator[str]:
        """Yield a warning of each state with an impact law that is left before the law is written.

        Of the instants of a slice the first `many` are looked at.
        """
        if not self._written_by:
            return
        rows = found.rows
        visits = int(found.visit[many])
        moves = rows.fired[: int(found.fired[visits]), :3]
        at = np.repeat(np.arange(visits), np.diff(found.fired[: visits + 1]))
        instant = np.repeat(np.arange(many), np.diff(found.visit[: many + 1]))
        # how many visits before each wrote what they found
        wrote = np.concatenate([[0], np.cumsum(rows.visit[:visits, 0] != MYTHICAL)])
        for machine, fieldless in self._written_by.items():
            own = np.flatnonzero((moves[:, 0] == machine) & (moves[:, 2] != SLIDING))
            target = moves[own, 2]
            news = np.diff(target, prepend=-2) != 0
            enters, state = at[own[news]], target[news]
            here, away = enters[:-1], enters[1:]
            unwritten = (instant[here] == instant[away]) & (wrote[here] == wrote[away])
            unwritten &= np.array(fieldless)[state[:-1]]
            for k in np.flatnonzero(unwritten).tolist():
                left = int(state[k])
                if (machine, left) not in self._on_trial:
                    self._on_trial.add((machine, left))
                    t = float(rows.instant_time[instant[away[k]], 0])
                    yield self._of_trial(machine, left, t)

    def _of_trial(self, machine: int, state: int, t: float) -> str:
        m = self.graph.machines[machine]
        name = m.states[state]
        return (
            f"at t = {t:.9g} s {m.path} leaves {name} before the impact law there is written: a "
            "rule out of it holds without the jump, which is on trial only and changes nothing; if "
            f'the law is to act, let it read pre({m.path}.state == "{name}") (the first that does)'
        )

    def _text(self, kind: int, t: float, about: list[float]) -> str:
        numbers = [int(a) for a in about]
        now = f"at t = {t:.9g} s"
        if kind == SECOND_ANSWER:
            return self._of_answers(now, numbers)
        if kind == IMPULSIVE:
            names = ", ".join(self.graph.nodes[k].path for k in numbers)
            return f"impulsive laws enter the jump equations: {names}"
        if kind == MODULUS_JUMPS:
            nodes = [self.graph.nodes[k] for k in dict.fromkeys(numbers)]
            which = ", ".join(f"{node.path} ({node.kind} {node.label})" for node in nodes)
            return (
                f"what the modulus of {which} reads jumps: impulses are those of the modulus "
                "before, and its law holds with what it is behind them"
            )
        if kind == IMPULSE_LEFT_OUT:
            return self._of_left_out(*numbers)
        if kind == LEFT_OPEN:
            machines = len(self.graph.machines)
            rule, when, *rest = numbers
            mode: Mode = tuple(rest[:machines])
            text = self.explain.guard_on_open(rule, when, rest[machines:], mode)
            return f"{text}; least leakage decides, as the model asks"
        if kind == SHARES_OPEN:
            names = ", ".join(self.graph.nodes[self._ports[k]].path for k in numbers)
            return (
                f"the equations leave open how {names} share what they carry "
                f"(first in the step that ends at t = {t:.9g} s); least leakage decides"
            )
        if kind == FIRES_ALWAYS:
            return (
                f"the machine {self.graph.machines[numbers[0]].path} fires at the end of every "
                f"step since about t = {t:.4g} s: time-stepping looks at machines written by hand "
                "only there; a junction law has no such limit"
            )
        if kind == NEXT_DECIDES:
            return f"{now} the laws leave no answer at this instant: the next step decides"
        if kind == HELD_AT_REST:
            name = self.graph.nodes[self._ports[numbers[0]]].path
            if self._breaks_with_others(name):
                return (
                    f"{now} others hold the friction of {name} at rest, so that what each of them "
                    "carries is not unique: they break loose together, where none can hold more"
                )
            return (
                f"{now} others hold the friction of {name} at rest, so that what each of them "
                "carries is not unique: it counts with what it holds in motion, not with its "
                "breakaway, until they break loose; a stiffness between them decides"
            )
        if kind == COURSE_UNSEEN:
            return self._of_course(t, *numbers)
        if kind == SWINGS:
            return self._of_swings(now, numbers[0], *about[1:])
        if kind == RATES_APART:
            return self._of_rates_apart(now, numbers[0], *about[1:])
        if kind == LOST_BETWEEN:
            return _of_lost(now, *about)
        if kind == GUARD_AT_REST:
            return self._of_rest(now, numbers[0], numbers[1] != 0, *about[2:])
        if kind == UNRESOLVED:
            return self._of_unresolved(now, numbers[0], *about[1:])
        if kind == ANOTHER:
            return self._of_another(now, *numbers[:3], *about[3:])
        if kind == FAR_APART:
            return self._far_apart(about[0], tuple(numbers[1:]))
        return self._of_surfaces(kind, now, numbers)

    def _of_swings(self, now: str, storage: int, off: float, size: float) -> str:
        """Say which rate is known less well than the state."""
        path, rate = self._rate_of(storage)
        return (
            f"from {now[3:]} on, steps swing about a law that is steeper there than the tolerance "
            f"of what it reads: what {path} stores is within that, but its {rate} is off by "
            f"{off:.2g} (of {size:.2g} at most), and so is what the law says; a smaller rtol makes "
            "it less, a larger C or I beside that law ends it"
        )

    def _of_rates_apart(
        self, now: str, storage: int, lasts: float, most: float, moves: float, at: float
    ) -> str:
        """Say which flow is not what has moved a storage, by how much, and what serves."""
        path, rate = self._rate_of(storage)
        return (
            f"from {now[3:]} on, for {lasts:.3g} s, the {rate} of {path} is not what fills it, and "
            f"what laws beside it say is off as well: by up to {most:.2g} where steps end, as at "
            f"t = {at:.6g} s, where {moves:.3g} fills it, and by more between. What drives it is a "
            f"difference far below the tolerance of what is stored, or rounding of it, and a law "
            f"that is steep there makes much of that; "
            f"what {path} stores is right. More resistance ends it, as r*f beside k*f*abs(f), or "
            "one storage for both"
        )

    def _rate_of(self, storage: int) -> tuple[str, str]:
        """Return the path of a storage, and which variable of its bond is its rate."""
        found = self.graph.storages[storage]
        return found.path, "flow" if found.kind == "C" else "effort"

    def _of_another(
        self, now: str, why: int, element: int, variable: int, here: float, there: float
    ) -> str:
        """Say that laws have another solution than the one that the run goes by."""
        name = self.explain.bond_variable(variable)
        bonds = len(self.graph.bonds)
        domain = self.graph.bonds[variable % bonds].domain
        unit = domain.flow if variable >= bonds else domain.effort
        one, other = (f"{x:.6g} {unit}" if unit else f"{x:.6g}" for x in (here, there))
        return (
            f"HB-N416: {now} the laws around {self.graph.nodes[self._elements[element]].path} have "
            f"more than one solution: {name} is {one}, and {other} would do as well; "
            f"{TAKES[why]}; {LOOP}"
        )

    def _of_unresolved(self, now: str, rule: int, carried: float, rounding: float) -> str:
        """Say that rounding is not small beside what a law carries, or blocks."""
        text, machine = self.explain.rule(rule).text, self.explain.machine_of(rule).path
        return (
            f"HB-N414: {now} the guard {text!r} of {machine} is known to {rounding:.2g} only, and "
            f"what it compares has been no more than {carried:.2g} since it was asked last: it may "
            "fire that much too late, or not at all, as this is a small difference of large terms; "
            "a larger resistance in series with it, or none, is resolved"
        )

    def _of_rest(self, now: str, rule: int, fires: bool, distance: float, size: float) -> str:
        """Say that a guard asks for what the motion comes to only in the limit, or nearly so."""
        text, machine = self.explain.rule(rule).text, self.explain.machine_of(rule).path
        if fires:
            return (
                f"HB-N413: {now} the guard {text!r} of {machine} fires, but when is not known: "
                f"its threshold is {abs(distance):.2g} from where the motion comes to rest, and "
                f"the run tells {size:.2g} there; a smaller rtol, or a threshold farther from the "
                "limit, tells more"
            )
        return (
            f"HB-N413: {now} the guard {text!r} of {machine} is {abs(distance):.2g} from its "
            f"threshold (of terms of {size:.6g}), where the motion comes to rest: rounding may "
            "put it on either side, and it does not fire; put the threshold clear of the limit"
        )

    def _of_course(self, t: float, place: int, why: int) -> str:
        """Say whose course of time is not seen: a number of a rule, or of an element."""
        if place < -1:
            who = f"in the guard {self.explain.rule(-2 - place).text!r}"
        else:
            who = "in the rate of a signal" if place < 0 else f"in {self.graph.nodes[place].path}"
        if why == UNBOUNDED:
            return (
                f"what time does {who} has no bound at t = {t:.9g} s: what it does there is not "
                "resolved; max_step bounds the steps around it"
            )
        if why == LOST:
            return (
                f"what a phase does {who} is not foreseen (first at t = {t:.9g} s), however near: "
                "it bounds no step, and what is narrow in it may be passed over; max_step bounds "
                "the steps"
            )
        return (
            f"fixed steps are too long for what time does {who} (first at t = {t:.9g} s): peaks "
            "between them are passed over; take a shorter step, or a solver that chooses its own"
        )

    def _of_left_out(self, number: int, how: int) -> str:
        node = self.graph.nodes[number]
        what = f"{node.path} ({node.kind} {node.label})"
        return f"HB-J104: in a jump {what} reads an impulse and {LEFT_OUT[how]}"

    def _of_answers(self, now: str, numbers: list[int]) -> str:
        """Return which branches laws may take together, and which of them are taken why."""
        why, many, more, *rest = numbers
        rows = [rest[k : k + 1 + many] for k in range(0, len(rest), 1 + many)]
        names = ", ".join(self.graph.nodes[self._ports[port]].path for port, *_ in rows)
        answers = [
            "(" + ", ".join(self._branch(port, ways[k]) for port, *ways in rows) + ")"
            for k in range(many)
        ]
        return (
            f"{now} the laws of {names} have {f'more than {many}' if more else many} answers: "
            f"{answers[0]} is taken, {TAKEN[why]}, and not {' or '.join(answers[1:])}; "
            "a stiffness in the contact decides"
        )

    def _branch(self, port: int, way: int) -> str:
        return self._states[port][way if way >= 0 else 2]

    def _breaks_with_others(self, path: str) -> bool:
        """Whether the rule by which friction breaks loose looks at that of others, too."""
        machine = next(m for m in self.graph.machines if m.path == path)
        return any(len(rule.reads) > 1 for rule in machine.rules if rule.source == 0)

    def _far_apart(self, least: float, mode: Mode) -> str:
        return (
            "elements lie too many powers of ten apart for the arithmetic: in mode "
            f"({self.graph.mode_text(mode)}) a coefficient is {least:.0e} of its terms and has few "
            "digits; leave out what is negligible, or check units"
        )

    def _of_surfaces(self, kind: int, now: str, numbers: list[int]) -> str:
        graph = self.graph
        if kind == NOT_UNIQUE:
            many, sides = numbers[0], numbers[2::2]
            surfaces = self._surfaces(numbers[1::2])
            words = [
                "sliding" if side == SLIDES else self._state(s, above=side == ABOVE)
                for s, side in zip(surfaces, sides, strict=True)
            ]
            return (
                f"{now} the motion from {' and '.join(s.text for s in surfaces)} is not unique: "
                f"{many} ways lead on, among them off the surface on either side; "
                f"it goes on in ({', '.join(words)})"
            )
        surfaces = self._surfaces(numbers)
        first = surfaces[0]
        if kind == NO_WAY_ON:
            where = " and ".join(s.text for s in surfaces)
            return f"no way on was found from {where} {now}: events go on"
        if kind == TWIN_SURFACES:
            one, other = (graph.machines[s.machine].path for s in surfaces)
            return (
                f"{one} and {other} both switch on {surfaces[1].text}: only {one} slides, "
                "make them one machine"
            )
        if kind == WITHOUT_END:
            return (
                f"{graph.machines[first.machine].path} is pushed back over {first.text} at once "
                "from either side, and crossings make stored quantities jump without an end "
                f"({now.removeprefix('at ')}): no sliding motion is the limit of that"
            )
        return (
            f"both sides push into {first.text} {now}, but the jump on crossing it "
            "throws back by more than was gained: there is no sliding along it"
        )

    def _surfaces(self, numbers: list[int]) -> list[Surface]:
        return [self.explain.surfaces[k] for k in numbers]

    def _state(self, s: Surface, *, above: bool) -> str:
        return self.graph.machines[s.machine].states[s.above if above else s.below]

    def why_no_rest(self, no_solution: str) -> str:
        """Return why the contact could not rest that ended the run.

        `no_solution` is why its structure had none, the last time.
        """
        if self.unrest is None:
            return REBOUND
        why, number, force, sign = self.unrest
        if why == REBOUNDS:
            return REBOUND
        if why == NO_SOLUTION:
            return f"its structure has no solution at rest ({no_solution})"
        reactions = [r for c in contacts_of(self.graph).values() for r in c.reactions]
        text = reactions[number].text
        if why == NO_SIGN:
            return f"the impulses of {text} have no sign"
        if why == OPEN:
            return f"the equations at rest leave {text} open"
        wanted = "positive" if sign > 0 else "negative"
        return f"at rest {text} = {force:.6g}, which is not {wanted}"


def _of_made(off: float, moved: float) -> str:
    """Return what steps of a fixed length have made, or lost, in words."""
    return (
        f"steps of this length have {'made' if off > 0.0 else 'lost'} {abs(off):.3g} J, "
        f"{100.0 * abs(off) / moved:.2g} % of the {moved:.3g} J that moved: take a shorter "
        "step, or a solver that chooses its own"
    )


def _of_lost(now: str, off: float, moved: float) -> str:
    """Return what laws have made or lost between the ends of steps, in words."""
    return (
        f"from {now[3:]} on, steps have {'lost' if off > 0.0 else 'made'} {abs(off):.3g} J between "
        f"their ends, beside {moved:.3g} J that were stored or moved: a law is so steep there that "
        "in the middle of a step it does not say what was stored; compare with a smaller rtol"
    )
