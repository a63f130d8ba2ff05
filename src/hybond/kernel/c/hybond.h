/* The kernel of hybond: what every file of it shares.
 *
 * Everything is plain data made by the Python side (kernel/plan.py), and stays owned by it: the
 * kernel reads modes, moves a motion on, and gives up (declines) on whatever it was not made for,
 * with the motion as it was before the step in question.
 */
#ifndef HYBOND_H
#define HYBOND_H

#include <stddef.h>
#include <stdint.h>

/* Instructions of expressions, those of one value from HB_SIN to HB_CEIL; kernel/bytecode.py has the
 * same list in the same order. */
enum hb_op {
    HB_END, HB_CONST, HB_SLOT, HB_ADD, HB_SUB, HB_MUL, HB_DIV, HB_POW, HB_NEG, HB_SQUARE,
    HB_LT, HB_LE, HB_GT, HB_GE, HB_EQ, HB_NE, HB_NOT, HB_TRUTH, HB_SKIP, HB_SKIP_UNLESS, HB_SKIP_IF,
    HB_SIN, HB_COS, HB_TAN, HB_ASIN, HB_ACOS, HB_ATAN, HB_SINH, HB_COSH, HB_TANH,
    HB_EXP, HB_LOG, HB_LOG10, HB_SQRT, HB_ABS, HB_SIGN, HB_FLOOR, HB_CEIL,
    HB_ATAN2, HB_HYPOT, HB_MOD, HB_MIN, HB_MAX, HB_TABLE
};

/* Where guards are looked at within a step, and what counts as quiet: modes/locate.py. */
enum { HB_SAMPLES = 9, HB_GRID = 65 };

typedef struct {
    const double *fractions;  /* HB_SAMPLES */
    const double *left_over;  /* HB_SAMPLES x HB_SAMPLES */
    const double *fine;       /* HB_GRID x HB_SAMPLES */
    double unresolved, near_zero, rounding;
    double overshoot;         /* how far `fine` strays beyond the samples, in parts of their spread */
} hb_sampling;

/* Sparse rows: entry k of row i has first[i] <= k < first[i + 1]. */
typedef struct {
    const int32_t *first, *column;
    const double *value;
} hb_rows;

/* One mode. Expressions are places in `code`; rows are those of the bond variables that something
 * reads; equal ones share a row. */
