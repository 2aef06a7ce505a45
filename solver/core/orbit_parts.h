/* What the files about quadrature over an orbit share: `orbit` and the search for equilibria.

   Each function does one problem. Next to a saddle the order of operations decides a digit. Pieces, panels and levels
   are explained in solver/orbits. C11, libm only; no global state. */

#ifndef ROD_ORBIT_PARTS_H
#define ROD_ORBIT_PARTS_H

#define TARGET
#define W 1
#define SUFFIX _1
#include "tuning.h"
#include "vectors.h"
#undef TARGET
#undef W
#undef SUFFIX
#undef ZERO

#include <stdlib.h>

#define TAU (2 * PI)
#define TINY 1e-150 /* angles and speeds below this have squares that a float cannot hold: they count as zero */

enum { NODES = 32, CRITICAL = 16, PIECES = 3 * CRITICAL, FUNCTIONS = 5, OF_ANGLE = 2 };
enum { PASS, SADDLE, CENTRE };           /* kinds of pieces */
enum { HELIX, LIBRATION, ROTATION };     /* kinds of orbits */
enum { DONE, NO_MEMORY, NOT_POSSIBLE };  /* what a function returns */

typedef struct {
    double lam, mu, phi, span, beta0, dbeta0;
} start_problem;

/* The critical points of G in [-pi, pi), rising; centre: whether each is a minimum of G. shelf: angles at which G rises or falls
   least between two of its bends (H' = 0, H H'' > 0); height: half that of the stretch about each in which G is almost level. */
typedef struct {
    int count, shelves;
    double beta[CRITICAL];
    int centre[CRITICAL];
    double shelf[CRITICAL], height[CRITICAL];
} critical;

/* The grid of the search for critical points: angles (m,), table (5, 2 m). */
typedef struct {
    int64_t m;
    const double *angles, *table;
} grid;

/* G about one critical point o. */
typedef struct {
    double lam, mu, phi, o, level, s, c, turn, bend, fixed;
} local_potential;

typedef struct {
    int64_t arc, rank, kind;
    double base, scale, u0, u1;
    local_potential local;
} piece;

/* turns_at: how many critical points a libration passes on its way forward. */
typedef struct {
    int kind, count, turns_at;
    double direction;
    piece pieces[PIECES];
} arcs;

/* The nodes of a panel and the linear maps on them: `numerics.chebyshev.Basis`. */
typedef struct {
    int64_t n;
    const double *nodes, *analyse, *values, *differentiate;
} points;

/* One panel. piece: its number; next: the number of the panel after it, -1 for none. base: the angle of a critical point,
   with whole turns, from which the series of beta counts; origin: the same in [-pi, pi). */
typedef struct {
    int64_t piece, next, open;
    double order, near, far, base, origin, duration, fastest, error, time_error, time_rounding;
} panel;

/* The panels of one problem after another; series: (room, FUNCTIONS, n + 1), NULL where durations alone are wanted. */
typedef struct {
    int64_t count, room, series_room, first;
    panel *rows;
    double *series;
} panels;

/* How panels are cut: see `rod_panelled`. series: how many of the FUNCTIONS are wanted of each, none where durations alone are,
   or OF_ANGLE, those of beta and |beta_t|. lanes: what rod_lanes says, or fewer. */
typedef struct {
    double length, goal, stretch;
    int series, lanes;
} cutting;

/* The orbits that are read: arrays as `rod_orbits_fetch` fills them; beta0: (B,). first, count, duration: (2 B,). */
typedef struct {
    int64_t coefficients, panels;
    const int64_t *kind, *first, *count;
    const double *beta0, *direction, *duration, *gain, *since, *width, *base, *origin, *series;
} read_orbits;

enum { PANEL_COLUMNS = 7 }; /* duration, base, origin, fastest, error, time_error and time_rounding */

/* Where panels are copied to. arc: (P,). columns: (PANEL_COLUMNS, P). series: (P, FUNCTIONS, size). */
typedef struct {
    int64_t panels, *arc;
    double *columns, *series;
} panel_arrays;

