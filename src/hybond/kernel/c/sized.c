/* Guards as settling asks them: values with the sizes of the terms that made them.
 *
 * What a difference leaves below a part of its terms is rounding, hence zero: modes/dirac.py, for
 * signals that do not jump.
 */
#include "hybond.h"

#include <math.h>

enum { DEPTH = 64 };
static const double ROUNDING = 1e-13;

typedef struct {
    double value, size;
} sized;

/* -1, 0 or 1; 2 for what is not a number. */
static int sign_of(sized a)
{
    if (fabs(a.value) > ROUNDING * a.size)
        return a.value > 0.0 ? 1 : -1;
    return a.value == a.value ? 0 : 2;
}

static sized of(double value)
{
    sized a = {value, fabs(value)};
    return a;
}

static sized difference(sized a, sized b)
{
    sized d = {a.value - b.value, a.size + b.size};
    return d;
}

static sized quotient(sized a, sized b)
{
    const double by = fabs(b.value);
    sized q = {a.value / b.value, a.size / by};
    if (b.value == 0.0) {
        q.value = a.value == 0.0 ? NAN : copysign(INFINITY, a.value);
        q.size = a.size == 0.0 ? NAN : INFINITY;
    }
    return q;
}

int hb_holds(const int32_t *code, const double *constants, const double *v, const double *size)
{
    sized stack[DEPTH + 1], *s = stack;
    for (;;) {
        const int32_t op = *code++;
        switch (op) {
        case HB_END: return s->value != 0.0;
        case HB_CONST: *++s = of(constants[*code++]); break;
        case HB_SLOT: {
            sized a = {v[*code], size[*code]};
            *++s = a;
            ++code;
            break;
        }
        case HB_ADD:
            s[-1].value += s->value;
            s[-1].size += s->size;
            --s;
            break;
        case HB_SUB: s[-1] = difference(s[-1], *s); --s; break;
        case HB_MUL:
            s[-1].value *= s->value;
            s[-1].size *= s->size;
            --s;
            break;
        case HB_DIV: s[-1] = quotient(s[-1], *s); --s; break;
        case HB_NEG: s->value = -s->value; break;
        case HB_LT: case HB_LE: case HB_GT: case HB_GE: case HB_EQ: case HB_NE: {
            const int c = sign_of(difference(s[-1], *s));
            if (c == 2)
                return -1;
            *--s = of(op == HB_LT ? c < 0 : op == HB_LE ? c <= 0 : op == HB_GT ? c > 0
                      : op == HB_GE ? c >= 0 : op == HB_EQ ? c == 0 : c != 0);
            break;
        }
        case HB_NOT: *s = of(s->value == 0.0); break;
        case HB_TRUTH: *s = of(s->value != 0.0); break;
        case HB_SKIP: code += *code + 1; break;
        case HB_SKIP_UNLESS: code += (s--)->value == 0.0 ? *code + 1 : 1; break;
        case HB_SKIP_IF: code += (s--)->value != 0.0 ? *code + 1 : 1; break;
        case HB_ABS: case HB_SIGN: {
            const int c = sign_of(*s);
            if (c == 2)
                return -1;
            if (op == HB_SIGN)
                *s = of(c);
            else if (c < 0)
                s->value = -s->value;
            break;
        }
        case HB_MIN: case HB_MAX: {
            const int c = sign_of(difference(*s, s[-1]));
            if (c == 2)
                return -1;
            if (op == HB_MIN ? c < 0 : c > 0)
                s[-1] = *s;
            --s;
            break;
        }
        case HB_HYPOT:
            s[-1].value = hypot(s[-1].value, s->value);
            s[-1].size = hypot(s[-1].size, s->size);
            --s;
            break;
        default: { /* the size of any other function is its value's */
            if (op != HB_SQUARE && op != HB_TABLE && op != HB_POW && op != HB_ATAN2 &&
                op != HB_MOD && (op < HB_SIN || op > HB_CEIL))
                return -1;
            int32_t one[] = {HB_SLOT, 0, op, 0, 0, 0};
            double both[] = {s->value, 0.0};
            if (op == HB_POW || op == HB_ATAN2 || op == HB_MOD) {
                int32_t two[] = {HB_SLOT, 0, HB_SLOT, 1, op, HB_END};
                both[0] = s[-1].value;
                both[1] = s->value;
                *--s = of(hb_evaluate(two, constants, both));
                break;
            }
            if (op == HB_TABLE)
                one[3] = *code++;
            *s = of(hb_evaluate(one, constants, both));
        }
        }
    }
}
