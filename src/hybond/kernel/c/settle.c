/* Mode selection at one instant: modes/settle.py and modes/trial.py, for machines that were written
 * and for diodes.
 *
 * The branches of diodes are sought by turning those that are violated, and taken only if each
 * stands beyond doubt: then they are the only answer, for the problem is monotone (kernel/
 * settling.py asks that), and the one that the reference would find.
 *
 * Only modes that are known take part, and only what is clear is decided: a mode that nobody has
 * made ready yet, an expression without meaning, a loop, an impact that might be the last before
 * rest are all left to the reference, with the state as it was before the instant.
 */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 200, TURNS = 16, UNDECIDED = 2, CARRIES = 2 };
static const double IMPULSE_RTOL = 1e-9; /* as in modes/dirac.py */
static const double CLEAR = 1e-9; /* a rate below this part of its terms decides nothing */

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
    s->turned = s->target + machines; /* a double has room for two of them */
    s->written = s->turned + machines;
    s->slope = s->written + HB_WRITES;
    return 1;
}

void hb_within(const hb_settler *s, int32_t k)
{
    const hb_schedule *p = s->schedule;
    hb_motion *o = s->o;
    o->input = p->input + k * s->atlas->inputs;
    o->input_rate = p->rate + k * s->atlas->inputs;
    o->input_time = p->start[k];
    for (int32_t i = 0; i < s->atlas->ats; ++i)
        o->v[s->atlas->at_slot + i] = p->at[k * s->atlas->ats + i];
}

static void show(const hb_mode *m, hb_motion *o)
{
    memcpy(o->v + m->flag_slot, m->flags, sizeof *m->flags * (size_t)m->flag_count);
    o->free = m->guess;
}

