/* Masses with springs and dampers between them, hung on a wall, each pulled by 1 N. */
#include "limit.h"

/* Rates of the stretches q and the velocities v; the pull of the last spring is returned. */
static double links(int masses, double cubic, const double *q, const double *v, double *dq,
                    double *dv)
{
    double before = 0, last = 0;
    for (int i = masses - 1; i >= 0; --i) {
        const double stretch = v[i] - (i ? v[i - 1] : 0);
        const double pull = 1000 * q[i] + cubic * q[i] * q[i] * q[i] + stretch;
        if (i == masses - 1)
            last = pull;
        dq[i] = stretch;
        dv[i] = 1 + before - pull;
        before = pull;
    }
    return last;
}
