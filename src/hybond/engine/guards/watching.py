"""The guards that may leave a mode: rules, kinks, and what ends sliding."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.guards.in_force import is_asked
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, NONE, Locator, fit_locator
from hybond.engine.guards.timetable_records import by_time_alone
from hybond.engine.mode.comparisons.sum_records import begin_sums
from hybond.engine.mode.comparisons.sums import take_sum
from hybond.engine.mode.reading import note_plain, read_guard, read_nothing
from hybond.engine.surfaces.followers import is_led
from hybond.engine.surfaces.law_means import is_meant, rests_on_mean
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Ints


def watch(e: Engine, g: Locator, state: Ints) -> None:
    """Take the guards that leave a mode."""
    m = e.model
    s = e.slide
    same = e.mode_at == g.watched and e.mode.made == g.watched_made
    own = s.k == 0 and s.many == 0 and not e.landings.any_landed
    if m.watches > 0 or m.kinks > 0 or m.disks > 0 or (m.laws > 0 and m.groups > 0):
        own = False  # how far laws that bend may reach is of the state that they are at
    if same and g.kept and own:
        watch_again(e, g)
        return
    g.kept = own
    rules = m.rule_first[m.machines]
    rests = m.surface_rest[2 * m.surfaces]
    apart = m.laws > 0 or m.followers > 0 or m.kinks > 0
    several = s.parts + 1 if s.k > 0 and apart else 1
    atoms = several * m.atom_first[rules] + m.rest_atom[rests] - m.atom_first[rules]
    turns = m.turn_first[rules + m.kinks + m.slide_kinks] - m.turn_first[rules]
    atoms += several * m.turn_first[rules] + (several + m.surfaces) * turns
    if not same or m.watches > 0 or s.k > 0:
        forget_denied(g)
    g.watched = e.mode_at
    g.watched_made = e.mode.made
    kinks = several * m.kinks + m.surface_jump_first[m.surfaces]
    margins = 2 * s.k + m.ports
    fit_locator(g, several * rules + rests + margins + kinks, atoms + margins + kinks)
    g.guards = 0
    g.atoms = 0
    read_nothing(m, g.reads)
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            elsewhere = e.planar.leading and m.law_planar[k] != 0
            # laws hold in each of the modes combined, not on their average: `watch_slide`
            elsewhere = elsewhere or (s.k > 0 and m.is_law[k] != 0)
            if elsewhere or m.rule_watched[r] == 0 or not is_asked(e, k, r, state[k]):
                continue
            watch_rule(e, g, r, ALL_PARTS)
            read_guard(m, e.mode, g.reads, r)
    g.rounded = s.k == 0
    if s.k > 0:
        watch_slide(e, g)
    elif not e.planar.leading:
        watch_kinks(e, g)
    if s.k == 0:
        note_plain(m, e.mode, g.reads)
    g.atom_first[g.guards] = g.atoms
    take_turns(e, g)
    begin_sums(g.sums, g.atoms)
    for a in range(g.atoms if s.k == 0 else 0):
        take_sum(e, g.sums, a, g.atom[a])


def watch_again(e: Engine, g: Locator) -> None:
    """Take the guards that were taken in this mode before: only inputs may be others."""
    for k in range(g.guards):
        g.still[k] = 0
    if e.model.inputs > 0 or (e.model.laws > 0 and not e.mode.seen_taken):
        begin_sums(g.sums, g.atoms)
        for a in range(g.atoms):
            take_sum(e, g.sums, a, g.atom[a])


def watch_kinks(e: Engine, g: Locator) -> None:
    """Take the kinks of laws, sources and rates."""
    m = e.model
    for k in range(m.kinks):
        switch = m.kink_switch[k]
        if switch < 0 or e.mode.on[switch] != 0:  # else nothing feels it
            watch_kink(e, g, k, ALL_PARTS)


def watch_kinks_apart(e: Engine, g: Locator) -> None:
    """Take the kinks of laws, sources and rates in each of the modes combined.

    What they have in common is asked of the motion, once.
    """
    m = e.model
    for k in range(m.kinks):
        apart = is_apart(e, m.kink_pair[k])
        switch = m.kink_switch[k]
        felt = False
        for part in range(e.slide.parts):
            feels = switch < 0 or part_mode(e, part).on[switch] != 0
            felt = felt or feels
            if apart and feels:
                watch_kink(e, g, k, part)
        if felt and not apart:
            watch_kink(e, g, k, ALL_PARTS)


def is_apart(e: Engine, pair: int) -> bool:
    """Whether what is compared may differ from mode to mode: it reads bond variables, or modes."""
    m = e.model
    booleans = m.on_slot + m.switches + m.state_first[m.machines]
    for p in range(m.read_first[pair], m.read_first[pair + 1]):
        slot = m.read_slot[p]
        if slot >= m.bond_slot and slot < m.bond_slot + 2 * m.bonds:
            return True
        if slot >= m.on_slot and slot < booleans:
            return True
    return False


def watch_kink(e: Engine, g: Locator, k: int, part: int) -> None:
    """Take one of them, in one of the modes combined or in the motion as it is."""
    m = e.model
    begin_guard(g, NONE, part)
    g.side[g.guards] = 0
    g.timed[g.guards] = 1 if by_time_alone(m, m.kink_pair[k]) else 0
    g.pair[g.guards] = m.kink_pair[k]
    end_guard(g, m.kink_atom + k, m.kink_atom + k + 1)
    read_guard(m, e.mode, g.reads, m.kink_pair[k])


def watch_slide(e: Engine, g: Locator) -> None:
    """Take what ends sliding: what allows it, weights, and branches in the modes combined.

    And at what a surface jumps, and laws bend.
    """
    m = e.model
    s = e.slide
    watch_kinks_apart(e, g)
    for j in range(s.k):
        for p in range(m.surface_jump_first[s.side[j]], m.surface_jump_first[s.side[j] + 1]):
            watch_kink(e, g, m.surface_jump[p], ALL_PARTS)
        for p in range(m.surface_rest[2 * s.side[j]], m.surface_rest[2 * s.side[j] + 2]):
            if m.rest_moves[p] != 0:
                begin_guard(g, m.surface_up[s.side[j]], ALL_PARTS)
                g.pair[g.guards] = m.rest_pair[p]
                g.test[g.guards] = m.rest_test[p]
                end_guard(g, m.rest_atom[p], m.rest_atom[p + 1])
    for margin in range(2 * s.k + m.ports):
        if margin < 2 * s.k or is_meant(e, margin - 2 * s.k):
            begin_guard(g, NONE, ALL_PARTS)
            g.margin[g.guards] = margin
            end_guard(g, NONE - margin, NONE - margin + 1)
    for part in range(s.parts if m.laws > 0 or m.followers > 0 else 0):
        for k in range(m.machines):
            there = (m.is_law[k] != 0 and not rests_on_mean(e, k)) or is_led(m, s, k)
            for r in range(m.rule_first[k], m.rule_first[k + 1] if there else 0):
                asked = m.rule_source[r] == part_mode(e, part).state[k] and m.rule_landed[r] == 0
                if asked and m.rule_watched[r] != 0:
                    watch_rule(e, g, r, part)


def watch_rule(e: Engine, g: Locator, r: int, part: int) -> None:
    """Take the guard of a rule, asked of one of the modes combined or of the motion as it is."""
    m = e.model
    begin_guard(g, r, part)
    g.pair[g.guards] = r
    g.test[g.guards] = m.rule_test[r]
    end_guard(g, m.atom_first[r], m.atom_first[r + 1])


def begin_guard(g: Locator, rule: int, part: int) -> None:
    """Begin one more guard."""
    if g.rule[g.guards] != rule:
        g.denied[g.guards] = 0
    g.rule[g.guards] = rule
    g.pair[g.guards] = NONE
    g.test[g.guards] = NONE
    g.margin[g.guards] = NONE
    g.part[g.guards] = part
    g.side[g.guards] = NO_KINK
    g.sleep[g.guards] = 0
    g.nap[g.guards] = 1
    g.blurred[g.guards] = 0
    g.still[g.guards] = 0
    g.atom_first[g.guards] = g.atoms


def end_guard(g: Locator, first: int, stop: int) -> None:
    """End it with its comparisons: those of the model, or a negative one for a margin."""
    for a in range(first, stop):
        g.atom[g.atoms] = a
        g.atom_part[g.atoms] = g.part[g.guards]
        g.atom_guard[g.atoms] = g.guards
        g.atoms += 1
    g.guards += 1


def take_turns(e: Engine, g: Locator) -> None:
    """Take what is zero where the comparisons of these guards turn, behind all comparisons."""
    m = e.model
    at = g.atoms
    for k in range(g.guards):
        g.turn_first[k] = at
        own = -1
        if g.side[k] != NO_KINK:
            own = m.rule_first[m.machines] + g.atom[g.atom_first[k]] - m.kink_atom
        elif g.rule[k] >= 0 and g.pair[k] == g.rule[k]:
            own = g.rule[k]
        for p in range(m.turn_first[max(own, 0)], m.turn_first[own + 1] if own >= 0 else 0):
            g.atom[at] = m.turn_atom[p]
            g.atom_part[at] = g.part[k]
            g.atom_guard[at] = k
            g.pole[at] = m.turn_pole[p]
            at += 1
    g.turn_first[g.guards] = at


def forget_denied(g: Locator) -> None:
    """Forget with which signs guards are false: the Booleans that they read may be others now."""
    for k in range(g.room):
        g.denied[k] = 0
