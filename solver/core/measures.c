/* The numbers measured along each rod, in units of A and rho. One rod at a time; the result for a rod does not depend on
   the others. */

#include "stretches.h"

#define WHOLE 1e-14         /* of the length: a share that differs less from it is all of it */
#define SURELY 1e4          /* times that: a push beyond this is none by the series of either */

/* The error of the integral by truncation and rounding. */
static double left_out(const workspace *w)
{
    double total = 0;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        total += (2 * p->tail + EPS * highest(p->of.size)) * p->time * p->count;
    }
    return total;
}

/* The integral, and its error where beta has the error `error`. */
static void whole_of(const workspace *w, double error, double *value, double *doubt)
{
    double total = 0, wrong = 0;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        total += total_of(p->series, w->by.mean) * p->time * p->count;
        wrong += total_of(p->of.spread, w->by.weight) * (2 * error) * p->time * p->count;
    }
    *value = total, *doubt = left_out(w) + wrong;
}

/* The error of the extremes. push: whether the error of a value includes what is counted as rounding of a push. */
static double worst_of(const workspace *w, double error, int push)
{
    double worst = -INFINITY;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double doubt[AT];
        for (int k = 0; k < AT; k++)
            doubt[k] = p->of.spread[k] * (2 * error) + (push ? 2 * p->tail + rod_tuning.barely * p->of.size[k] : 0);
        keep_larger(&worst, highest(doubt) + 2 * p->tail + EPS * highest(p->of.size));
    }
    return worst;
}

/* A push is none where it is smaller than its rounding: that of its terms, and that of an angle of one radian. Next to a
   straight rod the angle is smaller than any rounding of it, and so are all terms of the push. */
static double rounding_at(const density *push, int k) { return rod_tuning.barely * (push->size[k] + push->spread[k]); }

static double largest_rounding(const density *push)
{
    double rounding[AT];
    for (int k = 0; k < AT; k++)
        rounding[k] = rounding_at(push, k);
    return highest(rounding);
}

/* What one stretch adds: the shares on which the cylinder pushes and pulls, and the error of the first; and the mean of the
   push where it is positive. */
typedef struct {
    double area, share, lifted, unsure;
} parted;

/* The zeros of the push plus `many` times its rounding; returns whether it is positive at the start. */
static int zeros_beside(const workspace *w, const stretch *p, double many, double *c, sign_changes *found)
{
    double left[AT];
    for (int k = 0; k < AT; k++)
        left[k] = p->of.values[k] + many * rounding_at(&p->of, k);
    w->use.through(left, w->by.analyse, c);
    rod_changes(w, left, c, found);
    return left[0] > 0;
}

/* The share of a stretch on which a series is positive, from its zeros and whether it is at the start. */
static double positive_share(const sign_changes *found, int first)
{
    double share = first;
    for (int i = 0; i < found->count; i++)
        share += found->sign[i] * (1 - found->x[i]) / 2;
    return smaller(larger(share, 0), 1);
}

static parted parted_on(const workspace *w, const stretch *p, double whole, double largest_doubt)
{
    double c[AT];
    const double clear = fabs(p->series[0]) - range_of(p->series);
    if (clear > SURELY * largest_rounding(&p->of))
        return p->series[0] > 0 ? (parted){whole, 1, 0, 0} : (parted){0, 0, 1, 0};
    sign_changes pulled, found;
    const int held = zeros_beside(w, p, 1, c, &pulled), first = zeros_beside(w, p, -1, c, &found);
    parted out = {rod_positive_mean(w, p->of.values, whole, &found, first), positive_share(&found, first),
                  1 - positive_share(&pulled, held), 0};
    for (int i = 0; i < found.count; i++) {
        double rate, value;
        rod_series_and_rate(c, found.x[i], &value, &rate);
        const double moved = largest_doubt / fabs(rate);
        out.unsure += moved < 1 ? moved : 1;
    }
    return out;
}

/* The parts of the rod on which the cylinder pushes and pulls; the error of the push alone. An uncertain push has uncertain
   zeros, or may vanish on a whole stretch. */
