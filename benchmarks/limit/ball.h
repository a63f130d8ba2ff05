/* One ball over a floor that gives back a part of its speed. */
#include "limit.h"

enum { HEIGHT, SPEED };

static void fall(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    f[HEIGHT] = y[SPEED];
    f[SPEED] = -9.81;
}

static double arrives(const motion *m, double x)
{
    return part(m, SPEED, x) < 0 ? part(m, HEIGHT, x) : 1;
}

/* Its motion up to an instant; the time of its last bounce is returned. */
static double bounce(double restitution, double drop, double end, double rtol, journal *j)
{
    double last = 0;
    motion *m = begin(2, rtol, 0.01);
    m->y[HEIGHT] = drop;
    fall(2, 0, m->y, m->f);
    while (m->t < end) {
        step(m, fall, end);
        interpolation(m, 0, 2);
        const double x = crossing(m, arrives, 1);
        show(m, fmin(x, 1), j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        halt(m, x);
        m->y[HEIGHT] = 0;
        m->y[SPEED] *= -restitution;
        restart(m, fall);
        record(j, last = m->t, 0, m->y);
    }
    finish(m);
    return last;
}
