/* The functions of FMI 2.0.4, chapters 2 to 4. */
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *fmi2Component;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef struct {
    void (*logger)(void *, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *, fmi2Status);
    void *componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;
typedef struct {
    Unit unit;
    fmi2CallbackFunctions callbacks;
    char name[];
} Instance;

static fmi2Status told(Instance *i, bool fine)
{
    if (fine) {
        return fmi2OK;
    }
    if (i->callbacks.logger != NULL) {
        i->callbacks.logger(i->callbacks.componentEnvironment, i->name, fmi2Error, "error", "%s",
                            fault_text(&i->unit));
    }
    return fmi2Error;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n,
                                      const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    Instance *i = c;
    if (i != NULL) {
        release(&i->unit.arena);
        free(i);
    }
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, int kind, fmi2String guid, fmi2String folder,
                                     const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                     fmi2Boolean logging)
{
    (void)kind, (void)folder, (void)visible, (void)logging;
    if (guid == NULL || strcmp(guid, TOKEN) != 0) {
        return NULL;
    }
    const size_t length = name != NULL ? strlen(name) : 0;
    Instance *i = calloc(1, sizeof(Instance) + length + 1);
    if (i == NULL) {
        return NULL;
    }
    if (name != NULL) {
        memcpy(i->name, name, length);
    }
    if (callbacks != NULL) {
        i->callbacks = *callbacks;
    }
    if (!make_unit(&i->unit)) {
        told(i, false);
        fmi2FreeInstance(i);
        return NULL;
    }
    return i;
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    Instance *i = c;
    if (has_tolerance && tolerance > 0.0) {
        i->unit.model.rtol = tolerance;
    }
    if (has_stop && stop > 0.0) {
        i->unit.model.until = stop;
    }
    return start == 0.0 ? fmi2OK : fmi2Error; /* time begins at zero */
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *i = c;
    return told(i, ready(&i->unit));
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *i = c;
    return told(i, make_unit(&i->unit));
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                              fmi2Real value[])
{
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!get_value(&i->unit, vr[k], &value[k])) {
            return told(i, false);
        }
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                              const fmi2Real value[])
{
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!set_value(&i->unit, vr[k], value[k])) {
            return told(i, false);
        }
    }
    return fmi2OK;
}

#define NOTHING(name, type)                                                                        \
    EXPORT fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value)   \
    {                                                                                              \
        (void)c, (void)vr, (void)value;                                                            \
        return n == 0 ? fmi2OK : fmi2Error;                                                        \
    }
NOTHING(fmi2GetInteger, fmi2Integer *)
NOTHING(fmi2GetBoolean, fmi2Boolean *)
NOTHING(fmi2GetString, fmi2String *)
NOTHING(fmi2SetInteger, const fmi2Integer *)
NOTHING(fmi2SetBoolean, const fmi2Boolean *)
NOTHING(fmi2SetString, const fmi2String *)

#define ABSENT(name)                                                                               \
    EXPORT fmi2Status name(void)                                                                   \
    {                                                                                              \
        return fmi2Error;                                                                          \
    }
ABSENT(fmi2GetFMUstate)
ABSENT(fmi2SetFMUstate)
ABSENT(fmi2FreeFMUstate)
ABSENT(fmi2SerializedFMUstateSize)
ABSENT(fmi2SerializeFMUstate)
ABSENT(fmi2DeSerializeFMUstate)
ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2SetRealInputDerivatives)
ABSENT(fmi2GetRealOutputDerivatives)
ABSENT(fmi2CancelStep)
ABSENT(fmi2GetStatus)
ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetStringStatus)

/* Co-simulation. */
EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set)
{
    (void)no_set;
    Instance *i = c;
    return told(i, run_to(&i->unit, t + h));
}

/* Model exchange. */
EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    Instance *i = c;
    bool jumped = false;
    double next = HUGE_VAL;
    const bool fine = settle_instant(&i->unit, &jumped, &next);
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = jumped;
    info->nextEventTimeDefined = next < HUGE_VAL;
    info->nextEventTime = next;
    return told(i, fine);
}

EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set,
                                              fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    Instance *i = c;
    (void)no_set;
    bool stepped_over = false;
    const bool fine = look_back(&i->unit, &stepped_over);
    *enter_event_mode = stepped_over;
    *terminate = 0;
    return told(i, fine);
}

EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real t)
{
    Instance *i = c;
    return told(i, set_unit_time(&i->unit, t));
}

EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    Instance *i = c;
    return told(i, set_unit_states(&i->unit, x, n));
}

EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    Instance *i = c;
    return told(i, get_unit_states(&i->unit, x, n));
}

EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real rate[], size_t n)
{
    (void)n;
    Instance *i = c;
    return told(i, get_rates(&i->unit, rate));
}

EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n)
{
    (void)n;
    Instance *i = c;
    return told(i, get_indicators(&i->unit, z));
}

EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    Instance *i = c;
    return told(i, get_nominals(&i->unit, x, n));
}
