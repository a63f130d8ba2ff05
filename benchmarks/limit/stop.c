/* The chain with a rigid stop at its last mass, of restitution 1/2; it rests there when it
   rebounds with less than 1e-6 m/s.
   Given: masses, end, gap, rtol, points. Found: impacts, last stretch, first stretch. */
#include "chain.h"

static int masses, resting;

static void pulled(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    links(masses, 0, y, y + masses, f, f + masses);
    if (resting)
        f[2 * masses - 1] = 0;
    f[2 * masses] = -y[2 * masses - 1];
}

static double room(const motion *m, double x)
{
    return part(m, 2 * masses - 1, x) > 0 ? part(m, 2 * masses, x) : 1;
}

/* The force on the stop while the last mass rests there. */
static double push(const motion *m, double x)
{
    const double before = masses > 1 ? part(m, 2 * masses - 2, x) : 0;
    return 1 - 1000 * part(m, masses - 1, x) + before;
}

static int stop(const double *given, double *found)
{
    const double end = given[1];
    masses = (int)given[0];
    resting = 0;
    const int n = 2 * masses + 1, v = n - 2;
    journal j = opened(n, end, given[4], 2, (const int[]){masses - 1, v});
    motion *m = begin(n, given[3], 1e-3);
    m->y[n - 1] = given[2];
    restart(m, pulled);
    while (m->t < end) {
        step(m, pulled, end);
        interpolation(m, masses - 1, 1);
        interpolation(m, v - 1, 3);
        const double x = crossing(m, resting ? push : room, 1);
        show(m, fmin(x, 1), &j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        interpolation(m, 0, n);
        halt(m, x);
        if (resting) {
            resting = 0;
        } else {
            resting = 0.5 * m->y[v] < 1e-6;
            m->y[v] *= resting ? 0 : -0.5;
            m->y[n - 1] = 0;
        }
        restart(m, pulled);
        record(&j, m->t, resting, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[masses - 1];
    found[2] = m->y[0];
    finish(m);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, stop);
}
