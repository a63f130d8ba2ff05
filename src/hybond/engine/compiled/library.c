/* What the library shows: runs of any model whose tables somebody hands over, and looks into them.
 *
 * A run holds its engine and all its memory, and so does a look; any number of them live beside
 * each other, and the tables are only read. Nothing here ends the process: where memory is spent,
 * the run says so.
 */
#if defined(_WIN32)
#define SHOWN __declspec(dllexport)
#else
#define SHOWN __attribute__((visibility("default")))
#endif

/* Beside OK, REFUSED, ACCUMULATES and PAUSED: memory came to an end; there was no answer. */
enum { SPENT = 4, RAISED = 8 };

/* What a run asks: the record Question in answering.py. Who answers sets `answered`. */
typedef struct HybondQuestion {
    double t;
    double answer;
    double *values;
    int what, piece, answered;
} HybondQuestion;

/* A run, or a look, which has `l` and `meter` in place of `r` and `log`. */
typedef struct HybondRun {
    Arena arena; /* the first of all: ask_run finds the run by it */
    HybondQuestion *question;
    void (*ask)(int);
    bool raised;
    int passed; /* times that whoever looks on was not called */
    const Model *model;
    Engine *e;
    Run *r;
    Report *log;
    int status;
    bool settling; /* whether it was an instant that could not be settled */
    Carrier *carrier;
    Look *l;
    Meter *meter;
} HybondRun;

/* What a run hands to one that goes on: the numbers of the record Carried in native.py. */
typedef struct HybondCarried {
    int floats, ints;
    double *number;
    int *place;
} HybondCarried;

/* The log of a run: how many there are of what, and columns of numbers; as in rows.py. */
#define COUNTS(X) \
    X(steps) X(instants) X(visits) X(fireds) X(hits) X(reads) X(overs) X(opens) X(slids) X(slides) \
    X(rejected) X(bond_rows) X(turns)
#define FLOATS(X) \
    X(step_time) X(step_until) X(step_state) X(step_dense) X(step_bonds) X(step_energy) \
    X(instant_time) X(instant_state) X(instant_since) X(visit_energy) X(hit_area) X(read) \
    X(slide_time) X(turn_time)
#define INTS(X) \
    X(step_place) X(step_bond) X(instant_place) X(visit) X(fired) X(hit) X(over) X(open) X(slid)

/* What is read of a run: the numbers of the record Seen in rows.py. */
typedef struct HybondSeen {
    const double *y;
    const int *state;
    const int *tried;
    double t;
    double energy;
    int states;
    int evaluations;
    int modes_made;
    const int *propagated; /* as `found` in Exact; NULL without that method */
    int settling;
    int stuck_machine, stuck_events, stuck_why;
    double stuck_t, stuck_ratio;
    int warns, abouts;
    const int *warn, *warn_first;
    const double *warn_time, *about;
#define COUNT(name) int name;
#define FLOAT(name) const double *name;
#define INT(name) const int *name;
    COUNTS(COUNT)
    FLOATS(FLOAT)
    INTS(INT)
#undef COUNT
#undef FLOAT
#undef INT
} HybondSeen;

/* A refusal: the numbers of the record FaultSeen in refusal.py. */
typedef struct HybondFault {
    const char *code;
    const char *why;
    const char *place;
    double t;
    int many;
    const double *about;
} HybondFault;

/* Points with their states, or, where `step` is not NULL, in steps: as in points.py. */
typedef struct HybondPoints {
    int many;
    const double *t, *y;
    const int *accepted, *step;
    const double *step_time, *step_state, *step_dense;
} HybondPoints;

/* Which sources the library was made of. */
SHOWN const char *hybond_source(void)
{
    return HYBOND_SOURCE;
}

/* The columns of a model, in order, each with its type before it; NULL ends them. */
SHOWN const char *const *hybond_columns(void)
{
    return HYBOND_COLUMNS;
}

SHOWN int hybond_model_size(void)
{
    return (int)sizeof(Model);
}

static bool is_made(HybondRun *run, bool looking)
{
    if (setjmp(run->arena.spent) != 0) {
        return false;
    }
    run->e = make_engine(&run->arena, run->model);
    if (looking) {
        run->l = make_look(run->e);
        run->meter = make_meter(&run->arena);
    } else {
        run->log = make_report(run->e);
        run->r = make_run(run->e, run->log);
    }
    return true;
}

/* Give all memory of a run or a look back. */
SHOWN void hybond_end(HybondRun *run)
{
    if (run != NULL) {
        release(&run->arena);
        free(run);
    }
}

