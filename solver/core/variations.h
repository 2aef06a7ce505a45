/* The variations of orbits on their panels; solver/orbit/variations.py explains them. */

#ifndef ROD_VARIATIONS_H
#define ROD_VARIATIONS_H

#include "orbit_parts.h"

enum { PAIRS = 10, PARTS = 5 }; /* the elements of the symmetric matrix M; parts of a change: a0, g0 and three loads */
enum { BETA, RATE, LIFTS };      /* what changes: beta, beta_t and, by each load q, the integral of H_q d beta */

/* The state at the nodes of one panel, by a unit of the level and of the three loads. */
typedef struct {
    double v[NODES], H[NODES], c, origin, least, shift[3], gamma[3][NODES], M[PAIRS][NODES];
} varied_nodes;

/* The state at one place of an orbit: `variations.Place`. v: with its sign. M: from the start. */
typedef struct {
    double v, H, c, shift[4], gamma[4], M[PAIRS];
} varied_place;

enum { VARIED = 9 + PAIRS }; /* series of a panel: |beta_t|, H, c, shifts, gammas and the elements of M */

/* What the variations of orbits are kept in, P panels and n nodes: `variations.Variations`. */
typedef struct {
    double *least, *M, *jump, *closing, *series, *gain;
} varied_orbits;

/* What reads them: `series` and `gain` of `varied_orbits`; the series of the panel that was read last, -1 for none, one
   coefficient of all after the other. */
typedef struct {
    const read_orbits *of;
    const double *series, *gain;
    int64_t panel;
    double last[NODES + 1][VARIED];
} reader;

/* The state at x of a panel, moving away from the start; M: since the start, along its arc. */
void rod_varied_place_on(reader *from, int64_t panel, double x, varied_place *out);

/* The state of orbit b at t. */
void rod_varied_place_at(reader *from, int64_t b, double t, varied_place *out);

/* What a change with these parts adds at a place, (5,): to beta, to beta_t and to the integrals up to there. */
void rod_varied_change(const varied_place *start, const varied_place *there, const double parts[PARTS], double out[5]);

/* The state on a panel but for what depends on the other panels: all but gamma and M. x, v: (n,), beta from the angle
   `origin` and |beta_t| at the nodes. half: of the duration. */
void rod_varied_state(const double *loads, double origin, double half, int n, const double *x, const double *v,
                      varied_nodes *out);

/* gamma counted from the height of the critical point at `nearest`, and M. */
void rod_varied_rates(const double *loads, double nearest, int n, const double *x, varied_nodes *out);

/* What M gains on entering panel i of an orbit, and where the rotation of an arc closes, (PAIRS,). nodes: of all panels,
   with their rates up to that one. count: (2,), of the arcs. */
void rod_varied_entry(const varied_nodes *nodes, const int64_t *count, int64_t i, double direction, double *out);
void rod_varied_closing(const varied_nodes *nodes, const int64_t *count, int arc, int64_t kind, double direction,
                        double *out);

/* -(G_q(angle) - G_q(other))/2 for q = lam, mu, phi. */
void rod_height_rates(double angle, double other, double *out);

extern const int rod_pairs[2][PAIRS];

#endif
