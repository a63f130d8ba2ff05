/* The functions of FMI 2.0.4, chapters 2 to 4, that are its own. */
/* fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending */
typedef enum { FINE, WITH_WARNING, DISCARDED, WRONG, FATAL, PENDING } Status;
typedef int Boolean;
typedef struct {
    void (*logger)(void *, const char *, Status, const char *, const char *, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *, Status);
    void *componentEnvironment;
} Callbacks;
typedef struct {
    Boolean newDiscreteStatesNeeded;
    Boolean terminateSimulation;
    Boolean nominalsOfContinuousStatesChanged;
    Boolean valuesOfContinuousStatesChanged;
    Boolean nextEventTimeDefined;
    double nextEventTime;
} EventInfo;
typedef struct {
    Unit unit;
    Callbacks callbacks;
    char name[];
} Instance;
#define FMI(name) fmi2##name
#define RATES fmi2GetDerivatives

static void tell(Instance *i, const char *text)
{
    if (i->callbacks.logger != NULL) {
        i->callbacks.logger(i->callbacks.componentEnvironment, i->name, WRONG, "error", "%s",
                            text);
    }
}

@ALIKE@
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *folder,
                             const Callbacks *callbacks, Boolean visible, Boolean logging)
{
    (void)kind, (void)folder, (void)visible, (void)logging;
    if (guid == NULL || strcmp(guid, TOKEN) != 0) {
        return NULL;
    }
    const size_t length = name != NULL ? strlen(name) : 0;
    Instance *i = calloc(1, sizeof(Instance) + length + 1);
    if (i != NULL && name != NULL) {
        memcpy(i->name, name, length);
    }
    if (i != NULL && callbacks != NULL) {
        i->callbacks = *callbacks;
    }
    return made(i);
}

EXPORT Status fmi2SetupExperiment(void *c, Boolean has_tolerance, double tolerance, double start,
                                  Boolean has_stop, double stop)
{
    return experiment(c, has_tolerance, tolerance, start, has_stop, stop);
}
NOTHING_TO_DO(EnterInitializationMode)

EXPORT Status fmi2GetReal(void *c, const unsigned vr[], size_t n, double value[])
{
    return values_got(c, vr, n, value);
}

EXPORT Status fmi2SetReal(void *c, const unsigned vr[], size_t n, const double value[])
{
    return values_set(c, vr, n, value);
}

#define NONE_OF(name)                                                                              \
    EXPORT Status FMI(name)(void *c, const unsigned vr[], size_t n, const void *value)             \
    {                                                                                              \
        (void)c, (void)vr, (void)value;                                                            \
        return n == 0 ? FINE : WRONG;                                                              \
    }
NONE_OF(GetInteger)
NONE_OF(GetBoolean)
NONE_OF(GetString)
NONE_OF(SetInteger)
NONE_OF(SetBoolean)
NONE_OF(SetString)
ABSENT(GetFMUstate)
ABSENT(SetFMUstate)
ABSENT(FreeFMUstate)
ABSENT(SerializedFMUstateSize)
ABSENT(SerializeFMUstate)
ABSENT(DeSerializeFMUstate)
ABSENT(SetRealInputDerivatives)
ABSENT(GetRealOutputDerivatives)
ABSENT(CancelStep)
ABSENT(GetStatus)
ABSENT(GetRealStatus)
ABSENT(GetIntegerStatus)
ABSENT(GetBooleanStatus)
ABSENT(GetStringStatus)

/* Co-simulation. */
EXPORT Status fmi2DoStep(void *c, double t, double h, Boolean no_set)
{
    (void)no_set;
    Instance *i = c;
    Ask ask = {.t = t + h};
    return told(i, asked(&i->unit, answer_run, &ask));
}

/* Model exchange. */
EXPORT Status fmi2NewDiscreteStates(void *c, EventInfo *info)
{
    Instance *i = c;
    Ask ask = {.t = HUGE_VAL};
    const bool fine = asked(&i->unit, answer_instant, &ask);
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = ask.found;
    info->nextEventTimeDefined = ask.t < HUGE_VAL;
    info->nextEventTime = ask.t;
    return told(i, fine);
}
