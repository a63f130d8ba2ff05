
/* Members: runs of one model with other numbers in its tables, one after the other.
 *
 * All begin with the same memory, as an engine of its own would: what it holds when it is made is
 * kept, and put back for each of them.
 */

/* Beside OK: an ordinary run has more to say of this member. */
enum { ORDINARY = 5, LARGEST_SLICE = 2000 };
static const double CREATED_ENERGY = 1e-9; /* as CREATED in warned.py */

/* Members to run, and what is kept of them: the record Sets in members.py. */
typedef struct HybondSets {
    int many, entries, outputs, times;
    const double *number;      /* of each member its entries */
    double *const *place;      /* where each of these goes */
    const int *slot;           /* outputs */
    const double *t;           /* when they are looked at, and at the end besides */
    const volatile int *stop;  /* not zero: end early */
    int *status, *count;
    double *end, *out;
    int done;                  /* members that were run */
    size_t events;             /* of all of them, one after the other */
    const double *event;
    int *stays;                /* modes that each wrote; NULL: they are not asked for */
    size_t rows;               /* of all of them: when they were written, states of the machines */
    const double *since;
    const int *mode;
    int measured;              /* slots that are measured; 0: no steps are kept */
    const int *measure;
    int *stepped;              /* steps of each member */
    unsigned char *struck;     /* which of these slots had an impulse in it */
    double *energy;            /* the largest it has seen */
    size_t laid;               /* steps of all of them, one after the other */
    const double *time;        /* begin and end of the polynomial, and where it was ended */
    const int *motion;         /* the step with which the motion of each begins */
} HybondSets;

/* Points in steps that were kept, in order: the record Looked in members.py. */
typedef struct HybondLooked {
    int points, slots;
    const int *member, *step, *slot;
    const double *t;
    double *out;
    unsigned char *blind;      /* members of which not all can be read */
} HybondLooked;

/* What an arena holds at a moment. */
typedef struct Image {
    Chunk *large, *now;
    size_t used;               /* of the chunk that is filled */
    char *bytes;
} Image;

typedef struct HybondMembers {
    HybondRun *run;
    HybondRun *look;
    Image begun, looking;
    double *event, *t;
    int *step;
    size_t events, room;
    int times;
    double *since;
    int *mode, *now;
    size_t rows, rooms;
    double *time, *state, *dense;
    int *motion, *place;
    size_t laid, wide;         /* steps that are kept, and that there is room for */
} HybondMembers;

SHOWN HybondMembers *hybond_members_begin(const Model *model, int times);
SHOWN int hybond_members_run(HybondMembers *all, HybondSets *sets);
SHOWN void hybond_members_look(HybondMembers *all, const HybondSets *sets, HybondLooked *points);
SHOWN void hybond_members_end(HybondMembers *all);
static bool keep_steps(HybondMembers *all, HybondSets *sets, int k); /* kept_steps.c */

static size_t used_by(const Chunk *chunk)
{
    size_t used = 0;
    for (; chunk != NULL; chunk = chunk->next) {
        used += chunk->used;
    }
    return used;
}

static char *copy_of(const Chunk *chunk, char *to)
{
    for (; chunk != NULL; chunk = chunk->next) {
        memcpy(to, chunk + 1, chunk->used);
        to += chunk->used;
    }
    return to;
}

static bool keep_image(const Arena *arena, Image *image)
{
    image->large = arena->large;
    image->now = arena->now;
    image->used = arena->now != NULL ? arena->now->used : 0;
    image->bytes = malloc(used_by(arena->large) + used_by(arena->first) + 1);
    if (image->bytes == NULL) {
        return false;
    }
    (void)copy_of(arena->first, copy_of(arena->large, image->bytes));
    return true;
}

