/* A Cockcroft-Walton ladder of ideal diodes and equal capacitors on a sine. All its voltages are
   linear in the source's between two events, so it needs no steps: which diodes conduct is found
   by turning those that are violated, and what a set of them does is kept.
   Given: diodes, periods, points. Found: events, sets that were met, voltage of the last node. */
#include "limit.h"

enum { ROOM = 1 << 14 };

static const double pi = 3.14159265358979323846, VOLT = 100, PERIOD = 0.02;

/* What a set of conducting diodes does per volt of the source: their charges, and the growth of
   the reverse voltage of the others. */
typedef struct known {
    unsigned char *set;
    double *charge, *growth;
    struct known *next;
} known;

typedef struct {
    int n, kept;
    double *elastance, *lift;
    known **table;
} ladder;

/* Inverse of the matrix of node capacitances, seen by the diodes, by elimination; O(n^3) once. */
static ladder built(int n)
{
    ladder l = {.n = n};
    double *c = calloc((size_t)n * (size_t)n, sizeof *c);
    double *inverse = calloc((size_t)n * (size_t)n, sizeof *c);
    for (int k = 0; k < n; ++k) {
        inverse[k * n + k] = 1;
        c[k * n + k] += 1;
        if (k > 1) {
            c[(k - 2) * n + k - 2] += 1;
            c[(k - 2) * n + k] -= 1;
            c[k * n + k - 2] -= 1;
        }
    }
    for (int k = 0; k < n; ++k) {
        const double pivot = 1 / c[k * n + k];
        for (int j = 0; j < n; ++j) {
            c[k * n + j] *= pivot;
            inverse[k * n + j] *= pivot;
        }
        for (int i = 0; i < n; ++i) {
            const double factor = c[i * n + k];
            if (i == k || factor == 0)
                continue;
            for (int j = 0; j < n; ++j) {
                c[i * n + j] -= factor * c[k * n + j];
                inverse[i * n + j] -= factor * inverse[k * n + j];
            }
        }
    }
#define AT(i, j) ((i) < 0 || (j) < 0 ? 0 : inverse[(i) * n + (j)])
    l.elastance = calloc((size_t)n * (size_t)n, sizeof *c);
    l.lift = calloc((size_t)n, sizeof *c);
    for (int i = 0; i < n; ++i) {
        l.lift[i] = AT(i, 0) - AT(i - 1, 0);
        for (int j = 0; j < n; ++j)
            l.elastance[i * n + j] = AT(i, j) - AT(i - 1, j) - AT(i, j - 1) + AT(i - 1, j - 1);
    }
#undef AT
    l.table = calloc(ROOM, sizeof *l.table);
    free(c);
    free(inverse);
    return l;
}

static void dropped(ladder *l)
{
    for (int i = 0; i < ROOM; ++i)
        for (known *k = l->table[i], *next; k; k = next) {
            next = k->next;
            free(k->set);
            free(k->charge);
            free(k);
        }
    free(l->table);
    free(l->elastance);
    free(l->lift);
}

/* Cholesky of the conducting part, and both substitutions. */
static void answer(const ladder *l, known *k)
{
    const int n = l->n;
    int *at = malloc((size_t)n * sizeof *at), size = 0;
    for (int i = 0; i < n; ++i)
        if (k->set[i])
            at[size++] = i;
    double *a = malloc((size_t)(size * size + size + 1) * sizeof *a), *b = a + size * size;
    for (int i = 0; i < size; ++i) {
        double sum = -l->lift[at[i]];
        for (int j = 0; j <= i; ++j) {
            double entry = l->elastance[at[i] * n + at[j]];
            for (int p = 0; p < j; ++p)
                entry -= a[i * size + p] * a[j * size + p];
            a[i * size + j] = i == j ? sqrt(entry) : entry / a[j * size + j];
        }
        for (int p = 0; p < i; ++p)
            sum -= a[i * size + p] * b[p];
        b[i] = sum / a[i * size + i];
    }
    for (int i = size - 1; i >= 0; --i) {
        for (int p = i + 1; p < size; ++p)
            b[i] -= a[p * size + i] * b[p];
        b[i] /= a[i * size + i];
    }
    for (int i = 0; i < n; ++i) {
        k->charge[i] = 0;
        k->growth[i] = l->lift[i];
        for (int p = 0; p < size; ++p)
            k->growth[i] += l->elastance[i * n + at[p]] * b[p];
    }
    for (int p = 0; p < size; ++p) {
        k->charge[at[p]] = b[p];
        k->growth[at[p]] = 0;
    }
    free(a);
    free(at);
}

