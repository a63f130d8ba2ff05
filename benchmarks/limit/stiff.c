/* A ball on a springy floor that relaxes fast while nothing touches it: Radau IIA of order 5, as
   the field of each mode is linear, y' = A y + b.
   Given: end, rtol, points. Found: events, height at the end, the last event. */
#include "limit.h"

enum { SPEED, PAD, HEIGHT, N, STAGES = 3 * N };

static const double STIFF = 1000, DAMPED = 0.1, WEIGHT = 9.81;
static int touching;
static double matrix[N][N], pull[N];

static void enter(int touches)
{
    touching = touches;
    memset(matrix, 0, sizeof matrix);
    pull[SPEED] = -WEIGHT;
    matrix[HEIGHT][SPEED] = 1;
    if (touching) {
        matrix[SPEED][PAD] = STIFF;
        matrix[SPEED][SPEED] = -DAMPED;
        matrix[PAD][SPEED] = -1;
    } else {
        matrix[PAD][PAD] = -STIFF / DAMPED;
    }
}

static void rates(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    for (int i = 0; i < N; ++i) {
        f[i] = pull[i];
        for (int j = 0; j < N; ++j)
            f[i] += matrix[i][j] * y[j];
    }
}

/* Solves a system in place, with row exchanges; b is overwritten by the solution. */
static void solve(int n, double *a, double *b)
{
    for (int k = 0; k < n; ++k) {
        int p = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(a[i * n + k]) > fabs(a[p * n + k]))
                p = i;
        for (int j = 0; j < n && p != k; ++j) {
            const double swap = a[k * n + j];
            a[k * n + j] = a[p * n + j];
            a[p * n + j] = swap;
        }
        const double swap = b[k];
        b[k] = b[p];
        b[p] = swap;
        for (int i = k + 1; i < n; ++i) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k + 1; j < n; ++j)
                a[i * n + j] -= factor * a[k * n + j];
            b[i] -= factor * b[k];
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int j = i + 1; j < n; ++j)
            b[i] -= a[i * n + j] * b[j];
        b[i] /= a[i * n + i];
    }
}

static double size_of(const motion *m, int i)
{
    return m->rtol * fmax(fmax(fabs(m->y1[i]), m->largest[i]), 1e-6);
}

/* The embedded error, filtered by the real factor of the method. */
static double error_of(motion *m, const double *f, const double *z, double h)
{
    const double s6 = sqrt(6), real = 3 + pow(3, 2.0 / 3) - pow(3, 1.0 / 3);
    const double e[] = {(-13 - 7 * s6) / 3, (-13 + 7 * s6) / 3, -1.0 / 3};
    double a[N * N], b[N], sum = 0;
    for (int i = 0; i < N; ++i) {
        b[i] = f[i] + (e[0] * z[i] + e[1] * z[N + i] + e[2] * z[2 * N + i]) / h;
        for (int j = 0; j < N; ++j)
            a[i * N + j] = (i == j ? real / h : 0) - matrix[i][j];
    }
    solve(N, a, b);
    for (int i = 0; i < N; ++i)
        sum += b[i] * b[i] / (size_of(m, i) * size_of(m, i));
    return sqrt(sum / N);
}

/* One accepted step, with its dense output. */
static void implicit(motion *m, double end)
{
    const double s6 = sqrt(6);
    const double a[3][3] = {
        {(88 - 7 * s6) / 360, (296 - 169 * s6) / 1800, (-2 + 3 * s6) / 225},
        {(296 + 169 * s6) / 1800, (88 + 7 * s6) / 360, (-2 - 3 * s6) / 225},
        {(16 - s6) / 36, (16 + s6) / 36, 1.0 / 9}};
    const double c[] = {(4 - s6) / 10, (4 + s6) / 10, 1};
    const double p[3][3] = {{(13 + 7 * s6) / 3, (13 - 7 * s6) / 3, 1.0 / 3},
                            {(-23 - 22 * s6) / 3, (-23 + 22 * s6) / 3, -8.0 / 3},
                            {10.0 / 3 + 5 * s6, 10.0 / 3 - 5 * s6, 10.0 / 3}};
    double h = m->t + 1.01 * m->h >= end ? end - m->t : m->h, z[STAGES];
    for (int rejected = 0;; rejected = 1) {
        double system[STAGES * STAGES];
        for (int s = 0; s < 3; ++s)
            for (int i = 0; i < N; ++i) {
                z[s * N + i] = h * c[s] * m->f[i];
                for (int q = 0; q < 3; ++q)
                    for (int k = 0; k < N; ++k)
                        system[(s * N + i) * STAGES + q * N + k] =
                            (s == q && i == k) - h * a[s][q] * matrix[i][k];
            }
        solve(STAGES, system, z);
        for (int i = 0; i < N; ++i) {
            m->y1[i] = m->y[i] + z[2 * N + i];
            m->largest[i] = fmax(m->largest[i], fabs(m->y[i]));
        }
        const double error = error_of(m, m->f, z, h);
        const double factor = 0.9 * pow(fmax(error, 1e-10), -0.25);
        if (error <= 1) {
            m->h = h * fmin(fmax(factor, 0.2), rejected ? 1 : 10);
            m->taken = h;
            break;
        }
        h *= fmax(factor, 0.2);
    }
    for (int r = 0; r < 3; ++r)
        for (int i = 0; i < N; ++i)
            m->dense[r * N + i] = p[r][0] * z[i] + p[r][1] * z[N + i] + p[r][2] * z[2 * N + i];
    rates(N, 0, m->y1, m->k + 6 * N);
}

static double contact(const motion *m, double x)
{
    if (touching)
        return STIFF * part(m, PAD, x) - DAMPED * part(m, SPEED, x);
    return part(m, SPEED, x) < 0 ? part(m, HEIGHT, x) : 1;
}

static int stiff(const double *given, double *found)
{
    const double end = given[0];
    journal j = opened(N, end, given[2], 2, (const int[]){HEIGHT, SPEED});
    motion *m = begin(N, given[1], 1e-3);
    m->y[HEIGHT] = 3;
    enter(0);
    restart(m, rates);
    while (m->t < end) {
        implicit(m, end);
        const double x = crossing(m, contact, 1);
        show(m, fmin(x, 1), &j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        halt(m, x);
        enter(!touching);
        restart(m, rates);
        record(&j, m->t, touching, m->y);
        found[2] = m->t;
    }
    found[0] = (double)j.events;
    found[1] = m->y[HEIGHT];
    finish(m);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, stiff);
}
