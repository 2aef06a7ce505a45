/* What the files about quadrature over an orbit share: `orbit` and the search for equilibria.

   Each function does one problem. Next to a saddle the order of operations decides a digit. Pieces, panels and levels
   are explained in solver/orbit and solver/levels. C11, libm only; no global state. */

#ifndef ROD_ORBIT_PARTS_H
#define ROD_ORBIT_PARTS_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EPS DBL_EPSILON
#define PI 3.14159265358979323846
#define TAU (2 * PI)
#define FAR 1e6      /* angles beyond which sin and cos are left to libm */
#define TINY 1e-150 /* angles and speeds below this have squares that a float cannot hold: they count as zero */

enum { NODES = 32, CRITICAL = 16, PIECES = 3 * CRITICAL, FUNCTIONS = 5 };
enum { PASS, SADDLE, CENTRE };           /* kinds of pieces */
enum { HELIX, LIBRATION, ROTATION };     /* kinds of orbits */
enum { DONE, NO_MEMORY, NOT_POSSIBLE };  /* what a function returns */

typedef struct {
    double lam, mu, phi, span, beta0, dbeta0;
} start_problem;

/* The critical points of G in [-pi, pi), rising; centre: whether each is a minimum of G. */
typedef struct {
    int count;
    double beta[CRITICAL];
    int centre[CRITICAL];
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

typedef struct {
    int kind, count;
    double direction;
    piece pieces[PIECES];
} arcs;

/* The nodes of a panel and the linear maps on them: `numerics.chebyshev.Basis`. */
typedef struct {
    int64_t n;
    const double *nodes, *analyse, *values, *differentiate;
} points;

/* One panel. piece: its number; next: the number of the panel after it, -1 for none. */
typedef struct {
    int64_t piece, next, open;
    double order, near, far, duration, fastest, error, time_error, time_rounding, beta;
} panel;

/* The panels of one problem after another; series: (room, FUNCTIONS, n + 1), NULL where durations alone are wanted. */
typedef struct {
    int64_t count, room, series_room, first;
    panel *rows;
    double *series;
} panels;

/* How panels are cut: see `rod_panelled`. lanes: what rod_lanes says, or fewer. relative: of `rod_orbits`. */
typedef struct {
    double length, goal, stretch;
    int times_only, lanes, relative;
} cutting;

/* The orbits that are read: arrays as `rod_orbits_fetch` fills them; beta0: (B,). first, count, duration: (2 B,). */
typedef struct {
    int64_t coefficients, panels;
    const int64_t *kind, *first, *count;
    const double *beta0, *direction, *duration, *gain, *since, *width, *series;
} read_orbits;

/* Pieces of rods that lie on orbits: `rod_cover`. */
typedef struct {
    int64_t *of, *row;
    double *low, *high, *time, *count, *begin;
} covered;

/* Where a time lies on an orbit: `pieces.Phase`. */
typedef struct {
    int second, mirrored;
    double local, periods;
} phase;

/* One ends problem: see `transit_times.Boundary`. falls: (pins, 2). */
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

static inline double larger(double x, double y) { return x > y || x != x ? x : y; } /* NaN where one of them is */
static inline double smaller(double x, double y) { return x < y || x != x ? x : y; }
static inline double square(double x) { return x * x; }
static inline int modulo(int64_t k, int64_t m) { return (int)(((k % m) + m) % m); }

/* H and H' */
static inline double slope_by(double lam, double mu, double phi, double s, double c)
{
    const double s2 = s * s, size = fabs(c);
    return (lam - (c < 0 ? -mu : mu)) * c + mu * (s2 * (1 + 2 * size) / (1 + size)) - (phi + 2 * c * s2) * s;
}

static inline double slope(double lam, double mu, double phi, double beta)
{
    return slope_by(lam, mu, phi, sin(beta), cos(beta));
}

static inline double slope_rate(double lam, double mu, double phi, double beta)
{
    const double s = sin(beta), c = cos(beta);
    return -lam * s + 4 * mu * s * c - phi * c - 2 * s * s * (3 * c * c - s * s);
}

static inline double slope_size(double lam, double mu, double phi, double beta)
{
    const double s = sin(beta), c = cos(beta), s2 = s * s, size = fabs(c);
    return fabs((lam - (c < 0 ? -mu : mu)) * c) + fabs(mu * (s2 * (1 + 2 * size) / (1 + size))) +
           (fabs(phi) + 2 * size * s2) * fabs(s);
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

/* Inlined, so that a caller compiled for wider lanes has its own copy. */
#if defined(__x86_64__) && defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#define WIDE __attribute__((target("avx2")))
#else
#define INLINE static inline
#endif

/* The loops over nodes below have no branches, so the compiler uses the lanes of the processor; wider lanes do the
   same operations in the same order and so give the same bits. */
typedef union {
    double number;
    int64_t bits;
} word;

INLINE double chosen(int64_t mask, double x, double y) /* x where all bits are set, y where none is */
{
    word a = {x}, b = {y};
    a.bits = (a.bits & mask) | (b.bits & ~mask);
    return a.number;
}

/* sin and cos to about one unit in the last place, |x| < FAR */
INLINE void near_sin_cos(int n, const double *restrict x, double *restrict sine, double *restrict cosine)
{
    /* pi/2 in three parts: the products of the first two with a whole number below 2^20 are exact */
    const double p1 = 0x1.921fb54400000p+0, p2 = 0x1.0b4611a600000p-34, p3 = 0x1.3198a2e037073p-69;
    const double nearest = 0x1.8p52;
    for (int i = 0; i < n; i++) {
        word shifted = {x[i] * (2 / PI) + nearest};
        const double k = shifted.number - nearest;
        const double r = ((x[i] - k * p1) - k * p2) - k * p3, q = r * r;
        double s = -1.0 / 121645100408832000.0, c = -1.0 / 6402373705728000.0;
        s = s * q + 1.0 / 355687428096000.0, c = c * q + 1.0 / 20922789888000.0;
        s = s * q - 1.0 / 1307674368000.0, c = c * q - 1.0 / 87178291200.0;
        s = s * q + 1.0 / 6227020800.0, c = c * q + 1.0 / 479001600.0;
        s = s * q - 1.0 / 39916800.0, c = c * q - 1.0 / 3628800.0;
        s = s * q + 1.0 / 362880.0, c = c * q + 1.0 / 40320.0;
        s = s * q - 1.0 / 5040.0, c = c * q - 1.0 / 720.0;
        s = s * q + 1.0 / 120.0, c = c * q + 1.0 / 24.0;
        s = s * q - 1.0 / 6.0;
        s = r + r * q * s, c = 1.0 - (0.5 * q - q * q * c);
        const int64_t swap = -(shifted.bits & 1);
        word a = {chosen(swap, c, s)}, b = {chosen(swap, s, c)};
        a.bits ^= (int64_t)((uint64_t)(shifted.bits & 2) << 62);
        b.bits ^= (int64_t)((uint64_t)((shifted.bits + 1) & 2) << 62);
        sine[i] = a.number, cosine[i] = b.number;
    }
}

/* The same of any angles: where one is far, by libm. */
INLINE void sin_cos_of(int n, const double *restrict x, double *restrict sine, double *restrict cosine)
{
    double far = 0;
    for (int i = 0; i < n; i++)
        far = larger(far, fabs(x[i]));
    if (far < FAR)
        near_sin_cos(n, x, sine, cosine);
    else
        for (int i = 0; i < n; i++)
            sine[i] = sin(x[i]), cosine[i] = cos(x[i]);
}

/* out (m,) = values (n,) @ linear (n, m) */
INLINE void product(int n, int m, const double *restrict values, const double *restrict linear, double *restrict out)
{
    for (int j = 0; j < m; j++)
        out[j] = values[0] * linear[j];
    for (int i = 1; i < n; i++)
        for (int j = 0; j < m; j++)
            out[j] += values[i] * linear[i * m + j];
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

/* Values at the nodes to the series of the integral from -1, (n + 1,). */
INLINE void integrated(const points *at, const double *values, double *out)
{
    double coefficients[NODES];
    product((int)at->n, (int)at->n, values, at->analyse, coefficients);
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

/* Along a flow (v, -H) with the transversal (c H, v)/D, D = v^2 + c H^2: the rate at which a change across the flow
   moves along it, and how far it moves at once where c changes. */
static inline double shear_rate(double v, double H, double rate, double c)
{
    const double D = v * v + c * H * H;
    return (1 - c * rate) * ((v * v - c * H * H) / D) / D;
}

static inline double shear_jump(double v, double H, double old, double new)
{
    return v * H * ((old - new) / (v * v + old * H * H)) / (v * v + new * H * H);
}

/* A root by Newton's rule kept inside a shrinking bracket: `numerics.roots.bracket`. */
typedef void function(const void *of, double x, double *value, double *rate);
double rod_bracketed(function *f, const void *of, double lo, double hi, double x);

/* Makes room for so many elements of an array. Returns DONE or NO_MEMORY. */
int rod_roomy(void **array, int64_t *room, int64_t wanted, size_t size);

/* critical_points.c */
int rod_critical(double lam, double mu, double phi, const grid *, critical *);

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

/* variations.c: c of a panel from |beta_t|, H and H' at its nodes */
double rod_across(int n, const double *v, const double *H, const double *rate, double half);

/* orbits.c */
int64_t rod_place(const read_orbits *, int64_t b, double t, phase *, double *x);
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
