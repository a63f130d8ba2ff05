/* The first instant of a step at which a guard holds: modes/locate.py, function
 * by function, for guards that count rounding as zero. */
#include "hybond.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 14, AROUND = 6, SEARCH = 40, MOST = 256 };

/* What every part of the search looks at. */
typedef struct {
    const hb_mode *m;
    hb_motion *o;
    hb_work *work;
    const hb_sampling *sampling;
    const double *dense;
    double t0, t1, t[HB_SAMPLES];
    int failed;
} search;

typedef struct {
    double at[MOST];
    int count;
} instants;

static void keep(search *s, instants *list, double t)
{
    if (list->count < MOST)
        list->at[list->count++] = t;
    else
        s->failed = 1;
}

static double spacing(double t)
{
    return nextafter(fabs(t), INFINITY) - fabs(t);
}

/* Fill the values at t. */
static void look(search *s, double t)
{
    const int n = s->m->storages + s->m->signals + 2;
    const double *y = s->work->sampled, *c = s->dense;
    if (t == s->t0)
        y = s->o->y;
    else if (t == s->t1)
        y = s->work->y1;
    else
        hb_between(n, s->o->y, c, (t - s->t0) / (s->t1 - s->t0), s->work->sampled);
    if (!hb_solve(s->m, s->o, s->work, t, y))
        s->failed = 1;
}

static double atom(search *s, int a, double t)
{
    look(s, t);
    const double value = hb_evaluate(s->m->code + s->m->atom_code[a], s->m->constants, s->o->v);
    if (!isfinite(value))
        s->failed = 1;
    return value;
}

/* Ask a guard as settling will: with rounding counted as zero. */
static int holds(search *s, int g, double t)
{
    look(s, t);
    const double *v = s->o->v;
    const hb_signals signals = {v, v, 0, 0, s->m->slots, s->m, s->o, s->work,
                                sqrt(s->o->run_energy)};
    const int truth = hb_holds(s->m->code + s->m->guard_test[g], s->m->constants, &signals);
    if (truth < 0)
        s->failed = 1;
    return truth > 0;
}

/* A bracket of the sign change of an atom, a few units in the last place wide: Illinois. */
static double root(search *s, int which, double low, double high)
{
    double a = low, b = high, fa = atom(s, which, a), fb = atom(s, which, b);
    if (fa == 0.0 || fa * fb > 0.0)
        return high;
    const double wide = 4.0 * spacing(fmax(fabs(low), fabs(high)));
    for (int k = 0, side = 0; k < SEARCH && !s->failed; ++k) {
        if (b - a <= wide || fb == 0.0)
            break;
        double c = b - fb * (b - a) / (fb - fa);
        /* a step off either end keeps the bracket shrinking from both sides */
        c = fmin(fmax(c, a + 0.25 * wide), b - 0.25 * wide);
        const double fc = atom(s, which, c);
        if (fc * fb > 0.0 || fc == 0.0) {
            b = c;
            fb = fc;
            if (side > 0)
                fa *= 0.5;
            side = 1;
        } else {
            a = c;
            fa = fc;
            if (side < 0)
                fb *= 0.5;
            side = -1;
        }
    }
    return b;
}

/* The instant where sign * atom is least, if it comes near zero: golden section. */
static double dip(search *s, int which, double low, double high, double sign)
{
    const double ratio = 0.5 * (sqrt(5.0) - 1.0);
    double a = low, b = high, c = b - ratio * (b - a), d = a + ratio * (b - a);
    double fc = sign * atom(s, which, c), fd = sign * atom(s, which, d);
    for (int k = 0; k < SEARCH && !s->failed && fmin(fc, fd) > 0.0; ++k) {
        if (fc < fd) {
            b = d;
            d = c;
            fd = fc;
            c = b - ratio * (b - a);
            fc = sign * atom(s, which, c);
        } else {
            a = c;
            c = d;
            fc = fd;
            d = a + ratio * (b - a);
            fd = sign * atom(s, which, d);
        }
    }
    return fc <= fd ? c : d;
}