typedef struct {
    int32_t slots, storages, signals, inputs;
    int32_t stored_slot, signal_slot, input_slot, input_rate_slot;
    int32_t knowns, rows, free, values, entries, affine;
    int32_t laws, sources, spread, supplied, dissipated, guards, outputs, slopes;
    int32_t constraints, agreements, loose;
    int32_t bonds, bond_slot, machines, rules, flag_count, flag_slot;
    int32_t fieldless, enterable, ports, points;
    int32_t flow, moved, watched;                   /* flow: size of z in z' = M z; 0: none */
    double cost;                                    /* of a step, in operations, about */
    double flow_norm, flow_unit;                    /* of M, balanced; about its inverse, s */
    const int32_t *code;
    const double *constants;
    hb_rows co_energy;                              /* storages x storages */
    const int32_t *law_at, *law_code;               /* nonlinear storage: co-energy variables */
    const double *known;                            /* knowns that are constants, else 0 */
    const int32_t *source_at, *source_code;         /* knowns that are expressions */
    hb_rows solved;                                 /* rows x knowns */
    const double *by_free;                          /* rows x free */
    hb_rows measured;                               /* rows x knowns: whose terms make the size, */
    hb_rows shares;                                 /* loose x knowns: what leakage sets */
    const double *by_share;                         /* rows x loose */
    const int32_t *spread_row, *spread_slot;        /* rows to slots that are read */
    const int32_t *row_of;                          /* slots: rows, or -1 */
    const int32_t *value_code;                      /* dynamic rows: zero at the solution */
    const double *slope;                            /* values x free, constant part */
    const int32_t *entry_at, *entry_code;           /* slopes that vary: the dynamic row of each */
    const double *entry_by_free;                    /* entries x free */
    const int32_t *rate_row;                        /* storages */
    const double *rate_sign;
    const int32_t *signal_code;
    const int32_t *supplied_e, *supplied_f, *dissipated_e, *dissipated_f;
    const double *supplied_sign, *dissipated_sign;
    const int32_t *guard_test, *guard_atoms;        /* guards, guards + 1 */
    const int32_t *atom_code, *size_code;           /* differences, and sizes of their terms */
    const double *seen;                             /* rows, with a unit of energy in one storage */
    const int32_t *output_code;                     /* asked for at the end of each step */
    const double *stiffness;                        /* storages, constant part */
    const int32_t *slope_at, *slope_code;           /* nonlinear storage: stiffness */
    hb_rows constraint, agreement;                  /* constraints, agreements: of knowns */
    const double *known_reach, *stored_reach;       /* knowns, storages: with a unit of energy */
    const double *put_back;                         /* storages x constraints */
    const double *weighed;                          /* storages: 1 if laws ask for its energy */
    /* settling: */
    const int32_t *state;                           /* machines */
    const double *flags;                            /* Booleans of the mode, from flag_slot on */
    const int32_t *rule_machine, *rule_target;      /* rules that leave it, in order */
    const int32_t *rule_code;
    const int32_t *contact_code;                    /* what each impact law reads, at rest */
    hb_rows kick;                                   /* bonds x constraints: impulses */
    const double *point, *weight;                   /* points: Gauss's, for energies */
    double *guess;                                  /* free: where Newton ended last, written */
    /* junction laws, in the branch that this mode has of each */
    const int32_t *port_machine, *port_turn;        /* the other branch */
    const int32_t *port_gate, *port_adrift;         /* -1: none; 1, 2: it blocks, carries a share */
    const int32_t *port_drifts;                     /* whether it may come to block one */
    /* what must be positive in these branches, then what is zero on surfaces, and their rates */
    const int32_t *sense_code, *sense_push;         /* push: what sources add; -1: not known */
    hb_rows sense;                                  /* x storages: of co-energy variables */
    /* exact propagation: z are components of the state, then generators */
    hb_rows flow_matrix;                            /* of z / flow_scale */
    const double *flow_scale;
    const int32_t *moved_at, *along;                /* components that z begins with; all others */
    const int32_t *generator_code, *watched_at;     /* watched: of z, those that powers read */
    double *levels;                                 /* exponentials less I for 2^k units, written */
    int32_t *levels_known;
} hb_mode;
enum { HB_LEVELS = 60 };

/* What an implicit method keeps from one step to the next, of a mode with n states beside the energies.
 * Matrices are kept column after column. */
typedef struct {
    double left;                                    /* error that the last iteration left */
    double span;                                    /* the step of `polynomial`; 0: none */
    double served;                                  /* the step that the factors are of; 0: none */
    int32_t matrix, slow;                           /* the Jacobian, and whether it is outdated */
    int32_t first;                                  /* no step before the last told of its error */
    double *jacobian, *real, *re, *im;              /* n x n: itself, and factors for a step */
    int32_t *real_row, *pair_row;                   /* n: of their pivots */
    double *polynomial;                             /* 3 x states: of x, x^2, x^3 */
} hb_memory;

/* A motion under way: read and written. States are stored quantities, signals, energy supplied,
 * energy dissipated. */
typedef struct {
    double t, h, energy;
    double error_before, h_before;                  /* of the last step that tells of the next */
    double max_step, rtol, atol;                    /* atol: nan if none is given */
    double negligible, idle;
    double run_energy, instant;                     /* seen by the run; what is one instant, s */
    int64_t evaluations;
    int32_t controlled;
    int32_t method;                                 /* one of METHODS in method.c */
    double *y, *f, *largest, *free, *rounding;
    const double *input, *input_rate, *input_time;  /* at which `input` holds */
    double *v;                                      /* 2 slots: flags written, the rest is work */
    hb_memory memory;                               /* only with a method that needs it */
} hb_motion;

