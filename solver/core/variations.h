/* The variations of orbits on their panels; solver/orbits/variations.py explains them. */

#ifndef ROD_VARIATIONS_H
#define ROD_VARIATIONS_H

#include "orbit_parts.h"

enum { PAIRS = 10, PARTS = 5 }; /* the elements of the symmetric matrix M; parts of a change: a0, g0 and three loads */
enum { BETA, RATE, LIFTS };      /* what changes: beta, beta_t and, by each load q, the integral of H_q d beta */

/* The state at the nodes of one panel, by a unit of the level and of the three loads. sine, cosine: of beta. rate:
   H'. H_q: H_q + shift_q H'. M: its rates. */
typedef struct {
    double v[NODES], H[NODES], sine[NODES], cosine[NODES], rate[NODES], c, origin, least;
    double shift[3], gamma[3][NODES], H_q[3][NODES], M[PAIRS][NODES];
} varied_nodes;

/* The state at one place of an orbit. v: with its sign. M: from the start. */
typedef struct {
    double v, H, c, shift[4], gamma[4], M[PAIRS];
} varied_place;

/* Series of a panel: |beta_t|, H, gammas and M; then what is constant on it: c and the shifts. */
enum { BY_LEVEL = 5, VARIED = BY_LEVEL + PAIRS, CONSTANTS = 4 };

/* The numbers that are kept of a panel with series of `size` coefficients: (VARIED, size), and the constants. */
static inline int64_t varied_size(int64_t size) { return VARIED * size + CONSTANTS; }

/* What the variations of orbits are kept in, P panels and n nodes: `variations.Variations`. */
typedef struct {
    double *least, *M, *jump, *closing, *series, *gain;
    int64_t lanes; /* what rod_lanes says, or fewer; changes no bit */
} varied_orbits;

/* The state at the nodes of panel i of all orbits. Without `by_loads` no shift and no gamma. lanes: as of `varied_orbits`. */
void rod_vary_state(const double *loads, const read_orbits *, int64_t i, const points *, int by_loads, int64_t lanes,
                    varied_nodes *out);

/* The weights of the integral over a panel, (n,). */
void rod_panel_weights(const points *, double *out);

/* The variations of orbit b, none of a helix, on its panels, with nodes (P,) as room. points: an even number of them, at least
   8. loads: (3,). weights: of `rod_panel_weights`. only: two of the panels,
   numbered within the orbit, whose series alone are wanted, or NULL for all; M of `out` may be NULL. Returns the number within
   the orbit of the panel whose critical point the orbit comes closest to. */
int64_t rod_vary(const double *loads, const read_orbits *of, int64_t b, const points *at, const double *weights,
                 const int64_t *only, varied_nodes *nodes, const varied_orbits *out);

/* The state at x of a panel with series of `size` coefficients, moving away from the start; M: since the start, along its
   arc. */
void rod_varied_place_on(const varied_orbits *, int size, int64_t panel, double x, varied_place *out);

/* The state of orbit b at t. */
void rod_varied_place_at(const read_orbits *, const varied_orbits *, int64_t b, double t, varied_place *out);

/* What a unit of each part of a change adds at a place: to beta, to beta_t and to the integrals up to there. */
typedef struct {
    double by[5][PARTS];
} varied_unit;

void rod_varied_unit(const varied_place *start, const varied_place *there, varied_unit *out);

/* The parts of a unit of beta(0), beta_t(0), lam, mu and phi at the start, each with the others held: [part][of]. */
void rod_varied_directions(const varied_place *start, double out[PARTS][PARTS]);

/* The numbers of a case that have rates, the rows of `by`: NUMBERS in problem/dimensionless.py */
enum { BY_LAM, BY_MU, BY_PHI, BY_LENGTH, BY_BETA0, BY_END, BY_STIFFNESS, BY_RHO, BY_RATIO, BY_AZIMUTH, BY_TWIST };

/* Shapes at n stations, B rods. t, beta, rate, z: (B, n), in units of rho. by: (11, B, F), rates of the numbers of the case;
   NULL for the units of rho, whose rates are 0. later: (B, F), of the length in t. loads: (B, 3). ratio, rho: (B,). out:
   (5, B, F, n), the changes of beta, beta_t and the integrals of H_q d beta at constant t, which become the derivatives of
   beta, dbeta, alpha, z and gamma at constant s/L. Where `beta` is NULL they stay changes, and t and out alone are read. */
typedef struct {
    int64_t size, stations, F;
    const double *t, *beta, *rate, *z, *loads, *span, *by, *later, *ratio, *rho;
    double *out;
} shapes;

/* Fills `out` of shape `row`, which is of orbit b, for F directions with the parts (F, PARTS). Parts that do not change are
   left out: next to a saddle a column of M may be infinite. */
void rod_change_orbit(const read_orbits *, const varied_orbits *, int64_t b, const shapes *, int64_t row, const double *parts);

/* The most panels of one of n orbits, at least 1. */
int64_t rod_most_panels(const read_orbits *, int64_t n);

enum { LOST = -1 };

/* One orbit on its panels, in the order of travel: those of the forward arc, then those of the backward one; and its
   variations. It is not moved in memory, for `of` and `varied` point into it. */
typedef struct {
    int64_t count[2], first[2], kind;
    int64_t *rows;
    double direction, duration[2], integrals[6], closing[2 * PAIRS], gain[2 * PAIRS];
    double *room;
    varied_nodes *nodes;
    int64_t row_room, number_room, node_room;
    panels made;
    read_orbits of;
    varied_orbits varied;
} lone_orbit;

/* The orbit of a problem, from what `rod_cut_orbit` takes, in place of the one before, in its room; at first all is 0. To be
   freed in any case. Returns DONE, NO_MEMORY or NOT_POSSIBLE, as for a helix; `kind` is that of the orbit, LOST where there is
   none. */
int rod_lone_orbit(const start_problem *, const double *pinned, const critical *known, const grid *, const points *,
                   const cutting *, lone_orbit *out);
void rod_lone_orbit_free(lone_orbit *);

/* -(G_q(angle) - G_q(other))/2 for q = lam, mu, phi. */
void rod_height_rates(double angle, double other, double *out);

#endif
