/* Exact propagation of linear modes, as solvers/exact.py and solvers/propagation.py have it: z' = M z,
 * where z are the components that move linearly and the generators of their sources. What has no such
 * matrix is left to Dormand and Prince. */
#include "hybond.h"

#include <math.h>
#include <string.h>

enum { PARTS = 5, ASKED = 3, HIGHEST = 7, TERMS = 24 };
static const int MET[3] = {2, 4, 5};
static const double X[PARTS + 1] = {0.0, 1.0 / 5, 2.0 / 5, 3.0 / 5, 4.0 / 5, 1.0};
static const double FIT[3][3] = {
    {125.0 / 6, -125.0 / 16, 8.0 / 3},
    {-375.0 / 8, 875.0 / 32, -10.0},
    {625.0 / 24, -625.0 / 32, 25.0 / 3},
};
static const double SUMS[PARTS][PARTS + 1] = {
    {19.0 / 288, 1427.0 / 7200, -133.0 / 1200, 241.0 / 3600, -173.0 / 7200, 3.0 / 800},
    {14.0 / 225, 43.0 / 150, 7.0 / 225, 7.0 / 225, -1.0 / 75, 1.0 / 450},
    {51.0 / 800, 219.0 / 800, 57.0 / 400, 57.0 / 400, -21.0 / 800, 3.0 / 800},
    {14.0 / 225, 64.0 / 225, 8.0 / 75, 64.0 / 225, 14.0 / 225, 0.0},
    {19.0 / 288, 25.0 / 96, 25.0 / 144, 25.0 / 144, 25.0 / 96, 19.0 / 288},
};
static const double START[PARTS + 1] = {-137.0 / 12, 25.0, -25.0, 50.0 / 3, -25.0 / 4, 1.0};
static const double BETWEEN = 0.3819660112501051;
static const double VALUE[PARTS + 1] = {-0.004813921445239425, 0.05052466557565383, 1.0196049240189085,
                                        -0.08433338230667628, 0.021992881229683344, -0.0029751670723299796};
static const double SUM[PARTS + 1] = {0.062264764001971146, 0.28622745460559107, 0.012868512649067345,
                                      0.031889702213047655, -0.013533608930780382, 0.002249186711208267};
static const double FARTHEST = 0.00576, LOOSE = 100.0, SMALLEST = 1e-4;
static const double DOUBTFUL = 64.0 * 2.220446049250313e-16, SMALL = 0x1p-60;

/* Rooms in work->flow: z at all parts, or derivatives; two terms; amplitudes; states at all parts; the
 * dense output. States of z are balanced. */
typedef struct {
    double *z, *term, *amplitude, *y, *dense;
} rooms;

size_t hb_exact_room(const hb_mode *m)
{
    const size_t n = (size_t)hb_states(m), z = (size_t)m->flow;
    return z ? (HIGHEST + 1 + 2 + 1) * z + (PARTS + 1 + 4) * n : 0;
}

static rooms rooms_of(const hb_mode *m, const hb_work *work)
{
    const int z = m->flow;
    rooms r = {.z = work->flow};
    r.term = r.z + (HIGHEST + 1) * z;
    r.amplitude = r.term + 2 * z;
    r.y = r.amplitude + z;
    r.dense = r.y + (PARTS + 1) * hb_states(m);
    return r;
}

/* Whether some term is no small part of its sum: each for itself, since a small component may stand
 * beside a large one all the time. */
static int more(int n, const double *term, const double *sum)
{
    for (int i = 0; i < n; ++i)
        if (fabs(term[i]) > SMALL * fabs(sum[i]))
            return 1;
    return 0;
}

/* c M x. */
static void multiply(const hb_mode *m, double c, const double *x, double *y)
{
    const hb_rows *a = &m->flow_matrix;
    for (int i = 0; i < m->flow; ++i) {
        double sum = 0.0;
        for (int32_t k = a->first[i]; k < a->first[i + 1]; ++k)
            sum += a->value[k] * x[a->column[k]];
        y[i] = c * sum;
    }
}

/* z at (t, y), balanced. */
static void begins(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y,
                   double *z)
{
    for (int i = 0; i < m->moved; ++i)
        z[i] = y[m->moved_at[i]] / m->flow_scale[i];
    if (m->flow == m->moved)
        return;
    hb_known(m, o, work, t, y);
    for (int i = m->moved; i < m->flow; ++i)
        z[i] = hb_evaluate(m->code + m->generator_code[i - m->moved], m->constants, o->v) /
               m->flow_scale[i];
}

