/* A row of cells that charge and are discharged between two levels of their own voltage, each tied
   to the next one by a resistor.
   Given: cells, end, rtol, points. Found: events, voltage of the first cell, of the last one. */
#include "limit.h"

static const double CHARGE = 1, DRAIN = 20, LOAD = 0.1, TIE = 0.1, LOW = 0.3;
static int cells, watched;
static unsigned char *drains;

static double high(int k)
{
    return 0.6 + 0.2 * (k + 1) / cells;
}

static void charged(int n, double t, const double *y, double *f)
{
    (void)t;
    for (int k = 0; k < n; ++k) {
        f[k] = CHARGE * (1 - y[k]) - (LOAD + (drains[k] ? DRAIN : 0)) * y[k];
        if (k)
            f[k] += TIE * (y[k - 1] - y[k]);
        if (k < n - 1)
            f[k] += TIE * (y[k + 1] - y[k]);
    }
}

static double turns(const motion *m, double x)
{
    const double v = part(m, watched, x);
    return drains[watched] ? v - LOW : high(watched) - v;
}

static int run(const double *given, double *found)
{
    const double end = given[1];
    cells = (int)given[0];
    drains = calloc((size_t)cells, 1);
    journal j = opened(cells, end, given[3], 2, (const int[]){0, cells - 1});
    motion *m = begin(cells, given[2], 1e-3);
    restart(m, charged);
    while (m->t < end) {
        step(m, charged, end);
        interpolation(m, 0, cells);
        double x = 2;
        int which = 0;
        for (watched = 0; watched < cells; ++watched) {
            const double at = crossing(m, turns, fmin(x, 1));
            if (at < x) {
                x = at;
                which = watched;
            }
        }
        show(m, fmin(x, 1), &j);
        if (x > 1) {
            accept(m, end);
            continue;
        }
        halt(m, x);
        drains[which] = !drains[which];
        restart(m, charged);
        record(&j, m->t, which, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[0];
    found[2] = m->y[cells - 1];
    finish(m);
    closed(&j);
    free(drains);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, run);
}