/* Put back what an arena held; shared chunks that were added are empty then, and stay. */
static void restore(Arena *arena, const Image *image)
{
    while (arena->large != image->large) {
        Chunk *next = arena->large->next;
        free(arena->large);
        arena->large = next;
    }
    const char *at = image->bytes;
    for (Chunk *chunk = arena->large; chunk != NULL; chunk = chunk->next) {
        memcpy(chunk + 1, at, chunk->used);
        at += chunk->used;
    }
    bool added = image->now == NULL;
    for (Chunk *chunk = arena->first; chunk != NULL; chunk = chunk->next) {
        const bool last = chunk == image->now;
        const size_t held = added ? 0 : last ? image->used : chunk->used;
        char *bytes = (char *)(chunk + 1);
        memcpy(bytes, at, held);
        memset(bytes + held, 0, chunk->used - held);
        chunk->used = held;
        at += held;
        added = added || last;
    }
    arena->now = image->now != NULL ? image->now : arena->first;
}

/* Make ready for members whose outputs are looked at so many times; NULL without memory. */
SHOWN HybondMembers *hybond_members_begin(const Model *model, int times)
{
    HybondMembers *all = calloc(1, sizeof(HybondMembers));
    if (all == NULL) {
        return NULL;
    }
    all->times = times;
    all->run = hybond_begin(model, 0);
    all->look = hybond_begin(model, 1);
    all->t = malloc(((size_t)times + 1) * sizeof(double));
    all->step = malloc(((size_t)times + 1) * sizeof(int));
    all->now = malloc(((size_t)model->machines + 1) * sizeof(int));
    if (all->now == NULL || all->run == NULL || all->look == NULL || all->t == NULL || all->step == NULL
        || !keep_image(&all->run->arena, &all->begun)
        || !keep_image(&all->look->arena, &all->looking)) {
        hybond_members_end(all);
        return NULL;
    }
    return all;
}

SHOWN void hybond_members_end(HybondMembers *all)
{
    if (all != NULL) {
        hybond_end(all->run);
        hybond_end(all->look);
        free(all->begun.bytes);
        free(all->looking.bytes);
        free(all->event);
        free(all->t);
        free(all->step);
        free(all->since);
        free(all->mode);
        free(all->now);
        free(all->time);
        free(all->state);
        free(all->dense);
        free(all->motion);
        free(all->place);
        free(all);
    }
}

/* Whether a jump may have created energy, of which an ordinary run warns. */
static bool may_create(const Report *log, int machines)
{
    int visit = 0;
    for (int k = 0; k < log->instants; ++k) {
        const double largest = log->instant_time->at[2 * k + 1];
        const int visits = log->instant_place->at[(3 + 2 * machines) * k + 1];
        for (int last = visit + visits; visit < last; ++visit) {
            const double before = log->visit_energy->at[3 * visit];
            const double after = log->visit_energy->at[3 * visit + 1];
            const double given = log->visit_energy->at[3 * visit + 2];
            const double size = fmax(largest, fmax(fabs(after), fabs(given)));
            if (log->visit->at[5 * visit + 4] != 0
                && !(after - before - given <= CREATED_ENERGY * size)) {
                return true;
            }
        }
    }
    return false;
}

/* Whether a step belongs to the segment of the one before it. */
static bool goes_on(const Report *log, int step, int machines)
{
    const int wide = 2 + 2 * machines;
    const int *place = log->step_place->at + (size_t)wide * (size_t)step;
    return place[0] == place[-wide] && place[1] == place[1 - wide]
           && log->step_until->at[step] == log->step_until->at[step - 1];
}

/* Look at the outputs in the motion that begins with a step, from point `from` to before `to`. */
static int look_at_points(HybondMembers *all, const HybondSets *sets, int first, int from, int to,
                          double energy, double *out)
{
    const Report *log = all->run->log;
    HybondRun *look = all->look;
    const int machines = look->model->machines;
    const int *place = log->step_place->at + (size_t)(2 + 2 * machines) * (size_t)first + 2;
    if (setjmp(look->arena.spent) != 0) {
        return ORDINARY;
    }
    if (look_into(look->e, look->l, log->step_time->at[3 * first], place, place + machines, 0,
                  NULL, 0, 0, NULL, energy) != OK) {
        return ORDINARY;
    }
    points_within(look->l, to - from, all->t + from, all->step + from, log->step_time->at,
                  log->step_state->at, log->step_dense->at);
    ask_for(look->l, sets->outputs, sets->slot);
    double *row = out + (size_t)from * (size_t)sets->outputs;
    return look_values(look->e, look->l, row) == OK ? OK : ORDINARY;
}

