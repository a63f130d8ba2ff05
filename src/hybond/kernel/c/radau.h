/* A step of Radau IIA that is tried: what its iteration (stages.c) and its control (radau.c) share. */
#ifndef HYBOND_RADAU_H
#define HYBOND_RADAU_H

#include "hybond.h"

enum { STAGES = 3, ITERATIONS = 7 };
#define S6 2.449489742783178
static const double C[STAGES] = {(4.0 - S6) / 10.0, (4.0 + S6) / 10.0, 1.0};
static const double REAL = 3.63783425274449573; /* the real eigenvalue of the inverse of A */

/* Of the Jacobian in memory: kept from a step before, or made where this one starts. */
enum { NONE, KEPT, CURRENT };
/* How an iteration ended. */
enum { BEYOND, FAILED, CONVERGED };

/* Rows of `all` states: derivatives and states of the stages, derivative at the end; differences of the
 * stages from the start, corrections of them, coefficients of the dense output. */
typedef struct {
    const hb_mode *m;
    hb_motion *o;
    hb_work *work;
    hb_memory *memory;
    int n, all;                                     /* states that are solved for; of all */
    double *f, *y, *end, *z, *last, *polynomial, *tolerance, *real, *re, *im;
    double t1, h, trial;                            /* trial: before the end of time cut it */
    double size, rate, left, error;                 /* the first three as in `Stages` */
    int iterations;
} hb_attempt;

/* Whether none is infinite or not a number. */
int hb_finite(int n, const double *x);

/* The weighted sum of three rows. */
void hb_combine(int n, int stride, const double *weight, const double *rows, double *restrict sum);

/* The root mean square of rows in units of the tolerance, nothing in units of nothing being 0. */
double hb_mean(const hb_attempt *a, int rows, const double *x, const double *tolerance);

/* The rate of y; 0 if there is none that is finite. */
int hb_rate_at(const hb_attempt *a, double t, const double *y, double *f);

/* When a stage is. */
double hb_time_of(const hb_attempt *a, int stage);

/* Factors for a step of about this size; 0 if there are none. */
int hb_factorise(const hb_attempt *a);

/* Begin with the stages that the last step foresees; `origin`: 1 if it ends where this one starts, 0 if
 * both start there. Then iterate until the error left is negligible, or until it is clear that it will
 * not be. */
int hb_iterate(hb_attempt *a, double origin);

#endif
