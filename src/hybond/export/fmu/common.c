/* What a unit of either version of the standard is made of. All that an instance changes is here, or
 * in its arena: any number of them live in a process, each in a thread of its own if wanted.
 */
typedef struct Unit {
    Arena arena;
    Model model; /* with the parameters of this instance, and what follows from them */
    Engine *e;
    Run *r;
    double *rate;
    double *indicator;
    bool begun; /* whether the start is settled */
    bool failed;
    bool spent; /* whether memory came to an end */
    bool input_set[INPUTS + 1];
    bool parameter_set[PARAMETERS + 1];
    bool parameters_changed;
    const char *complaint; /* why a value was refused; NULL: if something went wrong, the engine knows */
    char text[400];
} Unit;

/* What is asked of a unit, and what it answers. */
typedef struct Ask {
    unsigned reference;
    bool found;
    double t;
    double *values;
} Ask;

/* Ask a unit something; where its memory ends, take() leads back to here. */
static bool asked(Unit *u, bool (*answer)(Unit *, Ask *), Ask *ask)
{
    if (u->spent) {
        return false;
    }
    if (!u->failed) {
        u->complaint = NULL;
    }
    if (setjmp(u->arena.spent) != 0) {
        u->spent = u->failed = true;
        u->complaint = "out of memory";
        return false;
    }
    return answer(u, ask);
}

#if PARAMETERS > 0
/* Put in what follows from the values that were set; false where the model is another one. */
static bool take_parameters(Unit *u)
{
    if (!u->parameters_changed) {
        return true;
    }
    const char *broken = put_parameters(&u->model, u->parameter_set);
    double level[INPUTS + 1];
    for (int k = 0; k < INPUTS; k++) {
        level[k] = INPUT_START[k];
    }
    put_inputs(&u->model, level);
    for (int k = 0; k < INPUTS; k++) {
        if (!u->input_set[k]) {
            set_input(u->e, INPUT_NUMBER[k], level[k]);
        }
    }
    if (broken != NULL) {
        snprintf(u->text, sizeof u->text,
                 "the model is made of other parts where not %s: export it again with these values",
                 broken);
        u->complaint = u->text;
    }
    return broken == NULL;
}

static double get_parameter(Unit *u, unsigned k)
{
    if (u->parameters_changed) {
        put_parameters(&u->model, u->parameter_set);
    }
    return u->model.parameter[k];
}

static bool set_parameter(Unit *u, unsigned k, double value)
{
    if (u->begun || PARAMETER_FOLLOWS[k]) {
        u->complaint = u->begun ? "parameters are set before the initialization ends"
                                : "this parameter follows from others";
        return false;
    }
    u->model.parameter[k] = value;
    u->parameter_set[k] = true;
    u->parameters_changed = true;
    return true;
}
#endif

static bool answer_made(Unit *u, Ask *ask)
{
    (void)ask;
    u->e = make_engine(&u->arena, &u->model);
    Report *report = make_report(u->e);
    report->silent = true;
    u->r = make_run(u->e, report);
    u->rate = floats(&u->arena, u->e->states);
    u->indicator = floats(&u->arena, indicators_of(u->e));
    for (int k = 0; k < INPUTS; k++) {
        set_input(u->e, INPUT_NUMBER[k], INPUT_START[k]);
    }
    return true;
}

/* Make a unit, or make it anew: with the values of the model, and nothing of what was before. */
static bool make_unit(Unit *u)
{
    release(&u->arena);
    memset(u, 0, sizeof *u);
    u->model = MODEL;
    return asked(u, answer_made, NULL);
}

/* Settle the start, once its inputs are known. */
static bool is_ready(Unit *u)
{
    if (!u->begun && !u->failed) {
        u->begun = true;
#if PARAMETERS > 0
        u->failed = !take_parameters(u);
#endif
        u->failed = u->failed || begin_unit(u->e, u->r) != 0;
    }
    return !u->failed;
}

static bool answer_ready(Unit *u, Ask *ask)
{
    (void)ask;
    return is_ready(u);
}

