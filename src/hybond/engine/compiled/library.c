/* What the library shows: runs of any model whose tables somebody hands over.
 *
 * A run holds its engine and all its memory; any number of them live beside each other, and the
 * tables are only read. Nothing here ends the process: where memory is spent, the run says so.
 */
#if defined(_WIN32)
#define SHOWN __declspec(dllexport)
#else
#define SHOWN __attribute__((visibility("default")))
#endif

/* Beside OK, REFUSED, ACCUMULATES and PAUSED: memory came to an end; there was no answer. */
enum { SPENT = 4, RAISED = 8 };

/* What a run asks: the record Question in calls.py. Who answers sets `answered`. */
typedef struct HybondQuestion {
    double t;
    double answer;
    double *values;
    int what, piece, answered;
} HybondQuestion;

/* Memory, and whom to ask: what a run and who looks into it begin with. */
typedef struct HybondOwn {
    Arena arena;
    HybondQuestion *question;
    void (*ask)(int);
    bool raised;
} HybondOwn;

typedef struct HybondRun {
    HybondOwn own;
    const Model *model;
    Engine *e;
    Run *r;
    Report *log;
    int status;
    bool settling; /* whether it was an instant that could not be settled */
} HybondRun;

/* What is read of a run: the numbers of the record Seen in native.py. */
typedef struct HybondSeen {
    const double *y;
    const int *state;
    const int *tried;
    double t;
    double energy;
    int status;
    int states;
    int evaluations;
    int modes_made;
    const int *propagated; /* as `found` in Exact; NULL without that method */
    int settling, rejected;
    int stuck_machine, stuck_events, stuck_why;
    double stuck_t, stuck_ratio;
    int steps, instants, visits, fireds, hits, reads, overs, opens, slids, slides, warns, abouts;
    const double *step_time, *step_until, *step_state, *step_dense;
    const double *instant_time, *instant_state, *visit_energy, *hit_area, *read, *slide_time;
    const double *warn_time, *about;
    const int *step_place, *instant_place, *visit, *fired, *hit, *over, *open, *slid;
    const int *warn, *warn_first;
    int bond_rows;
    const double *step_bonds, *step_energy, *instant_since;
    const int *step_bond;
} HybondSeen;

/* A refusal: the numbers of the record FaultSeen in native.py. */
typedef struct HybondFault {
    const char *code;
    const char *why;
    const char *place;
    double t;
    int many;
    const double *about;
} HybondFault;

SHOWN const char *hybond_source(void);
SHOWN const char *const *hybond_columns(void);
SHOWN int hybond_model_size(void);
SHOWN HybondRun *hybond_begin(const Model *model);
SHOWN void hybond_ask(void *who, HybondQuestion *question, void (*ask)(int));
SHOWN int hybond_run(HybondRun *run, int slice);
SHOWN int hybond_try(HybondRun *run, const int *state, int *hold);
SHOWN void hybond_see(const HybondRun *run, HybondSeen *seen);
SHOWN void hybond_fault(const HybondRun *run, int which, HybondFault *seen);
SHOWN void hybond_forget(HybondRun *run);
SHOWN void hybond_end(HybondRun *run);

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

static bool is_made(HybondRun *run)
{
    if (setjmp(run->own.arena.spent) != 0) {
        return false;
    }
    run->e = make_engine(&run->own.arena, run->model);
    run->log = make_report(run->e);
    run->r = make_run(run->e, run->log);
    return true;
}

/* Make ready for a run; NULL where there is no memory for it. */
SHOWN HybondRun *hybond_begin(const Model *model)
{
    HybondRun *run = calloc(1, sizeof(HybondRun));
    if (run == NULL) {
        return NULL;
    }
    run->model = model;
    if (!is_made(run)) {
        release(&run->own.arena);
        free(run);
        return NULL;
    }
    return run;
}

/* Say whom a run, or who looks into one, asks for inputs and blocks. */
SHOWN void hybond_ask(void *who, HybondQuestion *question, void (*ask)(int))
{
    HybondOwn *own = who;
    own->question = question;
    own->ask = ask;
}

/* Ask; where there is no answer the call ends here, as where memory does. The arena is the first of
 * what belongs to a run. */
static double ask_run(Arena *arena, int what, int k, double t, int piece, double *values)
{
    HybondOwn *own = (HybondOwn *)arena;
    HybondQuestion *question = own->question;
    if (question != NULL) {
        question->t = t;
        question->what = what;
        question->piece = piece;
        question->values = values;
        question->answered = 0;
        own->ask(k);
        if (question->answered) {
            return question->answer;
        }
    }
    own->raised = true;
    longjmp(arena->spent, 1);
}

