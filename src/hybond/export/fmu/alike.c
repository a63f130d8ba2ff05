/* The functions that are alike in both versions of the standard. */
static Status told(Instance *i, bool fine)
{
    if (!fine) {
        tell(i, fault_text(&i->unit));
    }
    return fine ? FINE : WRONG;
}

/* Ask a unit something that concerns numbers there. */
static Status answered(void *c, bool (*answer)(Unit *, Ask *), double *values)
{
    Instance *i = c;
    Ask ask = {.values = values};
    return told(i, asked(&i->unit, answer, &ask));
}

static Status values_got(void *c, const unsigned *reference, size_t n, double *value)
{
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        Ask ask = {.reference = reference[k], .values = &value[k]};
        if (!asked(&i->unit, answer_value, &ask)) {
            return told(i, false);
        }
    }
    return FINE;
}

static Status values_set(void *c, const unsigned *reference, size_t n, const double *value)
{
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!set_value(&i->unit, reference[k], value[k])) {
            return told(i, false);
        }
    }
    return FINE;
}

EXPORT void FMI(FreeInstance)(void *c)
{
    Instance *i = c;
    if (i != NULL) {
        release(&i->unit.arena);
        free(i);
    }
}

/* Return an instance whose unit is made; NULL for another model, or where there is no memory. */
static Instance *made(Instance *i)
{
    if (i != NULL && !make_unit(&i->unit)) {
        told(i, false);
        FMI(FreeInstance)(i);
        return NULL;
    }
    return i;
}

static Status experiment(Instance *i, bool has_tolerance, double tolerance, double start,
                         bool has_stop, double stop)
{
    if (has_tolerance && tolerance > 0.0) {
        i->unit.model.rtol = tolerance;
    }
    if (has_stop && stop > 0.0) {
        i->unit.model.until = stop;
    }
    return start == 0.0 ? FINE : WRONG; /* time begins at zero */
}

EXPORT Status FMI(SetDebugLogging)(void *c, Boolean on, size_t n, const char *const categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return FINE;
}

EXPORT Status FMI(ExitInitializationMode)(void *c)
{
    return answered(c, answer_ready, NULL);
}

EXPORT Status FMI(Reset)(void *c)
{
    Instance *i = c;
    return told(i, make_unit(&i->unit));
}

#define NOTHING_TO_DO(name)                                                                        \
    EXPORT Status FMI(name)(void *c)                                                               \
    {                                                                                              \
        (void)c;                                                                                   \
        return FINE;                                                                               \
    }
NOTHING_TO_DO(EnterEventMode)
NOTHING_TO_DO(EnterContinuousTimeMode)
NOTHING_TO_DO(Terminate)

#define ABSENT(name)                                                                               \
    EXPORT Status FMI(name)(void)                                                                  \
    {                                                                                              \
        return WRONG;                                                                              \
    }
ABSENT(GetDirectionalDerivative)

EXPORT Status FMI(CompletedIntegratorStep)(void *c, Boolean no_set, Boolean *enter_event_mode,
                                           Boolean *terminate)
{
    Instance *i = c;
    (void)no_set;
    Ask ask = {0};
    const bool fine = asked(&i->unit, answer_guards, &ask);
    *enter_event_mode = ask.found;
    *terminate = 0;
    return told(i, fine);
}

EXPORT Status FMI(SetTime)(void *c, double t)
{
    Instance *i = c;
    if (!i->unit.spent) {
        i->unit.e->t = t;
    }
    return told(i, !i->unit.spent);
}

EXPORT Status FMI(SetContinuousStates)(void *c, const double x[], size_t n)
{
    Instance *i = c;
    for (size_t k = 0; k < n && !i->unit.spent; k++) {
        i->unit.e->y[k] = x[k];
    }
    return told(i, !i->unit.spent);
}

EXPORT Status FMI(GetContinuousStates)(void *c, double x[], size_t n)
{
    (void)n;
    return answered(c, answer_states, x);
}

EXPORT Status RATES(void *c, double rate[], size_t n)
{
    (void)n;
    return answered(c, answer_rates, rate);
}

EXPORT Status FMI(GetEventIndicators)(void *c, double z[], size_t n)
{
    (void)n;
    return answered(c, answer_indicators, z);
}

EXPORT Status FMI(GetNominalsOfContinuousStates)(void *c, double x[], size_t n)
{
    (void)n;
    return answered(c, answer_nominals, x);
}
