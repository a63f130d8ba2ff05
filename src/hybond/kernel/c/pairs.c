/* Expressions over signals that may jump: modes/dirac.py, instruction by instruction.
 *
 * A value is a finite part, an impulse, what it was before, and the sizes of the terms that made
 * these: what a difference leaves below a part of its terms is rounding, hence zero.
 */
#include "hybond.h"

#include <math.h>

enum { DEPTH = 64 };
static const double ROUNDING = 1e-13, STEADY = 1e-9;

int hb_impulsive(const hb_pair *a)
{
    return fabs(a->impulse) > ROUNDING * a->impulse_size;
}

int hb_sign(const hb_pair *a)
{
    if (hb_impulsive(a))
        return a->impulse > 0.0 ? 1 : -1;
    if (fabs(a->finite) > ROUNDING * a->size)
        return a->finite > 0.0 ? 1 : -1;
    return a->finite == a->finite ? 0 : 2;
}

static int steady(const hb_pair *a)
{
    return !hb_impulsive(a) && fabs(a->finite - a->before) <= STEADY * fmax(a->size, fabs(a->before));
}

static hb_pair still(double value)
{
    hb_pair a = {value, 0.0, value, fabs(value), 0.0};
    return a;
}

static double size_of(const hb_signals *s, int32_t k)
{
    return s->size ? s->size[k] : hb_size(s->m, s->o, s->work, k, s->reach);
}

static hb_pair read(const hb_signals *s, int32_t k)
{
    if (k >= s->slots) {
        const double b = s->before[k - s->slots];
        hb_pair a = {b, 0.0, b, fmax(fabs(b), size_of(s, k - s->slots)), 0.0};
        return a;
    }
    const double p = s->impulse ? s->impulse[k] : 0.0;
    hb_pair a = {s->finite[k], p, s->before[k], size_of(s, k), fabs(p)};
    return a;
}

static hb_pair sum(hb_pair a, hb_pair b)
{
    hb_pair c = {a.finite + b.finite, a.impulse + b.impulse, a.before + b.before, a.size + b.size,
                 a.impulse_size + b.impulse_size};
    return c;
}

static hb_pair negative(hb_pair a)
{
    hb_pair c = {-a.finite, -a.impulse, -a.before, a.size, a.impulse_size};
    return c;
}

static double quotient(double a, double b)
{
    if (b != 0.0)
        return a / b;
    return a == 0.0 ? NAN : copysign(INFINITY, a);
}

/* Scale a by the finite parts of b; a product or a quotient. 0 if that has no meaning. */
static int scale(hb_pair *a, hb_pair b, int divided)
{
    if (hb_impulsive(&b) || (hb_impulsive(a) && !steady(&b)))
        return 0;
    double (*const by)(double, double) = quotient;
    const double impulse = divided ? by(a->impulse, b.finite) : a->impulse * b.finite;
    const double impulse_size =
        divided ? by(a->impulse_size, fabs(b.finite)) : a->impulse_size * fabs(b.finite);
    const int kept = hb_impulsive(a);
    a->finite = divided ? by(a->finite, b.finite) : a->finite * b.finite;
    a->before = divided ? by(a->before, b.before) : a->before * b.before;
    a->size = divided ? by(a->size, fabs(b.finite)) : a->size * b.size;
    a->impulse = kept ? impulse : 0.0;
    a->impulse_size = kept ? fabs(impulse_size) : 0.0;
    return 1;
}

static hb_pair length(hb_pair a, hb_pair b)
{
    const double p = hb_impulsive(&a) ? a.impulse : 0.0, q = hb_impulsive(&b) ? b.impulse : 0.0;
    const double impulse = hypot(p, q);
    hb_pair c = {impulse != 0.0 ? (a.finite * p + b.finite * q) / impulse
                                : hypot(a.finite, b.finite),
                 impulse, hypot(a.before, b.before), hypot(a.size, b.size),
                 hypot(a.impulse_size, b.impulse_size)};
    return c;
}