/* What a march leaves behind, one row a step. */
typedef struct {
    double *t, *y, *outputs;                        /* what it came to */
    double *stop, *end, *dense;                     /* the step: its end, 4 x states of x ... x^4 */
    int32_t *rejected;
} hb_trail;

/* What the modes of a graph have in common, and those that are known. */
typedef struct {
    int32_t modes, machines, states, storages, signals, inputs, slots, bonds, classes;
    int32_t ats, at_slot, surfaces, most_writes;
    double until, event_tol, rounded;               /* Limits; ErrorScale.start */
    double remaining, soonest, moment;              /* modes/landing: what may be a landing */
    double slow, lively, fading, at_once, vanished;
    const hb_mode *const *mode;                     /* null where a mode is not for the kernel */
    const int32_t *bond_class, *storage_class;      /* whose impulses are compared with whose */
    const int32_t *store_slot;                      /* storages: bond variables that show them */
    const double *store_sign, *real;                /* real: 1 if it stores energy */
    const int32_t *contact_of;                      /* machines x states: impact laws, or -1 */
    const int32_t *rests_in;                        /* contacts x states */
    const int32_t *ready;                           /* contacts whose reactions are known */
    const int32_t *surface_machine, *below, *above; /* surfaces: states on either side */
    double *since, *speed;                          /* machines: last impact, fastest approach */
} hb_atlas;

/* Intervals between timed events, one after the other. */
typedef struct {
    int32_t count;
    const double *end, *at, *input, *rate, *time;
} hb_schedule;

/* What a run leaves behind: a row for each segment that ended, with the instant that ended it. */
typedef struct {
    double *t, *before, *after, *energy, *approach; /* approach: machines, nan if not struck */
    int32_t *steps, *mode, *interval, *timed, *changed;
    int32_t *struck;                                /* whether an impulse was written */
    int32_t *fired;                                 /* machines */
    int32_t *wanted;                                /* machines: a mode that was not known */
    double last;                                    /* time of the last event */
    int32_t rows;
} hb_log;

/* Why a march or a run ends. */
enum { HB_ARRIVED, HB_FULL, HB_EVENT, HB_UNSURE, HB_DECLINED, HB_NO_MEMORY, HB_UNKNOWN };

double hb_evaluate(const int32_t *code, const double *constants, const double *v);

/* A value at a jump: finite part, impulse, what it was; sizes of the terms of the first two. */
typedef struct {
    double finite, impulse, before, size, impulse_size;
} hb_pair;

/* All signals at an instant: `slots` of each; impulse may be null if there are none. Sizes that are
 * null are found when they are asked for, from the last hb_solve; `reach` is as in hb_size. */
typedef struct hb_work hb_work;
typedef struct {
    const double *finite, *before, *impulse, *size;
    int32_t slots;
    const hb_mode *m;
    const hb_motion *o;
    const hb_work *work;
    double reach;
} hb_signals;

/* An expression of them; 0 if it has no meaning. */
int hb_paired(const int32_t *code, const double *constants, const hb_signals *signals,
              hb_pair *result);

int hb_impulsive(const hb_pair *a);

/* -1, 0 or 1, the impulse first; 2 for what is not a number. */
int hb_sign(const hb_pair *a);

/* The truth of a guard; -1 if it has no meaning. */
int hb_holds(const int32_t *code, const double *constants, const hb_signals *signals);

/* Work space of one march. */
struct hb_work {
    double *known, *w, *jacobian, *step;             /* one evaluation */
    double *k, *y1, *trial, *tolerance, *error;      /* one step */
    double *sampled, *atoms, *magnitudes;      /* guards */
    double *kept, *residuals, *dense, *guess;        /* constraints; the step to an event; Newton */
    double *met;                                     /* residuals taken away so far */
    double *began;                                   /* where Newton began */
    double *stages;                                  /* 13 x states: a step of radau */
    double *flow;                                    /* exact propagation */
    void *all;
};

