/* The Runge-Kutta pair 5(4) of Dormand and Prince with the control of solvers/dopri.py. */
#include "hybond.h"

#include <math.h>
#include <string.h>

enum { STAGES = 7 };
static const double C[STAGES] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double A[STAGES][STAGES - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double E[STAGES] = {-71.0 / 57600, 0.0, 71.0 / 16695, -71.0 / 1920,
                                 17253.0 / 339200, -22.0 / 525, 1.0 / 40};
static const double D[4][STAGES] = {
    {1.0},
    {-8048581381.0 / 2820520608, 0.0, 131558114200.0 / 32700410799, -1754552775.0 / 470086768,
     127303824393.0 / 49829197408, -282668133.0 / 205662961, 40617522.0 / 29380423},
    {8663915743.0 / 2820520608, 0.0, -68118460800.0 / 10900136933, 14199869525.0 / 1410260304,
     -318862633887.0 / 49829197408, 2019193451.0 / 616988883, -110615467.0 / 29380423},
    {-12715105075.0 / 11282082432, 0.0, 87487479700.0 / 32700410799, -10690763975.0 / 1880347072,
     701980252875.0 / 199316789632, -1453857185.0 / 822651844, 69997945.0 / 29380423},
};
static const double BETA = 0.04, SAFETY = 0.9, SHRINK = 0.2, GROW = 10.0, SMALLEST = 1e-4;

/* h times the sum of the first stages with these weights; loop by loop, for the sake of vectors. */
static void combine(int n, int stages, double h, const double *weight, const double *k,
                    double *restrict sum)
{
    for (int i = 0; i < n; ++i)
        sum[i] = h * weight[0] * k[i];
    for (int s = 1; s < stages; ++s) {
        const double factor = h * weight[s], *stage = k + s * n;
        if (factor == 0.0)
            continue;
        for (int i = 0; i < n; ++i)
            sum[i] += factor * stage[i];
    }
}

/* Try a step from o->t to t1; the norm of its error, nan if something is not finite. */
static double attempt(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    const int n = hb_states(m);
    const double h = t1 - o->t;
    double *k = work->k;
    memcpy(k, o->f, sizeof *k * (size_t)n);
    for (int s = 1; s < STAGES; ++s) {
        double *y = s == STAGES - 1 ? work->y1 : work->trial;
        combine(n, s, h, A[s], k, y);
        for (int i = 0; i < n; ++i)
            y[i] += o->y[i];
        double t = s < 5 ? o->t + C[s] * h : t1;
        if (!hb_rate(m, o, work, t, y, k + s * n))
            return NAN;
    }
    for (int i = 0; i < STAGES * n; ++i)
        if (!isfinite(k[i]))
            return NAN;
    for (int i = 0; i < n; ++i)
        if (!isfinite(work->y1[i]))
            return NAN;
    hb_tolerances(m, o, o->y, work->y1, work->tolerance);
    combine(n, STAGES, h, E, k, work->error);
    return hb_norm(m, o, work->error, work->tolerance);
}

int hb_steered(hb_trial *attempt, const hb_mode *m, hb_motion *o, hb_work *work, double t_end,
               double *t1, int32_t *rejected)
{
    const double remaining = t_end - o->t, t0 = o->t, exponent = 0.2 - 0.75 * BETA;
    const double smallest = 10.0 * (nextafter(fabs(t0), INFINITY) - fabs(t0));
    const int may_land = remaining <= o->max_step * (1.0 + 1e-12);
    double h = fmax(fmin(o->h, o->max_step), smallest), trial, error;
    *rejected = 0;
    for (;;) {
        trial = h;
        *t1 = may_land && remaining <= 1.01 * h ? t_end : t0 + h;
        if (*t1 > t_end)
            *t1 = t_end;
        h = *t1 - t0;
        error = attempt(m, o, work, *t1);
        if (error <= 1.0)
            break;
        if (!isfinite(error))
            return 0; /* beyond where the laws hold: the reference counts how often */
        ++*rejected;
        double smaller = h * fmax(SAFETY * pow(error, -exponent), SHRINK);
        if (smaller < smallest)
            return 0;
        h = smaller;
    }
    double factor = SAFETY * pow(fmax(error, 1e-10), -exponent) * pow(o->error_before, BETA);
    factor = fmin(fmax(factor, SHRINK), *rejected ? 1.0 : GROW);
    if (h < 0.99 * trial) {
        /* cut short by t_end: its small error says little about the size after it */
        o->h = factor >= 1.0 ? fmax(trial, h * factor) : h * factor;
    } else {
        o->h = h * factor;
        o->error_before = fmax(error, SMALLEST);
    }
    return 1;
}

static int step(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
                int32_t *rejected)
{
    return hb_steered(attempt, m, o, work, t_end, t1, rejected);
}

static int retry(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    return isfinite(attempt(m, o, work, t1));
}

static void dense_output(const hb_mode *m, const hb_work *work, double h, double *dense)
{
    const int n = hb_states(m);
    for (int p = 0; p < 4; ++p)
        combine(n, STAGES, h, D[p], work->k, dense + p * n);
}

static int begin(const hb_mode *m, hb_motion *o, hb_work *work, double limit)
{
    o->error_before = SMALLEST;
    o->h = hb_first_step(m, o, work, limit, 5.0);
    return 1;
}

const hb_method hb_dopri = {begin, step, retry, dense_output};
