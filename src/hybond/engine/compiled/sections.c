
/* Sections: what a run looks like once a period, or at events of one kind, value after value.
 *
 * A value may begin as the model does, or go on from where the one before has come. While it
 * settles nothing is kept; then come the values that are looked at, and the modes that are written
 * meanwhile. What an ordinary run has more to say of is left to one, and ends the call.
 */

enum { SECTION_SLICE = 500 };
static const double NEAR = 1e-9; /* of a period: an event so near to its beginning is at it */

/* Values to run, and what is kept of them: the record Sections in sections.py. */
typedef struct HybondSections {
    int many, entries, outputs;
    int settle, keep;          /* periods, or events */
    int machine, state;        /* the event: the state that a machine enters; -1: there is none */
    int before;                /* whether the left limit is looked at */
    int carry;                 /* whether each value goes on from the one before */
    int begun;                 /* whether `carried` is there to begin with */
    const double *number;      /* of each value its entries */
    double *const *place;      /* where each of these goes */
    const int *slot;           /* outputs */
    const double *period;      /* of each value, s; of events: how long it may take */
    const volatile int *stop;  /* not zero: end early */
    int *status, *found;       /* of each value; samples */
    double *when, *out;        /* of each value room for `keep`; of `when` one more, the end */
    int *stays;                /* modes written, the one at the first sample before all */
    double counted;            /* periods behind the carried state */
    int floats, ints;          /* of the carried state */
    double *carried;           /* what a value begins with, and where the last one has come */
    int *carried_place;
    double *left;              /* where each value has come */
    int *left_place;
    double *left_counted;
    int done;                  /* values that were run */
    size_t rows;
    const double *since;
    const int *mode;
} HybondSections;

SHOWN int hybond_sections_begin(HybondMembers *all, HybondSections *s);
SHOWN int hybond_sections_run(HybondMembers *all, HybondSections *s);

/* Make ready for values that go on from others; say how many numbers that takes. */
SHOWN int hybond_sections_begin(HybondMembers *all, HybondSections *s)
{
    HybondCarried seen;
    if (hybond_take(all->run, &seen) != OK) {
        return SPENT;
    }
    s->floats = seen.floats;
    s->ints = seen.ints;
    /* the room for what is carried belongs to what every value begins with */
    free(all->begun.bytes);
    return keep_image(&all->run->arena, &all->begun) ? OK : SPENT;
}

/* Let a run begin where the one before has come, at time t: with its state and mode. What that run
 * remembers beside is no part of it, as the time may be another one: when events were, sizes. */
static int begin_carried(HybondMembers *all, const HybondSections *s, double t, double until)
{
    HybondRun *run = all->run;
    HybondCarried seen;
    if (hybond_take(run, &seen) != OK || seen.floats != s->floats || seen.ints != s->ints) {
        return ORDINARY;
    }
    memcpy(seen.number, s->carried, (size_t)s->floats * sizeof(double));
    memcpy(seen.place, s->carried_place, (size_t)s->ints * sizeof(int));
    seen.number[0] = t;
    enum { CHANGED_WAY = 2 };
    return hybond_put(run, CHANGED_WAY, until, 0) == OK ? OK : ORDINARY;
}

/* Whether an ordinary run has more to say of what the log holds. */
static bool says_more(const Report *log, int machines)
{
    return log->warned->rows > 0 || log->opens > 0 || log->slides_made > 0 || log->bond_rows > 0
           || may_create(log, machines);
}

/* Go through the instants of the log from one on. Find those at which a machine enters a state;
 * return how many there are. `now` holds the state of the machine, and is moved on. */
static int enters(const HybondSections *s, const Report *log, int machines, int from, int *visit,
                  int *fired, int *now, double *when, int had, int room)
{
    int many = 0;
    for (int k = from; k < log->instants; ++k) {
        const int *place = log->instant_place->at + (size_t)(3 + 2 * machines) * (size_t)k;
        bool fires = false, entered = false;
        for (int last = *visit + place[1]; *visit < last; ++*visit) {
            const int *row = log->visit->at + 5 * (size_t)*visit;
            const int was = *now;
            for (int f = 0; f < row[1]; ++f, ++*fired) {
                const int *told = log->fired->at + 6 * (size_t)*fired;
                if (told[0] == s->machine && told[2] >= 0) {
                    *now = told[2];
                    fires = *now == s->state;
                }
            }
            if (*visit + 1 == last) {
                *now = place[3 + s->machine];
            }
            fires = fires || *now != was;
            entered = entered || (fires && row[0] != MYTHICAL && *now == s->state);
        }
        if (entered) {
            const double t = log->instant_time->at[2 * k];
            const int at = had + many - s->settle;
            if (at >= 0 && at < room) {
                when[at] = t;
            }
            ++many;
        }
    }
    return many;
}

