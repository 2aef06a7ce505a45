/* The tuned constants that C and Python share. What they mean stands in tuning.py, which fills them in; the core for
   browsers is compiled with them. */

#ifndef ROD_TUNING_H
#define ROD_TUNING_H

#include <stdint.h>

typedef struct {
    double off, cosine, longest, narrow, easy_bend, slower, faster, steep, share, least, ahead, nudge, same_saddle, alike;
    double beside_helix, beside_held_helix, beside_saddle, unresolved, settled, small, contraction, close;
    double lowest, on, moved, at_rest, as_high;
    double shapeless, safety, barely;
    int64_t rounds, steps_kept, most_panels, most_steps;
} tuning;

extern tuning rod_tuning;

#endif