/* Pieces of rods that lie on orbits: `rod_cover`. */
typedef struct {
    int64_t *of, *row;
    double *low, *high, *time, *count, *begin;
} covered;

/* Where a time lies on an orbit. */
typedef struct {
    int second, mirrored;
    double local, periods;
} phase;

/* One ends problem: see `boundary.Boundary`. falls: (pins, 2). */
typedef struct {
    double lam, mu, phi, span, low, high, deepest;
    int64_t whole_turns, passed, pins;
    const double *pin, *falls;
} boundary;

typedef struct {
    double time[3], rate[3];
    int joins, rotates;
} transit;

/* What a call needs: the problem, its critical points, how panels are cut, and room for them. */
typedef struct {
    const boundary *of;
    critical found;
    const points *at;
    cutting how;
    panels room;
    int64_t calls;
} search;

/* Inlined, so that a caller compiled for wider lanes has its own copy. IN_WIDTHS compiles an inlined function for narrow
   lanes and for wide ones, and FOR_LANES is the one that the processor can run; among the arguments WIDTH is how many numbers
   its registers hold. The loops over nodes have no branches, so the compiler uses these lanes; all widths do the same
   operations in the same order and so give the same bits. */
#define IN_WIDTH(name, parameters, arguments, many)                                                                    \
    static void name parameters                                                                                        \
    {                                                                                                                  \
        enum { WIDTH = many };                                                                                         \
        arguments;                                                                                                     \
    }
