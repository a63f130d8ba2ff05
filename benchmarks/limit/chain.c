/* A chain of masses with springs (stiffening ones if asked for) and dampers, pulled. */
#include "limit.h"

static double cubic;

static void chain(int n, double t, const double *y, double *f)
{
    const int masses = n / 2;
    const double *q = y, *v = y + masses;
    (void)t;
    double before = 0;
    for (int i = masses - 1; i >= 0; --i) {
        const double left = i ? v[i - 1] : 0, stretch = v[i] - left;
        const double pull = 1000 * q[i] + cubic * q[i] * q[i] * q[i] + stretch;
        f[i] = stretch;
        f[masses + i] = 1 + before - pull;
        before = pull;
    }
}

int main(int argc, char **argv)
{
    const int masses = argc > 1 ? atoi(argv[1]) : 100;
    const double end = argc > 2 ? atof(argv[2]) : 20;
    cubic = argc > 3 ? atof(argv[3]) : 0;
    const double start = seconds();
    motion *m = begin(2 * masses, 1e-8);
    m->h = 1e-3;
    chain(m->n, 0, m->y, m->f);
    long steps = 0;
    while (m->t < end) {
        const double h = step(m, chain, end);
        interpolation(m, h);
        memcpy(m->y, m->y1, sizeof(double) * (size_t)m->n);
        memcpy(m->f, m->k + 6 * m->n, sizeof(double) * (size_t)m->n);
        m->t = end - m->t - h < 1e-12 ? end : m->t + h;
        ++steps;
    }
    printf("%.9e %.15g %ld\n", seconds() - start, m->y[0], steps);
    return 0;
}