/* Minima of sign * atom near zero, between samples where it is positive. */
static void dips(search *s, int which, const double *samples, double sign, double near, double end,
                 instants *found)
{
    const hb_sampling *p = s->sampling;
    const int last = HB_GRID - 1;
    const double *t = s->t, from = t[0], span = t[HB_SAMPLES - 1] - t[0];
    double d[HB_SAMPLES], fine[HB_GRID];
    int low[HB_GRID + 2], high[HB_GRID + 2], count = 0;
    for (int i = 0; i < HB_SAMPLES; ++i)
        d[i] = sign * samples[i];
    for (int i = 0; i < HB_GRID; ++i) {
        fine[i] = 0.0;
        for (int j = 0; j < HB_SAMPLES; ++j)
            fine[i] += p->fine[i * HB_SAMPLES + j] * d[j];
    }
    for (int i = 1, after = 0; i < last; ++i) {
        while (after < HB_SAMPLES && p->fractions[after] <= (double)i / last)
            ++after;
        if (fine[i] <= fine[i - 1] && fine[i] <= fine[i + 1] && fine[i] <= near &&
            d[after - 1] > 0.0 && d[after] > 0.0) {
            low[count] = i > AROUND ? i - AROUND : 0;
            high[count++] = i + AROUND < last ? i + AROUND : last;
        }
    }
    /* the polynomials of two neighbouring blocks may each place an extremum in the other */
    for (int side = 0; side < 2; ++side) {
        const int edge = side ? last : 0, away = side ? last - AROUND : AROUND;
        const double at = d[side ? HB_SAMPLES - 1 : 0];
        if (!(0.0 < at && at <= near && fine[edge] <= fine[away]))
            continue;
        const double begin = from + span * edge / last, there = from + span * away / last;
        if (sign * atom(s, which, begin + 1e-3 * (there - begin)) < at) {
            low[count] = edge < away ? edge : away;
            high[count++] = edge < away ? away : edge;
        }
    }
    for (int i = 0; i < count && !s->failed; ++i) {
        const double begin = from + span * low[i] / last, until = from + span * high[i] / last;
        if (begin < end)
            keep(s, found, dip(s, which, begin, until, sign));
    }
}

/* Extrema of an atom that reach, or nearly reach, zero between samples. */
static void extrema(search *s, int which, const double *d, double end, instants *found)
{
    double least = d[0], most = d[0], rest = 0.0;
    for (int i = 0; i < HB_SAMPLES; ++i) {
        double sum = 0.0;
        for (int j = 0; j < HB_SAMPLES; ++j)
            sum += s->sampling->left_over[i * HB_SAMPLES + j] * d[j];
        rest = fmax(rest, fabs(sum));
        least = fmin(least, d[i]);
        most = fmax(most, d[i]);
    }
    const double near = s->sampling->near_zero * (most - least) + 3.0 * rest;
    if (most > 0.0)
        dips(s, which, d, 1.0, near, end, found);
    if (least < 0.0)
        dips(s, which, d, -1.0, near, end, found);
}

/* Close the bracket in on the root of a comparison, a little before which the guard may hold,
 * because rounding counts as zero, or a little after, where it is strict. */
static void around(search *s, int g, double *low, double root_, double *high)
{
    double reach = 4.0 * spacing(root_), at = root_ - reach;
    if (holds(s, g, root_)) {
        double yes = root_;
        for (; at > *low && !s->failed && holds(s, g, at); at = root_ - reach) {
            yes = at;
            reach *= 2.0;
        }
        *low = fmax(at, *low);
        *high = yes;
        return;
    }
    double no = root_;
    for (at = root_ + reach; at < *high && !s->failed && !holds(s, g, at); at = root_ + reach) {
        no = at;
        reach *= 2.0;
    }
    *low = no;
    *high = fmin(at, *high);
}

