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

typedef struct HybondRun {
    Arena arena;
    const Model *model;
    Engine *e;
    Run *r;
    Report *log;
    int status;
    HybondQuestion *question;
    void (*ask)(int);
    bool raised;
} HybondRun;

/* What is read of a run: the numbers of the record Seen in native.py. */
typedef struct HybondSeen {
    const double *y;
    const int *state;
    double t;
    double energy;
    int status;
    int states;
    int evaluations;
    int modes_made;
    const char *code;
    const char *why;
    const char *place;
    double fault_t;
    int steps, instants, visits, fireds, hits;
    const double *step_time, *step_state, *step_dense;
    const int *step_place;
    const double *instant_time, *instant_state;
    const int *instant_place, *visit, *fired, *hit;
    const double *hit_area;
} HybondSeen;

SHOWN const char *hybond_source(void);
SHOWN const char *const *hybond_columns(void);
SHOWN int hybond_model_size(void);
SHOWN HybondRun *hybond_begin(const Model *model);
SHOWN void hybond_ask(HybondRun *run, HybondQuestion *question, void (*ask)(int));
SHOWN int hybond_run(HybondRun *run, int slice);
SHOWN void hybond_see(const HybondRun *run, HybondSeen *seen);
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
    if (setjmp(run->arena.spent) != 0) {
        return false;
    }
    run->e = make_engine(&run->arena, run->model);
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
        release(&run->arena);
        free(run);
        return NULL;
    }
    return run;
}

/* Say whom a run asks for inputs and blocks. */
SHOWN void hybond_ask(HybondRun *run, HybondQuestion *question, void (*ask)(int))
{
    run->question = question;
    run->ask = ask;
}

/* Ask; where there is no answer the run ends here, as where memory does. The arena is a run's, which
 * begins with it. */
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
    return run->status;
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
    seen->code = e->fault->code;
    seen->why = e->fault->why;
    seen->place = e->fault->place;
    seen->fault_t = e->fault->t;
    seen->steps = log->steps;
    seen->instants = log->instants;
    seen->visits = log->visits;
    seen->fireds = log->fireds;
    seen->hits = log->hits;
    seen->step_time = log->step_time->at;
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
        release(&run->arena);
        free(run);
    }
}
