/* The tuned constants that C and Python share. */

#include "tuning.h"

#ifndef ROD_TUNING
#define ROD_TUNING {0} /* until they are filled in */
#endif

tuning rod_tuning = ROD_TUNING;

void rod_tune(const tuning *from) { rod_tuning = *from; }

const tuning *rod_tuned(void) { return &rod_tuning; }
