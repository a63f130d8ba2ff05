/* Radau IIA of order 5, with the iteration of solvers/newton.py and the control of
 * solvers/implicit.py. The energies that are followed, behind all other states, are quadratures:
 * nothing depends on them, and they have no part in the linear algebra. */
#include "radau.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double A[STAGES][STAGES] = {
    {(88 - 7 * S6) / 360, (296 - 169 * S6) / 1800, (-2 + 3 * S6) / 225},
    {(296 + 169 * S6) / 1800, (88 + 7 * S6) / 360, (-2 - 3 * S6) / 225},
    {(16 - S6) / 36, (16 + S6) / 36, 1.0 / 9},
};
static const double ERROR[STAGES] = {-10.0488093998274156, 1.3821427331607489,
                                     -0.333333333333333333};
static const double POLYNOMIAL[STAGES][STAGES] = {
    {10.0488093998274156, -1.3821427331607489, 0.333333333333333333},
    {-25.6295914470766394, 10.2962581137433061, -2.66666666666666667},
    {15.5807820472492238, -8.91411538058255716, 3.33333333333333333},
};
static const double SAFETY = 0.9, SHRINK = 0.2, GROW = 8.0, SMALLEST = 1e-2, KEEP = 1.2;
static const double FRESH = 0.05, SLOW = 1e-3;

/* The work space of steps; hb_reserve leaves room for it. */
static hb_attempt begun(const hb_mode *m, hb_motion *o, hb_work *work)
{
    hb_attempt a = {.m = m, .o = o, .work = work, .memory = &o->memory};
    a.all = hb_states(m);
    a.n = a.all - 2;
    a.f = work->k;
    a.y = a.f + STAGES * a.all;
    a.end = a.y + STAGES * a.all;
    a.z = work->stages;
    a.last = a.z + STAGES * a.all;
    a.polynomial = a.last + STAGES * a.all;
    a.tolerance = a.polynomial + STAGES * a.all;
    a.real = a.tolerance + a.all;
    a.re = a.real + a.all;
    a.im = a.re + a.all;
    return a;
}

/* Forward differences in the direction of motion: a state at the edge of where its law is defined is
 * more likely to have come from there than to go there. 0 if one is not finite. */
static int differentiate(const hb_attempt *a)
{
    const hb_motion *o = a->o;
    double *shifted = a->work->trial, *f = a->end;
    hb_tolerances(a->m, a->o, o->y, o->y, a->work->tolerance);
    memcpy(shifted, o->y, sizeof *shifted * (size_t)a->all);
    for (int j = 0; j < a->n; ++j) {
        double size = fmax(fabs(o->y[j]), a->work->tolerance[j] / o->rtol);
        double *column = a->memory->jacobian + j * a->n;
        if (size == 0.0)
            size = 1.0;
        shifted[j] = o->y[j] + sqrt(DBL_EPSILON) * copysign(size, o->f[j]);
        if (!hb_rate_at(a, o->t, shifted, f))
            return 0;
        for (int i = 0; i < a->n; ++i)
            column[i] = (f[i] - o->f[i]) / (shifted[j] - o->y[j]);
        if (!hb_finite(a->n, column))
            return 0;
        shifted[j] = o->y[j];
    }
    a->memory->matrix = CURRENT;
    a->memory->served = 0.0;
    return 1;
}

/* The error (REAL/h - J)^-1 (f + ERROR z/h), with a derivative f at the start; returns its norm. */
static double filtered(hb_attempt *a, const double *f)
{
    const double weight[] = {ERROR[0] / a->h, ERROR[1] / a->h, ERROR[2] / a->h};
    double *vector = a->work->error;
    hb_combine(a->n, a->all, weight, a->z, vector);
    for (int i = 0; i < a->n; ++i)
        vector[i] += f[i];
    hb_unfactor(a->n, a->memory->real, a->memory->real_row, vector);
    return hb_mean(a, 1, vector, a->work->tolerance);
}

/* Estimate the error, in a->error; 0 if that leads to where there is no derivative. */
static int estimate(hb_attempt *a, int rejected)
{
    double *shifted = a->work->trial;
    hb_tolerances(a->m, a->o, a->o->y, a->y + 2 * a->all, a->work->tolerance);
    a->error = filtered(a, a->o->f);
    if (a->error <= 1.0 || !(rejected || a->memory->first))
        return 1;
    /* in a fast transient the estimate is too large; filtered twice it is right */
    for (int i = 0; i < a->all; ++i)
        shifted[i] = a->o->y[i] + (i < a->n ? a->work->error[i] : 0.0);
    if (!hb_rate_at(a, a->o->t, shifted, a->end))
        return 0;
    a->error = fmin(a->error, filtered(a, a->end));
    return 1;
}

/* The state at the end with its derivative, energies, and the polynomial of the step; 0 if something is
 * not finite. */
static int finish(hb_attempt *a)
{
    const int n = a->n, all = a->all;
    double *y1 = a->work->y1;
    memcpy(y1, a->y + 2 * all, sizeof *y1 * (size_t)all);
    if (!hb_rate_at(a, a->t1, y1, a->end))
        return 0;
    if (a->size > FRESH)
        /* powers must be those of the stages as corrected, not as foreseen: nothing else controls
         * their error */
        for (int s = 0; s < 2; ++s)
            if (!hb_rate_at(a, hb_time_of(a, s), a->y + s * all, a->f + s * all))
                return 0;
    memcpy(a->f + 2 * all, a->end, sizeof *y1 * (size_t)all);
    for (int s = 0; s < STAGES; ++s) {
        const double weight[] = {a->h * A[s][0], a->h * A[s][1], a->h * A[s][2]};
        hb_combine(2, all, weight, a->f + n, a->z + s * all + n);
    }
    for (int i = n; i < all; ++i)
        y1[i] = a->o->y[i] + a->z[2 * all + i];
    for (int p = 0; p < STAGES; ++p)
        hb_combine(all, all, POLYNOMIAL[p], a->z, a->polynomial + p * all);
    return hb_finite(all, y1);
}

