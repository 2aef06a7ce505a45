/* The numbers of one equilibrium and the linear equations between their changes: solver/branches/orbit_rates.py. */

#ifndef ROD_ORBIT_RATES_H
#define ROD_ORBIT_RATES_H

#include "branches.h"
#include "variations.h"

enum { BETA0, BETAL, DBETA0, DBETAL, ALPHA, SWIRL, Z, LAM, MU, PHI, Y, NUMBERS };
enum { TURN = NUMBERS }; /* the rotation, made of mu, the length and the swirl */
enum { NO_ORBIT = 100 }; /* besides NO_MEMORY and NOT_POSSIBLE: no orbit of the path joins the ends */

/* `orbit_rates.OrbitRates`. length: at which the path meets beta(L). */
typedef struct {
    double values[NUMBERS], rows[NUMBERS * PARTS], by_span[NUMBERS], length;
} orbit_numbers;

/* Those of one equilibrium that is no helix. times, how: how panels are cut, for the length and for the orbit. Returns DONE,
   NO_MEMORY, NO_ORBIT or NOT_POSSIBLE. */
int rod_orbit_numbers(const place *, const path *, const points *, const cutting *times, const cutting *how,
                      orbit_numbers *out);

#endif
