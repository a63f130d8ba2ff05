/* What the limit programs share: Dormand and Prince with the control that hybond has, no more. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef void field(int n, double t, const double *y, double *f);
typedef double guard(int n, double t, const double *y);

typedef struct {
    int n;
    double t, h, before, rtol, *y, *f, *k, *y1, *trial, *dense, *largest;
} motion;

static motion *begin(int n, double rtol)
{
    motion *m = calloc(1, sizeof *m);
    m->n = n;
    m->rtol = rtol;
    m->before = 1e-4;
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
            return h;
        }
        h *= fmax(0.9 * pow(error, -0.17), 0.2);
    }
}

static void interpolation(motion *m, double h)
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
        for (int i = 0; i < m->n; ++i) {
            double sum = 0;
            for (int s = 0; s < 7; ++s)
                sum += d[p][s] * m->k[s * m->n + i];
            m->dense[p * m->n + i] = h * sum;
        }
}

static void between(const motion *m, double x, double *y)
{
    const double *d = m->dense;
    const int n = m->n;
    for (int i = 0; i < n; ++i)
        y[i] = m->y[i] + x * (d[i] + x * (d[n + i] + x * (d[2 * n + i] + x * d[3 * n + i])));
}

/* Where a guard falls through zero within the step of length h, as a part of it; 2 if nowhere. */
static double crossing(motion *m, guard *g, double h)
{
    double low = 0, high = 0, before = g(m->n, m->t, m->y);
    for (int k = 1; k <= 8; ++k) {
        high = k / 8.0;
        between(m, high, m->trial);
        double now = g(m->n, m->t + high * h, m->trial);
        if (before > 0 && now <= 0) {
            for (int i = 0; i < 60 && high - low > 1e-16; ++i) {
                double at = low + (high - low) * before / (before - now);
                at = fmin(fmax(at, low + 0.02 * (high - low)), high - 0.02 * (high - low));
                between(m, at, m->trial);
                double value = g(m->n, m->t + at * h, m->trial);
                if (value > 0) {
                    low = at;
                    before = value;
                } else {
                    high = at;
                    now = value;
                }
            }
            return high;
        }
        before = now;
        low = high;
    }
    return 2;
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
