/* The stages of a step of Radau IIA by Newton's iteration: solvers/newton.py. */
#include "radau.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The inverse of A, its complex eigenvalue, and its eigenvectors, scaled to end in 1:
 * solvers/collocation.py. */
static const double INVERSE[STAGES][STAGES] = {
    {3.22474487139158905, 1.16784008469040549, -0.253197264742180826},
    {-3.56784008469040549, 0.775255128608410951, 1.05319726474218083},
    {5.53197264742180826, -7.53197264742180826, 5.0},
};
static const double PAIR_RE = 2.68108287362775213, PAIR_IM = 3.05043019924741057;
static const double REAL_OUT[STAGES] = {0.0944387624889752415, 0.250213122965333311, 1.0};
static const double REAL_IN[STAGES] = {4.17871859155190473, 0.327682820761062387,
                                       0.523376445499449548};
static const double PAIR_OUT[STAGES][2] = {{-0.141255295020954208, 0.0300291941051474245},
                                           {0.204129352293799932, -0.382942112757261938},
                                           {1.0, 0.0}};
static const double PAIR_IN[STAGES][2] = {{-2.08935929577595236, -0.251436317472893438},
                                          {-0.163841410380531194, 1.28596347492780271},
                                          {0.238311777250275226, -0.298019602414112462}};
static const double ENOUGH = 0.001, STEADY = 1e-3;

int hb_finite(int n, const double *x)
{
    for (int i = 0; i < n; ++i)
        if (!isfinite(x[i]))
            return 0;
    return 1;
}

void hb_combine(int n, int stride, const double *weight, const double *rows, double *restrict sum)
{
    const double *x = rows, *y = rows + stride, *z = rows + 2 * stride;
    for (int i = 0; i < n; ++i)
        sum[i] = weight[0] * x[i] + weight[1] * y[i] + weight[2] * z[i];
}

double hb_mean(const hb_attempt *a, int rows, const double *x, const double *tolerance)
{
    double sum = 0.0;
    for (int s = 0; s < rows; ++s)
        for (int i = 0; i < a->n; ++i) {
            const double value = x[s * a->all + i];
            if (tolerance[i] != 0.0 || value != 0.0)
                sum += value / tolerance[i] * (value / tolerance[i]);
        }
    const double size = a->n ? sqrt(sum / (rows * a->n)) : 0.0;
    return isnan(size) ? INFINITY : size;
}

int hb_rate_at(const hb_attempt *a, double t, const double *y, double *f)
{
    return hb_rate(a->m, a->o, a->work, t, y, f) && hb_finite(a->all, f);
}

int hb_factorise(const hb_attempt *a)
{
    hb_memory *k = a->memory;
    const int n = a->n, square = n * n;
    if (k->served > 0.0 && fabs(a->h - k->served) <= STEADY * a->h)
        return 1;
    for (int i = 0; i < square; ++i) {
        k->real[i] = k->re[i] = -k->jacobian[i];
        k->im[i] = 0.0;
    }
    for (int i = 0; i < n; ++i) {
        k->real[i * n + i] += REAL / a->h;
        k->re[i * n + i] += PAIR_RE / a->h;
        k->im[i * n + i] = PAIR_IM / a->h;
    }
    const int found =
        hb_factor(n, k->real, k->real_row) && hb_factor_pair(n, k->re, k->im, k->pair_row);
    k->served = found ? a->h : 0.0;
    return found;
}

/* The stages that the last step foresees; `origin`: 1 if it ends where this one starts, 0 if both start
 * there. */
static void foresee(hb_attempt *a, double origin)
{
    const hb_memory *k = a->memory;
    memset(a->z, 0, sizeof *a->z * (size_t)(STAGES * a->all));
    if (k->span == 0.0)
        return;
    for (int s = 0; s < STAGES; ++s) {
        const double x = origin + a->h / k->span * C[s];
        const double weight[] = {x - origin, x * x - origin, x * x * x - origin};
        hb_combine(a->n, a->all, weight, k->polynomial, a->z + s * a->all);
    }
}

/* The states of the stages; those that nothing depends on stay. */
static void place(hb_attempt *a)
{
    for (int s = 0; s < STAGES; ++s)
        for (int i = 0; i < a->all; ++i)
            a->y[s * a->all + i] = a->o->y[i] + (i < a->n ? a->z[s * a->all + i] : 0.0);
}

double hb_time_of(const hb_attempt *a, int stage)
{
    return stage < 2 ? a->o->t + C[stage] * a->h : a->t1;
}

/* Correct the stages by what is left of their equations: in the basis of the eigenvectors these are a
 * real and a complex system. */
static void correct(hb_attempt *a)
{
    const hb_memory *k = a->memory;
    const int n = a->n, all = a->all;
    for (int i = 0; i < n; ++i)
        a->real[i] = a->re[i] = a->im[i] = 0.0;
    for (int s = 0; s < STAGES; ++s) {
        const double weight[] = {INVERSE[s][0] / a->h, INVERSE[s][1] / a->h, INVERSE[s][2] / a->h};
        double *residual = a->last + s * all;
        hb_combine(n, all, weight, a->z, residual);
        for (int i = 0; i < n; ++i) {
            residual[i] = a->f[s * all + i] - residual[i];
            a->real[i] += REAL_IN[s] * residual[i];
            a->re[i] += PAIR_IN[s][0] * residual[i];
            a->im[i] += PAIR_IN[s][1] * residual[i];
        }
    }
    hb_unfactor(n, k->real, k->real_row, a->real);
    hb_unfactor_pair(n, k->re, k->im, k->pair_row, a->re, a->im);
    for (int s = 0; s < STAGES; ++s)
        for (int i = 0; i < n; ++i) {
            const double half = PAIR_OUT[s][0] * a->re[i] - PAIR_OUT[s][1] * a->im[i];
            a->last[s * all + i] = REAL_OUT[s] * a->real[i] + 2.0 * half;
            a->z[s * all + i] += a->last[s * all + i];
        }
    place(a);
}

int hb_iterate(hb_attempt *a, double origin)
{
    /* below ten units of rounding of the state itself no iteration can come */
    const double enough = fmax(ENOUGH, 10.0 * DBL_EPSILON / a->o->rtol);
    const double *tolerance = a->tolerance;
    double before = 0.0;
    foresee(a, origin);
    a->rate = 0.0;
    a->left = pow(fmax(a->memory->left, 1e-16), 0.8);
    place(a);
    for (int count = 1; count <= ITERATIONS; ++count) {
        for (int s = 0; s < STAGES; ++s)
            if (!hb_rate_at(a, hb_time_of(a, s), a->y + s * a->all, a->f + s * a->all))
                return BEYOND;
        correct(a);
        a->iterations = count;
        a->size = hb_mean(a, STAGES, a->last, tolerance);
        if (a->size == INFINITY) {
            /* a state that leaves 0 in this step */
            hb_tolerances(a->m, a->o, a->o->y, a->y + 2 * a->all, a->work->tolerance);
            tolerance = a->work->tolerance;
            a->size = hb_mean(a, STAGES, a->last, tolerance);
        }
        if (count > 1) {
            a->rate = before > 0.0 ? a->size / before : 0.0;
            if (!(a->rate < 1.0))
                return FAILED;
            a->left = a->rate / (1.0 - a->rate);
            if (pow(a->rate, ITERATIONS - count) * a->left * a->size > enough)
                return FAILED;
        }
        if (a->left * a->size <= enough)
            return CONVERGED;
        before = a->size;
    }
    return FAILED;
}