/* The exponential for 2^k units, less the identity; they are kept with the mode. */
static const double *level(const hb_mode *m, int k)
{
    const int n = m->flow;
    const size_t size = (size_t)n * (size_t)n;
    const hb_rows *a = &m->flow_matrix;
    double *first = m->levels;
    if (!*m->levels_known) {
        double *power = first + size, *next = power + size;
        memset(first, 0, 2 * size * sizeof *first);
        for (int i = 0; i < n; ++i)
            power[i * n + i] = 1.0;
        for (int j = 0; j < TERMS; ++j) {
            for (int i = 0; i < n; ++i)
                for (int c = 0; c < n; ++c) {
                    double sum = 0.0;
                    for (int32_t e = a->first[i]; e < a->first[i + 1]; ++e)
                        sum += a->value[e] * power[a->column[e] * n + c];
                    next[i * n + c] = sum * m->flow_unit / (j + 1.0);
                }
            for (size_t i = 0; i < size; ++i)
                first[i] += next[i];
            double *last = power;
            power = next;
            next = last;
        }
        *m->levels_known = 1;
    }
    for (; *m->levels_known <= k; ++*m->levels_known) {
        const double *d = first + (size_t)(*m->levels_known - 1) * size;
        double *twice = first + (size_t)*m->levels_known * size;
        for (int i = 0; i < n; ++i) {
            double *row = twice + i * n;
            for (int c = 0; c < n; ++c)
                row[c] = 2.0 * d[i * n + c];
            for (int j = 0; j < n; ++j) {
                const double factor = d[i * n + j];
                if (factor == 0.0)
                    continue;
                for (int c = 0; c < n; ++c)
                    row[c] += factor * d[j * n + c];
            }
        }
    }
    return first + (size_t)k * size;
}

/* Bring z a time h on; 0 if that is too long. */
static int after(const hb_mode *m, double *z, double h, double *term)
{
    const int n = m->flow;
    double *sum = term + n;
    if (h >= m->flow_unit) {
        const double units = floor(h / m->flow_unit);
        if (!(units < 0x1p60))
            return 0;
        const int64_t whole = (int64_t)units;
        for (int k = HB_LEVELS - 1; k >= 0; --k) {
            if (!(whole >> k & 1))
                continue;
            const double *d = level(m, k);
            for (int i = 0; i < n; ++i) {
                sum[i] = 0.0;
                for (int j = 0; j < n; ++j)
                    sum[i] += d[i * n + j] * z[j];
            }
            for (int i = 0; i < n; ++i)
                z[i] += sum[i];
        }
        h -= units * m->flow_unit;
    }
    memcpy(sum, z, sizeof *z * (size_t)n);
    for (int k = 0; k < TERMS; ++k) {
        multiply(m, h / (k + 1.0), sum, term);
        for (int i = 0; i < n; ++i)
            z[i] += term[i];
        if (!more(n, term, z))
            break;
        memcpy(sum, term, sizeof *z * (size_t)n);
    }
    return 1;
}

/* From z in row 0, what it is after each part of a time h; 0 if that is too long. */
static int parts(const hb_mode *m, double *z, double h, double *term)
{
    const int n = m->flow;
    for (int p = 1; p <= PARTS; ++p)
        memcpy(z + p * n, z, sizeof *z * (size_t)n);
    if (!(h <= m->flow_unit)) {
        for (int p = 1; p <= PARTS; ++p) {
            memcpy(z + p * n, z + (p - 1) * n, sizeof *z * (size_t)n);
            const double end = p == PARTS ? h : h * p / PARTS;
            if (!after(m, z + p * n, end - h * (p - 1) / PARTS, term))
                return 0;
        }
        return 1;
    }
    double power[PARTS + 1] = {0.0, 1.0, 1.0, 1.0, 1.0, 1.0}, *last = term + n;
    memcpy(last, z, sizeof *z * (size_t)n);
    for (int k = 0; k < TERMS; ++k) {
        multiply(m, h / (k + 1.0), last, term);
        for (int p = 1; p <= PARTS; ++p) {
            power[p] *= X[p];
            for (int i = 0; i < n; ++i)
                z[p * n + i] += power[p] * term[i];
        }
        if (!more(n, term, z + PARTS * n))
            break;
        double *swap = last;
        last = term;
        term = swap;
    }
    return 1;
}

