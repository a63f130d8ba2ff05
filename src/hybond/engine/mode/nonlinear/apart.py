"""Laws of a mode that do not know of each other: which of them are solved one after the other.

A law with one free unknown determines that, and where it is known perhaps another law has one left.
What remains falls into groups that have no unknown in common. Which unknowns a law has is told from
what it reads, whether its slopes are zero or not.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import fit_places
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.apart_records import Apart
from hybond.engine.model import Model

NO_GROUP: Final = -1
NONE_GIVEN: Final = -1
MANY: Final = -2


def find_groups(m: Model, mode: Mode) -> None:
    """Find the groups of laws of a mode, in the order in which they are solved.

    There is none where laws are not as many as free unknowns, or where a constraint has its
    derivative among them.
    """
    a = mode.apart
    a.groups = 0
    a.all_give = False
    frees = mode.finite_frees
    if mode.dynamics != frees or frees == 0:
        return
    for i in range(mode.dynamics):
        if mode.dynamic[i] < 0:
            return
    fit_places(a.begins, frees + 1)
    fit_places(a.row, frees)
    fit_places(a.unknown, frees)
    fit_places(a.group_of, frees)
    fit_places(a.row_group, frees)
    for j in range(frees):
        a.group_of.at[j] = NO_GROUP
        a.row_group.at[j] = NO_GROUP
    a.begins.at[0] = 0
    more = True
    while more:
        more = False
        for i in range(frees):
            j = NO_GROUP if a.row_group.at[i] != NO_GROUP else only_unknown(m, mode, i)
            if j >= 0:
                put_in_group(a, i, j)
                more = True
    for i in range(frees):
        if a.row_group.at[i] == NO_GROUP and not gather(m, mode, i):
            a.groups = 0
            return
    list_read(m, mode)
    note_given(m, mode)


def only_unknown(m: Model, mode: Mode, i: int) -> int:
    """Return the only unknown of row i that is in no group yet; MANY, or NO_GROUP: none is."""
    found = NO_GROUP
    d = mode.dynamic[i]
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        k = m.law_column[p]
        for s in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            j = mode.share_of.at[s]
            if mode.apart.group_of.at[j] == NO_GROUP and j != found:
                if found != NO_GROUP:
                    return MANY
                found = j
    return found


def put_in_group(a: Apart, i: int, j: int) -> None:
    """Let row i be a group of its own, for unknown j."""
    at = a.begins.at[a.groups]
    a.row.at[at] = i
    a.unknown.at[at] = j
    a.row_group.at[i] = a.groups
    a.group_of.at[j] = a.groups
    a.groups += 1
    a.begins.at[a.groups] = at + 1


def gather(m: Model, mode: Mode, first: int) -> bool:
    """Put what hangs together with a row into a group; whether rows are as many as unknowns."""
    a = mode.apart
    g = a.groups
    begin = a.begins.at[g]
    rows = 1
    unknowns = 0
    a.row.at[begin] = first
    a.row_group.at[first] = g
    done = 0
    while done < rows:
        d = mode.dynamic[a.row.at[begin + done]]
        done += 1
        for p in range(m.law_reads[d], m.law_reads[d + 1]):
            k = m.law_column[p]
            for s in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
                j = mode.share_of.at[s]
                if a.group_of.at[j] == NO_GROUP:
                    a.group_of.at[j] = g
                    a.unknown.at[begin + unknowns] = j
                    unknowns += 1
        for i in range(mode.dynamics):
            if a.row_group.at[i] == NO_GROUP and reads_of(m, mode, i, g):
                a.row.at[begin + rows] = i
                a.row_group.at[i] = g
                rows += 1
    a.groups += 1
    a.begins.at[a.groups] = begin + rows
    return rows == unknowns


def reads_of(m: Model, mode: Mode, i: int, g: int) -> bool:
    """Whether row i reads an unknown of a group."""
    d = mode.dynamic[i]
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        k = m.law_column[p]
        for s in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            if mode.apart.group_of.at[mode.share_of.at[s]] == g:
                return True
    return False


def list_read(m: Model, mode: Mode) -> None:
    """List the bond variables that the laws of each group read."""
    a = mode.apart
    many = 0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        many += m.law_reads[d + 1] - m.law_reads[d]
    fit_places(a.read, many)
    fit_places(a.read_from, a.groups + 1)
    many = 0
    for g in range(a.groups):
        a.read_from.at[g] = many
        for q in range(a.begins.at[g], a.begins.at[g + 1]):
            d = mode.dynamic[a.row.at[q]]
            for p in range(m.law_reads[d], m.law_reads[d + 1]):
                k = m.law_column[p]
                known = False
                for s in range(a.read_from.at[g], many):
                    known = known or a.read.at[s] == k
                if not known:
                    a.read.at[many] = k
                    many += 1
    a.read_from.at[a.groups] = many


def note_given(m: Model, mode: Mode) -> None:
    """Note of each group the variable that its law only gives."""
    a = mode.apart
    fit_places(a.given, a.groups)
    a.all_give = True
    for g in range(a.groups):
        begin = a.begins.at[g]
        a.given.at[g] = given_by(m, mode, begin) if a.begins.at[g + 1] == begin + 1 else NONE_GIVEN
        a.all_give = a.all_give and a.given.at[g] >= 0


def given_by(m: Model, mode: Mode, at: int) -> int:
    """Return the variable that a law gives, which its unknown alone has part in; or NONE_GIVEN."""
    d = mode.dynamic[mode.apart.row.at[at]]
    given = given_of(m, d)
    if given < 0 or mode.share_first.at[given + 1] != mode.share_first.at[given] + 1:
        return NONE_GIVEN
    j = mode.apart.unknown.at[at]
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        k = m.law_column[p]
        for s in range(mode.share_first.at[k], mode.share_first.at[k + 1]):
            if (mode.share_of.at[s] == j) != (k == given):
                return NONE_GIVEN
    return given if slope_of_given(m, d, given) != 0.0 else NONE_GIVEN


def given_of(m: Model, d: int) -> int:
    """Return the variable that a law gives, the other one of its bond; or NONE_GIVEN."""
    other = m.dynamic_partner[d] if d >= 0 else -1
    if other < 0:
        return NONE_GIVEN
    return other + m.bonds if other < m.bonds else other - m.bonds


def slope_of_given(m: Model, d: int, given: int) -> float:
    """Return by what a law falls or rises with the variable that it gives; 0 if that varies."""
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        if m.slope_column[p] == given:
            return m.slope_constant[p] if m.slope_value[p] < 0 else 0.0
    return 0.0
