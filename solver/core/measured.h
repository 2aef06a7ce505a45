/* The one table of what is measured along rods. Python and pages read it as text by `rod_measured`. */

#ifndef ROD_MEASURED_H
#define ROD_MEASURED_H

/* The densities whose integrals and extremes are measured: densities.h. */
#define DENSITY_ROWS(ROW)                                                                                              \
    ROW(ANGLE, angle) ROW(CURVATURE, curvature) ROW(BENDING, bending) ROW(POTENTIAL, potential) ROW(OUTWARD, outward)   \
    ROW(TENSION, tension) ROW(ACROSS, across) ROW(ALONG, along)

/* The numbers: in which group, computed together; whether measure_rates.c differentiates it. */
#define NUMBER_ROWS(ROW)                                                                                               \
    ROW(ANGLES, LOW, low, 1)                                                                                           \
    ROW(ANGLES, HIGH, high, 1)                                                                                         \
    ROW(CURVATURES, CURVED, curvature, 1)                                                                              \
    ROW(CURVATURES, TIGHTEST, tightest, 1)                                                                             \
    ROW(BENDINGS, BENT, bending, 1)                                                                                    \
    ROW(POTENTIALS, STORED, potential, 1)                                                                              \
    ROW(PUSHES, PUSHED, pushed, 1)                                                                                     \
    ROW(PUSHES, PULLED, pulled, 1)                                                                                     \
    ROW(PUSHES, SHARE, share, 1)                                                                                       \
    ROW(PUSHES, LEAST, least, 1)                                                                                       \
    ROW(PUSHES, GREATEST, most, 1)                                                                                     \
    ROW(PUSH_ALONE, PUSHED_ALONE, push, 0)                                                                             \
    ROW(LIFT_OFFS, FIRST_LIFT, lifts, 1)                                                                                    \
    ROW(TENSIONS, LARGEST_TENSION, tension, 1)                                                                         \
    ROW(DIRECTIONS, TURNED, turned, 0)                                                                                 \
    ROW(DIRECTIONS, RISEN, risen, 0)                                                                                   \
    ROW(PEAKS, PEAK, peak, 1)

enum { ANGLES, CURVATURES, BENDINGS, POTENTIALS, PUSHES, PUSH_ALONE, LIFT_OFFS, TENSIONS, DIRECTIONS, PEAKS };

#define DENSITY_OF(id, name) id,
#define NUMBER_OF(group, id, name, rated) id,
enum { DENSITY_ROWS(DENSITY_OF) DENSITIES };
/* MIDDLE_PUSH: that of `push` over the middle third, of which there are rates alone. */
enum { NUMBER_ROWS(NUMBER_OF) NUMBERS, MIDDLE_PUSH = NUMBERS, RATES };

#endif