/* The polynomial through what a component is at the parts (`apart` from each other in memory), with a
 * slope at the first; how far it is off where it is asked. */
static double fitted(const double *y, int apart, double first, double *c)
{
    double left[3];
    for (int k = 0; k < 3; ++k)
        left[k] = y[MET[k] * apart] - y[0] - X[MET[k]] * first;
    for (int p = 0; p < 3; ++p)
        c[p] = FIT[p][0] * left[0] + FIT[p][1] * left[1] + FIT[p][2] * left[2];
    const double x = X[ASKED];
    return x * x * (c[0] + x * (c[1] + x * c[2])) - (y[ASKED * apart] - y[0] - x * first);
}

/* How far the generators that powers depend on are off, in what they may be. */
static double unresolved(const hb_mode *m, const hb_motion *o, const rooms *r, double h)
{
    const int n = m->flow;
    double sum = 0.0, c[3];
    if (!m->watched)
        return 0.0;
    multiply(m, h, r->z, r->term);
    for (int k = 0; k < m->watched; ++k) {
        const int32_t i = m->watched_at[k];
        r->amplitude[i] = fmax(r->amplitude[i], fabs(r->z[i]));
        double size = r->amplitude[i];
        for (int p = 1; p <= PARTS; ++p)
            size = fmax(size, fabs(r->z[p * n + i]));
        const double off = fitted(r->z + i, n, r->term[i], c);
        if (off != 0.0)
            sum += off / (LOOSE * o->rtol * size) * (off / (LOOSE * o->rtol * size));
    }
    return sqrt(sum / m->watched);
}

/* Add to the errors of signals that are integrated along: how far their rates are, at a point that no
 * whole number of periods divides, from what they are at all parts; 0 if that is not known. */
static int between(const hb_mode *m, hb_motion *o, hb_work *work, const rooms *r, double h,
                   double *const *f)
{
    const int n = hb_states(m), others = n - m->moved - 2;
    double *y = work->trial, *z = r->z + (PARTS + 1) * m->flow, *found = work->k + (PARTS)*n;
    if (others <= 0)
        return 1;
    memcpy(z, r->z, sizeof *z * (size_t)m->flow);
    memcpy(y, o->y, sizeof *y * (size_t)n);
    if (!after(m, z, BETWEEN * h, r->term))
        return 0;
    for (int i = 0; i < m->moved; ++i)
        y[m->moved_at[i]] = z[i] * m->flow_scale[i];
    for (int k = 0; k < others; ++k)
        for (int p = 0; p <= PARTS; ++p)
            y[m->along[k]] += h * SUM[p] * f[p][m->along[k]];
    if (!hb_rate(m, o, work, o->t + BETWEEN * h, y, found))
        return 0;
    for (int k = 0; k < others; ++k) {
        const int32_t i = m->along[k];
        double value = 0.0;
        for (int p = 0; p <= PARTS; ++p)
            value += VALUE[p] * f[p][i];
        if (!(h * fabs(found[i] - value) <= fabs(work->error[i])))
            work->error[i] = h * fabs(found[i] - value);
    }
    return 1;
}

