/* Rods whose loads vary along them: weight, and friction of a rod that slides or turns. Taylor series with variations.

State, in units of A and rho: beta, beta_t, alpha, q = lam - mu, phi, mu, u = t - z, g = gamma + alpha, both from 0.
lam - mu, 1 - cos(beta) and t - z keep their digits in a slender rod, where beta, lam - mu and t - z are small.

    beta_tt = -H,  H = q cos + mu e (3 - 2 e) - (phi + 2 cos sin^2) sin,  e = 1 - cos(beta)
    alpha_t = sin,  u_t = e,  g_t = (A/C) mu + sin e
    phi_t = ws_c + k P cos,  lam_t = ws_s sin(alpha) + k P sin        k = sigma mu_f, along the rod
    phi_t = ws_c + k P                                                              a rod that moves along the axis
    mu_t = k a P,  phi_t = ws_c + k o P sin,  lam_t = ws_s sin(alpha) + k P (a - o) cos      a rod that turns in place
    P = o f,  f = sin (q + mu e - sin^3) + H (3 sin cos - mu) - 3 beta_t^2 cos(2 beta) - ws_s cos(alpha) + beta_t mu_t

with o = 1 outside and -1 inside. */
#include "tuning.h"
#include "vectors.h"

#include <stdlib.h>

#define ORDER 20
#define TERMS (ORDER + 1)
#define STATES 8
#define WIDE 6   /* columns: changes by the first six numbers of the state, */
#define GIVENS 9 /* and by the weight along, the weight across and the friction */
#define SHALLOW 12 /* order of the derivatives that carry the error: a change can shrink a thousandfold and grow again */
#define USUAL 5.0 /* the ratio of a term to the next, at the end of a usual step */

enum { BETA, SPEED, ALPHA, Q, PHI, MU, SHORT, ROUND };
enum { RATIO, ALONG, ACROSS, FRICTION, WAY, RADIUS, SIDE, PARAMETERS }; /* of a rod; WAY: 0 slides along itself, 1 turns in place, -1 moves along the axis */

/* What is marched, and where the results go: see `rod_loaded`. */
typedef struct {
    int64_t from, to;
    const double *rod, *goal, *begin, *length, *stations;
    int64_t alike;
    double shorter;
    int columns, deep;
    double *end, *derived, *growth, *errors;
    const int64_t *first;
    double *const *out;
    int64_t stride, *steps;
} marches;

#define LANES "weight_friction_lanes.h"
#include "widths.h"

/* March the stretches from number `from` to `to` of `count`.
 *
 * rod, goal: PARAMETERS and STATES numbers of each, of which goal is what a step may leave out of the state; alike:
 * those of the first hold for all. shorter: a factor of the steps. begin, end: (count, STATES). derived: (count,
 * STATES, n), the derivatives of the end by the begin's first six numbers (n = 6), or by the first two, and by the
 * weight along, across and the friction (n = 9), of series up to the order `deep`; n = 0: none. growth: (count, 6), the
 * largest size of d beta by these at the ends of steps. errors: (count, 2), the largest standard deviations of the
 * errors of beta and alpha, with n = 2; or NULL. Stations first[i] .. first[i + 1] of stretch i, rising, fill out[k],
 * of each number k of the state, every `stride` numbers. steps: (count). lanes: their width, 0 for the widest of at
 * most `most`. Returns how many stretches were lost, whose results are NaN, or -1 if there is no memory. */
int64_t rod_loaded(int64_t from, int64_t to, const double *rod, const double *goal, int64_t alike, double shorter,
                   const double *begin, const double *length, int64_t n, int64_t deep, double *end, double *derived,
                   double *growth, double *errors, const int64_t *first, const double *stations, double *const *out,
                   int64_t stride, int64_t *steps, int64_t lanes, int64_t most)
{
    const marches all = {from, to, rod, goal, begin, length, stations, alike, shorter, (int)n, (int)deep, end, derived,
                         growth, errors, first, out, stride, steps};
    return FOR_WIDTH(lanes > 0 && lanes <= most ? lanes : to - from < 2 ? 1 : most, run)(&all);
}