/* Look at the outputs after the event at the very end, from point `from` on. */
static int look_after_end(HybondMembers *all, const HybondSets *sets, int from, int points,
                          double energy, double *out)
{
    static const int accepted = 1;
    const Report *log = all->run->log;
    HybondRun *look = all->look;
    const Model *m = look->model;
    const int last = log->instants - 1;
    const int *place = log->instant_place->at + (size_t)(3 + 2 * m->machines) * (size_t)last + 3;
    const int states = m->storages + m->integrals;
    if (setjmp(look->arena.spent) != 0) {
        return ORDINARY;
    }
    /* nothing has landed, as in Signals.after: what passes time there is not asked */
    for (int k = 0; k < m->machines; ++k) {
        if (place[m->machines + k] != 0) {
            return ORDINARY;
        }
    }
    if (look_into(look->e, look->l, log->instant_time->at[2 * last], place, place + m->machines, 0,
                  NULL, 0, 0, NULL, energy) != OK) {
        return ORDINARY;
    }
    for (int k = from; k < points; ++k) {
        points_at(look->l, 1, all->t + k, log->instant_state->at + (size_t)(2 * last + 1) * states,
                  &accepted);
        ask_for(look->l, sets->outputs, sets->slot);
        if (look_values(look->e, look->l, out + (size_t)k * (size_t)sets->outputs) != OK) {
            return ORDINARY;
        }
    }
    return OK;
}