/* Try a step from o->t to t1; how far its dense output is off, nan if something is not finite. */
static double attempt(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    const int n = hb_states(m), others = n - m->moved;
    const double h = t1 - o->t;
    const int doubtful = h * m->flow_norm * DOUBTFUL > o->rtol;
    const rooms r = rooms_of(m, work);
    double *f[PARTS + 1];
    begins(m, o, work, o->t, o->y, r.z);
    if (!parts(m, r.z, h, r.term))
        return NAN;
    /* dopri.c leaves the rate at the end in row 6 */
    for (int p = 0; p <= PARTS; ++p)
        f[p] = work->k + (p == PARTS ? PARTS + 1 : p) * n;
    memcpy(f[0], o->f, sizeof *o->f * (size_t)n);
    for (int p = 0; p <= PARTS; ++p) {
        double *y = r.y + p * n;
        memcpy(y, o->y, sizeof *y * (size_t)n);
        for (int i = 0; p && i < m->moved; ++i)
            y[m->moved_at[i]] = r.z[p * m->flow + i] * m->flow_scale[i];
        if (p && !hb_rate(m, o, work, p == PARTS ? t1 : o->t + X[p] * h, y, f[p]))
            return NAN;
    }
    for (int k = 0; k < others; ++k) {
        const int32_t i = m->along[k];
        for (int p = 1; p <= PARTS; ++p) {
            double sum = 0.0;
            for (int q = 0; q <= PARTS; ++q)
                sum += SUMS[p - 1][q] * f[q][i];
            r.y[p * n + i] += h * sum;
        }
    }
    for (int i = 0; i < n; ++i)
        r.dense[i] = h * o->f[i];
    for (int k = 0; doubtful && k < m->moved; ++k) {
        const int32_t i = m->moved_at[k];
        r.dense[i] = 0.0;
        for (int p = 0; p <= PARTS; ++p)
            r.dense[i] += START[p] * r.y[p * n + i];
    }
    for (int i = 0; i < n; ++i) {
        double c[3];
        work->error[i] = fitted(r.y + i, n, r.dense[i], c);
        for (int p = 0; p < 3; ++p)
            r.dense[(p + 1) * n + i] = c[p];
        work->y1[i] = r.y[PARTS * n + i];
        for (int p = 0; p <= PARTS; ++p)
            if (!isfinite(f[p][i]) || !isfinite(r.y[p * n + i]))
                return NAN;
    }
    if (!between(m, o, work, &r, h, f))
        return NAN;
    hb_tolerances(m, o, o->y, work->y1, work->tolerance);
    return fmax(hb_norm(m, o, work->error, work->tolerance), unresolved(m, o, &r, h));
}

/* Derivatives choose the first step: halved until its dense output will do. */
static double first_step(const hb_mode *m, hb_motion *o, hb_work *work, double limit)
{
    const int n = m->flow;
    const rooms r = rooms_of(m, work);
    double h = limit < INFINITY ? limit : fmax(1e3 * m->flow_unit, 1.0);
    if (!isfinite(h))
        h = 1.0;
    begins(m, o, work, o->t, o->y, r.z);
    for (int p = 1; p <= HIGHEST; ++p)
        multiply(m, 1.0 / p, r.z + (p - 1) * n, r.z + p * n);
    memset(r.amplitude, 0, sizeof *r.amplitude * (size_t)n);
    for (int turn = 0; turn < 1100; ++turn, h *= 0.5) {
        double sum = 0.0;
        for (int k = 0; k < m->moved + m->watched; ++k) {
            const int32_t i = k < m->moved ? k : m->watched_at[k - m->moved];
            const double loose = k < m->moved ? 1.0 : LOOSE, scale = m->flow_scale[i];
            double size = 0.0, off = 0.0, power = scale;
            for (int p = 1; p <= HIGHEST; ++p) {
                power *= h;
                *(p < PARTS ? &size : &off) += fabs(r.z[p * n + i]) * power;
            }
            const double allowed = k < m->moved ? work->tolerance[m->moved_at[k]]
                                                : loose * o->rtol * fabs(r.z[i] * scale);
            if (off != 0.0) {
                const double ratio = FARTHEST * off / (allowed + loose * o->rtol * size);
                sum += ratio * ratio;
            }
        }
        if (sum <= m->moved + m->watched)
            break;
    }
    return h;
}

static int begin(const hb_mode *m, hb_motion *o, hb_work *work, double limit)
{
    if (!m->flow)
        return hb_dopri.begin(m, o, work, limit);
    o->error_before = SMALLEST;
    const double h = first_step(m, o, work, limit);
    o->h = hb_states(m) > m->moved + 2 ? fmin(h, hb_first_step(m, o, work, limit, 5.0)) : h;
    return 1;
}

static int step(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
                int32_t *rejected)
{
    if (!m->flow)
        return hb_dopri.step(m, o, work, t_end, t1, rejected);
    return hb_steered(attempt, m, o, work, t_end, t1, rejected);
}

static int retry(const hb_mode *m, hb_motion *o, hb_work *work, double t1)
{
    return m->flow ? isfinite(attempt(m, o, work, t1)) : hb_dopri.retry(m, o, work, t1);
}

static void dense_output(const hb_mode *m, const hb_work *work, double h, double *dense)
{
    if (m->flow)
        memcpy(dense, rooms_of(m, work).dense, sizeof *dense * 4 * (size_t)hb_states(m));
    else
        hb_dopri.dense(m, work, h, dense);
}

const hb_method hb_exact = {begin, step, retry, dense_output};
