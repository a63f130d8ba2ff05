/* A bridge of four ideal diodes between a sine and a capacitor with a load.
   Given: cycles, rtol, points. Found: events, voltage at the end. */
#include "limit.h"

static const double pi = 3.14159265358979323846, R_LINE = 0.1, R_LOAD = 100, FARAD = 470e-6;
static double way; /* +1 or -1: which pair conducts; 0: none */

static double source(double t)
{
    return 325 * sin(100 * pi * t);
}

static void charge(int n, double t, const double *y, double *f)
{
    (void)n;
    f[0] = -y[0] / R_LOAD;
    if (way != 0)
        f[0] += (way * source(t) - y[0]) / R_LINE;
    f[0] /= FARAD;
}

static double forward(const motion *m, double x)
{
    return part(m, 0, x) - source(m->t + x * m->taken);
}

static double backward(const motion *m, double x)
{
    return part(m, 0, x) + source(m->t + x * m->taken);
}

static double current(const motion *m, double x)
{
    return way * source(m->t + x * m->taken) - part(m, 0, x);
}

static int rectifier(const double *given, double *found)
{
    const double end = given[0] * 0.02;
    journal j = opened(1, end, given[2], 1, (const int[]){0});
    motion *m = begin(1, given[1], 1e-5);
    way = 1;
    restart(m, charge);
    while (m->t < end) {
        step(m, charge, end);
        interpolation(m, 0, 1);
        double x, next = 0;
        if (way != 0) {
            x = crossing(m, current, 1);
        } else {
            const double first = crossing(m, forward, 1);
            x = crossing(m, backward, fmin(first, 1));
            next = first < x ? 1 : -1;
            x = fmin(x, first);
        }
        show(m, fmin(x, 1), &j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        halt(m, x);
        way = next;
        restart(m, charge);
        record(&j, m->t, way, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[0];
    finish(m);
    closed(&j);
    return 2;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, rectifier);
}