/* Look at the outputs when they are wanted, and at the end; `out` has a row for each. */
static int look_at_outputs(HybondMembers *all, const HybondSets *sets, double *out)
{
    const Report *log = all->run->log;
    const int machines = all->run->model->machines;
    const int steps = log->steps;
    const double end = log->step_time->at[3 * steps - 1];
    const double energy = fmin(all->run->e->energy, 1.7976931348623157e308);
    int points = 0;
    while (points < sets->times && sets->t[points] <= end) {
        all->t[points] = sets->t[points];
        ++points;
    }
    if (points < sets->times) {
        return ORDINARY;
    }
    all->t[points++] = end;
    int from = 0;
    restore(&all->look->arena, &all->looking);
    for (int first = 0, next = 0; first < steps; first = next) {
        for (next = first + 1; next < steps && goes_on(log, next, machines); ++next) {
        }
        int to = from;
        int step = first;
        const double over = log->step_time->at[3 * next - 1];
        while (to < points && (next == steps || all->t[to] < log->step_time->at[3 * next])) {
            if (all->t[to] > over) {
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
    const int last = log->instants - 1;
    if (last < 0 || log->instant_time->at[2 * last] != end || end <= 0.0) {
        return OK;
    }
    for (from = points; from > 0 && all->t[from - 1] == end; --from) {
    }
    return look_after_end(all, sets, from, points, energy, out);
}

static bool keep_events(HybondMembers *all, const Report *log)
{
    const size_t wanted = all->events + (size_t)log->instants;
    if (wanted > all->room) {
        double *more = realloc(all->event, 2 * wanted * sizeof(double));
        if (more == NULL) {
            return false;
        }
        all->event = more;
        all->room = 2 * wanted;
    }
    for (int k = 0; k < log->instants; ++k) {
        all->event[all->events++] = log->instant_time->at[2 * k];
    }
    return true;
}

/* Have room for a row more of the modes that were written. */
static bool room_for_mode(HybondMembers *all, int machines)
{
    if (all->rows < all->rooms) {
        return true;
    }
    const size_t wanted = 2 * all->rooms + 64;
    double *since = realloc(all->since, wanted * sizeof(double));
    if (since != NULL) {
        all->since = since;
    }
    int *mode = realloc(all->mode, wanted * ((size_t)machines + 1) * sizeof(int));
    if (mode != NULL) {
        all->mode = mode;
    }
    if (since == NULL || mode == NULL) {
        return false;
    }
    all->rooms = wanted;
    return true;
}

/* Keep the modes that were written since a time, those left at the same instant too; -1 without
 * memory. The mode before all of them is in `now`; what is known of it stands at row `before`, if
 * that is there. */
static int keep_modes(HybondMembers *all, const Report *log, double from, size_t before)
{
    const Model *m = all->run->model;
    const int machines = m->machines;
    const size_t size = (size_t)machines * sizeof(int);
    const size_t first = all->rows;
    int visit = 0;
    const int *fired = log->fired->at;
    for (int k = 0; k < log->instants; ++k) {
        const int *place = log->instant_place->at + (size_t)(3 + 2 * machines) * (size_t)k;
        for (int last = visit + place[1]; visit < last; ++visit) {
            const int *row = log->visit->at + 5 * (size_t)visit;
            for (int f = 0; f < row[1]; ++f, fired += 6) {
                if (fired[2] >= 0) {
                    all->now[fired[0]] = fired[2];
                }
            }
            if (visit + 1 == last) {
                memcpy(all->now, place + 3, size);
            }
            if (row[0] != MYTHICAL && log->instant_time->at[2 * k] < from) {
                if (before < first) {
                    memcpy(all->mode + before * (size_t)machines, all->now, size);
                }
            } else if (row[0] != MYTHICAL) {
                if (!room_for_mode(all, machines)) {
                    return -1;
                }
                all->since[all->rows] = log->instant_time->at[2 * k];
                memcpy(all->mode + all->rows * (size_t)machines, all->now, size);
                ++all->rows;
            }
        }
    }
    return (int)(all->rows - first);
}

/* Run a member; PAUSED if it was stopped. */
static int run_member(HybondMembers *all, HybondSets *sets, int k)
{
    HybondRun *run = all->run;
    const double *number = sets->number + (size_t)k * (size_t)sets->entries;
    for (int j = 0; j < sets->entries; ++j) {
        *sets->place[j] = number[j];
    }
    restore(&run->arena, &all->begun);
    run->status = PAUSED;
    while (run->status == PAUSED && *sets->stop == 0) {
        (void)hybond_run(run, LARGEST_SLICE);
    }
    const Report *log = run->log;
    if (run->status == PAUSED) {
        return PAUSED;
    }
    if (run->status != OK || log->steps == 0 || log->warned->rows > 0 || log->opens > 0
        || log->slides_made > 0 || log->bond_rows > 0 || may_create(log, run->model->machines)) {
        return ORDINARY;
    }
    double *out = sets->out + (size_t)k * ((size_t)sets->times + 1) * (size_t)sets->outputs;
    const size_t events = all->events;
    const size_t laid = all->laid;
    if (look_at_outputs(all, sets, out) != OK || !keep_events(all, log)) {
        return ORDINARY;
    }
    if (sets->stays != NULL) {
        memcpy(all->now, run->model->start, (size_t)run->model->machines * sizeof(int));
        sets->stays[k] = keep_modes(all, log, -HUGE_VAL, all->rows);
        if (sets->stays[k] < 0) {
            all->events = events;
            return ORDINARY;
        }
    }
    if (sets->measured > 0 && !keep_steps(all, sets, k)) {
        all->events = events;
        all->laid = laid;
        all->rows -= sets->stays != NULL ? (size_t)sets->stays[k] : 0;
        return ORDINARY;
    }
    return OK;
}

/* Run members one after the other; return how many were run before `stop`. */
SHOWN int hybond_members_run(HybondMembers *all, HybondSets *sets)
{
    all->events = 0;
    all->rows = 0;
    all->laid = 0;
    sets->done = 0;
    for (int k = 0; k < sets->many; ++k) {
        const int status = run_member(all, sets, k);
        if (status == PAUSED) {
            break;
        }
        const Report *log = all->run->log;
        sets->status[k] = status;
        sets->count[k] = status == OK ? log->instants : 0;
        if (sets->stays != NULL && status != OK) {
            sets->stays[k] = 0;
        }
        sets->end[k] = status == OK ? log->step_time->at[3 * log->steps - 1] : 0.0;
        sets->done = k + 1;
    }
    sets->event = all->event;
    sets->events = all->events;
    sets->since = all->since;
    sets->mode = all->mode;
    sets->rows = all->rows;
    sets->laid = all->laid;
    sets->time = all->time;
    sets->motion = all->motion;
    return sets->done;
}
