/* The one table of what is measured along rods. Python and pages read it as text by `rod_measured`. */

#ifndef ROD_MEASURED_H
#define ROD_MEASURED_H

/* The densities whose integrals and extremes are measured: densities.h. */
#define DENSITY_ROWS(ROW)                                                                                              \
    ROW(ANGLE, angle) ROW(CURVATURE, curvature) ROW(BENDING, bending) ROW(POTENTIAL, potential) ROW(OUTWARD, outward)  \
    ROW(TENSION, tension) ROW(ACROSS, across) ROW(ALONG, along)

/* The integrals: in which group; whether measure_rates.c differentiates it; of which density. A row is all that one needs, and
   a row above with its formula in densities.h, where its density is new. */
#define INTEGRAL_ROWS(ROW)                                                                                             \
    ROW(BENDINGS, BENT, bending, 1, BENDING)                                                                           \
    ROW(POTENTIALS, STORED, potential, 1, POTENTIAL)                                                                   \
    ROW(DIRECTIONS, TURNED, turned, 0, ACROSS)                                                                         \
    ROW(DIRECTIONS, RISEN, risen, 0, ALONG)

/* The other numbers: in which group, computed together; whether measure_rates.c differentiates it. */
#define OTHER_ROWS(ROW)                                                                                                \
    ROW(ANGLES, LOW, low, 1)                                                                                           \
    ROW(ANGLES, HIGH, high, 1)                                                                                         \
    ROW(CURVATURES, CURVED, curvature, 1)                                                                              \
    ROW(CURVATURES, TIGHTEST, tightest, 1)                                                                             \
    ROW(PUSHES, PUSHED, pushed, 1)                                                                                     \
    ROW(PUSHES, PULLED, pulled, 1)                                                                                     \
    ROW(PUSHES, SHARE, share, 1)                                                                                       \
    ROW(PUSHES, LIFTED, lifted, 0)                                                                                     \
    ROW(PUSHES, LEAST, least, 1)                                                                                       \
    ROW(PUSHES, GREATEST, most, 1)                                                                                     \
    ROW(PUSH_ALONE, PUSHED_ALONE, push, 0)                                                                             \
    ROW(LIFT_OFFS, FIRST_LIFT, lifts, 1)                                                                               \
    ROW(TENSIONS, LARGEST_TENSION, tension, 1)                                                                         \
    ROW(PEAKS, PEAK, peak, 1)

#define NUMBER_ROWS(ROW) INTEGRAL_ROWS(ROW) OTHER_ROWS(ROW)

/* The groups, in the order in which their first rows stand. */
enum { BENDINGS, POTENTIALS, DIRECTIONS, ANGLES, CURVATURES, PUSHES, PUSH_ALONE, LIFT_OFFS, TENSIONS, PEAKS };

#define DENSITY_OF(id, name) id,
#define NUMBER_OF(group, id, ...) id,
enum { DENSITY_ROWS(DENSITY_OF) DENSITIES };
/* MIDDLE_PUSH: that of `push` over the middle third, of which there are rates alone. */
enum { NUMBER_ROWS(NUMBER_OF) NUMBERS, MIDDLE_PUSH = NUMBERS, RATES };

#endif
