/* What a mode's equations give at one instant: bond variables, then rates. */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 40 };
static const double TOLERANCE = 1e-13; /* as in equations/mode.py */

static size_t most(size_t a, int32_t b)
{
    return b > 0 && (size_t)b > a ? (size_t)b : a;
}

int hb_reserve(hb_work *work, const hb_mode *const *modes, int count)
{
    size_t n = 0, atoms = 0, free_ = 0, guards = 0, slots = 0, rows = 0, knowns = 0;
    size_t constraints = 0, flow = 0;
    for (int k = 0; k < count; ++k) {
        const hb_mode *m = modes[k];
        if (!m)
            continue;
        n = most(n, m->storages + m->signals + 2);
        atoms = most(atoms, m->guard_atoms[m->guards]);
        free_ = most(free_, m->free);
        guards = most(guards, m->guards);
        slots = most(slots, m->slots);
        rows = most(rows, m->rows);
        knowns = most(knowns, m->knowns);
        constraints = most(constraints, m->constraints);
        flow = hb_exact_room(m) > flow ? hb_exact_room(m) : flow;
    }
    size_t sizes[] = {knowns, 2 * rows, free_ * free_, free_,
                      7 * n, n, n, n, n, n, (HB_SAMPLES + 1) * atoms + (HB_SAMPLES + 2) * guards,
                      slots, n, constraints, 4 * n, free_, constraints,
                      free_, 13 * n, flow};
    double **parts[] = {&work->known, &work->w, &work->jacobian, &work->step,
                        &work->k, &work->y1, &work->trial, &work->tolerance, &work->error,
                        &work->sampled, &work->atoms, &work->magnitudes, &work->kept,
                        &work->residuals, &work->dense, &work->guess, &work->met,
                        &work->began, &work->stages, &work->flow};
    size_t total = 1, parts_count = sizeof sizes / sizeof *sizes;
    for (size_t i = 0; i < parts_count; ++i)
        total += sizes[i];
    double *all = work->all = calloc(total, sizeof *all);
    if (!all)
        return 0;
    for (size_t i = 0; i < parts_count; ++i) {
        *parts[i] = all;
        all += sizes[i];
    }
    return 1;
}

static double product(const hb_rows *rows, int i, const double *x)
{
    double sum = 0.0;
    for (int32_t k = rows->first[i]; k < rows->first[i + 1]; ++k)
        sum += rows->value[k] * x[rows->column[k]];
    return sum;
}

/* Solve in place by elimination with partial pivoting; 0 if the matrix is singular. */
static int eliminate(int n, double *a, double *b)
{
    for (int k = 0; k < n; ++k) {
        int p = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(a[i * n + k]) > fabs(a[p * n + k]))
                p = i;
        double pivot = a[p * n + k];
        if (pivot == 0.0 || !isfinite(pivot))
            return 0;
        if (p != k) {
            for (int j = k; j < n; ++j) {
                double x = a[k * n + j];
                a[k * n + j] = a[p * n + j];
                a[p * n + j] = x;
            }
            double x = b[k];
            b[k] = b[p];
            b[p] = x;
        }
        for (int i = k + 1; i < n; ++i) {
            double l = a[i * n + k] / pivot;
            if (l == 0.0)
                continue;
            for (int j = k + 1; j < n; ++j)
                a[i * n + j] -= l * a[k * n + j];
            b[i] -= l * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        double sum = b[k];
        for (int j = k + 1; j < n; ++j)
            sum -= a[k * n + j] * b[j];
        b[k] = sum / a[k * n + k];
        if (!isfinite(b[k]))
            return 0;
    }
    return 1;
}

static void spread(const hb_mode *m, const double *w, double *v)
{
    for (int i = 0; i < m->spread; ++i)
        v[m->spread_slot[i]] = w[m->spread_row[i]];
}

/* Add what the free unknowns give, and write all where expressions read it. */
static void with_free(const hb_mode *m, const double *base, const double *r, double *w, double *v)
{
    for (int i = 0; i < m->rows; ++i) {
        double sum = base[i];
        for (int j = 0; j < m->free; ++j)
            sum += m->by_free[i * m->free + j] * r[j];
        w[i] = sum;
    }
    spread(m, w, v);
}

