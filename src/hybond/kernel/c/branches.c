/* The branches of diodes at an instant: modes/laws/complementarity.py, as far as they are clear.
 *
 * They are sought by turning those that are violated, and taken only if each stands beyond doubt:
 * then they are the only answer, for the problem is monotone (kernel/settling.py asks that), and the
 * one that the reference would find.
 */
#include "hybond.h"

#include <math.h>
#include <string.h>

enum { TURNS = 16, UNDECIDED = 2, CARRIES = 2, BARRED = 4 };
static const double ZERO = 1e-12; /* as in modes/laws/complementarity.py */
static const double DUST = 1e-9;  /* as in modes/trial.py */
static const double FEW = 4.0;     /* times that from which on a value is beyond doubt */
static const double SOON = 1e-3;  /* part of a run within which zero is left behind */
static const double CLEAR = 1e-9; /* a rate below this part of its terms decides nothing */

/* The rate of what is followed, and the size of its terms; 0 if it is not known. */
int hb_rate_of(hb_settler *s, const hb_mode *m, int32_t p, double *rate, double *size)
{
    const double *w = s->work->w;
    if (m->sense_push[p] < 0)
        return 0;
    *rate = hb_evaluate(m->code + m->sense_push[p], m->constants, s->o->v);
    *size = fabs(*rate);
    for (int32_t k = m->sense.first[p]; k < m->sense.first[p + 1]; ++k) {
        const int32_t j = m->sense.column[k];
        for (int32_t i = m->co_energy.first[j]; i < m->co_energy.first[j + 1]; ++i) {
            const int32_t x = m->co_energy.column[i];
            const double term = m->sense.value[k] * m->co_energy.value[i] * m->rate_sign[x] *
                                w[m->rate_row[x]];
            *rate += term;
            *size += fabs(term);
        }
    }
    return *rate == *rate;
}

/* The sign of the rate of what is followed; 0 also if it is not clear. */
int hb_trend(hb_settler *s, const hb_mode *m, int32_t p)
{
    double rate, size;
    if (!hb_rate_of(s, m, p, &rate, &size) || fabs(rate) <= CLEAR * size)
        return 0;
    return rate > 0.0 ? 1 : -1;
}

/* Whether a law may stay in its branch: 1 or -1 beyond doubt; 0 if its value and its rate are zero;
 * UNDECIDED if that cannot be said. */
static int branch_stands(hb_settler *s, const hb_mode *m, int32_t p, int jumped, int stay,
                         int turned)
{
    const hb_signals all = hb_signals_of(s, m, jumped);
    hb_pair value;
    if (m->port_gate[p] >= 0) {
        const int32_t *gate = m->code + m->port_gate[p];
        const int open = hb_holds(gate, m->constants, &all);
        if (open < 0 || open != (hb_evaluate(gate, m->constants, s->o->v) != 0.0))
            return UNDECIDED;
        if (!open)
            return 1; /* it may not take its other branch at all */
    }
    if (!hb_paired(m->code + m->sense_code[p], m->constants, &all, &value))
        return UNDECIDED;
    const int sign = hb_sign(&value);
    if (sign == UNDECIDED)
        return UNDECIDED;
    /* a mode that asks for an impulse is none to stay in: only what is violated counts */
    if (stay || jumped)
        return sign < 0 ? -1 : 1;
    if (sign > 0 && m->port_adrift[p] == CARRIES)
        return UNDECIDED; /* its share of a flow is at will, and may as well be none */
    const double large = fabs(value.finite), zero = ZERO * value.size;
    if (large > FEW * zero)
        return sign;
    /* what passes through zero at an instant is decided by its rate, if that is not slow */
    const int trend = hb_trend(s, m, p);
    double rate, size;
    if (trend && hb_rate_of(s, m, p, &rate, &size) &&
        fabs(rate) * SOON * s->atlas->until < zero)
        return turned && large <= zero ? 0 : UNDECIDED;
    if (large > zero && trend != sign)
        return UNDECIDED;
    return trend > 0 && sign < 0 ? UNDECIDED : trend;
}

