/* What an instant may be the beginning of: rest after impacts, or motion along a surface. Both are for
 * the reference; here is said only whether they are out of the question. */
#include "hybond.h"

#include <math.h>
#include <stddef.h>

/* How far the state y is from what an impact law prescribes at rest; nan if it has no value. */
static double speed(hb_settler *s, const hb_mode *m, int32_t contact, double t, const double *y)
{
    if (!hb_solve(m, s->o, s->work, t, y))
        return NAN;
    return hb_evaluate(m->code + m->contact_code[contact], m->constants, s->o->v);
}

/* Watch the impacts of an instant; 0 if one of them may be the last before rest, or is not known
 * well enough to tell (modes/landing/landing.py). */
int hb_observe(hb_settler *s, const hb_mode *m, double t, const double *before, int writes,
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
        hb_show(m, s->o);
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
void hb_approach(hb_settler *s, const hb_mode *m)
{
    for (int32_t k = 0; k < s->atlas->surfaces; ++k)
        s->slope[k] = hb_trend(s, m, m->ports + k);
}

/* Whether the motion may slide along a surface from here on (modes/sliding): it cannot if it crosses
 * one by its rate on both sides, or is clear of it. */
int hb_slides(hb_settler *s, const hb_mode *from, const hb_mode *m, double t, const double *y,
                  int timed, const int32_t *fired)
{
    const hb_atlas *a = s->atlas;
    const double spread = sqrt(s->o->run_energy);
    int others = -1, vanishes = 1;
    if (!a->surfaces)
        return 0;
    for (int32_t i = 0; i < m->storages; ++i)
        vanishes &= fabs(s->here[i] - y[i]) <=
                    a->vanished * (fabs(s->here[i]) + m->stored_reach[i] * spread);
    hb_show(m, s->o);
    if (!hb_solve(m, s->o, s->work, t, s->here))
        return 1;
    for (int32_t k = 0; k < m->machines; ++k)
        others += from->state[k] != m->state[k];
    for (int32_t p = 0; p < m->ports; ++p) /* each side has the branches of its own laws */
        others -= from->state[m->port_machine[p]] != m->state[m->port_machine[p]];
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
            if ((over && !s->jumped) || !hb_rate_of(s, m, m->ports + k, &rate, &size) ||
                !(fabs(g) > 2.0 * a->at_once * fabs(t) * size))
                return 1;
            continue;
        }
        if (!over)
            continue;
        const int up = is == a->above[k] ? 1 : -1;
        /* the sides of a surface are modes that differ in its machine alone */
        if (others || s->slope[k] != up || hb_trend(s, m, m->ports + k) != up)
            return 1;
    }
    return 0;
}

