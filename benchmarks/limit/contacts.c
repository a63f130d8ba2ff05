/* The chain with stiffening springs and ten compliant contacts, at even distances along it. A
   contact has a spring and a damper, which relaxes while nothing touches it.
   Given: masses, end, rtol, points. Found: events, the stretch at the first contact, the first one. */
#include "chain.h"

enum { CONTACTS = 10 };

static const double STIFF = 1e5, DAMPED = 100;
static int masses, touching[CONTACTS], watched;

static int mass_of(int contact)
{
    return (contact + 1) * masses / CONTACTS - 1;
}

static int way_of(int contact)
{
    return 2 * masses + contact;
}

static int pad_of(int contact)
{
    return 2 * masses + CONTACTS + contact;
}

static double gap_of(int contact)
{
    return 0.5 + 0.05 * contact;
}

static void pulled(int n, double t, const double *y, double *f)
{
    (void)n, (void)t;
    links(masses, 1e5, y, y + masses, f, f + masses);
    for (int c = 0; c < CONTACTS; ++c) {
        const int v = masses + mass_of(c);
        f[way_of(c)] = y[v];
        f[pad_of(c)] = touching[c] ? y[v] : -STIFF / DAMPED * y[pad_of(c)];
        if (touching[c])
            f[v] -= STIFF * y[pad_of(c)] + DAMPED * y[v];
    }
}

static double contact(const motion *m, double x)
{
    const double v = part(m, masses + mass_of(watched), x);
    if (touching[watched])
        return STIFF * part(m, pad_of(watched), x) + DAMPED * v;
    return v > 0 ? gap_of(watched) - part(m, way_of(watched), x) : 1;
}

static int contacts(const double *given, double *found)
{
    const double end = given[1];
    masses = (int)given[0];
    memset(touching, 0, sizeof touching);
    const int n = 2 * (masses + CONTACTS);
    journal j = opened(n, end, given[3], 2, (const int[]){way_of(0), way_of(CONTACTS - 1)});
    motion *m = begin(n, given[2], 1e-3);
    restart(m, pulled);
    while (m->t < end) {
        step(m, pulled, end);
        interpolation(m, 2 * masses, 2 * CONTACTS);
        double x = 2;
        int which = 0;
        for (watched = 0; watched < CONTACTS; ++watched) {
            interpolation(m, masses + mass_of(watched), 1);
            const double at = crossing(m, contact, fmin(x, 1));
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
        interpolation(m, 0, n);
        halt(m, x);
        touching[which] = !touching[which];
        restart(m, pulled);
        double mode = 0;
        for (int c = 0; c < CONTACTS; ++c)
            mode += touching[c] << c;
        record(&j, m->t, mode, m->y);
    }
    found[0] = (double)j.events;
    found[1] = m->y[mass_of(0)];
    found[2] = m->y[0];
    finish(m);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, contacts);
}