/* Make ready for a run, or for looking; NULL where there is no memory for it. */
SHOWN HybondRun *hybond_begin(const Model *model, int looking)
{
    HybondRun *run = calloc(1, sizeof(HybondRun));
    if (run == NULL) {
        return NULL;
    }
    run->model = model;
    if (!is_made(run, looking != 0)) {
        hybond_end(run);
        return NULL;
    }
    return run;
}

/* Say whom a run, or a look, asks for inputs and blocks. */
SHOWN void hybond_ask(HybondRun *run, HybondQuestion *question, void (*ask)(int))
{
    run->question = question;
    run->ask = ask;
}

/* Ask; where there is no answer the call ends here, as where memory does. */
static double ask_run(Arena *arena, int what, int k, double t, int piece, double *values)
{
    HybondRun *run = (HybondRun *)arena;
    HybondQuestion *question = run->question;
    if (question != NULL) {
        question->t = t;
        question->what = what;
        question->piece = piece;
        question->values = values;
        question->answered = 0;
        run->ask(k);
        if (question->answered) {
            return question->answer;
        }
    }
    run->raised = true;
    longjmp(arena->spent, 1);
}

/* Let whoever looks on do so; a look into a run has nobody. */
static void look_outside(Arena *arena)
{
    HybondRun *run = (HybondRun *)arena;
    /* what is called costs microseconds, and so much work only tens of them in most models */
    enum { PASSED_OVER = 8 };
    if (run->question != NULL && run->r != NULL && ++run->passed >= PASSED_OVER) {
        run->passed = 0;
        (void)ask_run(arena, OUTSIDE, 0, run->e->t, 0, NULL);
    }
}

/* Run on by so many steps and instants, -1: to the end; return the status. */
SHOWN int hybond_run(HybondRun *run, int slice)
{
    if (run->raised) {
        return RAISED;
    }
    if (setjmp(run->arena.spent) != 0) {
        run->status = run->raised ? RAISED : SPENT;
        return run->status;
    }
    run->r->slice = slice;
    run->status = run_to_end(run->e, run->r);
    if (run->status == REFUSED) {
        run->settling = run->log->settling;
        report_broken(run->e, run->log, run->r->instant);
    }
    return run->status;
}

/* Try a mode at the start of a run that has not begun; `hold` says which rules leave it. */
SHOWN int hybond_try(HybondRun *run, const int *state, int *hold)
{
    if (setjmp(run->arena.spent) != 0) {
        return run->raised ? RAISED : SPENT;
    }
    run->settling = true;
    return try_at_start(run->e, run->r, state, hold);
}

/* Write down where a run has come: how many numbers, and where they stand until the next call. */
SHOWN int hybond_take(HybondRun *run, HybondCarried *carried)
{
    if (setjmp(run->arena.spent) != 0) {
        return SPENT;
    }
    if (run->carrier == NULL) {
        run->carrier = make_carrier(run->e);
    }
    take_out(run->e, run->r, run->carrier);
    carried->floats = run->carrier->floats;
    carried->ints = run->carrier->ints;
    carried->number = run->carrier->number->at;
    carried->place = run->carrier->place->at;
    return 0;
}

/* Let a run that has not begun begin with numbers that stand where `hybond_take` had them. */
SHOWN int hybond_put(HybondRun *run, int way, double until, int deep)
{
    if (setjmp(run->arena.spent) != 0) {
        return SPENT;
    }
    take_over(run->e, run->r, run->carrier, way, until, deep != 0);
    return 0;
}

SHOWN void hybond_see(const HybondRun *run, HybondSeen *seen)
{
    const Engine *e = run->e;
    const Report *log = run->log;
    seen->y = e->y;
    seen->state = e->state;
    seen->tried = e->trial->state;
    seen->t = e->t;
    seen->energy = e->energy;
    seen->states = e->states;
    seen->evaluations = e->evaluations;
    seen->modes_made = e->modes_made;
    seen->propagated = e->exact == NULL || e->quantised != NULL ? NULL : e->exact->found;
    seen->settling = run->settling;
    seen->stuck_machine = e->landings->stuck_machine;
    seen->stuck_events = e->landings->stuck_events;
    seen->stuck_why = e->landings->stuck_why;
    seen->stuck_t = e->landings->limit_t;
    seen->stuck_ratio = e->landings->limit_ratio;
    seen->warns = log->warned->rows;
    seen->abouts = log->warned->numbers;
    seen->warn = log->warned->kind->at;
    seen->warn_first = log->warned->first->at;
    seen->warn_time = log->warned->time->at;
    seen->about = log->warned->number->at;
#define NUMBER(name) seen->name = log->name;
#define COLUMN(name) seen->name = log->name->at;
    COUNTS(NUMBER)
    FLOATS(COLUMN)
    INTS(COLUMN)
#undef NUMBER
#undef COLUMN
}