#if defined(__x86_64__) && defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#define WIDE __attribute__((target("avx2")))
#define WIDEST __attribute__((target("avx512f,avx512dq")))
#define IN_WIDTHS(name, parameters, arguments)                                                                         \
    IN_WIDTH(name##_narrow, parameters, name arguments, 2)                                                             \
    WIDE IN_WIDTH(name##_wide, parameters, name arguments, 4)                                                          \
    WIDEST IN_WIDTH(name##_widest, parameters, name arguments, 8)
#define FOR_LANES(lanes, name) ((lanes) >= 8 ? name##_widest : (lanes) >= 4 ? name##_wide : name##_narrow)
#else
#define INLINE static inline
#define IN_WIDTHS(name, parameters, arguments) IN_WIDTH(name##_narrow, parameters, name arguments, 2)
#define FOR_LANES(lanes, name) name##_narrow
#endif

static inline double square(double x) { return x * x; }
static inline int modulo(int64_t k, int64_t m) { return (int)(((k % m) + m) % m); }

/* H, its derivative, the sum of the sizes of its terms, and its second and third derivative, from sin and cos of beta */
INLINE double slope_by(double lam, double mu, double phi, double s, double c)
{
    const double s2 = s * s, size = fabs(c);
    return (lam - (c < 0 ? -mu : mu)) * c + mu * (s2 * (1 + 2 * size) / (1 + size)) - (phi + 2 * c * s2) * s;
}

INLINE double slope_rate_by(double lam, double mu, double phi, double s, double c)
{
    return -lam * s + 4 * mu * s * c - phi * c - 2 * s * s * (3 * c * c - s * s);
}

INLINE double slope_size_by(double lam, double mu, double phi, double s, double c)
{
    const double s2 = s * s, size = fabs(c);
    return fabs((lam - (c < 0 ? -mu : mu)) * c) + fabs(mu * (s2 * (1 + 2 * size) / (1 + size))) +
           (fabs(phi) + 2 * size * s2) * fabs(s);
}

static inline double higher_rates_by(double lam, double mu, double phi, double s, double c, double *third)
{
    const double s2 = 2 * s * c, c2 = (c - s) * (c + s), s4 = 2 * s2 * c2, c4 = (c2 - s2) * (c2 + s2);
    *third = lam * s - 8 * mu * s2 + phi * c + 4 * c2 - 16 * c4;
    return -lam * c + 4 * mu * c2 + phi * s + 2 * s2 - 4 * s4;
}

/* A bound of the square root of |H'| anywhere, and so of the change of beta_t that comes with a unit change of beta */
INLINE double steepness_of(double lam, double mu, double phi) { return sqrt(fabs(lam) + 2 * fabs(mu) + fabs(phi) + 2); }

static inline double slope(double lam, double mu, double phi, double beta)
{
    return slope_by(lam, mu, phi, sin(beta), cos(beta));
}

static inline double slope_rate(double lam, double mu, double phi, double beta)
{
    return slope_rate_by(lam, mu, phi, sin(beta), cos(beta));
}

/* a - b moved into [-pi, pi), of angles in [-pi, pi); exact where they are neighbours across the cut at pi */
static inline double apart(double a, double b)
{
    const double x = a - b;
    return x >= PI ? (a - TAU) - b : x < -PI ? (a + TAU) - b : x;
}

static inline double wrapped(double angle)
{
    angle = angle - TAU * rint(angle / TAU);
    return angle >= PI ? angle - TAU : angle;
}

/* The largest and the smallest of the sizes of n numbers, NaN where one of them is: sizes have the order of their bits, and NaN
   comes last. */
INLINE double largest_size(int n, const double *values)
{
    int64_t most = 0;
    for (int i = 0; i < n; i++) {
        const int64_t size = bits_of(values[i]) & INT64_MAX;
        most = size > most ? size : most;
    }
    return number_of(most);
}

INLINE double smallest_size(int n, const double *values)
{
    const double most = largest_size(n, values);
    int64_t least = bits_of(INFINITY);
    for (int i = 0; i < n; i++) {
        const int64_t size = bits_of(values[i]) & INT64_MAX;
        least = size < least ? size : least;
    }
    return most != most ? most : number_of(least);
}

/* sin and cos to about one unit in the last place, |x| < FAR */
INLINE void near_sin_cos(int n, const double *restrict x, double *restrict sine, double *restrict cosine)
{
    for (int i = 0; i < n; i++)
        near_sin_cos_1(x[i], &sine[i], &cosine[i]);
}

/* The same of any angles: where one is far, by libm. */
INLINE void sin_cos_of(int n, const double *restrict x, double *restrict sine, double *restrict cosine)
{
    if (largest_size(n, x) < FAR)
        near_sin_cos(n, x, sine, cosine);
    else
        for (int i = 0; i < n; i++)
            sine[i] = sin(x[i]), cosine[i] = cos(x[i]);
}

/* out (m,) = values (n,) @ linear (n, m) */
INLINE void plain_product(int n, int m, const double *restrict values, const double *restrict linear, double *restrict out)
{
    for (int j = 0; j < m; j++)
        out[j] = values[0] * linear[j];
    for (int i = 1; i < n; i++)
        for (int j = 0; j < m; j++)
            out[j] += values[i] * linear[i * m + j];
}

#define MANY 2
#include "registers.h"
#if defined(__x86_64__)
#define MANY 4
#include "registers.h"
#define MANY 8
#include "registers.h"
#define PRODUCTS(width) ((width) == 8 ? products_8 : (width) == 4 ? products_4 : products_2)
#define TWO_SERIES(width) ((width) == 8 ? two_series_8 : (width) == 4 ? two_series_4 : two_series_2)
#else
#define PRODUCTS(width) products_2
#define TWO_SERIES(width) two_series_2
#endif

/* Registers of a row of sums: with those of a second row as many as a processor has, and some for what is summed. */
#define REGISTERS(width) ((width) == 8 ? 3 : 6)

/* The same for functions IN_WIDTHS, with their WIDTH. */
INLINE void product(int width, int n, int m, const double *values, const double *linear, double *out)
{
    if (m < width)
        plain_product(n, m, values, linear, out);
    else
        PRODUCTS(width)(1, REGISTERS(width), 0, n, m, &values, linear, &out);
}

/* Of two rows at once, in little more time than of one. */
INLINE void product_of_two(int width, int n, int m, const double *first, const double *second, const double *linear,
                           double *to_first, double *to_second)
{
    const double *values[2] = {first, second};
    double *out[2] = {to_first, to_second};
    for (int r = 0; m < width && r < 2; r++)
        plain_product(n, m, values[r], linear, out[r]);
    if (m >= width)
        PRODUCTS(width)(2, REGISTERS(width), 0, n, m, values, linear, out);
}

/* Coefficients (n,) to those of the integral from -1, (n + 1,). */
INLINE void integral(int n, const double *restrict a, double *restrict b)
{
    double sign = 1, total = 0;
    b[1] = a[0] - a[2] / 2;
    for (int k = 2; k < n - 1; k++)
        b[k] = (a[k - 1] - a[k + 1]) / (2 * k);
    b[n - 1] = a[n - 2] / (2 * (n - 1));
    b[n] = a[n - 1] / (2 * n);
    for (int k = 1; k <= n; k++, sign = -sign)
        total += sign * b[k];
    b[0] = total;
}

/* The sum of n numbers: of a series, its value at 1. */
INLINE double sum_of(int n, const double *values)
{
    double total = 0;
    for (int k = 0; k < n; k++)
        total += values[k];
    return total;
}

/* Values at the nodes to the series of the integral from -1, (n + 1,). */
INLINE void integrated(const points *at, const double *values, double *out)
{
    double coefficients[NODES];
    plain_product((int)at->n, (int)at->n, values, at->analyse, coefficients);
    integral((int)at->n, coefficients, out);
}

/* A series of n coefficients at x. */
static inline double at_place(const double *series, int n, double x)
{
    double older = 1, now = x, total = series[0] + (n > 1 ? x * series[1] : 0);
    for (int k = 2; k < n; k++) {
        const double next = 2 * x * now - older;
        older = now, now = next, total += next * series[k];
    }
    return total;
}

/* `rows` series of n coefficients at x. */
static inline void values_at(int rows, const double *series, int n, double x, double *out)
{
    double polynomial[NODES + 1];
    polynomial[0] = 1, polynomial[1] = x;
    for (int k = 2; k < n; k++)
        polynomial[k] = 2 * x * polynomial[k - 1] - polynomial[k - 2];
    for (int row = 0; row < rows; row++) {
        double total = 0;
        for (int k = 0; k < n; k++)
            total += polynomial[k] * series[row * n + k];
        out[row] = total;
    }
}

/* Along a flow (v, -H) with the transversal (c H, v)/D, D = v^2 + c H^2: the rate at which a change across the flow
   moves along it, and how far it moves at once where c changes. A rod at rest has neither. */
static inline double across_flow(double v, double H, double c)
{
    const double D = v * v + c * H * H;
    return D > 0 ? D : 1;
}

static inline double shear_rate(double v, double H, double rate, double c)
{
    const double D = across_flow(v, H, c);
    return v == 0 && H == 0 ? 0 : (1 - c * rate) * ((v * v - c * H * H) / D) / D;
}

static inline double shear_jump(double v, double H, double old, double new)
{
    return v * H * ((old - new) / across_flow(v, H, old)) / across_flow(v, H, new);
}

/* A root by Newton's rule kept inside a shrinking bracket: `numerics.roots.bracket`. */
typedef void function(const void *of, double x, double *value, double *rate);
double rod_bracketed(function *f, const void *of, double lo, double hi, double x);

/* Makes room for so many elements of an array. Returns DONE or NO_MEMORY. */
int rod_roomy(void **array, int64_t *room, int64_t wanted, size_t size);

/* critical_points.c */
int rod_critical(double lam, double mu, double phi, const grid *, critical *);

/* About one critical point: sin(o + x), cos(o + x/2) and the bracket S^2 + 2 s S + 3 s^2, x by its half angle: o + x is
   never formed; and how steeply G rises with sin(x/2)^2. */
INLINE double near_of(const local_potential *l, double sh, double ch, double *S, double *C, double *bracket)
{
    const double s = l->s, c = l->c;
    *S = s * (1 - 2 * sh * sh) + 2 * c * sh * ch;
    *C = c * ch - s * sh;
    *bracket = *S * *S + s * (2 * *S + 3 * s);
    return *C * *C * *bracket;
}

INLINE double steepness_by(const local_potential *l, double sh, double ch, double near)
{
    return 4 * (l->fixed - 2 * ch * (l->turn * sh + l->bend * ch) + near);
}

/* rod.c: the weight of a change of beta_t(0) beside one of beta(0); whether H' hardly changes along a rod, and the
   condition number as if it did not */
double rod_weight_of(const start_problem *);
int rod_beside_helix(const start_problem *, double weight, double *condition);

/* arcs.c */
local_potential rod_local(double lam, double mu, double phi, double o, double level);
double rod_steepness(const local_potential *, double x);
double rod_drop(const local_potential *, double x);
double rod_weight(const local_potential *, double reach);
double rod_faintest(const local_potential *);
double rod_start_variable(int form, double *scale, double x, double v, int first, const local_potential *);
int rod_arcs(const start_problem *, double pin, double gap, const critical *, arcs *);

/* panels.c; the first: beta_t over sqrt(turn^2 - x^2), not below what rounding leaves of it */
double rod_slope_over_root(const local_potential *, double turn, double x);
int rod_panelled(const start_problem *, const piece *, int count, const points *, const cutting *, panels *);
void rod_panels_free(panels *);

/* What a unit of falling log gap adds to the time at an end of a piece: 1/(2 r) where it ends at the saddle from whose height
   the level is measured, or at the turning point before it; else 0. */
double rod_half_passage(const piece *, double gap, int at_far_end);
/* Adds panels on which the rod stays at that saddle, longer by a smaller log of the gap. On them beta is the angle of the
   saddle, to within the root of the gap, and the integrals grow evenly. */
int rod_rest(const piece *, int count, double gap, double deeper, const points *, panels *);

/* orbits.c */

/* The panels of one orbit behind those that are there; `piece` of each is the number of its arc, 0 or 1. pinned: an angle,
   the height of the level above G there, and by how much the log of the true gap is smaller; or NULL: beta(0), its own, 0.
   known: the critical points, or NULL. */
int rod_cut_orbit(const start_problem *, const double *pinned, const critical *known, const grid *, const points *,
                  const cutting *, arcs *, panels *);

/* Copies the panels of one orbit, from number `first`, in their order into rows from `row` on, the first `kept` series of
   each; arc: 0 or 1. Returns the row after them. */
int64_t rod_copy_panels(const panels *, int64_t first, int64_t size, int kept, int64_t row, const panel_arrays *to);

/* Sums along arcs, of P panels in the order of travel: since, (P,), the time from the start of the arc; first, count and
   duration, (arcs,); gain: (arcs, 3), of alpha, z and the swirl, whose series then count from the start too; 0 without
   series. */
void rod_orbits_sum(int64_t arcs, int64_t P, int64_t size, const int64_t *arc, const double *width, double *series,
                    double *since, int64_t *first, int64_t *count, double *duration, double *gain);
int64_t rod_place(const read_orbits *, int64_t b, double t, phase *, double *x);
/* The same of `many` times, which are found sooner where they lie in the order of the rod. */
void rod_places_at(const read_orbits *, int64_t b, int many, const double *t, int64_t *panel, phase *, double *x);
void rod_orbit_at(const read_orbits *, int64_t b, double t, double *out);
int64_t rod_cover(const read_orbits *, int64_t n, const double *span, const covered *out);
double rod_unfolded(double value, const phase *, double there, double after, int librates);

/* transit_times.c */
int rod_search(search *, const boundary *, int64_t count, const double *beta, const int64_t *centre, const points *,
               const cutting *);
int rod_transit_at(search *, int64_t pin, double sign, double y, int deep, transit *);
/* Length of a path at one level less that of the rod; counts: how often it has each of the three times. */
int rod_excess(search *, int64_t pin, double sign, const int64_t *counts, double y, double *off);
double rod_fall(double lam, double mu, double phi, double pin, double beta, int extremum);

#endif
