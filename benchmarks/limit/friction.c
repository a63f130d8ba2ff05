/* A chain of blocks with springs and dampers between them, hung on a wall, the last one driven by a
   sine; each rubs on the ground with dry friction.
   Given: blocks, end, rtol, points. Found: events, stretch of the last spring, of the middle one. */
#include "limit.h"

static const double STIFF = 1000, RUB = 0.1, PUSH = 5, OMEGA = 6.283185307179586;
static int blocks, *way, watched;

/* What springs, dampers and the drive do to block i. */
static double net(int i, double t, double q, double above, double v, double before, double behind)
{
    const double own = STIFF * q + (v - before);
    return i < blocks - 1 ? STIFF * above + (behind - v) - own : PUSH * sin(OMEGA * t) - own;
}

static void rubbed(int n, double t, const double *y, double *f)
{
    const double *v = y + blocks;
    (void)n;
    for (int i = 0; i < blocks; ++i) {
        const double before = i ? v[i - 1] : 0, last = i == blocks - 1;
        f[i] = v[i] - before;
        f[blocks + i] = way[i] ? net(i, t, y[i], last ? 0 : y[i + 1], v[i], before,
                                     last ? 0 : v[i + 1]) - RUB * way[i]
                               : 0;
    }
}

static double net_at(const motion *m, double x, int i)
{
    const int last = i == blocks - 1, v = blocks + i;
    return net(i, m->t + x * m->taken, part(m, i, x), last ? 0 : part(m, i + 1, x), part(m, v, x),
               i ? part(m, v - 1, x) : 0, last ? 0 : part(m, v + 1, x));
}

static double turns(const motion *m, double x)
{
    return way[watched] ? way[watched] * part(m, blocks + watched, x)
                        : RUB - fabs(net_at(m, x, watched));
}

static int friction(const double *given, double *found)
{
    const double end = given[1];
    blocks = (int)given[0];
    const int n = 2 * blocks;
    way = calloc((size_t)blocks, sizeof *way);
    journal j = opened(n, end, given[3], 2, (const int[]){blocks - 1, n - 1});
    motion *m = begin(n, given[2], 1e-3);
    restart(m, rubbed);
    while (m->t < end) {
        step(m, rubbed, end);
        interpolation(m, 0, n);
        double x = 2;
        int which = 0;
        for (watched = 0; watched < blocks; ++watched) {
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
        const double pulled = net_at(m, x, which);
        halt(m, x);
        /* one that has come to rest stays, or goes back; one that is torn loose goes on */
        way[which] = way[which] && fabs(pulled) <= RUB ? 0 : pulled > 0 ? 1 : -1;
        m->y[blocks + which] = 0;
        restart(m, rubbed);
        record(&j, m->t, which, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[blocks - 1];
    found[2] = m->y[blocks / 2];
    finish(m);
    closed(&j);
    free(way);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, friction);
}
