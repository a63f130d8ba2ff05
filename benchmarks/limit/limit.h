/* What the limit programs share: Dormand and Prince with the control that hybond has, no more. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef void field(int n, double t, const double *y, double *f);

typedef struct {
    int n;
    double t, h, before, rtol, begun, taken;
    double *y, *f, *k, *y1, *trial, *dense, *largest;
} motion;

/* A guard at a part x, from 0 to 1, of the step just taken; what it means happens where it falls
   through zero. */
typedef double guard(const motion *m, double x);

/* What a run leaves: events with their mode and state, and output points at even distances. */
typedef struct {
    int width, shown;
    const int *which;
    size_t events, room, points, most;
    double spacing, *event, *point;
} journal;

static journal opened(int width, double end, double points, int shown, const int *which)
{
    journal j = {.width = width, .shown = shown, .which = which, .room = 64};
    j.most = (size_t)points;
    j.spacing = points > 1 ? end / (points - 1) : 2 * end;
    j.event = malloc(j.room * (size_t)(width + 2) * sizeof(double));
    j.point = malloc((j.most + 1) * (size_t)shown * sizeof(double));
    return j;
}

static void closed(journal *j)
{
    free(j->event);
    free(j->point);
}

static void record(journal *j, double t, double mode, const double *y)
{
    const size_t size = (size_t)j->width + 2;
    if (j->events == j->room)
        j->event = realloc(j->event, (j->room *= 2) * size * sizeof(double));
    double *at = j->event + j->events++ * size;
    at[0] = t;
    at[1] = mode;
    memcpy(at + 2, y, (size_t)j->width * sizeof(double));
}

static motion *begin(int n, double rtol, double h)
{
    motion *m = calloc(1, sizeof *m);
    m->n = n;
    m->rtol = rtol;
    m->before = 1e-4;
    m->h = h;
    double *all = calloc((size_t)n * 17, sizeof *all);
    m->y = all;
    m->f = all + n;
    m->k = all + 2 * n;
    m->y1 = all + 9 * n;
    m->trial = all + 10 * n;
    m->dense = all + 11 * n;
    m->largest = all + 16 * n;
    return m;
}

static void finish(motion *m)
{
    free(m->y);
    free(m);
}

