/* The functions of FMI 3.0.2, chapters 2 to 4, that are its own. */
/* fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal */
typedef enum { FINE, WITH_WARNING, DISCARDED, WRONG, FATAL } Status;
typedef bool Boolean;
typedef void (*LogMessage)(void *, Status, const char *, const char *);
typedef struct {
    Unit unit;
    LogMessage log;
    void *environment;
} Instance;
#define FMI(name) fmi3##name
#define RATES fmi3GetContinuousStateDerivatives

static void tell(Instance *i, const char *text)
{
    if (i->log != NULL) {
        i->log(i->environment, WRONG, "error", text);
    }
}

@ALIKE@
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

static Instance *instance(const char *token, void *environment, LogMessage log)
{
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        return NULL;
    }
    Instance *i = calloc(1, sizeof(Instance));
    if (i != NULL) {
        i->log = log;
        i->environment = environment;
    }
    return made(i);
}

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *folder,
                                          Boolean visible, Boolean logging, void *environment,
                                          LogMessage log)
{
    (void)name, (void)folder, (void)visible, (void)logging;
    return instance(token, environment, log);
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *folder,
                                         Boolean visible, Boolean logging, Boolean event_mode,
                                         Boolean early_return, const unsigned intermediate[],
                                         size_t intermediates, void *environment, LogMessage log,
                                         void *update)
{
    (void)name, (void)folder, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)intermediate, (void)intermediates, (void)update;
    return instance(token, environment, log);
}

EXPORT void *fmi3InstantiateScheduledExecution(void) { return NULL; }

EXPORT Status fmi3EnterInitializationMode(void *c, Boolean has_tolerance, double tolerance,
                                          double start, Boolean has_stop, double stop)
{
    return experiment(c, has_tolerance, tolerance, start, has_stop, stop);
}
NOTHING_TO_DO(EnterStepMode)

EXPORT Status fmi3GetFloat64(void *c, const unsigned vr[], size_t n, double value[], size_t values)
{
    (void)values;
    return values_got(c, vr, n, value);
}

EXPORT Status fmi3SetFloat64(void *c, const unsigned vr[], size_t n, const double value[],
                             size_t values)
{
    (void)values;
    return values_set(c, vr, n, value);
}

#define NONE_OF(name)                                                                              \
    EXPORT Status FMI(name)(void *c, const unsigned vr[], size_t n)                                \
    {                                                                                              \
        (void)c, (void)vr;                                                                         \
        return n == 0 ? FINE : WRONG;                                                              \
    }
#define BOTH(type) NONE_OF(Get##type) NONE_OF(Set##type)
BOTH(Float32)
BOTH(Int8)
BOTH(UInt8)
BOTH(Int16)
BOTH(UInt16)
BOTH(Int32)
BOTH(UInt32)
BOTH(Int64)
BOTH(UInt64)
BOTH(Boolean)
BOTH(String)
BOTH(Binary)
BOTH(Clock)
ABSENT(GetNumberOfVariableDependencies)
ABSENT(GetVariableDependencies)
ABSENT(GetFMUState)
ABSENT(SetFMUState)
ABSENT(FreeFMUState)
ABSENT(SerializedFMUStateSize)
ABSENT(SerializeFMUState)
ABSENT(DeserializeFMUState)
ABSENT(GetAdjointDerivative)
ABSENT(EnterConfigurationMode)
ABSENT(ExitConfigurationMode)
ABSENT(GetIntervalDecimal)
ABSENT(GetIntervalFraction)
ABSENT(GetShiftDecimal)
ABSENT(GetShiftFraction)
ABSENT(SetIntervalDecimal)
ABSENT(SetIntervalFraction)
ABSENT(SetShiftDecimal)
ABSENT(SetShiftFraction)
ABSENT(EvaluateDiscreteStates)
ABSENT(GetOutputDerivatives)
ABSENT(ActivateModelPartition)

/* Co-simulation. */
EXPORT Status fmi3DoStep(void *c, double t, double h, Boolean no_set, Boolean *event_needed,
                         Boolean *terminate, Boolean *early, double *last)
{
    (void)no_set;
    Instance *i = c;
    Ask ask = {.t = t + h};
    *event_needed = *terminate = *early = false;
    const bool fine = asked(&i->unit, answer_run, &ask);
    *last = i->unit.e != NULL ? i->unit.e->t : t;
    return told(i, fine);
}

/* Model exchange. */
EXPORT Status fmi3UpdateDiscreteStates(void *c, Boolean *again, Boolean *terminate,
                                       Boolean *nominals, Boolean *values, Boolean *has_next,
                                       double *next)
{
    Instance *i = c;
    Ask ask = {.t = HUGE_VAL};
    const bool fine = asked(&i->unit, answer_instant, &ask);
    *again = *terminate = *nominals = false;
    *values = ask.found;
    *has_next = ask.t < HUGE_VAL;
    *next = ask.t;
    return told(i, fine);
}

EXPORT Status fmi3GetNumberOfContinuousStates(void *c, size_t *n)
{
    (void)c;
    *n = FIRST_DERIVATIVE - FIRST_STATE;
    return FINE;
}

EXPORT Status fmi3GetNumberOfEventIndicators(void *c, size_t *n)
{
    (void)c;
    *n = BEYOND_LAST - FIRST_INDICATOR;
    return FINE;
}