/* The first instant in (low, high] at which guard g holds; it does at high. */
static double bracket(search *s, int g, double low, double high)
{
    const int first = s->m->guard_atoms[g], stop = s->m->guard_atoms[g + 1];
    int turned = 0, which = 0, crosses = 0;
    for (int a = first; a < stop; ++a) {
        const double before = atom(s, a, low), after = atom(s, a, high);
        if ((before > 0.0) != (after > 0.0) || before * after == 0.0) {
            ++turned;
            which = a;
            crosses = before != 0.0 && before * after <= 0.0;
        }
    }
    if (turned == 1 && crosses)
        around(s, g, &low, root(s, which, low, high), &high);
    const double wide = 4.0 * spacing(fmax(fabs(low), fabs(high)));
    while (high - low > wide && !s->failed) {
        const double middle = 0.5 * (low + high);
        if (holds(s, g, middle))
            high = middle;
        else
            low = middle;
    }
    return high;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The roots of an atom on both sides of an extremum beyond zero between samples: another comparison
 * may hold on one side of it only. */
static void beside(search *s, int a, double c, instants *marks)
{
    int after = 0;
    while (after < HB_SAMPLES && s->t[after] < c)
        ++after;
    if (after == 0 || after == HB_SAMPLES || s->t[after] == c)
        return;
    const double low = s->t[after - 1], high = s->t[after], middle = atom(s, a, c);
    if (atom(s, a, low) * middle < 0.0)
        keep(s, marks, root(s, a, low, c));
    if (atom(s, a, high) * middle < 0.0)
        keep(s, marks, root(s, a, c, high));
}

/* The first instant of the block at which guard g holds, infinity if none; `before` is one at which
 * another guard does. */
static double of_rule(search *s, int g, const double *truth, const double *atoms, double before)
{
    const int first = s->m->guard_atoms[g], stop = s->m->guard_atoms[g + 1];
    const double *t = s->t;
    double end = INFINITY;
    instants found = {.count = 0};
    /* unless it holds and ceases to before that, it becomes true later than the other guard */
    if (before < INFINITY && !holds(s, g, before))
        end = before;
    for (int i = 1; i < HB_SAMPLES; ++i)
        if (truth[i] != 0.0)
            keep(s, &found, t[i]);
    instants marks = {.count = 0};
    for (int a = first; a < stop; ++a) {
        const int begin = found.count;
        extrema(s, a, atoms + a * HB_SAMPLES, end, &found);
        for (int k = begin; stop - first > 1 && k < found.count; ++k)
            beside(s, a, found.at[k], &marks);
    }
    if (stop - first > 1) {
        /* a window between two crossings may be narrower than the sampling: ask halfway between
         * any two neighbouring roots */
        for (int a = first; a < stop; ++a)
            for (int i = 0; i + 1 < HB_SAMPLES && !s->failed; ++i) {
                const double *d = atoms + a * HB_SAMPLES + i;
                if (((d[0] > 0.0 && d[1] < 0.0) || (d[0] < 0.0 && d[1] > 0.0)) && t[i] < end)
                    keep(s, &marks, root(s, a, t[i], t[i + 1]));
            }
        if (marks.count) {
            for (int i = 0; i < marks.count; ++i)
                keep(s, &found, marks.at[i]);
            for (int i = 0; i < HB_SAMPLES; ++i)
                keep(s, &marks, t[i]);
            qsort(marks.at, (size_t)marks.count, sizeof *marks.at, ascending);
            for (int i = 0; i + 1 < marks.count; ++i)
                if (marks.at[i + 1] - marks.at[i] > 0.0)
                    keep(s, &found, 0.5 * (marks.at[i] + marks.at[i + 1]));
        }
    }
    qsort(found.at, (size_t)found.count, sizeof *found.at, ascending);
    for (int k = 0; k < found.count && !s->failed; ++k) {
        const double c = found.at[k];
        /* true at c: it may have become so at any time after the candidate before */
        double low = t[0];
        for (int i = 0; i < HB_SAMPLES; ++i)
            if (t[i] < c)
                low = fmax(low, t[i]);
        for (int i = 0; i < k; ++i)
            if (found.at[i] < c)
                low = fmax(low, found.at[i]);
        if (c >= end || low >= before)
            break;
        if (c > s->t0 && holds(s, g, c))
            return bracket(s, g, low, c);
    }
    return INFINITY;
}

/* What the samples of an atom look like; `turn` is about when it changes sign. */
static int calm(const search *s, const double *d, double *rest, int *doubtful, double *turn)
{
    const hb_sampling *p = s->sampling;
    double least = d[0], most = d[0], size = 0.0;
    *rest = 0.0;
    *turn = INFINITY;
    for (int i = 0; i < HB_SAMPLES; ++i) {
        double sum = 0.0;
        for (int j = 0; j < HB_SAMPLES; ++j)
            sum += p->left_over[i * HB_SAMPLES + j] * d[j];
        *rest = fmax(*rest, fabs(sum));
        least = fmin(least, d[i]);
        most = fmax(most, d[i]);
        size = fmax(size, fabs(d[i]));
    }
    const double spread = most - least, up = d[0] > 0.0 ? 1.0 : d[0] < 0.0 ? -1.0 : 0.0;
    *doubtful = *rest > p->unresolved * spread && *rest > p->rounding * size;
    for (int i = 1; i < HB_SAMPLES; ++i)
        if (up * d[i] < 0.0) {
            const double share = d[i - 1] / (d[i - 1] - d[i]);
            *turn = p->fractions[i - 1] + share * (p->fractions[i] - p->fractions[i - 1]);
            break;
        }
    if (size == 0.0)
        return 1;
    double low = up > 0.0 ? least : up < 0.0 ? -most : 0.0;
    const double bound = p->near_zero * spread + 3.0 * *rest;
    if (low <= bound)
        return 0;
    if (low - p->overshoot * spread > bound)
        return 1; /* the polynomial strays no further from its samples */
    for (int i = 0; i < HB_GRID && low > bound; ++i) {
        double sum = 0.0;
        for (int j = 0; j < HB_SAMPLES; ++j)
            sum += p->fine[i * HB_SAMPLES + j] * d[j];
        low = fmin(low, up * sum);
    }
    return low > bound;
}

/* Sample all guards of the block s->t; 0 if one has no value. */
static int sample(search *s, double *atoms, double *truth)
{
    const hb_mode *m = s->m;
    for (int k = 0; k < HB_SAMPLES && !s->failed; ++k) {
        look(s, s->t[k]);
        for (int g = 0; g < m->guards; ++g)
            truth[g * HB_SAMPLES + k] =
                hb_evaluate(m->code + m->guard_test[g], m->constants, s->o->v);
        for (int a = 0; a < m->guard_atoms[m->guards]; ++a) {
            const double value = hb_evaluate(m->code + m->atom_code[a], m->constants, s->o->v);
            s->failed |= !isfinite(value);
            atoms[a * HB_SAMPLES + k] = value;
        }
    }
    return !s->failed;
}

/* Whether what the polynomial leaves of an atom's samples is but the rounding of its terms. */
static int rounding(search *s, int a, double rest)
{
    const hb_mode *m = s->m;
    double *v = s->o->v, largest = 0.0;
    look(s, s->t[0]);
    for (int i = 0; i < m->spread; ++i)
        s->work->magnitudes[m->spread_slot[i]] =
            hb_size(m, s->o, s->work, m->spread_slot[i], sqrt(s->o->run_energy));
    for (int k = 0; k < HB_SAMPLES && !s->failed; ++k) {
        look(s, s->t[k]);
        for (int i = 0; i < m->spread; ++i) {
            const int32_t slot = m->spread_slot[i];
            v[slot] = fmax(fabs(v[slot]), s->work->magnitudes[slot]);
        }
        largest = fmax(largest, hb_evaluate(m->code + m->size_code[a], m->constants, v));
    }
    return largest * 1e-13 >= rest;
}

int hb_locate(const hb_mode *m, hb_motion *o, hb_work *work, const hb_sampling *sampling, double t1,
              const double *dense, double *at)
{
    const int atoms = m->guard_atoms[m->guards];
    search s = {m, o, work, sampling, dense, o->t, t1, {0}, 0};
    struct {
        double low, high;
        int depth;
    } blocks[DEEPEST + 2] = {{o->t, t1, 0}};
    int left = m->guards ? 1 : 0;
    while (left) {
        const double low = blocks[--left].low, high = blocks[left].high;
        const int depth = blocks[left].depth;
        for (int k = 0; k < HB_SAMPLES; ++k)
            s.t[k] = low + (high - low) * sampling->fractions[k];
        s.t[HB_SAMPLES - 1] = high;
        double *d = work->atoms, *truth = d + atoms * HB_SAMPLES;
        double *turns = truth + m->guards * HB_SAMPLES, *quiet = turns + m->guards;
        if (!sample(&s, d, truth))
            return -1;
        int halve = 0;
        for (int g = 0; g < m->guards; ++g) {
            turns[g] = INFINITY;
            quiet[g] = 1.0;
            for (int a = m->guard_atoms[g]; a < m->guard_atoms[g + 1] && !halve; ++a) {
                double rest, turn;
                int doubtful;
                if (!calm(&s, d + a * HB_SAMPLES, &rest, &doubtful, &turn))
                    quiet[g] = 0.0;
                turns[g] = fmin(turns[g], turn);
                halve = doubtful && depth < DEEPEST && !rounding(&s, a, rest);
            }
            for (int k = 0; k < HB_SAMPLES; ++k)
                if (truth[g * HB_SAMPLES + k] != 0.0)
                    quiet[g] = 0.0;
        }
        if (s.failed)
            return -1;
        if (halve) {
            const double middle = 0.5 * (low + high);
            blocks[left].low = middle;
            blocks[left].high = high;
            blocks[left++].depth = depth + 1;
            blocks[left].low = low;
            blocks[left].high = middle;
            blocks[left++].depth = depth + 1;
            continue;
        }
        double found = INFINITY;
        for (;;) {
            /* the likeliest first: the others then need no more than a look */
            int next = -1;
            for (int g = 0; g < m->guards; ++g)
                if (quiet[g] == 0.0 && (next < 0 || turns[g] < turns[next]))
                    next = g;
            if (next < 0)
                break;
            quiet[next] = 1.0;
            found = fmin(found, of_rule(&s, next, truth + next * HB_SAMPLES, d, found));
            if (s.failed)
                return -1;
        }
        if (found < INFINITY) {
            *at = found;
            return 1;
        }
    }
    return 0;
}
