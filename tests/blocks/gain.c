/* A co-simulation unit that lags behind: x' = kp*(y - x), u = x, by steps of Euler of 0.1 ms.
   Compiled with -DFMI=2 or -DFMI=3; only what FMPy calls is here. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

typedef struct { double t, x, y, kp; } unit;

static void steps(unit *u, double h) {
    int n = (int)(h / 1e-4 + 0.5);
    for (int k = 0; k < n; k++) u->x += 1e-4 * u->kp * (u->y - u->x);
}
static double *slot(unit *u, unsigned r) { return r == 0 ? &u->y : r == 1 ? &u->x : &u->kp; }

#if FMI == 2
#define X(name) fmi2##name
typedef const char *text;
const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void *fmi2Instantiate(text n, int k, text g, text r, const void *c, int v, int l) {
    (void)n; (void)k; (void)g; (void)r; (void)c; (void)v; (void)l;
    unit *u = calloc(1, sizeof(unit)); u->kp = 1; return u;
}
int fmi2SetupExperiment(void *c, int a, double b, double s, int d, double e) {
    (void)a; (void)b; (void)d; (void)e; ((unit *)c)->t = s; return 0;
}
int fmi2EnterInitializationMode(void *c) { (void)c; return 0; }
int fmi2DoStep(void *c, double t, double h, int n) {
    (void)t; (void)n; if (((unit *)c)->kp < 0) return 3; steps(c, h); return 0;
}
int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *v) {
    for (size_t k = 0; k < n; k++) *slot(c, r[k]) = v[k];
    return 0;
}
int fmi2GetReal(void *c, const unsigned *r, size_t n, double *v) {
    for (size_t k = 0; k < n; k++) v[k] = *slot(c, r[k]);
    return 0;
}
#define OTHERS(M) M(SetDebugLogging) M(Reset) M(GetInteger) M(GetBoolean) M(GetString) M(SetInteger) \
    M(SetBoolean) M(SetString) M(GetFMUstate) M(SetFMUstate) M(FreeFMUstate) M(SerializedFMUstateSize) \
    M(SerializeFMUstate) M(DeSerializeFMUstate) M(GetDirectionalDerivative) M(SetRealInputDerivatives) \
    M(GetRealOutputDerivatives) M(CancelStep) M(GetStatus) M(GetRealStatus) M(GetIntegerStatus) \
    M(GetBooleanStatus) M(GetStringStatus)
#else
#define X(name) fmi3##name
typedef const char *text;
const char *fmi3GetVersion(void) { return "3.0"; }
void *fmi3InstantiateCoSimulation(text n, text g, text r, _Bool v, _Bool l, _Bool e, _Bool a,
                                  const unsigned *w, size_t s, void *d, void *f, void *h) {
    (void)n; (void)g; (void)r; (void)v; (void)l; (void)e; (void)a; (void)w; (void)s; (void)d; (void)f; (void)h;
    unit *u = calloc(1, sizeof(unit)); u->kp = 1; return u;
}
int fmi3EnterInitializationMode(void *c, _Bool a, double b, double s, _Bool d, double e) {
    (void)a; (void)b; (void)d; (void)e; ((unit *)c)->t = s; return 0;
}
int fmi3DoStep(void *c, double t, double h, _Bool n, _Bool *ev, _Bool *te, _Bool *er, double *last) {
    (void)n; steps(c, h); *ev = *te = *er = 0; *last = t + h; return 0;
}
int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *v, size_t m) {
    (void)m; for (size_t k = 0; k < n; k++) *slot(c, r[k]) = v[k];
    return 0;
}
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *v, size_t m) {
    (void)m; for (size_t k = 0; k < n; k++) v[k] = *slot(c, r[k]);
    return 0;
}
#define INTS(M, W) M(W##Int8) M(W##UInt8) M(W##Int16) M(W##UInt16) M(W##Int32) M(W##UInt32) M(W##Int64) M(W##UInt64)
#define OTHERS(M) M(SetDebugLogging) M(Reset) M(EnterEventMode) INTS(M, Get) INTS(M, Set) \
    M(GetFloat32) M(SetFloat32) M(GetBoolean) M(SetBoolean) M(GetString) M(SetString) M(GetBinary) M(SetBinary) \
    M(GetClock) M(SetClock) M(GetNumberOfVariableDependencies) M(GetVariableDependencies) M(GetFMUState) \
    M(SetFMUState) M(FreeFMUState) M(SerializedFMUStateSize) M(SerializeFMUState) M(DeserializeFMUState) \
    M(GetDirectionalDerivative) M(GetAdjointDerivative) M(EnterConfigurationMode) M(ExitConfigurationMode) \
    M(GetIntervalDecimal) M(GetIntervalFraction) M(GetShiftDecimal) M(GetShiftFraction) M(SetIntervalDecimal) \
    M(SetIntervalFraction) M(SetShiftDecimal) M(SetShiftFraction) M(EvaluateDiscreteStates) \
    M(UpdateDiscreteStates) M(EnterContinuousTimeMode) M(CompletedIntegratorStep) M(SetTime) \
    M(SetContinuousStates) M(GetContinuousStateDerivatives) M(GetEventIndicators) M(GetContinuousStates) \
    M(GetNominalsOfContinuousStates) M(GetNumberOfEventIndicators) M(GetNumberOfContinuousStates) \
    M(EnterStepMode) M(GetOutputDerivatives) M(ActivateModelPartition) M(InstantiateModelExchange) \
    M(InstantiateScheduledExecution)
#endif
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define EMPTY(name) int JOIN(JOIN(fmi, FMI), name)(void) { return 0; }
OTHERS(EMPTY)
int X(ExitInitializationMode)(void *c) { (void)c; return 0; }
int X(Terminate)(void *c) { (void)c; return 0; }
void X(FreeInstance)(void *c) { free(c); }
