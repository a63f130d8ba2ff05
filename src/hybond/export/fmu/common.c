/* What a unit of either version of the standard is made of. */
typedef struct Unit {
    Model model;
    Engine *e;
    Run *r;
    double *rate;
    double *indicator;
    bool begun; /* whether the start is settled */
    bool failed;
    bool input_set[INPUTS + 1];
} Unit;

/* Why a value was refused; NULL: if something went wrong, the engine has the reason. */
static const char *complaint = NULL;

#if PARAMETERS > 0
static bool parameter_set[PARAMETERS];
static bool parameters_changed = false;

/* Take the values of the model. */
static void forget_parameters(void)
{
    for (int k = 0; k < PARAMETERS; k++) {
        parameter[k] = PARAMETER_START[k];
        parameter_set[k] = false;
    }
    if (parameters_changed) {
        put_parameters(parameter_set);
        put_inputs();
        parameters_changed = false;
    }
}

/* Put in what follows from the values that were set; false where the model is another one. */
static bool take_parameters(Unit *u)
{
    static char text[300];
    if (!parameters_changed) {
        return true;
    }
    put_parameters(parameter_set);
    put_inputs();
    for (int k = 0; k < INPUTS; k++) {
        if (!u->input_set[k]) {
            set_input(u->e, INPUT_NUMBER[k], INPUT_START[k]);
        }
    }
    const char *broken = broken_condition();
    if (broken != NULL) {
        snprintf(text, sizeof text,
                 "the model is made of other parts where not %s: export it again with these values",
                 broken);
        complaint = text;
    }
    return broken == NULL;
}

static double get_parameter(unsigned k)
{
    if (parameters_changed) {
        put_parameters(parameter_set);
    }
    return parameter[k];
}

static bool set_parameter(Unit *u, unsigned k, double value)
{
    if (u->begun || PARAMETER_FOLLOWS[k]) {
        complaint = u->begun ? "parameters are set before the initialization ends"
                             : "this parameter follows from others";
        return false;
    }
    parameter[k] = value;
    parameter_set[k] = true;
    parameters_changed = true;
    return true;
}
#endif

static Unit *make_unit(void)
{
    complaint = NULL;
#if PARAMETERS > 0
    forget_parameters();
#endif
    Unit *u = take(1, sizeof(Unit));
    u->model = MODEL;
    u->e = make_engine(&u->model);
    Report *report = make_report(u->e);
    report->silent = true;
    u->r = make_run(u->e, report);
    u->rate = floats(u->e->states);
    u->indicator = floats(indicators_of(u->e));
    for (int k = 0; k < INPUTS; k++) {
        set_input(u->e, INPUT_NUMBER[k], INPUT_START[k]);
    }
    return u;
}

/* Settle the start, once its inputs are known. */
static bool ready(Unit *u)
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

/* Put the value of a variable there; false if there is no such variable, or it has no value. */
static bool get_value(Unit *u, unsigned reference, double *value)
{
#if PARAMETERS > 0
    if (reference > 0 && reference < FIRST_INPUT) {
        *value = get_parameter(reference - 1);
        return true;
    }
#endif
    if (!ready(u)) {
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
    complaint = NULL;
    if (reference == 0 || reference >= FIRST_OUTPUT || !isfinite(value)) {
        complaint = "parameters and inputs are set, to finite numbers";
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
static bool run_to(Unit *u, double t)
{
    if (!ready(u)) {
        return false;
    }
    u->failed = take_inputs(u->e, u->r) != 0 || advance(u->e, u->r, t) != 0;
    return !u->failed;
}

/* Settle an instant that the importer has found; say whether states jumped, and what comes next. */
static bool settle_instant(Unit *u, bool *jumped, double *next)
{
    if (!ready(u)) {
        return false;
    }
    Engine *e = u->e;
    for (int k = 0; k < e->states; k++) {
        u->rate[k] = e->y[k];
    }
    u->failed = settle_unit(e, u->r) != 0;
    *jumped = false;
    for (int k = 0; k < e->states; k++) {
        *jumped = *jumped || u->rate[k] != e->y[k];
    }
    *next = e->next_break;
    return !u->failed;
}

/* Whether a guard holds that the importer has not found. */
static bool stepped_over(Unit *u)
{
    return ready(u) && guard_holds(u->e);
}

static const char *fault_text(Unit *u)
{
    static char text[400];
    if (complaint != NULL) {
        snprintf(text, sizeof text, "%s", complaint);
        return text;
    }
    const Fault *fault = u->e->fault;
    snprintf(text, sizeof text, "%s at t = %.9g s: %s", fault->code != NULL ? fault->code : "",
             fault->t, fault->why != NULL ? fault->why : "");
    return text;
}
