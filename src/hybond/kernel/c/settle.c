/* Mode selection at one instant: modes/settle.py and modes/trial.py, for machines that were written
 * and for diodes.
 *
 * Only modes that are known take part, and only what is clear is decided: a mode that nobody has
 * made ready yet, an expression without meaning, a loop, an impact that might be the last before
 * rest are all left to the reference, with the state as it was before the instant.
 */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 200 };
static const double IMPULSE_RTOL = 1e-9; /* as in modes/dirac.py */

int hb_settler_for(hb_settler *s)
{
    const hb_atlas *a = s->atlas;
    const size_t machines = (size_t)a->machines, slots = (size_t)a->slots;
    const size_t n = (size_t)a->storages + (size_t)a->signals;
    double *all = s->all = calloc(2 * n + slots + (size_t)a->bonds + (size_t)a->classes +
                                      machines + (size_t)a->surfaces + HB_WRITES + 1,
                         sizeof *all);
    if (!all)
        return 0;
    s->here = all;
    s->there = s->here + n;
    s->impulse = s->there + n;
    s->area = s->impulse + slots;
    s->largest = s->area + a->bonds;
    s->target = (int32_t *)(s->largest + a->classes);
    s->written = s->target + machines;
    s->slope = s->written + HB_WRITES;
    return 1;
}

void hb_within(const hb_settler *s, int32_t k)
{
    const hb_schedule *p = s->schedule;
    hb_motion *o = s->o;
    o->input = p->input + k * s->atlas->inputs;
    o->input_rate = p->rate + k * s->atlas->inputs;
    o->input_time = p->time + k * s->atlas->inputs;
    for (int32_t i = 0; i < s->atlas->ats; ++i)
        o->v[s->atlas->at_slot + i] = p->at[k * s->atlas->ats + i];
}

void hb_show(const hb_mode *m, hb_motion *o)
{
    memcpy(o->v + m->flag_slot, m->flags, sizeof *m->flags * (size_t)m->flag_count);
    o->free = m->guess;
}

/* The energy of what is stored: nonlinear laws are polynomials, integrated along a ray. */
static double energy_of(const hb_settler *s, const hb_mode *m, const double *x)
{
    const double *real = s->atlas->real;
    double sum = 0.0, *v = s->o->v + m->stored_slot;
    for (int32_t i = 0; i < m->storages; ++i)
        for (int32_t k = m->co_energy.first[i]; k < m->co_energy.first[i + 1]; ++k) {
            const int32_t j = m->co_energy.column[k];
            sum += 0.5 * real[i] * real[j] * m->co_energy.value[k] * x[i] * x[j];
        }
    for (int32_t p = 0; m->laws && p < m->points; ++p) {
        for (int32_t i = 0; i < m->storages; ++i)
            v[i] = m->point[p] * x[i];
        for (int32_t k = 0; k < m->laws; ++k) {
            const int32_t i = m->law_at[k];
            sum += m->weight[p] * real[i] * x[i] *
                   hb_evaluate(m->code + m->law_code[k], m->constants, s->o->v);
        }
    }
    return fabs(sum);
}

/* The impulses of the jump just made, those that are rounding left out. */
static void impulses(hb_settler *s, const hb_mode *m, const double *x)
{
    const hb_atlas *a = s->atlas;
    const double spread = sqrt(s->o->run_energy);
    for (int32_t c = 0; c < a->classes; ++c)
        s->largest[c] = 0.0;
    for (int32_t i = 0; i < m->storages; ++i) {
        double *most = s->largest + a->storage_class[i];
        *most = fmax(fmax(*most, m->stored_reach[i] * spread),
                     fmax(fabs(s->here[i]), fabs(x[i])));
    }
    for (int32_t b = 0; b < a->bonds; ++b) {
        double sum = 0.0;
        for (int32_t k = m->kick.first[b]; k < m->kick.first[b + 1]; ++k)
            sum += m->kick.value[k] * s->work->met[m->kick.column[k]];
        s->area[b] = sum;
        s->largest[a->bond_class[b]] = fmax(s->largest[a->bond_class[b]], fabs(sum));
    }
    s->struck = 0;
    for (int32_t b = 0; b < a->bonds; ++b) {
        const int shown = fabs(s->area[b]) > IMPULSE_RTOL * s->largest[a->bond_class[b]];
        s->impulse[m->bond_slot + b] = shown ? s->area[b] : 0.0;
        s->struck |= shown;
    }
}

hb_signals hb_signals_of(const hb_settler *s, const hb_mode *m, int jumped)
{
    hb_signals all = {s->o->v, s->o->v + m->slots, jumped ? s->impulse : 0, 0, m->slots,
                      m, s->o, s->work, sqrt(s->o->run_energy)};
    return all;
}

