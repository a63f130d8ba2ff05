"""What is printed: a table of outputs, or the events and the final state."""

from __future__ import annotations

from hybond.engine.answers import (
    bond_name,
    machine_name,
    node_name,
    output_name,
    rule_text,
    state_name,
    stored_name,
    value,
)
from hybond.engine.engine import Engine
from hybond.engine.instant.instant import (
    ACCUMULATION,
    GUARD,
    INPUT,
    LAW,
    MYTHICAL,
    PINNACLE,
    SAMPLE,
    START,
    TIME,
    Instant,
)
from hybond.engine.methods.stepping import between
from hybond.engine.model import Model
from hybond.engine.reasons.noting import (
    APART,
    BALANCE,
    CREATED,
    ELEMENT,
    ENDS,
    IMPACT,
    MANY,
    MOVES,
    PULLS,
    STORAGE,
    UNFIRED,
    UNTOUCHED,
)
from hybond.engine.timestepping.step_event import STEP
from hybond.engine.timestepping.step_shown import show_point
from hybond.engine.words import (
    Floats,
    Text,
    floats,
    put_line,
    put_number,
    put_text,
    record,
)


@record
class Report:
    """What is asked for, and how far the table is."""

    events: bool
    """Whether events are printed instead of the table."""
    silent: bool
    """Whether nothing is printed at all."""
    points: int
    next_point: int
    y: Floats
    left: Floats


def make_report(e: Engine) -> Report:
    """Return a report of the model's own points."""
    r = Report()
    r.points = e.model.points
    r.y = floats(e.states)
    r.left = floats(e.model.outputs)
    return r


def put_header(e: Engine, r: Report) -> None:
    """Print the names of the columns."""
    if r.events:
        return
    put_text("time")
    for k in range(e.model.outputs):
        put_text(",")
        put_text(output_name(e.model, k))
    put_line()


def put_row(e: Engine, t: float, y: Floats) -> None:
    """Print a row of the table: the outputs at a point of the motion."""
    m = e.model
    show_point(e, t, y)
    put_number(t)
    for k in range(m.outputs):
        put_text(",")
        put_number(value(m, m.output_value[k], e.shown))
    put_line()


def point_time(e: Engine, r: Report, k: int) -> float:
    """Return when output point k is due."""
    return e.until if k >= r.points else e.until * (float(k) / float(r.points))


def report_step(e: Engine, r: Report) -> None:
    """Print the points within the step that ended at the present time, that end left out."""
    if r.events or r.silent:
        return
    while r.next_point <= r.points and point_time(e, r, r.next_point) < e.t:
        t = point_time(e, r, r.next_point)
        between(e, t, r.y)
        put_row(e, t, r.y)
        r.next_point += 1


def report_slide(e: Engine, r: Report) -> None:
    """Do nothing: what is slid on shows in the events."""


def report_end(e: Engine, r: Report) -> None:
    """Print the row of the present time if a point is due."""
    if r.events or r.silent:
        return
    if r.next_point <= r.points and point_time(e, r, r.next_point) <= e.t:
        put_row(e, e.t, e.y)
        r.next_point += 1


def keep_left(e: Engine, r: Report) -> None:
    """Keep the outputs at the left limit of what may be an event."""
    m = e.model
    if r.events or r.silent:
        return
    show_point(e, e.t, e.y)
    for k in range(m.outputs):
        r.left[k] = value(m, m.output_value[k], e.shown)


def report_event(e: Engine, r: Report, i: Instant) -> None:
    """Print an event: the rows at its limits, or its transitions."""
    if r.silent:
        return
    if not r.events:
        if i.cause == STEP:
            return
        if i.cause != START:
            put_number(e.t)
            for k in range(e.model.outputs):
                put_text(",")
                put_number(r.left[k])
            put_line()
        put_row(e, e.t, e.y)
        while r.next_point <= r.points and point_time(e, r, r.next_point) <= e.t:
            r.next_point += 1
        return
    for step in range(i.steps):
        put_step(e, i, step)


def put_step(e: Engine, i: Instant, step: int) -> None:
    """Print a mode visited: the transitions that led there, the impulses that passed."""
    first = i.first.at[step]
    for f in range(first, i.first.at[step + 1]):
        put_transition(e, i, f, step)
    if first == i.first.at[step + 1]:
        put_number(i.t)
        put_text(" ")
        put_text(cause_name(i.cause))
        put_text(" - - -> - ")
        put_text(kind_name(i.kind.at[step]))
        put_line()
    for h in range(i.hit_first.at[step], i.hit_first.at[step + 1]):
        put_text("impulse ")
        put_number(i.t)
        put_text(" ")
        put_number(i.hit_area.at[h])
        put_text(" ")
        put_text(kind_name(i.kind.at[step]))
        put_text(" ")
        put_text(bond_name(e.model, i.hit_bond.at[h]))
        put_line()


