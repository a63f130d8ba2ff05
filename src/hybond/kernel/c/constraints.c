/* Dependent storage: integration drifts off its constraints by rounding, and is put back. */
#include "hybond.h"

#include <math.h>

enum { STEPS = 60 };
/* As in modes/jump.py. */
static const double MET = 1e-12, BEST = 1e-14, AGREE = 1e-9, CANCELLED = 1e-15, NOTHING = 1e-20;
static const double TINY = 2.2250738585072014e-296;

/* What the other ports of its field add to the co-energy variable of port j, at the state x: the
 * sum of magnitudes. */
static double coupled(const hb_mode *m, int32_t j, const double *x)
{
    double sum = 0.0;
    for (int32_t k = m->co_energy.first[j]; k < m->co_energy.first[j + 1]; ++k)
        if (m->co_energy.column[k] != j)
            sum += fabs(m->co_energy.value[k] * x[m->co_energy.column[k]]);
    return sum;
}

/* The residual of row i of what sources prescribe, and the sum of the magnitudes of its terms. */
static double disagreement(const hb_rows *rows, int i, const double *xi, double *size)
{
    double sum = 0.0, terms = 0.0;
    for (int32_t k = rows->first[i]; k < rows->first[i + 1]; ++k) {
        const int32_t j = rows->column[k];
        sum += rows->value[k] * xi[j];
        terms += fabs(rows->value[k] * xi[j]);
    }
    *size = terms;
    return sum;
}

/* The same of constraint i at the state x. */
static double residual(const hb_mode *m, int i, const double *xi, const double *x, double spread,
                       double *size)
{
    const hb_rows *rows = &m->constraint;
    double sum = 0.0, terms = 0.0;
    for (int32_t k = rows->first[i]; k < rows->first[i + 1]; ++k) {
        const int32_t j = rows->column[k];
        double known = fabs(xi[j]) + m->known_reach[j] * spread + TINY;
        if (j < m->storages)
            known += coupled(m, j, x);
        sum += rows->value[k] * xi[j];
        terms += fabs(rows->value[k]) * known;
    }
    *size = terms;
    return sum;
}

/* Whether sources that prescribe one variable do so alike. */
static int agree(const hb_mode *m, const hb_work *work)
{
    double size;
    for (int i = 0; i < m->agreements; ++i)
        if (!(fabs(disagreement(&m->agreement, i, work->known, &size)) <= AGREE * size))
            return 0;
    return 1;
}

int hb_jump(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y)
{
    const int nx = m->storages, n = m->constraints;
    const double spread = sqrt(o->run_energy);
    double size, best = INFINITY, *x = work->kept, *r = work->residuals;
    int rounding = 1;
    /* laws and sources read signals as well */
    for (int i = 0; i < nx + m->signals; ++i)
        x[i] = y[i];
    if (!n && !m->agreements)
        return HB_STAYS;
    hb_known(m, o, work, t, y);
    if (!agree(m, work))
        return 0;
    for (int i = 0; i < n; ++i)
        work->met[i] = 0.0;
    for (int turn = 0;; ++turn) {
        double worst = 0.0;
        int exact = 1;
        if (turn)
            hb_known(m, o, work, t, x);
        for (int i = 0; i < n; ++i) {
            r[i] = residual(m, i, work->known, x, spread, &size);
            exact &= r[i] == 0.0;
            if (!turn)
                rounding &= fabs(r[i]) <= MET * size;
            worst = fmax(worst, fabs(r[i]) / (size > 0.0 ? size : 1.0));
        }
        if (turn == 0 && exact)
            return HB_STAYS;
        if (turn > 0 && (worst <= BEST || (worst <= MET && worst >= 0.5 * best)))
            break;
        if (turn == STEPS - 1)
            return 0;
        best = fmin(best, worst);
        for (int j = 0; j < n; ++j)
            work->met[j] += r[j];
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < n; ++j)
                x[i] -= m->put_back[i * n + j] * r[j];
    }
    for (int i = 0; i < nx; ++i) /* a sum that cancels to rounding is zero */
        if (fabs(x[i]) <= CANCELLED * (fabs(y[i]) + fabs(x[i] - y[i])))
            x[i] = 0.0;
    return rounding ? HB_SWEPT : HB_JUMPS;
}

int hb_keep(const hb_mode *m, hb_motion *o, hb_work *work, double t, double *y, int *moved)
{
    const double spread = sqrt(o->run_energy), *x = work->kept;
    *moved = 0;
    const int how = hb_jump(m, o, work, t, y);
    if (how == 0 || how == HB_STAYS)
        return how;
    for (int i = 0; i < m->storages; ++i) {
        /* what a constraint holds at next to nothing is zero */
        const double was = y[i];
        y[i] = fabs(x[i]) <= NOTHING * m->stored_reach[i] * spread ? 0.0 : x[i];
        *moved |= y[i] != was;
    }
    return 1;
}
