/* A branch of equilibria over one parameter p as a curve in its unknowns, and pseudo-arclength steps along it:
   solver/branches/equilibrium_curve.py and numerics/arclength.py. */

#ifndef ROD_BRANCH_POINTS_H
#define ROD_BRANCH_POINTS_H

#include "branches.h"
#include "orbit_rates.h"

enum { KEPT = 4, UNKNOWNS = 7, EQUATIONS = UNKNOWNS - 1, GIVEN = 5 };
enum { FAILED = 100, INTERRUPTED }; /* besides NO_MEMORY and NOT_POSSIBLE; INTERRUPTED: the caller has raised */

/* What the caller is asked: the problem at a value of the parameter p. Under dead loads its six numbers, lam, mu, phi,
   span, beta(0) and beta(L); with held ends the five given numbers, span and A/C. NaN until they are given. */
typedef struct {
    double p, numbers[GIVEN + 2];
} question;

enum { RAISED, THERE, NOWHERE }; /* what it answers; RAISED also where an exception ends it before it answers */
typedef int problem_at(question *);

/* The parameter: its scale, the values at which to halt (rising, the ends of the range among them), and when two values
   are one. */
typedef struct {
    double scale, low, high, rounding;
    int64_t count;
    const double *halts;
} range;

/* A point of the branch, w = (x, p) over their scales, and with held ends the two angles and the three loads over
   theirs: `arclength.Node` and the curve's chart. The jacobian has as many columns as there are unknowns. */
typedef struct {
    double w[UNKNOWNS], jacobian[EQUATIONS * UNKNOWNS], tangent[UNKNOWNS], sign, bend, ahead;
    chart chart;
} point;

/* Held ends: the places of the given numbers among those of orbit_rates.h, and the scale of the loads. */
typedef struct {
    int64_t given[GIVEN];
    double loads;
} held_ends;

/* The problems over p; raised: whether the caller was interrupted, and is asked no more. held: NULL under dead loads. line: the problems at p = 0 and p = 1 of a line under dead loads, in
   place of `problem`; along it p only rises. at, known: the last few problems under dead loads. numbers, rates: of the
   last point with held ends. */
typedef struct {
    problem_at *problem;
    int raised;
    const ends_problem *line;
    const range *over;
    const held_ends *held;
    const grid *by;
    const points *nodes;
    cutting times, orbits;
    search room;
    int newest;
    double at[KEPT];
    place known[KEPT];
    orbit_numbers numbers;
} family;

static inline int unknowns_of(const family *f) { return f->held ? UNKNOWNS : 2; }

/* The problem under dead loads at p. */
int rod_curve_problem(family *, double p, const place **);
/* The problem and the path at a point. */
int rod_curve_place(family *, const point *, place *, path *);
/* The lengths at (x, p) less that of the rod, under dead loads. */
int rod_curve_excess(family *, const chart *, int count, const double *x, double p, double *off);
/* The derivatives of the excess by w at a point under dead loads. */
int rod_curve_jacobian(family *, point *);
/* The point of the curve in the plane through a guess with the normal `across`, with held ends also the jacobian there;
   from: a point near it. */
int rod_curve_corrected(family *, const point *from, const double *guess, const double *across, point *out);
/* Gauss's elimination of a square matrix of n rows with some right hand sides behind its columns; the determinant's
   sign, 0 where it is singular. */
int rod_eliminated(int n, int columns, double *matrix);

#endif
