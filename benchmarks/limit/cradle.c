/* Newton's cradle of small swings: balls on springs to their places of rest, elastic impacts one
   after the other. All at one instant are one event.
   Given: balls, end, rtol, points. Found: instants with impacts, place of the first and last ball. */
#include "limit.h"

static const double MASS = 0.1, STIFF = 0.981, OUT = 0.05, NEAR = 1e-9;
static int balls, watched;

static void swung(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    for (int i = 0; i < balls; ++i) {
        f[i] = y[balls + i];
        f[balls + i] = -STIFF / MASS * y[i];
    }
}

/* The gap before ball `watched`, where it closes. */
static double gap(const motion *m, double x)
{
    const double closing = part(m, balls + watched, x) - part(m, balls + watched + 1, x);
    return closing > NEAR ? part(m, watched + 1, x) - part(m, watched, x) : 1;
}

static int cradle(const double *given, double *found)
{
    const double end = given[1];
    balls = (int)given[0];
    const int n = 2 * balls;
    journal j = opened(n, end, given[3], 2, (const int[]){0, balls - 1});
    motion *m = begin(n, given[2], 1e-3);
    m->y[0] = -OUT;
    restart(m, swung);
    while (m->t < end) {
        step(m, swung, end);
        interpolation(m, 0, n);
        double x = 2;
        for (watched = 0; watched < balls - 1; ++watched)
            x = fmin(x, crossing(m, gap, fmin(x, 1)));
        show(m, fmin(x, 1), &j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        halt(m, x);
        for (int hit = 1; hit;) {
            hit = 0;
            for (int i = 0; i < balls - 1; ++i) {
                double *v = m->y + balls + i;
                if (m->y[i + 1] - m->y[i] > NEAR || v[0] - v[1] <= NEAR)
                    continue;
                const double own = v[0];
                v[0] = v[1];
                v[1] = own;
                hit = 1;
            }
        }
        restart(m, swung);
        record(&j, m->t, 0, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[0];
    found[2] = m->y[balls - 1];
    finish(m);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, cradle);
}
