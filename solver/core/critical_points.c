/* The critical points of G of one problem, bracketed roots, and arrays that grow. */

#include "orbit_parts.h"

enum { GRID = 512 }; /* the most angles of the grid */

int rod_roomy(void **array, int64_t *room, int64_t wanted, size_t size)
{
    if (wanted <= *room)
        return DONE;
    const int64_t more = 2 * wanted + 64;
    void *larger_one = realloc(*array, size * (size_t)more);
    if (!larger_one)
        return NO_MEMORY;
    *array = larger_one, *room = more;
    return DONE;
}

double rod_bracketed(function *f, const void *of, double lo, double hi, double x)
{
    double older = fabs(hi - lo), last = 0;
    for (int step_number = 0; step_number < 120; step_number++) {
        double value, rate;
        f(of, x, &value, &rate);
        if (value < 0)
            lo = x;
        else
            hi = x;
        double new = x - value / rate, step = fabs(new - x);
        if (!((new - lo) * (new - hi) <= 0) || step > older / 2) {
            new = value == 0 ? x : (lo + hi) / 2;
            step = fabs(new - x);
        }
        /* Newton's steps shrink to the square, so the next one would be step (step/last)^2 */
        if (step * square(fmin(step / last, 1)) <= 4e-16 * fabs(new))
            return new;
        if (last > 0)
            older = last;
        last = step, x = new;
    }
    return x;
}

typedef struct {
    double lam, mu, phi, sign;
} signed_loads;

static void slope_and_rate(const void *of, double x, double *value, double *rate)
{
    const signed_loads *p = of;
    *value = p->sign * slope(p->lam, p->mu, p->phi, x);
    *rate = p->sign * slope_rate(p->lam, p->mu, p->phi, x);
}

static void rate_and_second(const void *of, double x, double *value, double *rate)
{
    const signed_loads *p = of;
    *value = p->sign * slope_rate(p->lam, p->mu, p->phi, x);
    double third;
    *rate = p->sign * higher_rates_by(p->lam, p->mu, p->phi, sin(x), cos(x), &third);
}

/* The root of the inverse cubic through two values of opposite sign and their rates; if outside, of the secant. */
static double crossing(double lo, double hi, double v0, double v1, double r0, double r1)
{
    const double rise = v1 - v0, w = -v0 / rise, secant = lo + (hi - lo) * w;
    const double cubic = secant + w * (1 - w) * ((1 - w) * (rise / r0 - (hi - lo)) - w * (rise / r1 - (hi - lo)));
    return (cubic - lo) * (cubic - hi) <= 0 ? cubic : secant;
}

/* Puts a root behind those that are not above it. */
static int add(critical *found, double root, int centre)
{
    if (found->count == CRITICAL || root != root)
        return NOT_POSSIBLE;
    int k = found->count++;
    for (; k > 0 && found->beta[k - 1] > root; k--)
        found->beta[k] = found->beta[k - 1], found->centre[k] = found->centre[k - 1];
    found->beta[k] = root, found->centre[k] = centre;
    return DONE;
}

static int add_root(critical *found, signed_loads p, double lo, double hi, int up, double guess)
{
    p.sign = up ? 1 : -1;
    const double root = rod_bracketed(slope_and_rate, &p, lo, hi, guess);
    return add(found, root >= PI ? root - TAU : root, up);
}

/* Where H comes nearest to zero between two angles of the grid, with the rates r1 and r2: two roots that share the cell, or
   a shelf. near: whether the tangents reach zero inside the cell. */
static int add_tip(critical *found, signed_loads p, double lo, double hi, double value, double r1, double r2, int near,
                   int *paired)
{
    p.sign = r2 > 0 ? 1 : -1;
    const double guess = lo + (hi - lo) * r1 / (r1 - r2);
    const double tip = near ? rod_bracketed(rate_and_second, &p, lo, hi, guess) : guess, least = slope(p.lam, p.mu, p.phi, tip);
    if (near && least * value < 0) {
        *paired = 1;
        const int failed = add_root(found, p, lo, tip, value < 0, (lo + tip) / 2);
        return failed ? failed : add_root(found, p, tip, hi, value >= 0, (tip + hi) / 2);
    }
    if (found->shelves == CRITICAL)
        return NOT_POSSIBLE;
    found->shelf[found->shelves] = tip >= PI ? tip - TAU : tip;
    found->height[found->shelves++] = 2 * fabs(least) * sqrt(6 * fabs(least / (r2 - r1)) * (hi - lo));
    return DONE;
}

