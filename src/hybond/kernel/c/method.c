/* What all ways to make a step have in common, and the choice among them. */
#include "hybond.h"

#include <math.h>

static const hb_method *const METHODS[] = {&hb_dopri, &hb_radau, &hb_exact};

int hb_states(const hb_mode *m)
{
    return m->storages + m->signals + 2;
}

/* Each storage's own stiffness at y. */
static void stiffness_at(const hb_mode *m, hb_motion *o, const double *y, double *stiffness)
{
    for (int i = 0; i < m->storages; ++i) {
        stiffness[i] = fabs(m->stiffness[i]);
        if (m->slopes)
            o->v[m->stored_slot + i] = y[i];
    }
    for (int k = 0; k < m->slopes; ++k)
        stiffness[m->slope_at[k]] =
            fabs(hb_evaluate(m->code + m->slope_code[k], m->constants, o->v));
}

void hb_tolerances(const hb_mode *m, hb_motion *o, const double *y0, const double *y1,
                   double *tolerance)
{
    const int nx = m->storages, n = nx + m->signals;
    double now = 0.0, tried = 0.0;
    for (int i = 0; i < n; ++i)
        if (fabs(y0[i]) > o->largest[i])
            o->largest[i] = fabs(y0[i]);
    tolerance[n] = tolerance[n + 1] = INFINITY;
    if (o->atol == o->atol) {
        for (int i = 0; i < n; ++i)
            tolerance[i] = o->rtol * fmax(fabs(y1[i]), o->largest[i]) + o->atol;
        return;
    }
    stiffness_at(m, o, y0, tolerance);
    for (int i = 0; i < nx; ++i) {
        now += tolerance[i] * y0[i] * y0[i];
        tried += tolerance[i] * y1[i] * y1[i];
    }
    o->energy = fmax(o->energy, 0.5 * now);
    double energy = fmax(o->energy, 0.5 * tried);
    for (int i = 0; i < n; ++i) {
        double size = fmax(fabs(y1[i]), o->largest[i]), whole = 0.0;
        if (i < nx) {
            whole = sqrt(2.0 * energy / tolerance[i]);
            whole = isfinite(whole) ? o->negligible * whole : 0.0;
        }
        tolerance[i] = o->rtol * fmax(size, whole);
        if (i >= nx)
            tolerance[i] += o->idle;
        else if (size > 0.0 && o->rounding[i] > tolerance[i])
            tolerance[i] = o->rounding[i];
    }
}

double hb_norm(const hb_mode *m, const hb_motion *o, const double *vector,
               const double *tolerance)
{
    double sum = 0.0;
    for (int i = 0; i < hb_states(m); ++i) {
        if (isinf(tolerance[i]) || (tolerance[i] == 0.0 && vector[i] == 0.0))
            continue;
        sum += vector[i] / tolerance[i] * (vector[i] / tolerance[i]);
    }
    return sqrt(sum / o->controlled);
}

/* As solvers/control.py chooses it. */
double hb_first_step(const hb_mode *m, hb_motion *o, hb_work *work, double limit, double order)
{
    const int n = hb_states(m);
    const double unit = limit < INFINITY ? limit : 1.0;
    const double d0 = hb_norm(m, o, o->y, work->tolerance), d1 = hb_norm(m, o, o->f, work->tolerance);
    double h0 = d1 > 0.0 && d1 < INFINITY ? fmax(0.01 * d0, 10.0) / d1 : 1e-6 * unit;
    h0 = h0 > 0.0 ? fmin(h0, 1e-3 * unit) : 1e-6 * unit;
    for (int i = 0; i < n; ++i)
        work->trial[i] = o->y[i] + h0 * o->f[i];
    if (!hb_rate(m, o, work, o->t + h0, work->trial, work->k))
        return 0.01 * h0;
    for (int i = 0; i < n; ++i)
        work->k[i] -= o->f[i];
    const double d2 = hb_norm(m, o, work->k, work->tolerance) / h0;
    if (!isfinite(d2))
        return 0.01 * h0;
    double h1 = INFINITY;
    if (d2 > 0.0 && d1 < INFINITY) {
        h1 = d1 > 0.0 ? d1 / d2 * pow(0.01 / d1 * (d2 / d1), 1.0 / order) : 0.0;
        h1 = fmax(h1, 1.0 / sqrt(d2));
    }
    return fmin(fmin(100.0 * h0, h1), limit);
}

int hb_begin(const hb_mode *m, hb_motion *o, hb_work *work, double t_bound)
{
    if (!hb_rate(m, o, work, o->t, o->y, o->f))
        return 0;
    for (int i = 0; i < hb_states(m); ++i)
        if (!isfinite(o->f[i]) || !isfinite(o->y[i]))
            return 0;
    hb_tolerances(m, o, o->y, o->y, work->tolerance);
    o->controlled = 0;
    for (int i = 0; i < hb_states(m); ++i)
        o->controlled += work->tolerance[i] < INFINITY;
    if (!o->controlled)
        o->controlled = 1;
    const double limit = t_bound > o->t ? fmin(o->max_step, t_bound - o->t) : o->max_step;
    return METHODS[o->method]->begin(m, o, work, limit);
}

int hb_step(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
            int32_t *rejected)
{
    return METHODS[o->method]->step(m, o, work, t_end, t1, rejected);
}

int hb_retry(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    return METHODS[o->method]->retry(m, o, work, t1);
}

void hb_dense(const hb_mode *m, const hb_motion *o, const hb_work *work, double h, double *dense)
{
    METHODS[o->method]->dense(m, work, h, dense);
}