/* Look at the outputs at points, in order; `out` has a row for each. */
static int look_at_sections(HybondMembers *all, const HybondSets *sets, const double *t,
                            int points, bool before, double *out)
{
    const Report *log = all->run->log;
    const int machines = all->run->model->machines;
    const int steps = log->steps;
    const double energy = fmin(all->run->e->energy, 1.7976931348623157e308);
    int from = 0;
    memcpy(all->t, t, (size_t)points * sizeof(double));
    restore(&all->look->arena, &all->looking);
    for (int first = 0, next = 0; first < steps && from < points; first = next) {
        for (next = first + 1; next < steps && goes_on(log, next, machines); ++next) {
        }
        int to = from;
        int step = first;
        const double over = log->step_time->at[3 * next - 1];
        while (to < points
               && (before ? all->t[to] <= over
                          : next == steps || all->t[to] < log->step_time->at[3 * next])) {
            if (all->t[to] > over || all->t[to] < log->step_time->at[3 * first]) {
                return ORDINARY;
            }
            while (log->step_time->at[3 * step + 2] < all->t[to]) {
                ++step;
            }
            all->step[to++] = step;
        }
        if (to > from && look_at_points(all, sets, first, from, to, energy, out) != OK) {
            return ORDINARY;
        }
        from = to;
    }
    return from == points ? OK : ORDINARY;
}

/* The instants of periods: where an event is at the beginning of one, its own. */
static void begin_periods(const Report *log, int many, double first, double period, double *when)
{
    int k = 0;
    for (int j = 0; j < many; ++j) {
        when[j] = (first + j) * period;
        while (k < log->instants && log->instant_time->at[2 * k] < when[j] - NEAR * period) {
            ++k;
        }
        const double nominal = when[j];
        for (int i = k; i < log->instants && log->instant_time->at[2 * i] <= nominal + NEAR * period;
             ++i) {
            when[j] = log->instant_time->at[2 * i];
        }
    }
}

/* Keep the mode at the first sample, then those written since; the number of rows, -1: no memory. */
static int keep_modes_since(HybondMembers *all, double from, const int *now)
{
    const int machines = all->run->model->machines;
    const size_t first = all->rows;
    if (!room_for_mode(all, machines)) {
        return -1;
    }
    all->since[first] = from;
    ++all->rows;
    memcpy(all->now, now, (size_t)machines * sizeof(int));
    memcpy(all->mode + first * (size_t)machines, all->now, (size_t)machines * sizeof(int));
    return keep_modes(all, all->run->log, from, first) < 0 ? -1 : (int)(all->rows - first);
}

