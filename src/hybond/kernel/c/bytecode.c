/* Expressions: a stack machine over the vector of values. */
#include "hybond.h"

#include <math.h>

enum { DEPTH = 64 }; /* kernel/bytecode.py refuses what needs more */

static double sign_of(double a)
{
    return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : fabs(a) * 0.0;
}

/* The remainder with the sign of the divisor, as Python has it. */
static double modulo(double a, double b)
{
    double r = fmod(a, b);
    if (r != 0.0)
        return (r < 0.0) != (b < 0.0) ? r + b : r;
    return b == b ? copysign(0.0 * r, b) : r;
}

/* A table: number of points, extrapolated or not, slope or value, then x, then y. */
static double table(const double *at, double x)
{
    int n = (int)at[0];
    const double *xs = at + 3, *ys = xs + n;
    if (x != x || (at[1] == 0.0 && !(xs[0] <= x && x <= xs[n - 1])))
        return NAN;
    int low = 0, high = n; /* the first point beyond x */
    while (low < high) {
        int middle = (low + high) / 2;
        if (x < xs[middle])
            high = middle;
        else
            low = middle + 1;
    }
    int k = low - 1;
    k = k < 0 ? 0 : k > n - 2 ? n - 2 : k;
    double slope = (ys[k + 1] - ys[k]) / (xs[k + 1] - xs[k]);
    return at[2] != 0.0 ? slope : ys[k] + slope * (x - xs[k]);
}

double hb_evaluate(const int32_t *code, const double *constants, const double *v)
{
    double stack[DEPTH + 1];
    double *s = stack; /* the top; nothing stands in stack[0] */
#define TWO(name, result) case name: { double a = s[-1], b = s[0]; --s; *s = (result); break; }
#define ONE(name, result) case name: { double a = *s; *s = (result); break; }
    for (;;) {
        switch (*code++) {
        case HB_END: return *s;
        case HB_CONST: *++s = constants[*code++]; break;
        case HB_SLOT: *++s = v[*code++]; break;
        TWO(HB_ADD, a + b)
        TWO(HB_SUB, a - b)
        TWO(HB_MUL, a * b)
        TWO(HB_DIV, a / b)
        TWO(HB_POW, pow(a, b))
        ONE(HB_NEG, -a)
        ONE(HB_SQUARE, a * a)
        TWO(HB_LT, a < b)
        TWO(HB_LE, a <= b)
        TWO(HB_GT, a > b)
        TWO(HB_GE, a >= b)
        TWO(HB_EQ, a == b)
        TWO(HB_NE, a != b)
        ONE(HB_NOT, a == 0.0)
        ONE(HB_TRUTH, a != 0.0)
        case HB_SKIP: code += *code + 1; break;
        case HB_SKIP_UNLESS: code += *s-- == 0.0 ? *code + 1 : 1; break;
        case HB_SKIP_IF: code += *s-- != 0.0 ? *code + 1 : 1; break;
        ONE(HB_SIN, sin(a))
        ONE(HB_COS, cos(a))
        ONE(HB_TAN, tan(a))
        ONE(HB_ASIN, asin(a))
        ONE(HB_ACOS, acos(a))
        ONE(HB_ATAN, atan(a))
        ONE(HB_SINH, sinh(a))
        ONE(HB_COSH, cosh(a))
        ONE(HB_TANH, tanh(a))
        ONE(HB_EXP, exp(a))
        ONE(HB_LOG, log(a))
        ONE(HB_LOG10, log10(a))
        ONE(HB_SQRT, sqrt(a))
        ONE(HB_ABS, fabs(a))
        ONE(HB_SIGN, sign_of(a))
        ONE(HB_FLOOR, floor(a))
        ONE(HB_CEIL, ceil(a))
        TWO(HB_ATAN2, atan2(a, b))
        TWO(HB_HYPOT, hypot(a, b))
        TWO(HB_MOD, modulo(a, b))
        TWO(HB_MIN, b < a || b != b ? b : a)
        TWO(HB_MAX, b > a || b != b ? b : a)
        case HB_TABLE: *s = table(constants + *code++, *s); break;
        default: return NAN;
        }
    }
#undef TWO
#undef ONE
}