static known *find(ladder *l, const unsigned char *set)
{
    const size_t n = (size_t)l->n;
    unsigned hash = 2166136261u;
    for (size_t i = 0; i < n; ++i)
        hash = (hash ^ set[i]) * 16777619u;
    known **place = l->table + hash % ROOM;
    for (known *k = *place; k; k = k->next)
        if (!memcmp(k->set, set, n))
            return k;
    known *k = malloc(sizeof *k);
    k->set = memcpy(malloc(n), set, n);
    k->charge = malloc(2 * n * sizeof(double));
    k->growth = k->charge + n;
    k->next = *place;
    answer(l, k);
    l->kept++;
    return *place = k;
}

/* Turns what is violated, of the diodes that bear no voltage; one at a time if that goes on. */
static const known *settled(ladder *l, unsigned char *set, const double *reverse, double way)
{
    for (int i = 0; i < l->n; ++i)
        set[i] = set[i] && reverse[i] <= 0;
    for (int turn = 0;; ++turn) {
        const known *k = find(l, set);
        int turned = 0;
        for (int i = l->n - 1; i >= 0 && !(turned && turn > 20); --i) {
            const int bad = set[i] ? way * k->charge[i] < -1e-12
                                   : reverse[i] <= 0 && way * k->growth[i] < -1e-12;
            set[i] ^= (unsigned char)bad;
            turned += bad;
        }
        if (!turned)
            return k;
    }
}

static double when(double u, double way, int half)
{
    const double angle = asin(fmin(fmax(u / VOLT, -1), 1));
    return (way > 0 ? angle + pi * half : pi * half - angle) * PERIOD / (2 * pi);
}

static int run(const double *given, double *found)
{
    const int n = (int)given[0];
    const double end = given[1] * PERIOD;
    ladder l = built(n);
    journal j = opened(n, end, given[2], 1, (const int[]){0});
    double *reverse = calloc((size_t)n, sizeof *reverse), u = 0, t = 0, top = 0;
    unsigned char *set = calloc((size_t)n, 1);
    for (int half = 0; t < end; ++half) { /* from one turn of the source to the next */
        const double way = half % 2 ? -1 : 1;
        while (t < end) {
            const known *k = settled(&l, set, reverse, way);
            double distance = VOLT - way * u, rise = 0;
            for (int i = 0; i < n; ++i)
                if (!set[i] && way * k->growth[i] < -1e-12)
                    distance = fmin(distance, -reverse[i] / (way * k->growth[i]));
            const int turns = distance >= VOLT - way * u;
            double next = turns ? VOLT * way : u + way * distance, then = when(next, way, half);
            if (turns)
                then = (half + 0.5) * PERIOD / 2;
            if (then >= end) {
                next = VOLT * sin(2 * pi * end / PERIOD);
                then = end;
            }
            for (int i = 0; i < n; ++i)
                rise += k->growth[i];
            for (double at; j.points < j.most && (at = (double)j.points * j.spacing) <= then;)
                j.point[j.points++] = top + rise * (VOLT * sin(2 * pi * at / PERIOD) - u);
            for (int i = 0; i < n; ++i) {
                reverse[i] += k->growth[i] * (next - u);
                if (reverse[i] < 1e-10 * VOLT)
                    reverse[i] = 0;
            }
            top += rise * (next - u);
            u = next;
            t = then;
            record(&j, t, turns, reverse);
            if (turns)
                break;
        }
    }
    found[0] = (double)j.events;
    found[1] = l.kept;
    found[2] = top;
    free(reverse);
    free(set);
    dropped(&l);
    closed(&j);
    return 3;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, run);
}