/* A pair of roots that the grid cannot separate about 0 (sign 1) or -pi (sign -1). */
static int add_touching(critical *found, signed_loads p, double at, double sign, double before, double after)
{
    if (!(p.lam == sign * p.mu && before * after > 0))
        return DONE;
    const double mu = sign * p.mu, phi = sign * p.phi;
    const double root = sqrt(larger(2.25 * mu * mu - 8 * phi, 0));
    double other = at + sign * 2 * phi / (1.5 * mu + copysign(root, mu));
    if (other < -PI)
        other += TAU;
    /* H has one sign outside the two: where that is minus, the first of them in rising order is the centre */
    const int first = (before < 0) ^ (other < at) ^ (other > at + 1);
    const int failed = add(found, at, first);
    return failed ? failed : add(found, other, !first);
}

int rod_critical(double lam, double mu, double phi, const grid *by, critical *found)
{
    const int64_t m = by->m;
    const double *angles = by->angles, *table = by->table;
    const signed_loads p = {lam, mu, phi, 1};
    const double loads[5] = {lam - mu, lam + mu, mu, phi, 1};
    int paired = 0, failed = DONE;
    double value[2 * GRID], *rate = value + m;
    if (m > GRID || m < 3)
        return NOT_POSSIBLE;
    for (int64_t i = 0; i < 2 * m; i++)
        value[i] = loads[0] * table[i] + loads[1] * table[2 * m + i] + loads[2] * table[4 * m + i] +
                   loads[3] * table[6 * m + i] + loads[4] * table[8 * m + i];
    found->count = found->shelves = 0;
    /* a root on the grid has the sign of its left neighbour, so that one where H only touches zero does not count */
    int rising = (value[0] == 0 ? value[m - 1] : value[0]) >= 0;
    for (int64_t i = 0; i < m && !failed; i++) {
        const int64_t j = i + 1 < m ? i + 1 : 0;
        const int next = (value[j] == 0 ? value[i] : value[j]) >= 0;
        const double lo = angles[i], hi = j ? angles[j] : angles[0] + TAU;
        if (rising != next)
            failed = add_root(found, p, lo, hi, !rising, crossing(lo, hi, value[i], value[j], rate[i], rate[j]));
        else if (value[i] * rate[i] < 0 && value[j] * rate[j] > 0) /* H approaches zero from both sides */
            failed = add_tip(found, p, lo, hi, value[i], rate[i], rate[j],
                             fabs(value[i] / rate[i]) + fabs(value[j] / rate[j]) < hi - lo, &paired);
        rising = next;
    }
    int64_t zero = 0;
    while (zero < m && angles[zero] < 0)
        zero++;
    if (!failed)
        failed = add_touching(found, p, 0, 1, value[zero - 1], value[zero + 1]);
    if (!failed && !paired)
        failed = add_touching(found, p, -PI, -1, value[m - 1], value[0]);
    return failed ? failed : found->count >= 2 && found->count % 2 == 0 ? DONE : NOT_POSSIBLE;
}

/* The critical points of n problems, loads (n, 3): lam, mu, phi. beta, centre: (n, 16), filled up to count (n,). */
int rod_critical_points(int64_t n, const double *loads, const grid *by, double *beta, uint8_t *centre, int64_t *count)
{
    critical found;
    for (int64_t b = 0; b < n; b++) {
        const double *p = loads + 3 * b;
        const int failed = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])
                               ? rod_critical(p[0], p[1], p[2], by, &found)
                               : NOT_POSSIBLE;
        if (failed)
            return failed;
        count[b] = found.count;
        for (int k = 0; k < found.count; k++)
            beta[CRITICAL * b + k] = found.beta[k], centre[CRITICAL * b + k] = (uint8_t)found.centre[k];
    }
    return DONE;
}