static int iterate(const hb_mode *m, hb_motion *o, hb_work *work)
{
    const int n = m->free;
    double *base = work->w + m->rows, *r = o->free, *step = work->step, update = INFINITY;
    memcpy(base, work->w, sizeof *base * (size_t)m->rows);
    for (int turn = 0; turn < STEPS; ++turn) {
        with_free(m, base, r, work->w, o->v);
        int exact = 1;
        for (int i = 0; i < n; ++i) {
            step[i] = hb_evaluate(m->code + m->value_code[i], m->constants, o->v);
            if (!isfinite(step[i]))
                return 0;
            exact &= step[i] == 0.0;
        }
        if (exact)
            return 1;
        double *a = work->jacobian;
        memcpy(a, m->slope, sizeof *a * (size_t)n * (size_t)n);
        for (int e = 0; e < m->entries; ++e) {
            double slope = hb_evaluate(m->code + m->entry_code[e], m->constants, o->v);
            for (int j = 0; j < n; ++j)
                a[m->entry_at[e] * n + j] += slope * m->entry_by_free[e * n + j];
        }
        if (!eliminate(n, a, step))
            return 0;
        double size = 0.0, most = 0.0, previous = update;
        for (int i = 0; i < m->rows; ++i)
            size = fmax(size, fabs(base[i]));
        for (int j = 0; j < n; ++j)
            most = fmax(most, fabs(r[j]));
        size += most;
        update = 0.0;
        for (int j = 0; j < n; ++j) {
            r[j] -= step[j];
            update = fmax(update, fabs(step[j]));
        }
        if (m->affine)
            update = 0.0;
        if (update <= TOLERANCE * size || (update <= 1e-9 * size && update >= 0.5 * previous)) {
            with_free(m, base, r, work->w, o->v);
            return 1;
        }
    }
    return 0;
}

/* Newton in the free unknowns, from where it ended last; it stays there if it fails. */
static int newton(const hb_mode *m, hb_motion *o, hb_work *work)
{
    memcpy(work->began, o->free, sizeof *o->free * (size_t)m->free);
    const int found = iterate(m, o, work);
    if (!found)
        memcpy(o->free, work->began, sizeof *o->free * (size_t)m->free);
    return found;
}

void hb_known(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y)
{
    const double *x = y, *s = y + m->storages;
    double *v = o->v, *xi = work->known;
    v[0] = t;
    for (int i = 0; i < m->inputs; ++i) {
        v[m->input_slot + i] = o->input[i] + o->input_rate[i] * (t - o->input_time[i]);
        v[m->input_rate_slot + i] = o->input_rate[i];
    }
    for (int i = 0; i < m->storages; ++i)
        v[m->stored_slot + i] = x[i];
    for (int i = 0; i < m->signals; ++i)
        v[m->signal_slot + i] = s[i];
    memcpy(xi, m->known, sizeof *xi * (size_t)m->knowns);
    for (int i = 0; i < m->storages; ++i)
        xi[i] = product(&m->co_energy, i, x);
    for (int i = 0; i < m->laws; ++i)
        xi[m->law_at[i]] = hb_evaluate(m->code + m->law_code[i], m->constants, v);
    for (int i = 0; i < m->sources; ++i)
        xi[m->source_at[i]] = hb_evaluate(m->code + m->source_code[i], m->constants, v);
}

int hb_solve(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y)
{
    hb_known(m, o, work, t, y);
    for (int i = 0; i < m->rows; ++i)
        work->w[i] = product(&m->solved, i, work->known);
    if (m->free)
        return newton(m, o, work);
    spread(m, work->w, o->v);
    return 1;
}

double hb_row_size(const hb_mode *m, const hb_motion *o, const hb_work *work, int row)
{
    double sum = 0.0;
    for (int32_t k = m->measured.first[row]; k < m->measured.first[row + 1]; ++k)
        sum += fabs(m->measured.value[k] * work->known[m->measured.column[k]]);
    for (int j = 0; j < m->free; ++j)
        sum += fabs(m->by_free[row * m->free + j] * o->free[j]);
    for (int j = 0; j < m->loose; ++j)
        sum += fabs(m->by_share[row * m->loose + j] * product(&m->shares, j, work->known));
    return sum;
}

double hb_size(const hb_mode *m, const hb_motion *o, const hb_work *work, int32_t slot,
               double reach)
{
    const double value = fabs(o->v[slot]);
    const int32_t row = m->row_of[slot];
    if (row < 0)
        return value;
    return fmax(value, fmax(hb_row_size(m, o, work, row), 10.0 * reach * m->seen[row]));
}

void hb_between(int n, const double *y0, const double *dense, double x, double *y)
{
    /* powers and their sum as the reference takes them: a touch is decided by the last bits */
    const double p[] = {x, x * x, x * x * x, x * x * x * x};
    for (int i = 0; i < n; ++i)
        y[i] = y0[i] + (p[0] * dense[i] + p[1] * dense[n + i] + p[2] * dense[2 * n + i] +
                        p[3] * dense[3 * n + i]);
}

static double power(int n, const int32_t *e, const int32_t *f, const double *sign, const double *w)
{
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
        sum += w[e[i]] * w[f[i]] * sign[i];
    return sum;
}

int hb_rate(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y, double *rate)
{
    ++o->evaluations;
    if (!hb_solve(m, o, work, t, y))
        return 0;
    const double *w = work->w;
    for (int i = 0; i < m->storages; ++i)
        rate[i] = m->rate_sign[i] * w[m->rate_row[i]];
    rate += m->storages;
    for (int i = 0; i < m->signals; ++i)
        rate[i] = hb_evaluate(m->code + m->signal_code[i], m->constants, o->v);
    rate += m->signals;
    rate[0] = power(m->supplied, m->supplied_e, m->supplied_f, m->supplied_sign, w);
    rate[1] = power(m->dissipated, m->dissipated_e, m->dissipated_f, m->dissipated_sign, w);
    return 1;
}