/* Run a value; PAUSED if it was stopped. */
static int run_section(HybondMembers *all, HybondSections *s, const HybondSets *sets, int k,
                       int *begin_mode)
{
    HybondRun *run = all->run;
    const Model *m = run->model;
    const Report *log = run->log;
    const int machines = m->machines;
    const double period = s->period[k];
    const double *number = s->number + (size_t)k * (size_t)s->entries;
    double *when = s->when + (size_t)k * (size_t)(s->keep + 1);
    for (int j = 0; j < s->entries; ++j) {
        *s->place[j] = number[j];
    }
    restore(&run->arena, &all->begun);
    run->status = PAUSED;
    const bool events = s->machine >= 0;
    const bool on = s->carry != 0 && s->begun != 0;
    const double behind = on ? s->counted : 0.0;
    const double start = !on ? 0.0 : events ? s->carried[0] : behind * period;
    const double until = events ? start + period : (behind + s->settle + s->keep) * period;
    /* the record of the model is this thread's own */
    ((Model *)m)->until = until;
    memcpy(begin_mode, on ? s->carried_place : m->start, (size_t)machines * sizeof(int));
    if (on && begin_carried(all, s, start, until) != OK) {
        return ORDINARY;
    }
    const double from = events ? 0.0 : (behind + s->settle - NEAR) * period;
    int had = 0, from_instant = 0, visit = 0, fired = 0;
    int now = events ? begin_mode[s->machine] : 0;
    /* one event more than is kept: what happens after the last one is known then */
    bool enough = false;
    while (run->status == PAUSED && !enough) {
        if (*s->stop != 0) {
            return PAUSED;
        }
        (void)hybond_run(run, SECTION_SLICE);
        if (run->status == REFUSED || run->status == SPENT || run->status == RAISED) {
            return ORDINARY;
        }
        bool settled = run->e->t >= from;
        if (events) {
            had += enters(s, log, machines, from_instant, &visit, &fired, &now, when, had,
                          s->keep + 1);
            from_instant = log->instants;
            settled = had > s->settle;
            enough = had > s->settle + s->keep;
        }
        if (!settled && run->status == PAUSED) {
            if (says_more(log, machines)) {
                return ORDINARY;
            }
            if (log->instants > 0) {
                const int *place = log->instant_place->at
                                   + (size_t)(3 + 2 * machines) * (size_t)(log->instants - 1) + 3;
                memcpy(begin_mode, place, (size_t)machines * sizeof(int));
            }
            hybond_forget(run);
            from_instant = visit = fired = 0;
        }
    }
    if ((run->status != OK && !enough) || log->steps == 0 || says_more(log, machines)) {
        return ORDINARY;
    }
    int many = s->keep;
    if (!events) {
        begin_periods(log, many, behind + s->settle, period, when);
        when[many] = until;
    } else {
        many = had - s->settle - 1 < s->keep ? had - s->settle - 1 : s->keep;
        many = many > 0 ? many : 0;
    }
    s->found[k] = many;
    double *out = s->out + (size_t)k * (size_t)s->keep * (size_t)s->outputs;
    if (look_at_sections(all, sets, when, many, s->before != 0, out) != OK) {
        return ORDINARY;
    }
    s->stays[k] = many > 0 ? keep_modes_since(all, events ? when[0] : from, begin_mode) : 0;
    if (s->stays[k] < 0) {
        return ORDINARY;
    }
    HybondCarried seen;
    if (hybond_take(run, &seen) != OK || seen.floats != s->floats || seen.ints != s->ints) {
        return ORDINARY;
    }
    double *left = s->left + (size_t)k * (size_t)s->floats;
    int *left_place = s->left_place + (size_t)k * (size_t)s->ints;
    memcpy(left, seen.number, (size_t)s->floats * sizeof(double));
    memcpy(left_place, seen.place, (size_t)s->ints * sizeof(int));
    s->left_counted[k] = behind + s->settle + s->keep;
    if (s->carry != 0) {
        memcpy(s->carried, left, (size_t)s->floats * sizeof(double));
        memcpy(s->carried_place, left_place, (size_t)s->ints * sizeof(int));
        s->begun = 1;
        s->counted = s->left_counted[k];
    }
    return OK;
}

/* Run values one after the other; return how many were before one that was not, or `stop`. */
SHOWN int hybond_sections_run(HybondMembers *all, HybondSections *s)
{
    HybondSets sets = {0};
    sets.outputs = s->outputs;
    sets.slot = s->slot;
    all->rows = 0;
    s->done = 0;
    int *begin_mode = malloc(((size_t)all->run->model->machines + 1) * sizeof(int));
    for (int k = 0; begin_mode != NULL && k < s->many; ++k) {
        const size_t rows = all->rows;
        const int status = run_section(all, s, &sets, k, begin_mode);
        if (status == PAUSED) {
            break;
        }
        s->status[k] = status;
        s->done = k + 1;
        if (status != OK) {
            all->rows = rows;
            s->stays[k] = s->found[k] = 0;
            if (s->carry != 0) {
                break; /* the next one goes on from what an ordinary run comes to */
            }
        }
    }
    free(begin_mode);
    s->since = all->since;
    s->mode = all->mode;
    s->rows = all->rows;
    return s->done;
}
