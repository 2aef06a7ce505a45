/* Equilibria of ends problems by their levels and paths: `boundary.Path`, `Boundary` and `Chart`. What the
   files about branches share: charts.c, branch_curves.c, branch_steps.c, orbit_rates.c. */

#ifndef ROD_BRANCHES_H
#define ROD_BRANCHES_H

#include "orbit_parts.h"

enum { UP = 1, DOWN = -1, CHARTS = CRITICAL + 4 };
enum { SADDLE_OF, START_OF, END_OF }; /* where the level of a chart is measured from */

typedef struct {
    double lam, mu, phi, span, beta0, betaL;
} ends_problem;

/* One equilibrium: `boundary.Path`. */
typedef struct {
    double pin, sign, y;
    int64_t leaving, turns;
} path;

/* nudge: of the coordinate, over which differences are taken: a small share of what changes the form of the orbit. */
typedef struct {
    int kind, logarithmic;
    double own, scale, nudge;
    path at;
} chart;

/* One ends problem with the critical points of its G. helix: whether there is a rod that is a helix from end to end. */
typedef struct {
    ends_problem p;
    critical found;
    double low, high, start, end;
    int rising, passed, helix;
    int64_t whole_turns;
} place;

static inline int64_t floored(int64_t a, int64_t b) { return a / b - (a % b != 0 && (a % b < 0) != (b < 0)); }

/* UP or DOWN at the start, or at the far end. */
static inline int direction(const path *one, int at_end)
{
    return (int)(at_end && one->turns % 2 ? -one->leaving : one->leaving);
}

static inline double coordinate(const chart *c)
{
    return c->logarithmic ? c->at.y : direction(&c->at, c->kind == END_OF) * exp(c->at.y / 2);
}

/* The problem with its critical points. */
int rod_place_of(const ends_problem *, const grid *, place *);
double rod_place_fall(const place *, double pin, double beta);
int rod_is_tied(const place *);
void rod_path_counts(const place *, const path *, int64_t counts[3]);
/* Length of each path less that of the rod, all with the pin and the sign of the first. */
int rod_excess_of(search *, const place *, int count, const path *some, double *off);
/* The lengths of each path at x less that of the rod, NaN where one of them does not exist. */
int rod_excess_at(search *, const place *, const chart *, int count, const double *x, double *off);
/* The path at x; 0 where its saddle no longer exists or there is no such path. */
int rod_path_at(const place *, const chart *, double x, path *);
/* Coordinates in which the equilibrium can be followed, the best first; their number, 0 where there is none. */
path rod_own_path(const place *, const path *);
int rod_charts(const place *, const path *, chart *);
/* Whether the level lies above every maximum of G between the two ends. */
int rod_joined_at(const place *, const path *);

#endif
