/* Rods that are known at stations or by the steps of a march: the pieces between them, and what is measured on these. */

#include "stretches.h"

enum { QUINTIC = 6 };

/* The powers of x in [0, 1] as Chebyshev series of 2 x - 1: n of n coefficients, (n, n). */
static void powers_as_series(int n, double *out)
{
    memset(out, 0, sizeof(double) * (size_t)(n * n));
    out[0] = 1;
    for (int power = 1; power < n; power++) { /* times x = (1 + T_1) / 2 */
        const double *last = out + (power - 1) * n;
        double *next = out + power * n;
        for (int k = 0; k < power; k++) {
            next[k] += last[k] / 2, next[k + 1] += last[k] / (k ? 4 : 2);
            if (k)
                next[k - 1] += last[k] / 4;
        }
    }
}

/* The series of the quintic polynomial on [0, 1] with these values and derivatives at the ends. */
static void quintic(const double *series_of_powers, double y0, double y1, double d0, double d1, double b0, double b1,
                    double *out)
{
    const double rise = y1 - y0;
    const double powers[QUINTIC] = {y0,
                                    d0,
                                    b0 / 2,
                                    10 * rise - 6 * d0 - 4 * d1 - 1.5 * b0 + 0.5 * b1,
                                    -15 * rise + 8 * d0 + 7 * d1 + 1.5 * b0 - b1,
                                    6 * rise - 3 * (d0 + d1) - 0.5 * (b0 - b1)};
    plain_product(QUINTIC, QUINTIC, powers, series_of_powers, out);
}

/* The series of beta and beta_t on one step of a march, (2, n), from powers of the time in it (n,), of which it lasts h. */
INLINE void step_series(int width, int n, double h, const double *taylor, const double *series_of_powers, double *out)
{
    double beta[LONGEST], rate[LONGEST], power = 1;
    rate[n - 1] = 0;
    for (int k = 0; k + 1 < n; k++, power *= h)
        beta[k] = taylor[k] * power, rate[k] = taylor[k + 1] * (k + 1) * power;
    beta[n - 1] = taylor[n - 1] * power;
    product_of_two(width, n, n, beta, rate, series_of_powers, out, out + n);
}

IN_WIDTHS(step_series, (int n, double h, const double *taylor, const double *series_of_powers, double *out),
          (WIDTH, n, h, taylor, series_of_powers, out))

/* The series of beta and beta_t on the steps of marches, (steps, 2, n), n at most LONGEST. width: (steps,). taylor: (steps, 4,
   n), powers of the time in a step, the first of beta. */
void rod_step_series(int64_t steps, int64_t n, const double *width, const double *taylor, double *out, int64_t lanes)
{
    double series_of_powers[LONGEST * LONGEST];
    powers_as_series((int)n, series_of_powers);
    for (int64_t i = 0; i < steps; i++) {
        const double *later = taylor + 4 * n * (i + 8 < steps ? i + 8 : i);
        for (int64_t k = 0; k < n; k += 8) /* read in time: the powers of beta lie apart, those of a step in a row */
            __builtin_prefetch(later + k);
        FOR_LANES(lanes, step_series)((int)n, width[i], taylor + 4 * n * i, series_of_powers, out + 2 * n * i);
    }
}

/* The series of beta and beta_t between neighbouring stations, (rods, n - 1, 2, QUINTIC), through their values and rates
   at the stations (rods, n). loads: (rods, 3), lam, mu and phi. */
void rod_station_series(int64_t rods, int64_t n, const double *loads, const double *t, const double *beta,
                        const double *rate, double *out)
{
    double series_of_powers[QUINTIC * QUINTIC];
    powers_as_series(QUINTIC, series_of_powers);
    for (int64_t b = 0; b < rods; b++, loads += 3)
        for (int64_t i = 0; i + 1 < n; i++, out += 2 * QUINTIC) {
            const double *angle = beta + b * n + i, *v = rate + b * n + i, h = t[b * n + i + 1] - t[b * n + i];
            double bend[2], turn[2];
            for (int end = 0; end < 2; end++) {
                bend[end] = -slope(loads[0], loads[1], loads[2], angle[end]);
                turn[end] = -slope_rate(loads[0], loads[1], loads[2], angle[end]) * v[end];
            }
            quintic(series_of_powers, angle[0], angle[1], h * v[0], h * v[1], h * h * bend[0], h * h * bend[1], out);
            quintic(series_of_powers, v[0], v[1], h * bend[0], h * bend[1], h * h * turn[0], h * h * turn[1], out + QUINTIC);
        }
}

/* The pieces of one rod between n stations, for browsers, which have no Python to make them. They stand in `room`, (18 n + 2,).

   given: lam, mu, phi, the sign of the push, the error of beta and the span. goal: allowed error of series, relative. */
static rods pieces_of(int64_t n, const double *given, const double *t, const double *beta, const double *rate, double goal,
                      double *room)
{
    double *series = room, *ends = room + 12 * n, *time = ends + 2 * n, *begin = time + n, *row = begin + n;
    double *count = row + n, *first = count + n;
    int64_t *firsts = (int64_t *)first, *rows = (int64_t *)row;
    rod_station_series(1, n, given, t, beta, rate, series);
    firsts[0] = firsts[1] = 0;
    for (int64_t i = 0; i + 1 < n; i++) {
        const int64_t k = firsts[1];
        ends[k] = -1, ends[n + k] = 1, time[k] = t[i + 1] - t[i], begin[k] = t[i], rows[k] = i, count[k] = 1;
        firsts[1] += time[k] > 0; /* two stations may be one */
    }
    return (rods){
        .coefficients = QUINTIC, .kinds = 2, .groups = -1, .goal = goal, .series = series, .first = firsts, .row = rows,
        .low = ends, .high = ends + n, .time = time, .count = count, .begin = begin, .lam = given, .mu = given + 1,
        .phi = given + 2, .span = given + 5, .beta0 = beta, .sign = given + 3, .error = given + 4,
    };
}

/* All numbers of one rod that is known at stations, as `rod_measure` gives them, (2, NUMBERS). */
int rod_measure_stations(int64_t n, const double *given, const double *t, const double *beta, const double *rate,
                         double goal, double *room, void *out)
{
    const rods one = pieces_of(n, given, t, beta, rate, goal, room);
    return rod_measure(&one, out, 0, 1, 1);
}

/* The landmarks of one rod that is known at stations, as `rod_landmarks` gives them. */
int64_t rod_landmarks_of_stations(int64_t n, const double *given, const double *t, const double *beta, const double *rate,
                                  double goal, double *room, int64_t most, double *out)
{
    const rods one = pieces_of(n, given, t, beta, rate, goal, room);
    return rod_landmarks(&one, most, out, 1);
}
