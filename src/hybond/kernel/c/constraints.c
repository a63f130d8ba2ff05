/* Dependent storage: integration drifts off its constraints by rounding, and is put back. */
#include "hybond.h"

#include <math.h>

enum { STEPS = 60 };
/* As in modes/jump.py. */
static const double MET = 1e-12, BEST = 1e-14, AGREE = 1e-9, CANCELLED = 1e-15, NOTHING = 1e-20;

/* The residual of row i, and the sum of the magnitudes of its terms. */
static double residual(const hb_rows *rows, int i, const double *xi, const double *reach,
                       double spread, double *size)
{
    double sum = 0.0, terms = 0.0;
    for (int32_t k = rows->first[i]; k < rows->first[i + 1]; ++k) {
        const int32_t j = rows->column[k];
        sum += rows->value[k] * xi[j];
        terms += fabs(rows->value[k]) * (fabs(xi[j]) + (reach ? reach[j] * spread : 0.0));
    }
    *size = terms;
    return sum;
}

int hb_keep(const hb_mode *m, hb_motion *o, hb_work *work, double t, double *y, int *moved)
{
    const int nx = m->storages, n = m->constraints;
    const double spread = sqrt(o->run_energy);
    double size, best = INFINITY, *x = work->kept, *r = work->residuals;
    *moved = 0;
    if (!n && !m->agreements)
        return 1;
    hb_known(m, o, work, t, y);
    for (int i = 0; i < m->agreements; ++i)
        if (!(fabs(residual(&m->agreement, i, work->known, 0, 0.0, &size)) <= AGREE * size))
            return 0;
    for (int i = 0; i < nx; ++i)
        x[i] = y[i];
    for (int turn = 0;; ++turn) {
        double worst = 0.0;
        int exact = 1;
        if (turn)
            hb_known(m, o, work, t, x);
        for (int i = 0; i < n; ++i) {
            r[i] = residual(&m->constraint, i, work->known, m->known_reach, spread, &size);
            exact &= r[i] == 0.0;
            worst = fmax(worst, fabs(r[i]) / (size > 0.0 ? size : 1.0));
        }
        if (turn == 0 && exact)
            return 1;
        if (turn > 0 && (worst <= BEST || (worst <= MET && worst >= 0.5 * best)))
            break;
        if (turn == STEPS - 1)
            return 0;
        best = fmin(best, worst);
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < n; ++j)
                x[i] -= m->put_back[i * n + j] * r[j];
    }
    for (int i = 0; i < nx; ++i) {
        /* a sum that cancels to rounding is zero, and so is what is next to nothing */
        double was = y[i];
        if (fabs(x[i]) <= CANCELLED * (fabs(was) + fabs(x[i] - was)) ||
            fabs(x[i]) <= NOTHING * m->stored_reach[i] * spread)
            x[i] = 0.0;
        *moved |= x[i] != was;
        y[i] = x[i];
    }
    return 1;
}
