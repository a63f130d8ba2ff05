/* A buck converter: a switch at fixed edges, and an ideal diode.
   Given: cycles, rtol, points. Found: events, current and voltage at the end. */
#include "limit.h"

enum { CURRENT, VOLTAGE };
enum { SWITCH, DIODE, NEITHER };

static const double VOLT = 12, HENRY = 1e-4, FARAD = 1e-4, OHM = 2, PERIOD = 1e-5, DUTY = 0.5;
static int mode;

static void convert(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    f[CURRENT] = mode == NEITHER ? 0 : ((mode == SWITCH ? VOLT : 0) - y[VOLTAGE]) / HENRY;
    f[VOLTAGE] = (y[CURRENT] - y[VOLTAGE] / OHM) / FARAD;
}

static double diode(const motion *m, double x)
{
    return part(m, mode == DIODE ? CURRENT : VOLTAGE, x);
}

static int buck(const double *given, double *found)
{
    const double end = given[0] * PERIOD;
    const int edges = (int)(2 * given[0]);
    journal j = opened(2, end, given[2], 2, (const int[]){CURRENT, VOLTAGE});
    motion *m = begin(2, given[1], 1e-7);
    for (int edge = 0; edge < edges; ++edge) {
        const double next = edge % 2 ? (edge / 2 + 1) * PERIOD : (edge / 2 + DUTY) * PERIOD;
        mode = edge % 2 == 0 ? SWITCH : m->y[CURRENT] > 0 ? DIODE : NEITHER;
        restart(m, convert);
        record(&j, m->t, mode, m->y);
        while (m->t < next) {
            step(m, convert, next);
            interpolation(m, 0, 2);
            const double x = mode == SWITCH ? 2 : crossing(m, diode, 1);
            show(m, fmin(x, 1), &j);
            if (x > 1) {
                accept(m, next);
                continue;
            }
            halt(m, x);
            mode = mode == DIODE ? NEITHER : DIODE;
            if (mode == NEITHER)
                m->y[CURRENT] = 0;
            restart(m, convert);
            record(&j, m->t, mode, m->y);
        }
    }
    found[0] = (double)j.events;
    memcpy(found + 1, m->y, sizeof(double) * 2);
    finish(m);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, buck);
}
