/* Move a motion on, step by step, as long as nothing can happen. */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef HYBOND_SOURCE
#define HYBOND_SOURCE "unknown"
#endif

/* Which sources this library was built from: a stale one is not used. */
const char *hb_source(void)
{
    return HYBOND_SOURCE;
}

/* A march under way. */
typedef struct {
    const hb_mode *m;
    hb_motion *o;
    const hb_sampling *sampling;
    hb_trail *trail;
    hb_work *work;
    double t_end;
    size_t n;
} march;

/* Repeat the step to t1 in which a guard holds at *at so that it ends just past that, for the full
 * accuracy of a step. The step that counts is left in `dense` and work.y1; 0 if in doubt. */
static int land(march *a, double *t1, double *at, double *dense)
{
    static const double PAST[] = {1e-6, 1e-3};
    const double t0 = a->o->t, whole = *t1;
    const size_t size = sizeof *dense * 4 * a->n;
    int repeated = 0;
    for (int k = 0; k < 2; ++k) {
        const double end = *at + PAST[k] * (*at - t0);
        double again;
        if (end >= whole || end - t0 <= 1e-9 * (whole - t0))
            break;
        repeated = 1;
        if (!hb_retry(a->m, a->o, a->work, end))
            return 0;
        hb_dense(a->m, a->o, a->work, end - t0, a->work->dense);
        const int found =
            hb_locate(a->m, a->o, a->work, a->sampling, end, a->work->dense, &again);
        if (found < 0)
            return 0;
        if (found) {
            memcpy(dense, a->work->dense, size);
            *t1 = end;
            *at = again;
            return 1;
        }
    }
    return !repeated || hb_retry(a->m, a->o, a->work, whole);
}

/* Make one step, row k of the trail. Where it gives up the motion has not moved. */
static int advance(march *a, size_t k)
{
    hb_motion *o = a->o;
    hb_trail *trail = a->trail;
    double t1, at, *dense = trail->dense + k * 4 * a->n, *y = trail->y + k * a->n;
    int moved;
    if (!hb_step(a->m, o, a->work, a->t_end, &t1, trail->rejected + k))
        return HB_DECLINED;
    hb_dense(a->m, o, a->work, t1 - o->t, dense);
    const int found = hb_locate(a->m, o, a->work, a->sampling, t1, dense, &at);
    if (found < 0 || (found && !land(a, &t1, &at, dense)))
        return HB_UNSURE;
    if (!found)
        at = t1;
    else if (at >= a->t_end - o->instant)
        return HB_UNSURE; /* one instant with what ends the interval */
    memcpy(trail->end + k * a->n, a->work->y1, sizeof *y * a->n);
    memcpy(y, a->work->y1, sizeof *y * a->n);
    if (at != t1)
        hb_between((int)a->n, o->y, dense, (at - o->t) / (t1 - o->t), y);
    /* the derivative at the end, before anything else is evaluated */
    memcpy(a->work->trial, a->work->k + 6 * a->n, sizeof *y * a->n);
    if (!hb_keep(a->m, o, a->work, at, y, &moved))
        return HB_UNSURE;
    if (moved && !found && !hb_rate(a->m, o, a->work, at, y, a->work->trial))
        return HB_DECLINED;
    if (a->m->outputs) {
        if (!hb_solve(a->m, o, a->work, at, y))
            return HB_DECLINED;
        double *outputs = trail->outputs + k * (size_t)a->m->outputs;
        for (int32_t i = 0; i < a->m->outputs; ++i)
            outputs[i] = hb_evaluate(a->m->code + a->m->output_code[i], a->m->constants, o->v);
    }
    double energy = 0.0;
    hb_known(a->m, o, a->work, at, y);
    for (int32_t i = 0; i < a->m->storages; ++i)
        energy += 0.5 * a->m->weighed[i] * y[i] * a->work->known[i];
    o->run_energy = fmax(o->run_energy, fabs(energy));
    o->t = trail->t[k] = at;
    trail->stop[k] = t1;
    memcpy(o->y, y, sizeof *y * a->n);
    memcpy(o->f, a->work->trial, sizeof *y * a->n);
    return found ? HB_EVENT : HB_FULL;
}

int32_t hb_pass(const hb_mode *m, hb_motion *o, hb_work *work, const hb_sampling *sampling,
                double t_end, int32_t most, int32_t begins, hb_trail *trail, int32_t *count)
{
    march a = {.m = m, .o = o, .sampling = sampling, .trail = trail, .work = work, .t_end = t_end};
    a.n = (size_t)m->storages + (size_t)m->signals + 2;
    int32_t why = begins && !hb_begin(m, o, work, t_end) ? HB_DECLINED : HB_FULL;
    for (int32_t made = 0; why == HB_FULL && made < most && o->t < t_end; ++made) {
        const double h = o->h, error_before = o->error_before, h_before = o->h_before;
        memcpy(work->guess, o->free, sizeof(double) * (size_t)m->free);
        why = advance(&a, (size_t)*count);
        if (why == HB_FULL || why == HB_EVENT) {
            ++*count;
        } else {
            o->h = h;
            o->error_before = error_before;
            o->h_before = h_before;
            memcpy(o->free, work->guess, sizeof(double) * (size_t)m->free);
        }
    }
    return why == HB_FULL && !(o->t < t_end) ? HB_ARRIVED : why;
}

/* March to t_end (after a jump if it `begins`), or until `most` steps are on the trail, or to the first
 * instant at which a guard holds, or up to the start of a step that the reference has to look at.
 * Returns the reason; *count are the steps. */
int32_t hb_march(const hb_mode *m, hb_motion *o, const hb_sampling *sampling, double t_end,
                 int32_t most, int32_t begins, hb_trail *trail, int32_t *count)
{
    hb_work work;
    *count = 0;
    if (!hb_reserve(&work, &m, 1))
        return HB_NO_MEMORY;
    const int32_t why = hb_pass(m, o, &work, sampling, t_end, most, begins, trail, count);
    free(work.all);
    return why;
}