/* Run on by so many steps and instants, -1: to the end; return the status. */
SHOWN int hybond_run(HybondRun *run, int slice)
{
    if (run->own.raised) {
        return RAISED;
    }
    if (setjmp(run->own.arena.spent) != 0) {
        run->status = run->own.raised ? RAISED : SPENT;
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
    if (setjmp(run->own.arena.spent) != 0) {
        return run->own.raised ? RAISED : SPENT;
    }
    run->settling = true;
    return try_at_start(run->e, run->r, state, hold);
}

SHOWN void hybond_see(const HybondRun *run, HybondSeen *seen)
{
    const Engine *e = run->e;
    const Report *log = run->log;
    seen->y = e->y;
    seen->state = e->state;
    seen->t = e->t;
    seen->energy = e->energy;
    seen->status = run->status;
    seen->states = e->states;
    seen->evaluations = e->evaluations;
    seen->modes_made = e->modes_made;
    seen->propagated = e->exact == NULL || e->quantised != NULL ? NULL : e->exact->found;
    seen->steps = log->steps;
    seen->instants = log->instants;
    seen->visits = log->visits;
    seen->fireds = log->fireds;
    seen->hits = log->hits;
    seen->step_time = log->step_time->at;
    seen->step_until = log->step_until->at;
    seen->step_state = log->step_state->at;
    seen->step_dense = log->step_dense->at;
    seen->step_place = log->step_place->at;
    seen->instant_time = log->instant_time->at;
    seen->instant_state = log->instant_state->at;
    seen->instant_place = log->instant_place->at;
    seen->visit = log->visit->at;
    seen->fired = log->fired->at;
    seen->hit = log->hit->at;
    seen->hit_area = log->hit_area->at;
    seen->tried = e->trial->state;
    seen->settling = run->settling;
    seen->rejected = log->rejected;
    seen->stuck_machine = e->landings->stuck_machine;
    seen->stuck_events = e->landings->stuck_events;
    seen->stuck_why = e->landings->stuck_why;
    seen->stuck_t = e->landings->limit_t;
    seen->stuck_ratio = e->landings->limit_ratio;
    seen->visit_energy = log->visit_energy->at;
    seen->reads = log->reads;
    seen->read = log->read->at;
    seen->overs = log->overs;
    seen->over = log->over->at;
    seen->opens = log->opens;
    seen->open = log->open->at;
    seen->slids = log->slids;
    seen->slid = log->slid->at;
    seen->slides = log->slides;
    seen->slide_time = log->slide_time->at;
    seen->warns = log->warned->rows;
    seen->warn = log->warned->kind->at;
    seen->warn_first = log->warned->first->at;
    seen->warn_time = log->warned->time->at;
    seen->abouts = log->warned->numbers;
    seen->about = log->warned->number->at;
    seen->bond_rows = log->bond_rows;
    seen->step_bonds = log->step_bonds->at;
    seen->step_energy = log->step_energy->at;
    seen->instant_since = log->instant_since->at;
    seen->step_bond = log->step_bond->at;
}

/* See why the run stopped, 0, or why what was struck cannot rest, 1. */
SHOWN void hybond_fault(const HybondRun *run, int which, HybondFault *seen)
{
    const Fault *fault = which == 0 ? run->e->fault : run->e->unrest;
    HybondFault nothing = {"", "", "", 0.0, 0, NULL};
    *seen = nothing;
    if (fault != NULL) {
        seen->code = fault->code;
        seen->why = fault->why;
        seen->place = fault->place;
        seen->t = fault->t;
        seen->many = fault->many;
        seen->about = fault->many > 0 ? fault->about->at : NULL;
    }
}

/* Forget the rows of the log that were read. */
SHOWN void hybond_forget(HybondRun *run)
{
    forget_rows(run->log);
}

/* Give all memory of a run back. */
SHOWN void hybond_end(HybondRun *run)
{
    if (run != NULL) {
        release(&run->own.arena);
        free(run);
    }
}

/* Looking into motions that are known: an engine of its own, which no run sees. */
typedef struct HybondLook {
    HybondOwn own;
    const Model *model;
    Engine *e;
    Look *l;
    Meter *meter;
} HybondLook;

/* Points with their states, or, where `step` is not NULL, in steps: as `Points` in look.py. */
typedef struct HybondPoints {
    int many;
    const double *t, *y;
    const int *accepted, *step;
    const double *step_time, *step_state, *step_dense;
} HybondPoints;

SHOWN HybondLook *hybond_look_begin(const Model *model);
SHOWN int hybond_look_into(HybondLook *look, double t, const int *state, const int *landed,
                           int surfaces, const int *surface, int product, int rows,
                           const int *branch, double energy);
SHOWN int hybond_look_modes(HybondLook *look, int *state);
SHOWN int hybond_look_linear(HybondLook *look, int *why);
SHOWN int hybond_look_values(HybondLook *look, const HybondPoints *points, int many,
                             const int *slot, double *out);
SHOWN int hybond_look_along(HybondLook *look, const HybondPoints *points, int many,
                            const int *slot, int motions, const int *first, const double *begin,
                            const int *state, const int *landed, double energy, double *out);
SHOWN int hybond_look_parts(HybondLook *look, const HybondPoints *points, int many,
                            const int *slot, double *share, double *out);
SHOWN int hybond_look_powers(HybondLook *look, const HybondPoints *points, double *out);
SHOWN int hybond_look_energies(HybondLook *look, const HybondPoints *points, const double *end,
                               double *out);
SHOWN int hybond_look_stored(HybondLook *look, int many, const double *y, double *out);
SHOWN int hybond_look_sources(HybondLook *look, int *source, int *rated);
SHOWN int hybond_look_by_knowns(HybondLook *look, int many, const double *known, double *out);
SHOWN void hybond_look_fault(const HybondLook *look, const char **texts, double *t);
SHOWN void hybond_look_end(HybondLook *look);

static bool can_look(HybondLook *look)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return false;
    }
    look->e = make_engine(&look->own.arena, look->model);
    look->l = make_look(look->e);
    look->meter = make_meter(&look->own.arena);
    return true;
}

