/* Dense linear systems, real and complex: factors with partial pivoting, kept column after column so
 * that every inner loop runs along memory. A complex matrix is two, its real and imaginary parts. Zeros
 * are passed over: the systems of a graph have many of them. */
#include "hybond.h"

#include <math.h>

static void swap(double *x, double *y)
{
    const double z = *x;
    *x = *y;
    *y = z;
}

static void swap_rows(int n, double *a, int i, int j)
{
    for (int k = 0; k < n; ++k)
        swap(a + k * n + i, a + k * n + j);
}

/* y -= c x */
static void subtract(int n, double c, const double *restrict x, double *restrict y)
{
    for (int i = 0; i < n; ++i)
        y[i] -= c * x[i];
}

int hb_factor(int n, double *a, int32_t *row)
{
    for (int k = 0; k < n; ++k) {
        double *column = a + k * n;
        int p = k, last = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(column[i]) > fabs(column[p]))
                p = i;
        const double pivot = column[p];
        if (pivot == 0.0 || !isfinite(pivot))
            return 0;
        row[k] = p;
        if (p != k)
            swap_rows(n, a, k, p);
        for (int i = k + 1; i < n; ++i) {
            column[i] /= pivot;
            if (column[i] != 0.0)
                last = i;
        }
        for (int j = k + 1; j < n; ++j)
            if (a[j * n + k] != 0.0)
                subtract(last - k, a[j * n + k], column + k + 1, a + j * n + k + 1);
    }
    return 1;
}

void hb_unfactor(int n, const double *a, const int32_t *row, double *b)
{
    for (int k = 0; k < n; ++k)
        if (row[k] != k)
            swap(b + k, b + row[k]);
    for (int k = 0; k < n; ++k)
        if (b[k] != 0.0)
            subtract(n - k - 1, b[k], a + k * n + k + 1, b + k + 1);
    for (int k = n - 1; k >= 0; --k) {
        b[k] /= a[k * n + k];
        if (b[k] != 0.0)
            subtract(k, b[k], a + k * n, b);
    }
}

typedef struct {
    double re, im;
} pair;

static pair times(pair a, pair b)
{
    const pair c = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    return c;
}

/* Smith's way: squares of large or small parts are not taken. */
static pair reciprocal(pair a)
{
    if (fabs(a.re) >= fabs(a.im)) {
        const double r = a.im / a.re, d = a.re + a.im * r;
        const pair c = {1.0 / d, -r / d};
        return c;
    }
    const double r = a.re / a.im, d = a.re * r + a.im;
    const pair c = {r / d, -1.0 / d};
    return c;
}

static void subtract_pair(int n, pair c, const double *restrict xr, const double *restrict xi,
                          double *restrict yr, double *restrict yi)
{
    for (int i = 0; i < n; ++i) {
        yr[i] -= c.re * xr[i] - c.im * xi[i];
        yi[i] -= c.re * xi[i] + c.im * xr[i];
    }
}

int hb_factor_pair(int n, double *re, double *im, int32_t *row)
{
    for (int k = 0; k < n; ++k) {
        double *cr = re + k * n, *ci = im + k * n;
        int p = k, last = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(cr[i]) + fabs(ci[i]) > fabs(cr[p]) + fabs(ci[p]))
                p = i;
        const pair pivot = {cr[p], ci[p]};
        if ((pivot.re == 0.0 && pivot.im == 0.0) || !isfinite(pivot.re) || !isfinite(pivot.im))
            return 0;
        row[k] = p;
        if (p != k) {
            swap_rows(n, re, k, p);
            swap_rows(n, im, k, p);
        }
        const pair inverse = reciprocal(pivot);
        for (int i = k + 1; i < n; ++i) {
            const pair c = times((pair){cr[i], ci[i]}, inverse);
            cr[i] = c.re;
            ci[i] = c.im;
            if (c.re != 0.0 || c.im != 0.0)
                last = i;
        }
        for (int j = k + 1; j < n; ++j) {
            const pair c = {re[j * n + k], im[j * n + k]};
            const int at = j * n + k + 1;
            if (c.re != 0.0 || c.im != 0.0)
                subtract_pair(last - k, c, cr + k + 1, ci + k + 1, re + at, im + at);
        }
    }
    return 1;
}

void hb_unfactor_pair(int n, const double *re, const double *im, const int32_t *row, double *br,
                      double *bi)
{
    for (int k = 0; k < n; ++k)
        if (row[k] != k) {
            swap(br + k, br + row[k]);
            swap(bi + k, bi + row[k]);
        }
    for (int k = 0; k < n; ++k) {
        const int at = k * n + k + 1;
        subtract_pair(n - k - 1, (pair){br[k], bi[k]}, re + at, im + at, br + k + 1, bi + k + 1);
    }
    for (int k = n - 1; k >= 0; --k) {
        const pair pivot = {re[k * n + k], im[k * n + k]};
        const pair b = times((pair){br[k], bi[k]}, reciprocal(pivot));
        br[k] = b.re;
        bi[k] = b.im;
        subtract_pair(k, b, re + k * n, im + k * n, br, bi);
    }
}