/* A function without a meaning of its own for impulses: of the values, and of those before. */
static hb_pair plain(const int32_t *code, const double *constants, hb_pair a, hb_pair b)
{
    const double now[] = {a.finite, b.finite}, was[] = {a.before, b.before};
    hb_pair c = still(hb_evaluate(code, constants, now));
    c.before = hb_evaluate(code, constants, was);
    return c;
}

int hb_paired(const int32_t *code, const double *constants, const hb_signals *signals,
              hb_pair *result)
{
    hb_pair stack[DEPTH + 1], *s = stack;
    for (;;) {
        const int32_t op = *code++;
        switch (op) {
        case HB_END: *result = *s; return 1;
        case HB_CONST: *++s = still(constants[*code++]); break;
        case HB_SLOT: *++s = read(signals, *code++); break;
        case HB_ADD: s[-1] = sum(s[-1], *s); --s; break;
        case HB_SUB: s[-1] = sum(s[-1], negative(*s)); --s; break;
        case HB_MUL:
            if (hb_impulsive(s)) {
                const hb_pair a = s[-1];
                s[-1] = *s;
                *s = a;
            }
            if (!scale(s - 1, *s, 0))
                return 0;
            --s;
            break;
        case HB_DIV:
            if (!scale(s - 1, *s, 1))
                return 0;
            --s;
            break;
        case HB_NEG: *s = negative(*s); break;
        case HB_LT: case HB_LE: case HB_GT: case HB_GE: case HB_EQ: case HB_NE: {
            const hb_pair d = sum(s[-1], negative(*s));
            const int c = hb_sign(&d);
            if (c == 2)
                return 0;
            *--s = still(op == HB_LT ? c < 0 : op == HB_LE ? c <= 0 : op == HB_GT ? c > 0
                         : op == HB_GE ? c >= 0 : op == HB_EQ ? c == 0 : c != 0);
            break;
        }
        case HB_NOT: *s = still(s->finite == 0.0); break;
        case HB_TRUTH: *s = still(s->finite != 0.0); break;
        case HB_SKIP: code += *code + 1; break;
        case HB_SKIP_UNLESS: code += (s--)->finite == 0.0 ? *code + 1 : 1; break;
        case HB_SKIP_IF: code += (s--)->finite != 0.0 ? *code + 1 : 1; break;
        case HB_ABS: case HB_SIGN: {
            const int c = hb_sign(s);
            if (c == 2)
                return 0;
            if (op == HB_SIGN)
                *s = still(c);
            else if (c < 0)
                *s = negative(*s);
            break;
        }
        case HB_MIN: case HB_MAX: {
            const hb_pair d = sum(*s, negative(s[-1]));
            const int c = hb_sign(&d);
            if (c == 2)
                return 0;
            if (op == HB_MIN ? c < 0 : c > 0)
                s[-1] = *s;
            --s;
            break;
        }
        case HB_HYPOT: s[-1] = length(s[-1], *s); --s; break;
        case HB_POW: case HB_ATAN2: case HB_MOD: {
            const int32_t two[] = {HB_SLOT, 0, HB_SLOT, 1, op, HB_END};
            const int jumps = hb_impulsive(s - 1) || hb_impulsive(s);
            if (jumps && (op != HB_POW || hb_impulsive(s) || s->finite != 1.0))
                return 0;
            if (!jumps)
                s[-1] = plain(two, constants, s[-1], *s);
            --s;
            break;
        }
        default: {
            int32_t one[] = {HB_SLOT, 0, op, 0, 0, 0};
            if (op != HB_SQUARE && op != HB_TABLE && (op < HB_SIN || op > HB_CEIL))
                return 0;
            if (op == HB_TABLE)
                one[3] = *code++;
            if (hb_impulsive(s))
                return 0;
            *s = plain(one, constants, *s, *s);
        }
        }
    }
}

int hb_holds(const int32_t *code, const double *constants, const hb_signals *signals)
{
    hb_pair truth;
    return hb_paired(code, constants, signals, &truth) ? truth.finite != 0.0 : -1;
}
