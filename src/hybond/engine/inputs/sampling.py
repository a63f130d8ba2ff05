"""Signals that are set at instants and held between them."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import stored_name, value
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.inputs.calls import call_block
from hybond.engine.inputs.interval import ROUNDING, is_due, moment, one_instant
from hybond.engine.model import Model
from hybond.engine.reasons.facts import no_sample
from hybond.engine.words import Floats

JUMPS: Final = 1e-6
"""Part of a value that it jumps by at least within an instant."""
STAYS: Final = 0.5
"""Part of that by which it moves in as much time beyond."""


def sample(e: Engine, s: Floats) -> int:
    """Set the signals in `s` that are due now to what they read a priori; each instant once.

    At the very end of a run nothing is set. What would be is kept: what happens there with time
    alone is over when another one goes on.
    """
    m = e.model
    if m.samples == 0:
        return OK
    if e.t <= e.sampled_at or one_instant(e.sampled_at, e.t):
        return OK
    v = e.work.values
    for k in range(m.slots):
        v[k] = e.pre[k]
        v[m.slots + k] = e.pre[k]
    v[0] = e.t
    waited = one_instant(e.awaited_at, e.t)
    if e.t >= e.samples_end:
        if not waited:
            await_samples(e, v)
        return OK
    for k in range(m.samples):
        if not is_due(m, k, e.t):
            continue
        e.sampled_at = e.t
        if m.blocks > 0 and m.sample_block[k] >= 0:
            if run_block(e, m.sample_block[k], v, s) != OK:
                return REFUSED
            continue
        i = m.sample_signal[k]
        s[i] = e.awaited[i] if waited else value_at_instant(m, m.sample_value[k], v)
        size = value(m, m.sample_size[k], v)
        e.sample_terms[i] = size if math.isfinite(size) else 0.0
        if not math.isfinite(s[i]):
            why = "a sampled signal has no value"
            if m.tells != 0:
                return no_sample(e, i, s[i], why)
            return say_fault(e, "HB-N305", why, stored_name(m, m.storages + i))
    return OK


def await_samples(e: Engine, v: Floats) -> None:
    """Keep what is sampled now; blocks are called when it is set."""
    m = e.model
    for k in range(m.samples):
        if is_due(m, k, e.t) and not (m.blocks > 0 and m.sample_block[k] >= 0):
            e.awaited[m.sample_signal[k]] = value_at_instant(m, m.sample_value[k], v)
            e.awaited_at = e.t


def value_at_instant(m: Model, law: int, v: Floats) -> float:
    """Return what is sampled, where it jumps with time as it is from this instant on.

    Three tenths of a second are three times a tenth, whatever rounding makes of either. What jumps
    stays there beyond; what only moves goes on as far once more.
    """
    t = v[0]
    way = ROUNDING * math.fabs(t) if t != 0.0 else moment(m, t)
    here = value(m, law, v)
    v[0] = t + way
    behind = value(m, law, v)
    v[0] = t + 2.0 * way
    beyond = value(m, law, v)
    v[0] = t
    jump = math.fabs(behind - here)
    size = max(math.fabs(here), math.fabs(behind))
    return behind if jump > JUMPS * size and math.fabs(beyond - behind) < STAYS * jump else here


def run_block(e: Engine, block: int, v: Floats, s: Floats) -> int:
    """Call a block with what it reads of `v`, and set its outputs in `s`."""
    m = e.model
    c = e.calls
    first = m.block_first[block]
    for k in range(first, m.block_first[block + 1]):
        c.values[k - first] = value_at_instant(m, m.block_value[k], v)
    call_block(c, block, e.t)
    first = m.block_set[block]
    for k in range(first, m.block_set[block + 1]):
        i = m.block_signal[k]
        s[i] = c.values[k - first]
        if not math.isfinite(s[i]):
            why = "a block gives a signal no value"
            return say_fault(e, "HB-N305", why, stored_name(m, m.storages + i))
    return OK