/* Whether all laws may stay in their branches: 1 if so, beyond doubt; 0 if not, with those that
 * must turn in s->target; UNDECIDED if nothing says.
 *
 * Where value and rate of some are zero, higher rates decide. All others stand beyond doubt, so that
 * no other answer differs but in these, and by no more than that. Those that were turned, because
 * the branch that was `given` was refuted, have the right one; several of them may share at will what
 * an open loop holds, or nothing. The others are idle and keep theirs, unless they might block a part
 * of such a loop. Branches that were just chosen `stay` unless they are violated. */
static int branches_stand(hb_settler *s, const hb_mode *m, const int32_t *given, int jumped,
                          int stay)
{
    int violated = 0, open = 0, shared = 1;
    memcpy(s->target, m->state, sizeof *s->target * (size_t)m->machines);
    for (int32_t p = 0; p < m->ports; ++p) {
        const int32_t k = m->port_machine[p];
        const int turned = m->state[k] != given[k];
        const int one = branch_stands(s, m, p, jumped, stay, turned);
        if (one == UNDECIDED)
            return UNDECIDED;
        if (one == 0 && !turned && (m->loose || (m->state[k] && m->port_drifts[p])))
            return UNDECIDED;
        open += one == 0 && turned;
        shared &= one != 0 || m->port_adrift[p] != 0;
        if (one < 0) {
            s->target[k] = m->port_turn[p];
            violated = 1;
        }
    }
    if (violated)
        return 0;
    return open > 1 && m->loose && !shared ? UNDECIDED : 1;
}

/* Whether a jump is nothing but rounding of what is stored. */
static int dust(const hb_settler *s, const hb_mode *m)
{
    const double spread = sqrt(s->o->run_energy);
    for (int32_t i = 0; i < m->storages; ++i)
        if (fabs(s->there[i] - s->here[i]) >
            DUST * (fabs(s->here[i]) + m->stored_reach[i] * spread))
            return 0;
    return !s->struck;
}

/* Seek branches from those of *now on: turn what is violated until all stand. How the mode is
 * entered, 0 if that cannot be said, -1 if a mode is not known, BARRED if *now itself is no mode to
 * begin with. */
static int seek(hb_settler *s, int32_t *now, const int32_t *given, double t, int jump, int stay)
{
    for (int turn = 0; turn < TURNS; ++turn) {
        const hb_mode *m = s->atlas->mode[*now];
        const int how = m->enterable ? hb_enter(s, m, t, jump) : 0;
        if (!how)
            return turn ? 0 : BARRED;
        if (!m->ports)
            return how;
        const int jumped = how == HB_JUMPS && !dust(s, m);
        const int stand = branches_stand(s, m, given, jumped, stay && !turn);
        if (stand == UNDECIDED || (stand && jumped))
            return 0; /* an impulse through junction laws is for the reference */
        if (stand)
            return how;
        *now = hb_lookup(s);
        if (*now < 0)
            return -1;
    }
    return 0;
}

/* Enter a mode with the branches that its laws take from there; how, or 0, or -1 as above.
 *
 * Where a switch shorts a diode that conducts, say, the branches as they were are no mode at all:
 * then others are sought from, those next to them. */
int hb_branches(hb_settler *s, int32_t *now, double t, int jump, int stay,
                           int32_t *fired)
{
    const hb_mode *first = s->atlas->mode[*now];
    int how = seek(s, now, first->state, t, jump, stay), unknown = 0;
    for (int32_t p = 0; how == BARRED && p < first->ports && p < TURNS; ++p) {
        memcpy(s->target, first->state, sizeof *s->target * (size_t)first->machines);
        s->target[first->port_machine[p]] = first->port_turn[p];
        *now = hb_lookup(s);
        unknown |= *now < 0;
        if (*now >= 0)
            how = seek(s, now, first->state, t, jump, 0);
    }
    if (how == BARRED)
        return unknown ? -1 : 0;
    if (how <= 0 || !first->ports)
        return how;
    const hb_mode *m = s->atlas->mode[*now];
    for (int32_t p = 0; p < m->ports; ++p) {
        const int32_t k = m->port_machine[p];
        fired[k] += m->state[k] != first->state[k];
    }
    return how;
}