/* Room for any of some modes; 0 if there is none. */
int hb_reserve(hb_work *work, const hb_mode *const *modes, int count);

/* The knowns at (t, y), in work->known; values but for bond variables. */
void hb_known(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y);

/* Bond variables at (t, y), written to the slots that are read; 0 if Newton does not converge. */
int hb_solve(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y);

/* The rate of y; 0 as above. */
int hb_rate(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y, double *rate);

/* A way to make steps. `begin` chooses the first step after a jump, no longer than `limit`; `step` makes
 * one that is accepted, to *t1 <= t_end, and sets o->h for the next; `retry` makes one to t1 as it
 * comes. Both leave the state at the end in work->y1, its rate in row 6 of work->k, and what `dense`
 * needs, which writes the coefficients of the step's dense output, 4 x states. 0: there is none. */
typedef struct {
    int (*begin)(const hb_mode *m, hb_motion *o, hb_work *work, double limit);
    int (*step)(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
                int32_t *rejected);
    int (*retry)(const hb_mode *m, hb_motion *o, hb_work *work, double t1);
    void (*dense)(const hb_mode *m, const hb_work *work, double h, double *dense);
} hb_method;
extern const hb_method hb_dopri, hb_radau, hb_exact;

/* One step under the control of solvers/dopri.py. An attempt returns the norm of the error of a step to
 * t1, nan if something is not finite. */
typedef double hb_trial(const hb_mode *m, hb_motion *o, hb_work *work, double t1);
int hb_steered(hb_trial *attempt, const hb_mode *m, hb_motion *o, hb_work *work, double t_end,
               double *t1, int32_t *rejected);

/* What exact propagation works with in a mode: numbers in work->flow. */
size_t hb_exact_room(const hb_mode *m);

/* Those of the method of a motion. */
int hb_begin(const hb_mode *m, hb_motion *o, hb_work *work, double t_bound);
int hb_step(const hb_mode *m, hb_motion *o, hb_work *work, double t_end, double *t1,
            int32_t *rejected);
int hb_retry(const hb_mode *m, hb_motion *o, hb_work *work, double t1);
void hb_dense(const hb_mode *m, const hb_motion *o, const hb_work *work, double h, double *dense);

/* Stored quantities, signals, energy supplied and dissipated. */
int hb_states(const hb_mode *m);

/* What one step may be wrong by: `ErrorScale` of simulation.py. */
void hb_tolerances(const hb_mode *m, hb_motion *o, const double *y0, const double *y1,
                   double *tolerance);

/* The norm of a vector in units of the tolerances. */
double hb_norm(const hb_mode *m, const hb_motion *o, const double *vector,
               const double *tolerance);

/* The first step of a method of an order. */
double hb_first_step(const hb_mode *m, hb_motion *o, hb_work *work, double limit, double order);

/* Factors of a matrix, in place, and a system solved with them, in place; column after column. A complex
 * matrix has its real and imaginary parts apart. 0 if it is singular. */
int hb_factor(int n, double *a, int32_t *row);
void hb_unfactor(int n, const double *a, const int32_t *row, double *b);
int hb_factor_pair(int n, double *re, double *im, int32_t *row);
void hb_unfactor_pair(int n, const double *re, const double *im, const int32_t *row, double *br,
                      double *bi);

/* The size of the terms of a value of the last hb_solve. `reach` is what a unit of energy in one
 * storage weighs: 0 or the root of the energy of the run. */
double hb_size(const hb_mode *m, const hb_motion *o, const hb_work *work, int32_t slot,
               double reach);

/* The size of the terms of one row of the last hb_solve. */
double hb_row_size(const hb_mode *m, const hb_motion *o, const hb_work *work, int row);

/* Jump from what y stores onto the constraints of a mode: to work->kept, by the residuals in
 * work->met. 0 if there is no such jump; else whether impulses are more than rounding. */
