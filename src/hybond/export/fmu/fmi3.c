/* The functions of FMI 3.0.2, chapters 2 to 4. */
#include <stdint.h>
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *fmi3Instance;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(void *, fmi3Status, fmi3String, fmi3String);
typedef struct {
    Unit unit;
    fmi3LogMessageCallback log;
    void *environment;
} Instance;

static fmi3Status told(Instance *i, bool fine)
{
    if (!fine && i->log != NULL) {
        i->log(i->environment, fmi3Error, "error", fault_text(&i->unit));
    }
    return fine ? fmi3OK : fmi3Error;
}

EXPORT void fmi3FreeInstance(fmi3Instance c)
{
    Instance *i = c;
    if (i != NULL) {
        release(&i->unit.arena);
        free(i);
    }
}

static Instance *make_instance(fmi3String token, void *environment, fmi3LogMessageCallback log)
{
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        return NULL;
    }
    Instance *i = calloc(1, sizeof(Instance));
    if (i == NULL) {
        return NULL;
    }
    i->log = log;
    i->environment = environment;
    if (!make_unit(&i->unit)) {
        told(i, false);
        fmi3FreeInstance(i);
        return NULL;
    }
    return i;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n,
                                      const fmi3String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi3OK;
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                 fmi3String folder, fmi3Boolean visible,
                                                 fmi3Boolean logging, void *environment,
                                                 fmi3LogMessageCallback log)
{
    (void)name, (void)folder, (void)visible, (void)logging;
    return make_instance(token, environment, log);
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String folder, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
    size_t intermediates, void *environment, fmi3LogMessageCallback log, void *update)
{
    (void)name, (void)folder, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)intermediate, (void)intermediates, (void)update;
    return make_instance(token, environment, log);
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(void) { return NULL; }

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance,
                                              fmi3Float64 tolerance, fmi3Float64 start,
                                              fmi3Boolean has_stop, fmi3Float64 stop)
{
    Instance *i = c;
    if (has_tolerance && tolerance > 0.0) {
        i->unit.model.rtol = tolerance;
    }
    if (has_stop && stop > 0.0) {
        i->unit.model.until = stop;
    }
    return start == 0.0 ? fmi3OK : fmi3Error; /* time begins at zero */
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    Instance *i = c;
    return told(i, ready(&i->unit));
}

#define FINE(name)                                                                                 \
    EXPORT fmi3Status name(fmi3Instance c)                                                         \
    {                                                                                              \
        (void)c;                                                                                   \
        return fmi3OK;                                                                             \
    }
FINE(fmi3EnterEventMode)
FINE(fmi3EnterContinuousTimeMode)
FINE(fmi3EnterStepMode)
FINE(fmi3Terminate)

EXPORT fmi3Status fmi3Reset(fmi3Instance c)
{
    Instance *i = c;
    return told(i, make_unit(&i->unit));
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                 fmi3Float64 value[], size_t values)
{
    (void)values;
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!get_value(&i->unit, vr[k], &value[k])) {
            return told(i, false);
        }
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                 const fmi3Float64 value[], size_t values)
{
    (void)values;
    Instance *i = c;
    for (size_t k = 0; k < n; k++) {
        if (!set_value(&i->unit, vr[k], value[k])) {
            return told(i, false);
        }
    }
    return fmi3OK;
}

#define NOTHING(name)                                                                              \
    EXPORT fmi3Status name(fmi3Instance c, const fmi3ValueReference vr[], size_t n)                \
    {                                                                                              \
        (void)c, (void)vr;                                                                         \
        return n == 0 ? fmi3OK : fmi3Error;                                                        \
    }
#define BOTH(type) NOTHING(fmi3Get##type) NOTHING(fmi3Set##type)
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

#define ABSENT(name)                                                                               \
    EXPORT fmi3Status name(void)                                                                   \
    {                                                                                              \
        return fmi3Error;                                                                          \
    }
ABSENT(fmi3GetNumberOfVariableDependencies)
ABSENT(fmi3GetVariableDependencies)
ABSENT(fmi3GetFMUState)
ABSENT(fmi3SetFMUState)
ABSENT(fmi3FreeFMUState)
ABSENT(fmi3SerializedFMUStateSize)
ABSENT(fmi3SerializeFMUState)
ABSENT(fmi3DeserializeFMUState)
ABSENT(fmi3GetDirectionalDerivative)
ABSENT(fmi3GetAdjointDerivative)
ABSENT(fmi3EnterConfigurationMode)
ABSENT(fmi3ExitConfigurationMode)
ABSENT(fmi3GetIntervalDecimal)
ABSENT(fmi3GetIntervalFraction)
ABSENT(fmi3GetShiftDecimal)
ABSENT(fmi3GetShiftFraction)
ABSENT(fmi3SetIntervalDecimal)
ABSENT(fmi3SetIntervalFraction)
ABSENT(fmi3SetShiftDecimal)
ABSENT(fmi3SetShiftFraction)
ABSENT(fmi3EvaluateDiscreteStates)
ABSENT(fmi3GetOutputDerivatives)
ABSENT(fmi3ActivateModelPartition)

/* Co-simulation. */
EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean no_set,
                             fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early,
                             fmi3Float64 *last)
{
    (void)no_set;
    Instance *i = c;
    *event_needed = *terminate = *early = false;
    const bool fine = run_to(&i->unit, t + h);
    *last = i->unit.e != NULL ? i->unit.e->t : t;
    return told(i, fine);
}

/* Model exchange. */
EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again,
                                           fmi3Boolean *terminate, fmi3Boolean *nominals,
                                           fmi3Boolean *values, fmi3Boolean *has_next,
                                           fmi3Float64 *next)
{
    Instance *i = c;
    bool jumped = false;
    double following = HUGE_VAL;
    const bool fine = settle_instant(&i->unit, &jumped, &following);
    *again = *terminate = *nominals = false;
    *values = jumped;
    *has_next = following < HUGE_VAL;
    *next = following;
    return told(i, fine);
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_set,
                                              fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
{
    Instance *i = c;
    (void)no_set;
    bool stepped_over = false;
    const bool fine = look_back(&i->unit, &stepped_over);
    *enter_event_mode = stepped_over;
    *terminate = false;
    return told(i, fine);
}

EXPORT fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 t)
{
    Instance *i = c;
    return told(i, set_unit_time(&i->unit, t));
}

EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n)
{
    Instance *i = c;
    return told(i, set_unit_states(&i->unit, x, n));
}

EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    Instance *i = c;
    return told(i, get_unit_states(&i->unit, x, n));
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 rate[], size_t n)
{
    (void)n;
    Instance *i = c;
    return told(i, get_rates(&i->unit, rate));
}

EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 z[], size_t n)
{
    (void)n;
    Instance *i = c;
    return told(i, get_indicators(&i->unit, z));
}

EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    Instance *i = c;
    return told(i, get_nominals(&i->unit, x, n));
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
    (void)c;
    *n = FIRST_DERIVATIVE - FIRST_STATE;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
    (void)c;
    *n = BEYOND_LAST - FIRST_INDICATOR;
    return fmi3OK;
}