/* Put the value of a variable there; false if there is no such variable, or it has no value. */
static bool answer_value(Unit *u, Ask *ask)
{
    const unsigned reference = ask->reference;
    double *value = ask->values;
#if PARAMETERS > 0
    if (reference > 0 && reference < FIRST_INPUT) {
        *value = get_parameter(u, reference - 1);
        return true;
    }
#endif
    if (!is_ready(u)) {
        return false;
    }
    Engine *e = u->e;
    if (reference == 0) {
        *value = e->t;
    } else if (reference < FIRST_OUTPUT) {
        *value = e->asked[INPUT_NUMBER[reference - FIRST_INPUT]];
    } else if (reference < FIRST_STATE) {
        *value = output_now(e, (int)(reference - FIRST_OUTPUT));
        return isfinite(*value);
    } else if (reference < FIRST_DERIVATIVE) {
        *value = e->y[reference - FIRST_STATE];
    } else if (reference < FIRST_INDICATOR) {
        if (rates_now(e, u->rate) != 0) {
            return false;
        }
        *value = u->rate[reference - FIRST_DERIVATIVE];
    } else if (reference < BEYOND_LAST) {
        if (indicators_now(e, u->indicator) != 0) {
            return false;
        }
        *value = u->indicator[reference - FIRST_INDICATOR];
    } else {
        return false;
    }
    return true;
}

static bool set_value(Unit *u, unsigned reference, double value)
{
    if (u->spent) {
        return false;
    }
    u->complaint = NULL;
    if (reference == 0 || reference >= FIRST_OUTPUT || !isfinite(value)) {
        u->complaint = "parameters and inputs are set, to finite numbers";
        return false;
    }
#if PARAMETERS > 0
    if (reference < FIRST_INPUT) {
        return set_parameter(u, reference - 1, value);
    }
#endif
    u->input_set[reference - FIRST_INPUT] = true;
    set_input(u->e, INPUT_NUMBER[reference - FIRST_INPUT], value);
    return true;
}

/* Run to a time, with the inputs that hold from now on. */
static bool answer_run(Unit *u, Ask *ask)
{
    if (!is_ready(u)) {
        return false;
    }
    u->failed = take_inputs(u->e, u->r) != 0 || advance(u->e, u->r, ask->t) != 0;
    return !u->failed;
}

/* Settle an instant that the importer has found; say whether states jumped, and what comes next. */
static bool answer_instant(Unit *u, Ask *ask)
{
    if (!is_ready(u)) {
        return false;
    }
    Engine *e = u->e;
    for (int k = 0; k < e->states; k++) {
        u->rate[k] = e->y[k];
    }
    u->failed = settle_unit(e, u->r) != 0;
    for (int k = 0; k < e->states; k++) {
        ask->found = ask->found || u->rate[k] != e->y[k];
    }
    ask->t = e->next_break;
    return !u->failed;
}

/* Find whether a guard holds that the importer has not found. */
static bool answer_guards(Unit *u, Ask *ask)
{
    ask->found = is_ready(u) && guard_holds(u->e);
    return !u->failed;
}

static bool answer_rates(Unit *u, Ask *ask)
{
    return rates_now(u->e, ask->values) == 0;
}

static bool answer_indicators(Unit *u, Ask *ask)
{
    return indicators_now(u->e, ask->values) == 0;
}

static bool answer_states(Unit *u, Ask *ask)
{
    const bool fine = is_ready(u);
    for (int k = 0; k < u->e->states && fine; k++) {
        ask->values[k] = u->e->y[k];
    }
    return fine;
}

static bool answer_nominals(Unit *u, Ask *ask)
{
    const bool fine = is_ready(u);
    for (int k = 0; k < u->e->states && fine; k++) {
        ask->values[k] = nominal_now(u->e, k);
    }
    return fine;
}

static const char *fault_text(Unit *u)
{
    if (u->complaint != NULL) {
        return u->complaint;
    }
    const Fault *fault = u->e->fault;
    snprintf(u->text, sizeof u->text, "%s at t = %.9g s: %s", fault->code != NULL ? fault->code : "",
             fault->t, fault->why != NULL ? fault->why : "");
    return u->text;
}

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