enum { HB_STAYS = 1, HB_SWEPT, HB_JUMPS };
int hb_jump(const hb_mode *m, hb_motion *o, hb_work *work, double t, const double *y);

/* Put y back on the constraints; 0 if that is not possible. */
int hb_keep(const hb_mode *m, hb_motion *o, hb_work *work, double t, double *y, int *moved);

/* The state at the part x of a step. */
void hb_between(int n, const double *y0, const double *dense, double x, double *y);

/* The first instant in (t, t1] at which a guard holds: 1 and *at; 0 if none does; -1 in doubt. */
int hb_locate(const hb_mode *m, hb_motion *o, hb_work *work, const hb_sampling *sampling, double t1,
              const double *dense, double *at);

/* Let time pass in a mode: steps from row *count of the trail on, `most` at the most. */
int32_t hb_pass(const hb_mode *m, hb_motion *o, hb_work *work, const hb_sampling *sampling,
                double t_end, int32_t most, int32_t begins, hb_trail *trail, int32_t *count);

/* What settling works with. */
typedef struct {
    const hb_atlas *atlas;
    hb_motion *o;
    hb_work *work;
    const hb_schedule *schedule;
    const hb_log *log;
    double *here, *there, *impulse, *area, *largest; /* n; n; slots; bonds; classes */
    int32_t *target, *written, *slope;               /* machines; HB_WRITES modes; surfaces */
    int struck, jumped;                              /* impulses in the last entry, so far */
    int crowded;                                     /* the last event was but a moment ago */
    void *all;
} hb_settler;
enum { HB_WRITES = 32 };
int hb_settler_for(hb_settler *settler);

/* Inputs and comparisons of time in an interval; the Booleans of a mode. */
void hb_within(const hb_settler *s, int32_t interval);
void hb_show(const hb_mode *m, hb_motion *o);

/* The signals of the last hb_solve, a priori values included. */
hb_signals hb_signals_of(const hb_settler *s, const hb_mode *m, int jumped);

/* Enter a mode from what is stored `here`, which leads `there`: how, or 0 if it cannot be said. */
int hb_enter(hb_settler *s, const hb_mode *m, double t, int jump);
int32_t hb_lookup(const hb_settler *s);
int hb_branches(hb_settler *s, int32_t *now, double t, int jump, int stay, int32_t *fired);

/* The rate of what is followed, with the size of its terms (0 if it is not known), and its sign (0
 * also if it is not clear). */
int hb_rate_of(hb_settler *s, const hb_mode *m, int32_t p, double *rate, double *size);
int hb_trend(hb_settler *s, const hb_mode *m, int32_t p);

/* After an instant: whether no impact may have been the last, and whether a motion may slide. */
int hb_observe(hb_settler *s, const hb_mode *m, double t, const double *before, int writes,
               int32_t row);
void hb_approach(hb_settler *s, const hb_mode *m);
int hb_slides(hb_settler *s, const hb_mode *from, const hb_mode *m, double t, const double *y,
              int timed, const int32_t *fired);

/* Settle a mode at (t, y), between two intervals of the schedule; y is what is stored a priori, then
 * what is a posteriori. The reason why not, or HB_EVENT. */
int32_t hb_settle(hb_settler *s, double t, double *y, int32_t *mode, int32_t from, int32_t to,
                  int32_t row);

/* What Python calls: which sources this was built from, and a march (march.c). */
const char *hb_source(void);
int32_t hb_march(const hb_mode *m, hb_motion *o, const hb_sampling *sampling, double t_end,
                 int32_t most, int32_t begins, hb_trail *trail, int32_t *count);
int32_t hb_run(const hb_atlas *atlas, hb_motion *o, const hb_sampling *sampling,
               const hb_schedule *schedule, int32_t mode, int32_t most, int32_t rows, double budget,
               hb_trail *trail, hb_log *log);

#endif
