/* A unit whose memory ends wherever it can, beside another one that runs on. UNIT_FILE names its
 * source, FMI_VERSION is 2 or 3. Ends with 0 if every end of memory was told and the rest went well.
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static long left = 0; /* blocks of memory that there still are; negative: as many as wanted */

static void *scarce(size_t n, size_t size)
{
    if (left == 0) {
        return NULL;
    }
    left -= left > 0;
    return calloc(n, size);
}
#define calloc scarce
#include UNIT_FILE

static long told_of_memory = 0;

#if FMI_VERSION == 2
static void hear(void *environment, const char *name, Status status, const char *category,
                 const char *text, ...)
{
    (void)environment, (void)category, (void)text;
    va_list rest;
    va_start(rest, text);
    told_of_memory += strcmp(va_arg(rest, const char *), "out of memory") == 0;
    va_end(rest);
    if (strcmp(name, "unit") != 0 || status != WRONG) {
        exit(4);
    }
}

static void *make(void)
{
    char name[] = "unit"; /* no longer there when the unit speaks */
    Callbacks calls = {0};
    calls.logger = hear;
    void *unit = fmi2Instantiate(name, 1, TOKEN, "", &calls, 0, 0);
    memset(name, 'x', sizeof name - 1);
    return unit;
}

static bool begin_run(void *u)
{
    return fmi2SetupExperiment(u, 0, 0.0, 0.0, 0, 0.0) == FINE
           && fmi2EnterInitializationMode(u) == FINE && fmi2ExitInitializationMode(u) == FINE;
}

static bool step_to(void *u, double t, double h)
{
    double rate[9], z[99], x[9];
    const size_t n = FIRST_DERIVATIVE - FIRST_STATE;
    Boolean event = 0, end = 0;
    EventInfo info;
    return fmi2DoStep(u, t, h, 1) == FINE && fmi2GetContinuousStates(u, x, n) == FINE
           && fmi2SetContinuousStates(u, x, n) == FINE && fmi2SetTime(u, t + h) == FINE
           && fmi2GetDerivatives(u, rate, n) == FINE && fmi2GetEventIndicators(u, z, 0) == FINE
           && fmi2CompletedIntegratorStep(u, 1, &event, &end) == FINE
           && fmi2NewDiscreteStates(u, &info) == FINE;
}
#define RESET fmi2Reset
#define FREE fmi2FreeInstance
#else
static void hear(void *environment, Status status, const char *category, const char *text)
{
    (void)environment, (void)category;
    told_of_memory += strcmp(text, "out of memory") == 0;
    if (status != WRONG) {
        exit(4);
    }
}

static void *make(void)
{
    return fmi3InstantiateCoSimulation("unit", TOKEN, "", 0, 0, 0, 0, NULL, 0, NULL, hear, NULL);
}

static bool begin_run(void *u)
{
    return fmi3EnterInitializationMode(u, 0, 0.0, 0.0, 0, 0.0) == FINE
           && fmi3ExitInitializationMode(u) == FINE;
}

static bool step_to(void *u, double t, double h)
{
    double rate[9], z[99], x[9], last = 0.0, next = 0.0;
    const size_t n = FIRST_DERIVATIVE - FIRST_STATE;
    bool a = false, b = false, c = false, d = false, e = false;
    return fmi3DoStep(u, t, h, 1, &a, &b, &c, &last) == FINE
           && fmi3GetContinuousStates(u, x, n) == FINE
           && fmi3SetContinuousStates(u, x, n) == FINE && fmi3SetTime(u, t + h) == FINE
           && fmi3GetContinuousStateDerivatives(u, rate, n) == FINE
           && fmi3GetEventIndicators(u, z, 0) == FINE
           && fmi3CompletedIntegratorStep(u, 1, &a, &b) == FINE
           && fmi3UpdateDiscreteStates(u, &a, &b, &c, &d, &e, &next) == FINE;
}
#define RESET fmi3Reset
#define FREE fmi3FreeInstance
#endif

/* Make a unit, run it, begin anew, run it again; say whether all of that went well. */
static bool live(void)
{
    void *u = make();
    if (u == NULL) {
        return false;
    }
    bool fine = begin_run(u);
    for (int k = 0; k < 5 && fine; k++) {
        fine = step_to(u, 0.1 * k, 0.1);
    }
    if (fine) {
        fine = RESET(u) == FINE && begin_run(u) && step_to(u, 0.0, 0.7);
    }
    if (!fine && step_to(u, 0.8, 0.1)) {
        exit(5); /* it went on without its memory */
    }
    if (!fine) { /* what there is again, it can begin with */
        left = -1;
        if (RESET(u) != FINE || !begin_run(u) || !step_to(u, 0.0, 0.1)) {
            exit(6);
        }
    }
    FREE(u);
    return fine;
}

int main(void)
{
    left = -1;
    void *other = make();
    bool fine = other != NULL && begin_run(other);
    long silent = 0;
    long room = 0;
    double t = 0.0;
    for (bool whole = false; !whole && fine; room++) {
        const long before = told_of_memory;
        left = room;
        whole = live();
        silent += !whole && told_of_memory == before;
        left = -1;
        fine = step_to(other, t, 1e-3);
        t += 1e-3;
    }
    FREE(other);
    printf("%ld blocks, %ld times silent\n", room - 1, silent);
    /* without the block of the instance itself there is nobody who could speak */
    return fine && silent <= 1 && room > 100 ? 0 : 1;
}
