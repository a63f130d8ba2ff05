/* The same chain of blocks in fixed steps, as Moreau and Jean take them, with theta = 1: what
   friction does at the end of a step is found by turning those blocks that are violated, from
   those of the step before; each trial is one tridiagonal system.
   Given: blocks, end, step, points. Found: events, stretch of the last spring, of the middle one. */
#include "limit.h"

static const double STIFF = 1000, RUB = 0.1, PUSH = 5, OMEGA = 6.283185307179586;

/* Velocities at the end of a step, of those that slide, by elimination; those at rest have none. */
static void solved(int n, double tie, double most, const int *way, const double *b, double *v,
                   double *factor)
{
    double before = 0;
    for (int i = 0; i < n; ++i) {
        if (!way[i]) {
            factor[i] = v[i] = before = 0;
            continue;
        }
        const double own = 1 + tie * (i < n - 1 ? 2 : 1);
        const double pivot = 1 / (own - tie * before);
        v[i] = (b[i] - most * way[i] + tie * (i ? v[i - 1] : 0)) * pivot;
        factor[i] = before = tie * pivot;
    }
    for (int i = n - 2; i >= 0; --i)
        v[i] += factor[i] * v[i + 1];
}

static int stepped(const double *given, double *found)
{
    const int n = (int)given[0], steps = (int)round(given[1] / given[2]);
    const double h = given[1] / steps, tie = h + h * h * STIFF, most = h * RUB;
    journal j = opened(2 * n, given[1], given[3], 1, (const int[]){0});
    double *y = calloc((size_t)n * 5, sizeof *y), *v = y + n, *b = y + 2 * n, *next = y + 3 * n,
           *factor = y + 4 * n;
    int *way = calloc((size_t)n * 2, sizeof *way), *old = way + n;
    for (int k = 0; k < steps; ++k) {
        const double t = (k + 1) * h;
        int changed = 0;
        for (int i = 0; i < n; ++i)
            b[i] = v[i] - h * STIFF * y[i] + (i < n - 1 ? h * STIFF * y[i + 1] : h * PUSH * sin(OMEGA * t));
        memcpy(old, way, (size_t)n * sizeof *way);
        for (int turn = 0, bad = 1; bad && turn < 50; ++turn) {
            bad = 0;
            solved(n, tie, most, way, b, next, factor);
            for (int i = 0; i < n; ++i) {
                if (way[i] && way[i] * next[i] < 0) {
                    way[i] = 0;
                    bad = 1;
                } else if (!way[i]) {
                    const double rest = b[i] + tie * ((i ? next[i - 1] : 0) + (i < n - 1 ? next[i + 1] : 0));
                    if (fabs(rest) > most) {
                        way[i] = rest > 0 ? 1 : -1;
                        bad = 1;
                    }
                }
            }
        }
        for (int i = 0; i < n; ++i) {
            y[i] += h * (next[i] - (i ? next[i - 1] : 0));
            changed += way[i] != old[i];
        }
        memcpy(v, next, (size_t)n * sizeof *v);
        while (j.points < j.most && (double)j.points * j.spacing <= t)
            j.point[j.points++] = v[n - 1];
        if (changed)
            record(&j, t, changed, y);
    }
    found[0] = (double)j.events;
    found[1] = y[n - 1];
    found[2] = y[n / 2];
    free(y);
    free(way);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, stepped);
}