static void pushes_of(const workspace *w, double error, double span, numbers *out)
{
    double pushed = 0, pulled = 0, share = 0, lifted = 0, unsure = 0, wrong = 0;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double doubt[AT], faint = 0;
        for (int k = 0; k < AT; k++) {
            doubt[k] = p->of.spread[k] * (2 * error) + 2 * p->tail + rod_tuning.barely * p->of.size[k];
            faint += (fabs(p->of.values[k]) < doubt[k]) & (p->of.values[k] != 0);
        }
        const double length = p->time * p->count, whole = total_of(p->series, w->by.mean);
        const parted part = parted_on(w, p, whole, highest(doubt));
        pushed += part.area * length, pulled += (part.area - whole) * length;
        share += part.share * length, lifted += part.lifted * length;
        unsure += (smaller(larger(part.unsure, faint / AT), 1) + EPS) * length;
        wrong += total_of(doubt, w->by.weight) * length;
    }
    if (fabs(share - span) < WHOLE * span)
        share = span;
    out->value[PUSHED] = out->value[PUSHED_ALONE] = pushed, out->value[PULLED] = pulled, out->value[SHARE] = share;
    out->value[LIFTED] = lifted, out->error[LIFTED] = unsure;
    out->error[PUSHED] = out->error[PUSHED_ALONE] = out->error[PULLED] = wrong, out->error[SHARE] = unsure;
}

/* The least t at which the push is less than `doubted` times its doubt, or less than none where that is 0. */
static double first_below(const workspace *w, double error, double doubted)
{
    double first = INFINITY;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double left[AT], c[AT];
        for (int k = 0; k < AT; k++) {
            const double doubt = p->of.spread[k] * (2 * error) + 2 * p->tail + rod_tuning.barely * p->of.size[k];
            left[k] = p->of.values[k] + (doubted != 0 ? -doubted * doubt : rounding_at(&p->of, k));
        }
        sign_changes found;
        w->use.through(left, w->by.analyse, c);
        rod_changes(w, left, c, &found);
        double share = left[0] < 0 ? 0 : INFINITY;
        for (int k = 0; k < found.count; k++)
            if (found.sign[k] < 0 && (1 + found.x[k]) / 2 < share)
                share = (1 + found.x[k]) / 2;
        if (p->begin + share * p->time < first)
            first = p->begin + share * p->time;
    }
    return first;
}

static void lift_offs_of(const workspace *w, double error, double span, numbers *out)
{
    const double first = smaller(first_below(w, error, 0), span);
    const double early = smaller(first_below(w, error, 1), span), late = smaller(first_below(w, error, -1), span);
    out->value[FIRST_LIFT] = first, out->error[FIRST_LIFT] = larger(late - first, first - early) + 8 * EPS * span;
}

static void range_of_angles(const workspace *w, int64_t pieces, numbers *out)
{
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < pieces; i++) {
        const double a = w->angles[i].beta[0], b = w->angles[i].beta[AT - 1];
        if (smaller(a, b) < low)
            low = smaller(a, b);
        keep_larger(&high, larger(a, b));
    }
    out->value[LOW] = low, out->value[HIGH] = high;
}

/* The integrals of measured.h, of all groups asked for. */
static int integrals_of(workspace *w, int64_t b, double error, numbers *out)
{
#define INTEGRAL_OF(group, id, name, rated, density) {group, id, density},
    static const struct { int group, name, kind; } rows[] = {INTEGRAL_ROWS(INTEGRAL_OF)};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!(w->all->groups >> rows[i].group & 1))
            continue;
        if (rod_resolved(w, b, rows[i].kind, INTEGRAL, w->all->goal))
            return NO_MEMORY;
        whole_of(w, error, &out->value[rows[i].name], &out->error[rows[i].name]);
    }
    return DONE;
}