static double rounds(const hb_attempt *a)
{
    return (2.0 * ITERATIONS + 1.0) / (2.0 * ITERATIONS + a->iterations);
}

/* Try one size. 1: it is right; 0: not, and *shrink says what to try next; -1: it leads to where the
 * laws have no value, and the reference counts how often. */
static int attempted(hb_attempt *a, double origin, int rejected, double *shrink)
{
    *shrink = 0.5;
    if (!hb_factorise(a))
        return 0;
    switch (hb_iterate(a, origin)) {
    case BEYOND:
        return -1;
    case FAILED:
        if (a->memory->matrix != CURRENT) {
            /* the Jacobian may be to blame */
            a->memory->matrix = NONE;
            *shrink = 1.0;
        }
        return 0;
    }
    if (!estimate(a, rejected))
        return -1;
    if (a->error <= 1.0)
        return finish(a) ? 1 : -1;
    *shrink = fmin(fmax(SAFETY * rounds(a) * pow(a->error, -0.25), SHRINK), SAFETY);
    return 0;
}

/* Make one step of about h that satisfies the tolerance and ends at t_end or before; 0 if that is not
 * possible. */
static int advance(hb_attempt *a, double t_end, double h, double origin, int32_t *rejected)
{
    const hb_motion *o = a->o;
    const double remaining = t_end - o->t;
    const double smallest = 10.0 * (nextafter(fabs(o->t), INFINITY) - fabs(o->t));
    const int may_land = remaining <= o->max_step * (1.0 + 1e-12);
    double shrink;
    h = fmax(fmin(h, o->max_step), smallest);
    *rejected = 0;
    hb_tolerances(a->m, a->o, o->y, o->y, a->tolerance);
    for (;;) {
        if (a->memory->matrix == NONE && !differentiate(a))
            return 0;
        a->trial = h;
        /* a little longer rather than a sliver of a step afterwards */
        a->t1 = may_land && remaining <= 1.01 * h ? t_end : fmin(o->t + h, t_end);
        a->h = h = a->t1 - o->t;
        const int made = attempted(a, origin, *rejected, &shrink);
        if (made)
            return made > 0;
        ++*rejected;
        if (shrink < 1.0 && h * shrink < smallest)
            return 0;
        h *= shrink;
    }
}

static int step(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
                int32_t *rejected)
{
    hb_attempt a = begun(m, o, work);
    hb_memory *k = a.memory;
    k->matrix = k->matrix == NONE || k->slow ? NONE : KEPT;
    k->first = o->h_before == 0.0;
    if (!advance(&a, t_end, o->h, 1.0, rejected))
        return 0;
    *t1 = a.t1;
    const int cut = a.h < 0.99 * a.trial;
    double factor = SAFETY * rounds(&a) * pow(fmax(a.error, 1e-10), -0.25);
    if (o->h_before > 0.0 && !cut) {
        /* Gustafsson: the error is expected to go on changing as over the last two steps */
        const double change = pow(o->error_before / fmax(a.error, 1e-10), 0.25);
        factor *= fmin(1.0, a.h / o->h_before * change);
    }
    factor = fmin(fmax(factor, SHRINK), *rejected ? 1.0 : GROW);
    k->slow = a.iterations > 2 && a.rate > SLOW;
    k->left = a.left;
    k->span = a.h;
    memcpy(k->polynomial, a.polynomial, sizeof *k->polynomial * (size_t)(STAGES * a.all));
    if (cut && factor >= 1.0)
        /* cut short by t_end: its small error says little about the size after it */
        o->h = fmax(a.trial, a.h * factor);
    else
        o->h = !k->slow && factor >= 1.0 && factor < KEEP ? a.h : a.h * factor;
    if (!cut) {
        o->h_before = a.h;
        o->error_before = fmax(a.error, SMALLEST);
    }
    return 1;
}

/* The last step again, foreseen by itself, with its Jacobian; 0 also if one step will not do. */
static int retry(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    hb_attempt a = begun(m, o, work);
    int32_t rejected;
    return advance(&a, t1, t1 - o->t, 0.0, &rejected) && a.t1 == t1;
}

static void dense_output(const hb_mode *m, const hb_work *work, double h, double *dense)
{
    const size_t n = (size_t)hb_states(m);
    (void)h;
    memcpy(dense, work->stages + 2 * STAGES * n, sizeof *dense * STAGES * n);
    memset(dense + STAGES * n, 0, sizeof *dense * n);
}

static int begin(const hb_mode *m, hb_motion *o, hb_work *work, double limit)
{
    hb_memory *k = &o->memory;
    k->left = 1.0;
    k->span = k->served = 0.0;
    k->matrix = NONE;
    k->slow = 0;
    o->h_before = o->error_before = 0.0;
    o->h = hb_first_step(m, o, work, limit, 4.0);
    return 1;
}

const hb_method hb_radau = {begin, step, retry, dense_output};
