/* Densities on the pieces of rods, which are halved until a series of each converges; the last coefficients measure the
   error that is left. */

#ifndef ROD_STRETCHES_H
#define ROD_STRETCHES_H

#include "densities.h"
#include "tuning.h"

enum { ROUNDS = 48, CROSSINGS = 4 * AT }; /* most halvings of a piece; most changes of sign on a part of one */


/* The pieces of the rods, those of rod b from first[b] to first[b + 1]: `solution_pieces.Pieces`. kinds: of series, 2 or,
   where loads vary along the rods, 7. The others: (n,). */
typedef struct {
    int64_t coefficients, kinds, monotone, groups;
    double goal;
    const double *series;
    const int64_t *first, *row;
    const double *low, *high, *time, *count, *begin, *lam, *mu, *phi, *span, *beta0, *sign, *error;
} rods;

/* A piece, or a part of one, with a density on it. tail: what its series leaves out. */
typedef struct {
    int64_t row;
    double low, high, time, count, begin, series[AT], tail;
    density of;
} stretch;

/* A stretch that may have to be halved. before: the tail of the one of which it is a half. */
typedef struct {
    stretch part;
    double before;
    int stuck, round;
} candidate;

/* The nodes of a piece and the maps on them, as those of `numerics.chebyshev.Basis`; the means of the polynomials, the
   weights of an integral over values at the nodes, and the polynomials at the nodes. */
typedef struct {
    double nodes[AT], analyse[AT * AT], differentiate[AT * AT], mean[AT], weight[AT], polynomials[LONGEST * AT];
} rule;

/* The functions in which most time is spent, for the lanes of the processor; all give the same bits. */
typedef struct {
    void (*angles)(const rods *, const rule *, const stretch *, node_angles *, rod_loads *);
    void (*expanded)(const rule *, int kind, const node_angles *, const rod_loads *, stretch *);
    void (*through)(const double *values, const double *linear, double *out);
} kernels;

/* A local maximum of a density on a part of a rod, its ends included. x: in [-1, 1]. */
typedef struct {
    const stretch *part;
    double x, t, value;
} maximum;

/* What a call needs: room for the angles and loads of the pieces of a rod, and for the stretches of a density. loads: only
   where they vary along the rods; steady: elsewhere. */
typedef struct {
    const rods *all;
    rule by;
    kernels use;
    int64_t angle_room, load_room, room, count, maximum_room;
    node_angles *angles;
    rod_loads *loads, steady;
    stretch *parts;
    maximum *maxima;
    candidate waiting[2 * ROUNDS + 4];
} workspace;

INLINE double highest(const double *values)
{
    double best[8]; /* AT is a multiple of it */
    memcpy(best, values, sizeof best);
    for (int i = 8; i < AT; i += 8)
        for (int k = 0; k < 8; k++)
            best[k] = larger(best[k], values[i + k]);
    for (int k = 1; k < 8; k++)
        best[0] = larger(best[0], best[k]);
    return best[0];
}

INLINE double total_of(const double *values, const double *weight)
{
    double total = 0;
    for (int i = 0; i < AT; i++)
        total += values[i] * weight[i];
    return total;
}

/* How far a series may be from its first coefficient. */
INLINE double range_of(const double *series)
{
    double total = 0;
    for (int k = 1; k < AT; k++)
        total += fabs(series[k]);
    return total;
}

/* Keeps the best, as np.fmax.at does. */
INLINE void keep_larger(double *best, double value)
{
    if (value > *best)
        *best = value;
}

/* Which precision a density needs: of its integral, of its largest value, or of all values. */
enum { INTEGRAL, EXTREMES, SIGNS };

/* Changes of sign: where in [-1, 1], and whether up (1) or down (-1). */
typedef struct {
    int count;
    double x[CROSSINGS], sign[CROSSINGS];
} sign_changes;

/* stretches.c */
workspace *rod_workspace(const rods *, int lanes);
void rod_workspace_free(workspace *);
int rod_angles(workspace *, int64_t b);
int rod_resolved(workspace *, int64_t b, int kind, int precision, double allowed);
double rod_largest(const workspace *, double sign);
void rod_changes(const workspace *, const double *values, const double *series, sign_changes *);
void rod_series_and_rate(const void *series, double x, double *value, double *rate);
void rod_derivative(const double *series, double *out);
double rod_turning_place(const double *series, double sign, double low, double high);
double rod_positive_mean(const workspace *, const double *values, double mean, const sign_changes *, int first);

/* measures.c */
typedef struct {
    double value[NUMBERS], error[NUMBERS];
} numbers;

/* Those of the groups of rod b that are asked for. Returns DONE or NO_MEMORY. */
int rod_measured_numbers(workspace *, int64_t b, numbers *out);
int rod_measure(const rods *, numbers *out, int64_t begin, int64_t end, int lanes);

/* peaks.c */
int rod_places(workspace *, double turn, double until, double same, int most, double *t);
int rod_first_peak(workspace *, double doubt, double span, double barely, double *value, double *error);
int64_t rod_landmarks(const rods *, int64_t most, double *t, int lanes);

#endif
