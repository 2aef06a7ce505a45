/* How the numbers measured along rods answer changes of their orbits. */

#ifndef ROD_MEASURE_RATES_H
#define ROD_MEASURE_RATES_H

#include "stretches.h"
#include "variations.h"

enum { PLACES = 32, CANDIDATES = 4 + 2 * PLACES };

/* F changes of one orbit, and what is observed. parts: (F, PARTS). later: (F,), the change of the length in t. share: of the
   length that is measured. lifts, peak: the t of lift-off and of the largest push. wanted: bits of the rates. */
typedef struct {
    int64_t F, wanted;
    const double *parts, *later;
    double share, lifts, peak;
} changes;

/* The rates that are wanted of the only rod of the workspace, on orbit b, none of a helix, into out (F, RATES). room:
   (3 CANDIDATES, F). Returns DONE or NO_MEMORY. */
int rod_rates(workspace *, const read_orbits *, const points *, const varied_orbits *, const changes *, int64_t b,
              double *room, double *out);

#endif