int hb_enter(hb_settler *s, const hb_mode *m, double t, int jump)
{
    const int nx = m->storages, n = nx + m->signals;
    hb_motion *o = s->o;
    int how = HB_STAYS;
    hb_show(m, o);
    memcpy(s->there, s->here, sizeof *s->here * (size_t)n);
    o->run_energy = fmax(o->run_energy, energy_of(s, m, s->here));
    if (jump) {
        how = hb_jump(m, o, s->work, t, s->here);
        if (!how)
            return 0;
        memcpy(s->there, s->work->kept, sizeof *s->there * (size_t)nx);
        o->run_energy = fmax(o->run_energy, energy_of(s, m, s->there));
    }
    if (how == HB_JUMPS)
        impulses(s, m, s->there);
    if (!hb_solve(m, s->o, s->work, t, s->there))
        return 0;
    if (how == HB_JUMPS && m->signals) {
        const hb_signals all = hb_signals_of(s, m, 1);
        int moved = 0;
        for (int i = 0; i < m->signals; ++i) {
            hb_pair rate;
            if (!hb_paired(m->code + m->signal_code[i], m->constants, &all, &rate))
                return 0;
            if (hb_impulsive(&rate)) {
                s->there[nx + i] = s->here[nx + i] + rate.impulse;
                moved = 1;
            }
        }
        if (moved && !hb_solve(m, s->o, s->work, t, s->there))
            return 0;
    }
    return how;
}

/* Where the mode in s->target stands, -1 if it is not known. */
int32_t hb_lookup(const hb_settler *s)
{
    const size_t size = sizeof *s->target * (size_t)s->atlas->machines;
    for (int32_t k = 0; k < s->atlas->modes; ++k) {
        const hb_mode *m = s->atlas->mode[k];
        if (m && !memcmp(m->state, s->target, size))
            return k;
    }
    memcpy(s->log->wanted, s->target, size);
    return -1;
}

/* What is there becomes what was: signals for pre(). */
static void remember(hb_settler *s, const hb_mode *m)
{
    memcpy(s->o->v + m->slots, s->o->v, sizeof(double) * (size_t)m->slots);
}

/* The transitions of all machines at once: 1 if any fires, -1 if one cannot be said. */
static int enabled(hb_settler *s, const hb_mode *m, int jumped, int32_t *fired)
{
    const hb_signals all = hb_signals_of(s, m, jumped);
    int any = 0;
    memcpy(s->target, m->state, sizeof *s->target * (size_t)m->machines);
    for (int32_t r = 0, last = -1; r < m->rules; ++r) {
        const int truth = hb_holds(m->code + m->rule_code[r], m->constants, &all);
        if (truth < 0)
            return -1;
        if (!truth || m->rule_machine[r] == last)
            continue;
        last = m->rule_machine[r];
        s->target[last] = m->rule_target[r];
        ++fired[last];
        any = 1;
    }
    return any;
}

int32_t hb_settle(hb_settler *s, double t, double *y, int32_t *mode, int32_t from, int32_t to,
                  int32_t row)
{
    const hb_atlas *a = s->atlas;
    const hb_mode *m = a->mode[*mode];
    hb_motion *o = s->o;
    const size_t n = (size_t)m->storages + (size_t)m->signals;
    int32_t now = *mode, real = now, *fired = s->log->fired + (size_t)row * (size_t)a->machines;
    int writes = 0, tries = 0;
    memset(fired, 0, sizeof *fired * (size_t)a->machines);
    if (!m->enterable)
        return HB_DECLINED;
    hb_show(m, o);
    hb_within(s, from);
    if (!hb_solve(m, o, s->work, t, y))
        return HB_DECLINED;
    for (int32_t i = 0; i < m->storages; ++i)
        o->v[a->store_slot[i]] = a->store_sign[i] * s->work->known[i];
    hb_approach(s, m);
    remember(s, m);
    hb_within(s, to);
    s->jumped = 0;
    memcpy(s->here, y, sizeof *y * n);
    int how = hb_branches(s, &now, t, 1, 0, fired);
    for (;;) {
        int moved = 0, any;
        while (how > 0 && (any = enabled(s, a->mode[now], how == HB_JUMPS, fired)) != 0) {
            if (any < 0 || ++tries > TRIES)
                return HB_DECLINED;
            now = hb_lookup(s);
            if (now < 0)
                return HB_UNKNOWN;
            how = hb_branches(s, &now, t, 1, 0, fired);
            moved = 1;
        }
        if (how <= 0)
            return how < 0 ? HB_UNKNOWN : HB_DECLINED;
        if (!moved && how != HB_JUMPS && now == real)
            break;
        if (writes == a->most_writes)
            return HB_DECLINED;
        s->jumped |= how == HB_JUMPS && s->struck;
        s->written[writes++] = real = now;
        m = a->mode[now];
        memcpy(s->here, s->there, sizeof *s->here * n);
        if (!hb_enter(s, m, t, 0))
            return HB_DECLINED;
        remember(s, m);
        /* laws may ask for another jump; a declared impact law must not act on its own result */
        how = hb_branches(s, &now, t, m->ports && !m->fieldless, 1, fired);
    }
    /* events that crowd may accumulate: the reference looks at each of them; the corner of an input
     * at which nothing changes is none */
    if (writes && s->crowded)
        return HB_DECLINED;
    m = a->mode[now];
    if (m->fieldless)
        return HB_DECLINED;
    if (hb_slides(s, a->mode[*mode], m, t, y, from != to, fired))
        return HB_DECLINED;
    hb_within(s, from);
    if (!hb_observe(s, m, t, y, writes, row))
        return HB_DECLINED;
    memcpy(y, s->here, sizeof *y * n);
    *mode = now;
    s->log->changed[row] = writes > 0;
    s->log->struck[row] = s->jumped;
    return HB_EVENT;
}