int rod_measured_numbers(workspace *w, int64_t b, numbers *out)
{
    const rods *all = w->all;
    const double error = all->error[b];
    const int64_t groups = all->groups;
    if (rod_angles(w, b))
        return NO_MEMORY;
    if (groups >> ANGLES & 1) {
        out->error[LOW] = out->error[HIGH] = error;
        if (all->monotone)
            range_of_angles(w, all->first[b + 1] - all->first[b], out);
        else if (rod_resolved(w, b, ANGLE, EXTREMES, INFINITY))
            return NO_MEMORY;
        else
            out->value[LOW] = -rod_largest(w, -1), out->value[HIGH] = rod_largest(w, 1);
    }
    if (groups >> CURVATURES & 1) {
        if (rod_resolved(w, b, CURVATURE, EXTREMES, all->goal))
            return NO_MEMORY;
        whole_of(w, error, &out->value[CURVED], &out->error[CURVED]);
        out->value[TIGHTEST] = rod_largest(w, 1), out->error[TIGHTEST] = worst_of(w, error, 0);
    }
    if (groups & (1 << PUSHES | 1 << PUSH_ALONE | 1 << LIFT_OFFS | 1 << PEAKS)) {
        if (rod_resolved(w, b, OUTWARD, SIGNS, all->goal))
            return NO_MEMORY;
        if (groups & (1 << PUSHES | 1 << PUSH_ALONE))
            pushes_of(w, error, all->span[b], out);
        if (groups >> PUSHES & 1) {
            out->value[LEAST] = -rod_largest(w, -1), out->value[GREATEST] = rod_largest(w, 1);
            out->error[LEAST] = out->error[GREATEST] = worst_of(w, error, 1);
        }
        if (groups >> LIFT_OFFS & 1)
            lift_offs_of(w, error, all->span[b], out);
        if (groups >> PEAKS & 1 &&
            rod_first_peak(w, worst_of(w, error, 1), all->span[b], rod_tuning.barely, &out->value[PEAK], &out->error[PEAK]))
            return NO_MEMORY;
    }
    if (groups >> TENSIONS & 1) {
        if (rod_resolved(w, b, TENSION, EXTREMES, all->goal))
            return NO_MEMORY;
        out->value[LARGEST_TENSION] = larger(fabs(rod_largest(w, 1)), fabs(rod_largest(w, -1)));
        out->error[LARGEST_TENSION] = worst_of(w, error, 0);
    }
    return integrals_of(w, b, error, out);
}

/* Measures rods from `begin` to `end` into out: (n, 2, NUMBERS), values and errors of the groups asked for.

   lanes: what rod_lanes says, or fewer; changes no bit. Returns DONE, NO_MEMORY or NOT_POSSIBLE: series
   longer than LONGEST. */
int rod_measure(const rods *all, numbers *out, int64_t begin, int64_t end, int lanes)
{
    if (all->coefficients < 1 || all->coefficients > LONGEST)
        return NOT_POSSIBLE;
    workspace *w = rod_workspace(all, lanes);
    int failed = w ? DONE : NO_MEMORY;
    for (int64_t b = begin; b < end && !failed; b++)
        failed = rod_measured_numbers(w, b, out + b);
    rod_workspace_free(w);
    return failed;
}

/* A density and its derivatives at points of rods under loads that are the same along them.

   loads: (rods, 4), lam, mu, phi and the sign of the push. beta, rate: (rods, n), beta and beta_t, whose sign does not
   matter. out: (8, rods, n), the values, the sums of the sizes of their terms, the spread, and the derivatives with respect to
   beta, |beta_t|, lam, mu and phi. */
void rod_densities(int kind, int64_t rods, int64_t n, const double *loads, const double *beta, const double *rate,
                   double *out)
{
    for (int64_t b = 0; b < rods; b++) {
        rod_loads l;
        steady_loads(loads[4 * b], loads[4 * b + 1], loads[4 * b + 2], loads[4 * b + 3], &l);
        for (int64_t k = 0; k < n; k += AT) {
            const int64_t at = b * n + k, many = n - k < AT ? n - k : AT;
            node_angles angles = {0};
            density found;
            density_slopes by = {0};
            for (int64_t i = 0; i < many; i++)
                angles.beta[i] = beta[at + i], angles.speed[i] = fabs(rate[at + i]);
            directions_of(&angles);
            density_of(kind, &angles, &l, &found, &by);
            const double *rows[8] = {found.values, found.size, found.spread, by.beta, by.speed, by.lam, by.mu, by.phi};
            for (int row = 0; row < 8; row++)
                memcpy(out + row * rods * n + at, rows[row], sizeof(double) * (size_t)many);
        }
    }
}

/* The table of measured.h as text: the names of the densities, and of each number its group, its name and whether it has
   rates, with a bar before each. */
#define DENSITY_TEXT(id, name) #name " "
#define NUMBER_TEXT(group, id, name, rated, ...) "|" #group " " #name " " #rated
const char *rod_measured(void) { return DENSITY_ROWS(DENSITY_TEXT) NUMBER_ROWS(NUMBER_TEXT); }