def put_transition(e: Engine, i: Instant, f: int, step: int) -> None:
    """Print a transition."""
    m = e.model
    machine = i.machine.at[f]
    put_number(i.t)
    put_text(" ")
    put_text(cause_name(i.cause))
    put_text(" ")
    put_text(machine_name(m, machine))
    put_text(" ")
    put_state(m, machine, i.source.at[f])
    put_text(" -> ")
    put_state(m, machine, i.target.at[f])
    put_text(" ")
    put_text(kind_name(i.kind.at[step]))
    put_line()


def put_state(m: Model, machine: int, state: int) -> None:
    """Print a state of a machine; a negative one says that it slides."""
    if state < 0:
        put_text("sliding")
    else:
        put_text(state_name(m, m.state_first[machine] + state))


def cause_name(cause: int) -> Text:
    """Return why time stopped."""
    if cause == START:
        return "start"
    if cause == GUARD:
        return "guard"
    if cause == TIME:
        return "time"
    if cause == INPUT:
        return "input"
    if cause == SAMPLE:
        return "sample"
    if cause == LAW:
        return "law"
    if cause == ACCUMULATION:
        return "accumulation"
    return "step"


def kind_name(kind: int) -> Text:
    """Return what a mode was at an instant."""
    if kind == MYTHICAL:
        return "mythical"
    return "pinnacle" if kind == PINNACLE else "continuous"


def is_engines_own(e: Engine, signal: int) -> bool:
    """Whether an integrated signal is one that friction in the plane keeps for itself."""
    m = e.model
    found = False
    for d in range(m.disks):
        found = found or m.disk_heading[d] == signal or m.disk_slow[d] == signal
    return found


def put_final(e: Engine, r: Report) -> None:
    """Print the final state."""
    if not r.events:
        return
    put_text("final ")
    put_number(e.t)
    put_line()
    for k in range(e.states):
        if is_engines_own(e, k - e.model.storages):
            continue
        put_text("state ")
        put_text(stored_name(e.model, k))
        put_text(" ")
        put_number(e.y[k])
        put_line()


def put_stuck(e: Engine) -> None:
    """Print where events accumulate that nothing can rest after."""
    put_text("# stopped: events of ")
    put_text(machine_name(e.model, e.landings.stuck_machine))
    put_text(" accumulate (t = ")
    put_number(e.t)
    put_text(" s)")
    put_line()


def put_fault(e: Engine) -> None:
    """Print why the run stopped."""
    put_text("# stopped: ")
    put_text(e.fault.code)
    put_text(" ")
    put_text(e.fault.why)
    if e.fault.place != "":
        put_text(" at ")
        put_text(e.fault.place)
    put_text(" (t = ")
    put_number(e.fault.t)
    put_text(" s)")
    put_line()


def put_unsound(e: Engine) -> None:
    """Print which law did not hold first."""
    m = e.model
    c = e.checks
    put_text("# unsound: HB-N411 ")
    if c.what == ELEMENT:
        put_text("the law of ")
        put_text(node_name(m, m.element_node[c.index]))
    elif c.what == STORAGE:
        put_text("the law of ")
        put_text(stored_name(m, c.index))
    elif c.what == UNTOUCHED:
        put_text("what no jump reaches of ")
        put_text(stored_name(m, c.index))
    elif c.what == UNFIRED or c.what == APART:
        put_text("the guard ")
        put_text(rule_text(m, c.index))
    elif c.what == MANY:
        put_text("another solution of ")
        put_text(node_name(m, m.element_node[c.index]))
    elif c.what == ENDS:
        put_text("the end of a solution of ")
        put_text(node_name(m, m.element_node[c.index]))
    elif c.what == BALANCE:
        put_text("the energy of steps of ")
        put_text(stored_name(m, c.index))
    elif c.what == MOVES:
        put_text("the rate of ")
        put_text(stored_name(m, c.index))
    elif c.what == CREATED:
        put_text("the energy of a jump of ")
        put_text(stored_name(m, c.index))
    elif c.what == IMPACT:
        put_text("the impact of ")
        put_text(node_name(m, m.port_node[c.index]))
    elif c.what == PULLS:
        put_text("the mean of ")
        put_text(node_name(m, m.port_node[c.index]))
    else:
        put_text("the law of a junction")
    put_text(" is off by ")
    put_number(c.off)
    put_text(" (t = ")
    put_number(c.t)
    put_text(" s)")
    put_line()
