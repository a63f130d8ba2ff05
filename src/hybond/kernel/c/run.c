/* A run through events: segments of motion in known modes, with the instants between them. */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LONGER = 10.0;

/* What a state was like where a segment began: one that does not end here has not begun. */
typedef struct {
    double t, energy, run_energy, *y, *largest, *guess;
} mark;

static void note(mark *k, const hb_mode *m, const hb_motion *o, size_t n)
{
    memcpy(k->guess, m->guess, sizeof *m->guess * (size_t)m->free);
    k->t = o->t;
    k->energy = o->energy;
    k->run_energy = o->run_energy;
    memcpy(k->y, o->y, sizeof *o->y * n);
    memcpy(k->largest, o->largest, sizeof *o->y * (n - 2));
}

static void go_back(const mark *k, const hb_mode *m, hb_motion *o, size_t n)
{
    memcpy(m->guess, k->guess, sizeof *m->guess * (size_t)m->free);
    o->t = k->t;
    o->energy = k->energy;
    o->run_energy = k->run_energy;
    memcpy(o->y, k->y, sizeof *o->y * n);
    memcpy(o->largest, k->largest, sizeof *o->y * (n - 2));
}

/* What the rates of stored quantities cancel from, where a motion starts: ErrorScale.start. */
static int rounding(const hb_mode *m, hb_motion *o, hb_work *work, double part)
{
    if (!hb_solve(m, o, work, o->t, o->y))
        return 0;
    for (int32_t i = 0; i < m->storages; ++i) {
        const int row = m->rate_row[i];
        o->rounding[i] = part * fmax(hb_row_size(m, o, work, row), fabs(work->w[row]));
    }
    return 1;
}

/* One segment in `mode`, to its end and over it; the reason why not, or HB_EVENT. */
static int32_t segment(hb_settler *s, const hb_sampling *sampling, int32_t *mode, int32_t *interval,
                       int32_t most, hb_trail *trail, int32_t *count, double *last, hb_log *log)
{
    const hb_atlas *a = s->atlas;
    const hb_mode *m = a->mode[*mode];
    hb_motion *o = s->o;
    const int32_t k = *interval, row = log->rows;
    const size_t n = (size_t)m->storages + (size_t)m->signals + 2;
    const double end = fmin(s->schedule->end[k], a->until);
    memcpy(o->v + m->flag_slot, m->flags, sizeof *m->flags * (size_t)m->flag_count);
    hb_within(s, k);
    memset(o->v + m->slots, 0, sizeof *o->v * (size_t)m->slots); /* nothing was before */
    o->free = m->guess;
    o->instant = a->event_tol * fmax(a->until, fabs(o->t));
    if (!rounding(m, o, s->work, a->rounded))
        return HB_DECLINED;
    int32_t why = hb_pass(m, o, s->work, sampling, end, most, 1, trail, count);
    if (why != HB_EVENT && why != HB_ARRIVED)
        return why;
    const int timed = why == HB_ARRIVED;
    if (timed && (end >= a->until || k + 1 >= s->schedule->count))
        return HB_ARRIVED;
    const double gap = o->t - *last;
    if (gap <= a->event_tol * a->until)
        return HB_DECLINED;
    s->crowded = gap <= a->moment * fmax(fabs(o->t), a->soonest * a->until);
    memcpy(log->before + (size_t)row * (n - 2), o->y, sizeof *o->y * (n - 2));
    log->energy[row] = o->run_energy;
    why = hb_settle(s, o->t, o->y, mode, k, timed ? k + 1 : k, row);
    if (why != HB_EVENT)
        return why;
    if (!log->changed[row] && !timed)
        return HB_DECLINED;
    if (log->changed[row])
        *last = o->t;
    log->t[row] = o->t;
    memcpy(log->after + (size_t)row * n, o->y, sizeof *o->y * n);
    log->steps[row] = *count;
    log->mode[row] = *mode;
    log->interval[row] = k;
    log->timed[row] = timed;
    *interval += timed;
    ++log->rows;
    return HB_EVENT;
}

/* Run on from o->t in a mode until something is not known here, until no room is left, or until
 * about `budget` operations are spent. Only segments that ended count: the motion is left where the
 * first begins that did not. */
int32_t hb_run(const hb_atlas *atlas, hb_motion *o, const hb_sampling *sampling,
               const hb_schedule *schedule, int32_t mode, int32_t most, int32_t rows, double budget,
               hb_trail *trail, hb_log *log)
{
    hb_work work = {0};
    hb_settler s = {.atlas = atlas, .o = o, .work = &work, .schedule = schedule, .log = log};
    mark start = {0};
    const size_t n = (size_t)atlas->storages + (size_t)atlas->signals + 2;
    int32_t interval = 0, steps = 0, why = HB_NO_MEMORY;
    double last = log->last;
    size_t most_free = 0;
    for (int32_t k = 0; k < atlas->modes; ++k)
        if (atlas->mode[k] && (size_t)atlas->mode[k]->free > most_free)
            most_free = (size_t)atlas->mode[k]->free;
    start.y = calloc(2 * n + most_free, sizeof *start.y);
    log->rows = 0;
    if (start.y && hb_reserve(&work, atlas->mode, atlas->modes) &&
        hb_settler_for(&s)) {
        start.largest = start.y + n;
        start.guess = start.largest + n;
        why = HB_EVENT;
    }
    while (why == HB_EVENT && log->rows < rows && budget > 0.0) {
        const hb_mode *m = atlas->mode[mode];
        const int32_t before = steps;
        /* one segment at least, if it can be had in a few times as much */
        const double spent = log->rows ? budget : LONGER * budget;
        const double left = fmin(spent / m->cost + 1.0, (double)(most - steps));
        note(&start, m, o, n);
        why = left < 1.0 ? HB_FULL
                         : segment(&s, sampling, &mode, &interval, (int32_t)left, trail, &steps,
                                   &last, log);
        budget -= (steps - before) * m->cost;
        if (why != HB_EVENT)
            go_back(&start, m, o, n);
    }
    free(start.y);
    free(work.all);
    free(s.all);
    return why;
}