static void stages(motion *m, field *f, double h)
{
    static const double c[] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
    static const double a[7][6] = {
        {0},
        {0.2},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    const int n = m->n;
    memcpy(m->k, m->f, sizeof(double) * (size_t)n);
    for (int s = 1; s < 7; ++s) {
        double *y = s == 6 ? m->y1 : m->trial;
        memcpy(y, m->y, sizeof(double) * (size_t)n);
        for (int j = 0; j < s; ++j)
            for (int i = 0; i < n; ++i)
                y[i] += h * a[s][j] * m->k[j * n + i];
        f(n, m->t + c[s] * h, y, m->k + s * n);
    }
}

/* One accepted step, at most to `end`; its length is returned. */
static double step(motion *m, field *f, double end)
{
    static const double e[] = {-71.0 / 57600, 0, 71.0 / 16695, -71.0 / 1920,
                               17253.0 / 339200, -22.0 / 525, 1.0 / 40};
    const int n = m->n;
    double h = m->t + 1.01 * m->h >= end ? end - m->t : m->h, error;
    for (int rejected = 0;; rejected = 1) {
        stages(m, f, h);
        error = 0;
        for (int i = 0; i < n; ++i) {
            double sum = 0;
            for (int s = 0; s < 7; ++s)
                sum += e[s] * m->k[s * n + i];
            if (fabs(m->y[i]) > m->largest[i])
                m->largest[i] = fabs(m->y[i]);
            double size = m->rtol * fmax(fmax(fabs(m->y1[i]), m->largest[i]), 1e-6);
            sum *= h / size;
            error += sum * sum;
        }
        error = sqrt(error / n);
        if (error <= 1) {
            double factor = 0.9 * pow(fmax(error, 1e-10), -0.17) * pow(m->before, 0.04);
            m->h = h * fmin(fmax(factor, 0.2), rejected ? 1 : 10);
            m->before = fmax(error, 1e-4);
            return m->taken = h;
        }
        h *= fmax(0.9 * pow(error, -0.17), 0.2);
    }
}

/* The coefficients of the dense output, of `count` components from the first. */
static void interpolation(motion *m, int first, int count)
{
    static const double d[4][7] = {
        {1},
        {-8048581381.0 / 2820520608, 0, 131558114200.0 / 32700410799, -1754552775.0 / 470086768,
         127303824393.0 / 49829197408, -282668133.0 / 205662961, 40617522.0 / 29380423},
        {8663915743.0 / 2820520608, 0, -68118460800.0 / 10900136933, 14199869525.0 / 1410260304,
         -318862633887.0 / 49829197408, 2019193451.0 / 616988883, -110615467.0 / 29380423},
        {-12715105075.0 / 11282082432, 0, 87487479700.0 / 32700410799,
         -10690763975.0 / 1880347072, 701980252875.0 / 199316789632,
         -1453857185.0 / 822651844, 69997945.0 / 29380423}};
    for (int p = 0; p < 4; ++p)
        for (int i = first; i < first + count; ++i) {
            double sum = 0;
            for (int s = 0; s < 7; ++s)
                sum += d[p][s] * m->k[s * m->n + i];
            m->dense[p * m->n + i] = m->taken * sum;
        }
}

static double part(const motion *m, int i, double x)
{
    const double *d = m->dense + i;
    const int n = m->n;
    return m->y[i] + x * (d[0] + x * (d[n] + x * (d[2 * n] + x * d[3 * n])));
}

/* The zero of a guard between two parts of the step (Illinois). */
static double root(const motion *m, guard *g, double low, double above, double high, double below)
{
    double at = low;
    for (int i = 0, side = 0; i < 60; ++i) {
        const double next = high - below * (high - low) / (below - above);
        if (fabs(next - at) <= 1e-15)
            break;
        const double value = g(m, at = next);
        if (value > 0) {
            low = at, above = value;
            below *= side > 0 ? 0.5 : 1;
            side = 1;
        } else {
            high = at, below = value;
            above *= side < 0 ? 0.5 : 1;
            side = -1;
        }
    }
    return at;
}

/* Where a guard falls through zero within the step, as a part of it; 2 if nowhere before `limit`. */
static double crossing(const motion *m, guard *g, double limit)
{
    double low = 0, high = 0, before = g(m, 0);
    for (int k = 1; k <= 8 && low < limit; ++k) {
        high = k / 8.0;
        double now = g(m, high);
        if (before > 0 && now <= 0) {
            return root(m, g, low, before, high, now);
        }
        before = now;
        low = high;
    }
    return 2;
}

/* The output points from where the step begins to its part x. */
static void show(const motion *m, double x, journal *j)
{
    const double end = m->t + x * m->taken;
    for (double t; j->points < j->most && (t = (double)j->points * j->spacing) <= end; ++j->points)
        for (int i = 0; i < j->shown; ++i)
            j->point[j->points * (size_t)j->shown + (size_t)i] =
                part(m, j->which[i], (t - m->t) / m->taken);
}

/* The step stands; at the last one the time is the end itself. */
static void accept(motion *m, double end)
{
    memcpy(m->y, m->y1, sizeof(double) * (size_t)m->n);
    memcpy(m->f, m->k + 6 * m->n, sizeof(double) * (size_t)m->n);
    m->t = end - m->t - m->taken < 1e-12 * end ? end : m->t + m->taken;
}

/* The motion ends within the step, at its part x; all components have been interpolated. */
static void halt(motion *m, double x)
{
    for (int i = 0; i < m->n; ++i)
        m->trial[i] = part(m, i, x);
    memcpy(m->y, m->trial, sizeof(double) * (size_t)m->n);
    m->t += x * m->taken;
}

/* Motion starts anew, with a step not longer than what there was since the last event. */
static void restart(motion *m, field *f)
{
    if (m->t > m->begun)
        m->h = fmin(m->h, m->t - m->begun);
    m->begun = m->t;
    f(m->n, m->t, m->y, m->f);
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Does a job as often as the first argument says; prints seconds for one, and what it found. */
static int repeated(int argc, char **argv, int (*job)(const double *given, double *found))
{
    double given[16] = {0}, found[16] = {0};
    const int repeats = argc > 1 ? atoi(argv[1]) : 1;
    int count = 0;
    for (int i = 2; i < argc && i < 18; ++i)
        given[i - 2] = atof(argv[i]);
    const double start = seconds();
    for (int i = 0; i < repeats; ++i)
        count = job(given, found);
    printf("%.9e", (seconds() - start) / repeats);
    for (int i = 0; i < count; ++i)
        printf(" %.17g", found[i]);
    printf("\n");
    return 0;
}