/* The energy of linear storage. */
static double energy_of(const hb_atlas *a, const hb_mode *m, const double *x)
{
    double sum = 0.0;
    for (int32_t i = 0; i < m->storages; ++i)
        for (int32_t k = m->co_energy.first[i]; k < m->co_energy.first[i + 1]; ++k) {
            const int32_t j = m->co_energy.column[k];
            sum += 0.5 * a->real[i] * a->real[j] * m->co_energy.value[k] * x[i] * x[j];
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
    for (int32_t b = 0; b < a->bonds; ++b)
        s->impulse[m->bond_slot + b] =
            fabs(s->area[b]) > IMPULSE_RTOL * s->largest[a->bond_class[b]] ? s->area[b] : 0.0;
}

static hb_signals signals_of(const hb_settler *s, const hb_mode *m, int jumped)
{
    hb_signals all = {s->o->v, s->o->v + m->slots, jumped ? s->impulse : 0, s->work->sizes,
                      m->slots};
    return all;
}

static int evaluate(hb_settler *s, const hb_mode *m, double t, const double *y)
{
    if (!hb_solve(m, s->o, s->work, t, y))
        return 0;
    hb_sizes(m, s->o, s->work, 0.0);
    return 1;
}

/* Enter a mode from what is stored `here`, which leads `there`; how, 0 if it cannot be said. */
static int enter(hb_settler *s, const hb_mode *m, double t, int jump)
{
    const int nx = m->storages, n = nx + m->signals;
    hb_motion *o = s->o;
    int how = HB_STAYS;
    show(m, o);
    memcpy(s->there, s->here, sizeof *s->here * (size_t)n);
    o->run_energy = fmax(o->run_energy, energy_of(s->atlas, m, s->here));
    if (jump) {
        how = hb_jump(m, o, s->work, t, s->here);
        if (!how)
            return 0;
        memcpy(s->there, s->work->kept, sizeof *s->there * (size_t)nx);
        o->run_energy = fmax(o->run_energy, energy_of(s->atlas, m, s->there));
    }
    if (how == HB_JUMPS)
        impulses(s, m, s->there);
    s->jumped |= how == HB_JUMPS;
    if (!evaluate(s, m, t, s->there))
        return 0;
    if (how == HB_JUMPS && m->signals) {
        const hb_signals all = signals_of(s, m, 1);
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
        if (moved && !evaluate(s, m, t, s->there))
            return 0;
    }
    return how;
}

/* The rate of what is followed, and the size of its terms; 0 if it is not known. */
static int rate_with_size(hb_settler *s, const hb_mode *m, int32_t p, double *rate, double *size)
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
static int rate_of(hb_settler *s, const hb_mode *m, int32_t p)
{
    double rate, size;
    if (!rate_with_size(s, m, p, &rate, &size) || fabs(rate) <= CLEAR * size)
        return 0;
    return rate > 0.0 ? 1 : -1;
}

/* Whether a law may stay in its branch: 1 or -1 beyond doubt; 0 if its value and its rate are zero;
 * UNDECIDED if that cannot be said. */
static int branch_stands(hb_settler *s, const hb_mode *m, int32_t p, int jumped, int stay)
{
    const hb_signals all = signals_of(s, m, jumped);
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
    if (sign > 0 && !stay && m->port_adrift[p] == CARRIES)
        return UNDECIDED; /* its share of a flow is at will, and may as well be none */
    /* a mode that asks for an impulse is none to stay in: only what is violated counts */
    return sign ? sign : stay || jumped ? 1 : rate_of(s, m, p);
}

static int32_t lookup(const hb_settler *s)
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

/* Whether a law that conducts nothing in mode m would, if it blocked, have a share at will of what
 * an open loop holds: then the reference lets all of that loop block. 1 also if that is not known. */
static int adrift(hb_settler *s, const hb_mode *m, int32_t p)
{
    const int32_t k = m->port_machine[p];
    memcpy(s->target, m->state, sizeof *s->target * (size_t)m->machines);
    s->target[k] = m->port_turn[p];
    const int32_t other = lookup(s);
    return other < 0 || s->atlas->mode[other]->port_adrift[p] != 0;
}

/* Whether all laws may stay in their branches: 1 if so, beyond doubt; 0 if not, with those that
 * must turn in s->target; UNDECIDED if nothing says.
 *
 * Where value and rate of some are zero, higher rates decide. All others stand beyond doubt, so that
 * no other answer differs but in these. If they were turned to come here, because their other branch
 * was refuted, it is this one; several that block around an open loop do so together, in shares at
 * will. Those that have the branch that was `given` are idle, and keep it. Branches that were just
 * chosen `stay` unless they are violated. */
static int branches_stand(hb_settler *s, const hb_mode *m, const int32_t *given, int jumped,
                          int stay)
{
    int violated = 0, open = 0, came = 0, shared = 1;
    hb_sizes(m, s->o, s->work, sqrt(s->o->run_energy));
    for (int32_t p = 0; p < m->ports; ++p) {
        const int32_t k = m->port_machine[p];
        const int turned = s->turned[p], one = branch_stands(s, m, p, jumped, stay);
        if (one == UNDECIDED)
            return UNDECIDED;
        came += turned;
        if (one == 0 && turned)
            ++open;
        else if (one == 0 && (m->state[k] != given[k] || m->loose || adrift(s, m, p)))
            return UNDECIDED;
        shared &= one != 0 || m->port_adrift[p] != 0;
        violated += s->turned[p] = one < 0;
    }
    memcpy(s->target, m->state, sizeof *s->target * (size_t)m->machines);
    for (int32_t p = 0; p < m->ports; ++p)
        if (s->turned[p])
            s->target[m->port_machine[p]] = m->port_turn[p];
    if (violated)
        return 0;
    return open && (open != came || (open > 1 && !shared)) ? UNDECIDED : 1;
}

/* Enter a mode with the branches that its laws take from there; how, or 0, or -1 if one is not
 * known. */
static int settle_branches(hb_settler *s, int32_t *now, double t, int jump, int stay,
                           int32_t *fired)
{
    const int32_t *given = s->atlas->mode[*now]->state;
    memset(s->turned, 0, sizeof *s->turned * (size_t)s->atlas->machines);
    for (int turn = 0; turn < TURNS; ++turn) {
        const hb_mode *m = s->atlas->mode[*now];
        if (!m->enterable)
            return 0;
        const int how = enter(s, m, t, jump);
        if (!how || !m->ports)
            return how;
        const int stand = branches_stand(s, m, given, how == HB_JUMPS, stay && !turn);
        if (stand == UNDECIDED || (stand && how == HB_JUMPS))
            return 0; /* an impulse through junction laws is for the reference */
        if (stand) {
            for (int32_t p = 0; p < m->ports; ++p) {
                const int32_t k = m->port_machine[p];
                fired[k] += m->state[k] != given[k];
            }
            hb_sizes(m, s->o, s->work, 0.0);
            return how;
        }
        *now = lookup(s);
        if (*now < 0)
            return -1;
    }
    return 0;
}

/* What is there becomes what was: signals for pre(). */
static void remember(hb_settler *s, const hb_mode *m)
{
    memcpy(s->o->v + m->slots, s->o->v, sizeof(double) * (size_t)m->slots);
}

/* The transitions of all machines at once: 1 if any fires, -1 if one cannot be said. */
static int enabled(hb_settler *s, const hb_mode *m, int jumped, int32_t *fired)
{
    const hb_signals all = signals_of(s, m, jumped);
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

/* How far the state y is from what an impact law prescribes at rest; nan if it has no value. */
static double speed(hb_settler *s, const hb_mode *m, int32_t contact, double t, const double *y)
{
    if (!hb_solve(m, s->o, s->work, t, y))
        return NAN;
    return hb_evaluate(m->code + m->contact_code[contact], m->constants, s->o->v);
}

/* Watch the impacts of an instant; 0 if one of them may be the last before rest, or is not known
 * well enough to tell (modes/landing/landing.py). */
static int observe(hb_settler *s, const hb_mode *m, double t, const double *before, int writes,
                   int32_t row)
{
    const hb_atlas *a = s->atlas;
    double *approach = s->log->approach + (size_t)row * (size_t)a->machines;
    const double room = a->remaining * fmax(fabs(t), a->soonest * a->until);
    for (int32_t k = 0; k < a->machines; ++k) {
        int32_t contact = -1;
        approach[k] = NAN;
        for (int w = 0; w + 1 < writes; ++w) {
            const int32_t state = a->mode[s->written[w]]->state[k];
            const int32_t found = a->contact_of[k * a->states + state];
            contact = found >= 0 ? found : contact;
        }
        if (contact < 0)
            continue;
        if (!a->ready[contact])
            return 0;
        show(m, s->o);
        const double came = speed(s, m, contact, t, before);
        const double left = speed(s, m, contact, t, s->here);
        if (!(came == came && left == left))
            return 0;
        const int closed = a->rests_in[contact * a->states + m->state[k]];
        const double flight = t - a->since[k];
        const int lively = left >= 0.5 * came;
        if (!closed && (lively ? flight <= a->lively * room
                               : left <= a->slow * fmax(a->speed[k], came) ||
                                     flight <= a->fading * room))
            return 0;
        approach[k] = came;
    }
    for (int32_t k = 0; k < a->machines; ++k)
        if (approach[k] == approach[k]) {
            a->speed[k] = fmax(a->speed[k], approach[k]);
            a->since[k] = t;
        }
    return 1;
}

/* Note how the switching functions move before an instant. */
static void approach(hb_settler *s, const hb_mode *m)
{
    for (int32_t k = 0; k < s->atlas->surfaces; ++k)
        s->slope[k] = rate_of(s, m, m->ports + k);
}

/* Whether the motion may slide along a surface from here on (modes/sliding): it cannot if it crosses
 * one by its rate on both sides, or is clear of it. */
static int slides(hb_settler *s, const hb_mode *from, const hb_mode *m, double t, const double *y,
                  int timed, const int32_t *fired)
{
    const hb_atlas *a = s->atlas;
    const double spread = sqrt(s->o->run_energy);
    int crossed = 0, vanishes = 1;
    if (!a->surfaces)
        return 0;
    for (int32_t i = 0; i < m->storages; ++i)
        vanishes &= fabs(s->here[i] - y[i]) <=
                    a->vanished * (fabs(s->here[i]) + m->stored_reach[i] * spread);
    show(m, s->o);
    if (!evaluate(s, m, t, s->here))
        return 1;
    for (int32_t k = 0; k < a->surfaces; ++k) {
        const int32_t j = a->surface_machine[k], was = from->state[j], is = m->state[j];
        const int within = is == a->below[k] || is == a->above[k];
        const int over = fired[j] == 1 && within && was != is &&
                         (was == a->below[k] || was == a->above[k]);
        if (!within)
            continue;
        if (s->jumped && fired[j] && vanishes)
            return 1;
        if (timed || s->jumped) {
            const double g = hb_evaluate(m->code + m->sense_code[m->ports + k], m->constants,
                                         s->o->v);
            double rate, size;
            if ((over && !s->jumped) || !rate_with_size(s, m, m->ports + k, &rate, &size) ||
                !(fabs(g) > 2.0 * a->at_once * fabs(t) * size))
                return 1;
            continue;
        }
        if (!over)
            continue;
        const int up = is == a->above[k] ? 1 : -1;
        if (++crossed > 1 || s->slope[k] != up || rate_of(s, m, m->ports + k) != up)
            return 1;
    }
    return 0;
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
    show(m, o);
    hb_within(s, from);
    if (!hb_solve(m, o, s->work, t, y))
        return HB_DECLINED;
    for (int32_t i = 0; i < m->storages; ++i)
        o->v[a->store_slot[i]] = a->store_sign[i] * s->work->known[i];
    approach(s, m);
    remember(s, m);
    hb_within(s, to);
    s->jumped = 0;
    memcpy(s->here, y, sizeof *y * n);
    int how = settle_branches(s, &now, t, 1, 0, fired);
    for (;;) {
        int moved = 0, any;
        while (how > 0 && (any = enabled(s, a->mode[now], how == HB_JUMPS, fired)) != 0) {
            if (any < 0 || ++tries > TRIES)
                return HB_DECLINED;
            now = lookup(s);
            if (now < 0)
                return HB_UNKNOWN;
            how = settle_branches(s, &now, t, 1, 0, fired);
            moved = 1;
        }
        if (how <= 0)
            return how < 0 ? HB_UNKNOWN : HB_DECLINED;
        if (!moved && how != HB_JUMPS && now == real)
            break;
        if (writes == HB_WRITES)
            return HB_DECLINED;
        s->written[writes++] = real = now;
        m = a->mode[now];
        memcpy(s->here, s->there, sizeof *s->here * n);
        if (!enter(s, m, t, 0))
            return HB_DECLINED;
        remember(s, m);
        /* laws may ask for another jump; a declared impact law must not act on its own result */
        how = settle_branches(s, &now, t, m->ports && !m->fieldless, 1, fired);
    }
    m = a->mode[now];
    if (m->fieldless)
        return HB_DECLINED;
    if (slides(s, a->mode[*mode], m, t, y, from != to, fired))
        return HB_DECLINED;
    hb_within(s, from);
    if (!observe(s, m, t, y, writes, row))
        return HB_DECLINED;
    memcpy(y, s->here, sizeof *y * n);
    *mode = now;
    s->log->changed[row] = writes > 0;
    return HB_EVENT;
}
