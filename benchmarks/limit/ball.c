/* A ball that loses a thousandth of its speed at each bounce. */
#include "limit.h"

static void fall(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    f[0] = y[1];
    f[1] = -9.81;
}

static double height(int n, double t, const double *y)
{
    (void)n, (void)t;
    return y[1] < 0 ? y[0] : 1;
}

int main(int argc, char **argv)
{
    const int bounces = argc > 1 ? atoi(argv[1]) : 1000;
    double *stored = calloc((size_t)bounces * 3, sizeof *stored), last = 0;
    const double start = seconds();
    motion *m = begin(2, 1e-8);
    m->y[0] = 3;
    m->h = 0.01;
    fall(2, 0, m->y, m->f);
    for (int count = 0; count < bounces;) {
        const double h = step(m, fall, 1e9);
        interpolation(m, h);
        const double x = crossing(m, height, h);
        if (x > 1) {
            memcpy(m->y, m->y1, sizeof(double) * 2);
            memcpy(m->f, m->k + 12, sizeof(double) * 2);
            m->t += h;
            continue;
        }
        double y[2];
        between(m, x, y);
        m->t += x * h;
        m->y[0] = 0;
        m->y[1] = -0.999 * y[1];
        fall(2, m->t, m->y, m->f);
        memcpy(stored + 3 * count++, (double[]){m->t, m->y[0], m->y[1]}, sizeof(double) * 3);
        last = m->t;
    }
    printf("%.9e %.15g\n", seconds() - start, last);
    return 0;
}