/* See why it stopped, 0, or why what was struck cannot rest, 1; of a look: at which time. */
SHOWN void hybond_fault(const HybondRun *run, int which, HybondFault *seen)
{
    const Fault *fault = which == 0 ? run->e->fault : run->e->unrest;
    HybondFault nothing = {"", "", "", 0.0, 0, NULL};
    *seen = nothing;
    if (fault != NULL) {
        seen->code = fault->code;
        seen->why = fault->why;
        seen->place = fault->place;
        seen->t = run->l != NULL ? run->e->t : fault->t;
        seen->many = fault->many;
        seen->about = fault->many > 0 ? fault->about->at : NULL;
    }
}

/* Forget the rows of the log that were read. */
SHOWN void hybond_forget(HybondRun *run)
{
    forget_rows(run->log);
}

/* Why a call of a look ended early. */
static int ended(HybondRun *look)
{
    if (!look->raised) {
        return SPENT;
    }
    look->raised = false;
    return RAISED;
}

/* Look into a motion that is known. */
SHOWN int hybond_look_into(HybondRun *look, double t, const int *state, const int *landed,
                           int surfaces, const int *surface, int product, int rows,
                           const int *branch, double energy)
{
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    return look_into(look->e, look->l, t, state, landed, surfaces, surface, product, rows,
                     branch, energy);
}

/* The solution that a motion had of laws with several: times, and bond variables row after row. */
SHOWN int hybond_look_from(HybondRun *look, int many, int wide, const double *when,
                           const double *given)
{
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    look_from(look->e, many, wide, when, given);
    return OK;
}

/* The states of machines in each mode that is combined, and how many modes these are; NULL asks
 * for their number alone. */
SHOWN int hybond_look_modes(HybondRun *look, int *state)
{
    return state == NULL ? look->e->slide->parts : parts_of(look->e, state);
}

/* Look at points: the numbers of ASKED in native_look.py. */
enum { LOOK_VALUES, LOOK_PARTS, LOOK_POWERS, LOOK_ENERGIES };
static int look_at(HybondRun *look, int what, const HybondPoints *p, int many, const int *slot,
                   const double *end, double *out, double *more)
{
    if (p->step != NULL) {
        points_within(look->l, p->many, p->t, p->step, p->step_time, p->step_state, p->step_dense);
    } else {
        points_at(look->l, p->many, p->t, p->y, p->accepted);
    }
    if (slot != NULL) {
        ask_for(look->l, many, slot);
    }
    switch (what) {
    case LOOK_VALUES:
        return look_values(look->e, look->l, out);
    case LOOK_PARTS:
        return look_parts(look->e, look->l, out, more);
    case LOOK_POWERS:
        return look_powers(look->e, look->l, look->meter, out);
    default:
        return look_energies(look->e, look->l, look->meter, end, out);
    }
}

SHOWN int hybond_look_at(HybondRun *look, int what, const HybondPoints *points, int many,
                         const int *slot, const double *end, double *out, double *more)
{
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    return look_at(look, what, points, many, slot, end, out, more);
}

/* Look at points of one motion after another, where nothing is slid on; a row of `out` for each
 * point has `wide` numbers. */
SHOWN int hybond_look_along(HybondRun *look, int what, const HybondPoints *points, int many,
                            const int *slot, const double *end, int motions, const int *first,
                            const double *begin, const int *state, const int *landed,
                            double energy, int wide, double *out)
{
    const int machines = look->model->machines;
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    for (int k = 0; k < motions; ++k) {
        HybondPoints own = *points;
        own.t += first[k];
        own.step += first[k];
        own.many = first[k + 1] - first[k];
        int status = look_into(look->e, look->l, begin[k], state + k * machines,
                               landed + k * machines, 0, NULL, 0, 0, NULL, energy);
        if (status == OK) {
            double *here = out + (size_t)first[k] * (size_t)wide;
            const double *to = end == NULL ? NULL : end + first[k];
            status = look_at(look, what, &own, many, slot, to, here, NULL);
        }
        if (status != OK) {
            return status;
        }
    }
    return OK;
}

SHOWN int hybond_look_stored(HybondRun *look, int many, const double *y, double *out)
{
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    return look_stored(look->e, look->l, many, y, out);
}

/* The sources of a linear mode; how many, or NOT_LINEAR. */
SHOWN int hybond_look_sources(HybondRun *look, int *source, int *rated)
{
    return look_sources(look->e, source, rated);
}

SHOWN int hybond_look_by_knowns(HybondRun *look, int many, const double *known, double *out)
{
    if (setjmp(look->arena.spent) != 0) {
        return ended(look);
    }
    look_by_knowns(look->e, many, known, out);
    return OK;
}