/* Make ready for looking; NULL where there is no memory for it. */
SHOWN HybondLook *hybond_look_begin(const Model *model)
{
    HybondLook *look = calloc(1, sizeof(HybondLook));
    if (look == NULL) {
        return NULL;
    }
    look->model = model;
    if (!can_look(look)) {
        release(&look->own.arena);
        free(look);
        return NULL;
    }
    return look;
}

/* Why a call ended early. */
static int ended(HybondLook *look)
{
    if (!look->own.raised) {
        return SPENT;
    }
    look->own.raised = false;
    return RAISED;
}

SHOWN int hybond_look_into(HybondLook *look, double t, const int *state, const int *landed,
                           int surfaces, const int *surface, int product, int rows,
                           const int *branch, double energy)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    return look_into(look->e, look->l, t, state, landed, surfaces, surface, product, rows,
                     branch, energy);
}

/* The states of machines in each mode that is combined, and how many modes these are; NULL asks
 * for their number alone. */
SHOWN int hybond_look_modes(HybondLook *look, int *state)
{
    return state == NULL ? look->e->slide->parts : parts_of(look->e, state);
}

/* Why the mode is not linear: as `why_not_linear` in look.py. */
SHOWN int hybond_look_linear(HybondLook *look, int *why)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    *why = why_not_linear(look->e);
    return OK;
}

static void take_points(HybondLook *look, const HybondPoints *p)
{
    if (p->step != NULL) {
        points_within(look->l, p->many, p->t, p->step, p->step_time, p->step_state, p->step_dense);
    } else {
        points_at(look->l, p->many, p->t, p->y, p->accepted);
    }
}

SHOWN int hybond_look_values(HybondLook *look, const HybondPoints *points, int many,
                             const int *slot, double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    take_points(look, points);
    ask_for(look->l, many, slot);
    return look_values(look->e, look->l, out);
}

/* Values at points of one motion after another, where nothing is slid on. */
SHOWN int hybond_look_along(HybondLook *look, const HybondPoints *points, int many,
                            const int *slot, int motions, const int *first, const double *begin,
                            const int *state, const int *landed, double energy, double *out)
{
    const int machines = look->model->machines;
    if (setjmp(look->own.arena.spent) != 0) {
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
            take_points(look, &own);
            ask_for(look->l, many, slot);
            status = look_values(look->e, look->l, out + (size_t)first[k] * (size_t)many);
        }
        if (status != OK) {
            return status;
        }
    }
    return OK;
}

SHOWN int hybond_look_parts(HybondLook *look, const HybondPoints *points, int many,
                            const int *slot, double *share, double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    take_points(look, points);
    ask_for(look->l, many, slot);
    return look_parts(look->e, look->l, share, out);
}

SHOWN int hybond_look_powers(HybondLook *look, const HybondPoints *points, double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    take_points(look, points);
    return look_powers(look->e, look->l, look->meter, out);
}

SHOWN int hybond_look_energies(HybondLook *look, const HybondPoints *points, const double *end,
                               double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    take_points(look, points);
    return look_energies(look->e, look->l, look->meter, end, out);
}

SHOWN int hybond_look_stored(HybondLook *look, int many, const double *y, double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    return look_stored(look->e, look->l, many, y, out);
}

/* The sources of a linear mode; how many, or NOT_LINEAR. */
SHOWN int hybond_look_sources(HybondLook *look, int *source, int *rated)
{
    return look_sources(look->e, source, rated);
}

SHOWN int hybond_look_by_knowns(HybondLook *look, int many, const double *known, double *out)
{
    if (setjmp(look->own.arena.spent) != 0) {
        return ended(look);
    }
    look_by_knowns(look->e, many, known, out);
    return 0;
}

/* Why and when a look was refused: code, reason, place. */
SHOWN void hybond_look_fault(const HybondLook *look, const char **texts, double *t)
{
    const Fault *fault = look->e->fault;
    texts[0] = fault->code;
    texts[1] = fault->why;
    texts[2] = fault->place;
    *t = look->e->t;
}

SHOWN void hybond_look_end(HybondLook *look)
{
    if (look != NULL) {
        release(&look->own.arena);
        free(look);
    }
}
