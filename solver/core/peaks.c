/* Where a density is largest along a rod: the first place, how far the others are that may be larger, and all places.
   Where densities turn and change their sign. */

#include "stretches.h"

enum { MOST_ON_A_PART = AT + 1 };
#define FAINT 1e-9 /* of the largest value: a density that changes by less on a part has no landmark there */

static double begin_of(const workspace *w)
{
    double begin = INFINITY;
    for (int64_t i = 0; i < w->count; i++)
        begin = smaller(begin, w->parts[i].begin);
    return begin;
}

static double equal_below(const workspace *w, double barely)
{
    double same = -INFINITY;
    for (int64_t i = 0; i < w->count; i++)
        keep_larger(&same, barely * highest(w->parts[i].of.size) + 4 * w->parts[i].tail);
    return same;
}

static double least_of(const workspace *w)
{
    double least = INFINITY;
    for (int64_t i = 0; i < w->count; i++)
        for (int k = 0; k < AT; k++)
            least = smaller(least, w->parts[i].of.values[k]);
    return least;
}

/* Adds the places in [-1, 1] where a density stops to rise, or with the sign -1 to fall; returns their number. */
static int turns_on(const workspace *w, const stretch *p, const double *rate, double sign, double *x)
{
    const double *nodes = w->by.nodes;
    int count = 0;
    for (int k = 0; k + 1 < AT; k++)
        if (sign * rate[k] > 0 && sign * rate[k + 1] <= 0)
            x[count++] = rod_turning_place(p->series, -sign, nodes[k], nodes[k + 1]);
    return count;
}

/* Adds the local maxima of a part; returns their number. */
static int maxima_on(const workspace *w, const stretch *p, double begin, maximum *out)
{
    double rate[AT], x[MOST_ON_A_PART];
    w->use.through(p->series, w->by.differentiate, rate);
    int count = turns_on(w, p, rate, 1, x);
    if (rate[0] <= 0 || p->begin <= begin)
        x[count++] = -1;
    if (rate[AT - 1] >= 0)
        x[count++] = 1;
    for (int k = 0; k < count; k++)
        out[k] = (maximum){p, x[k], p->begin + (1 + x[k]) / 2 * p->time, at_place(p->series, AT, x[k])};
    return count;
}

/* How far from a place the density falls by twice its doubt. noise: how much of the rounding of the derivatives is taken
   off them. */
static double width_at(const maximum *m, double doubt, double noise)
{
    const stretch *p = m->part;
    double slopes[AT], slope, bend;
    const double rounding = noise * AT * AT * (EPS * highest(p->of.size) + p->tail);
    rod_derivative(p->series, slopes);
    rod_series_and_rate(slopes, m->x, &slope, &bend);
    slope = larger(fabs(slope) - rounding, 0), bend = larger(fabs(bend) - AT * AT * rounding, 0);
    return fmin(sqrt(4 * doubt / bend), 2 * doubt / slope) * p->time / 2;
}

/* The place of the largest value among n local maxima, the first within `doubt`, and its error. */
static void first_of(const maximum *m, int64_t n, double doubt, double same, double *place, double *error)
{
    double best = -INFINITY, first = INFINITY, width = -INFINITY, there = -INFINITY, far = 0;
    for (int64_t i = 0; i < n; i++)
        keep_larger(&best, m[i].value);
    for (int64_t i = 0; i < n; i++)
        if (m[i].value >= best - doubt && m[i].t < first)
            first = m[i].t;
    for (int64_t i = 0; i < n; i++)
        if (m[i].value >= best - doubt && m[i].t == first)
            keep_larger(&width, width_at(&m[i], doubt, 0));
    for (int64_t i = 0; i < n; i++) /* the end of a part may be next to the maximum */
        if (m[i].t >= first && m[i].t <= first + width)
            keep_larger(&there, m[i].value);
    *place = INFINITY;
    for (int64_t i = 0; i < n; i++)
        if (m[i].t >= first && m[i].t <= first + width && m[i].value == there && m[i].t < *place)
            *place = m[i].t;
    for (int64_t i = 0; i < n; i++) {
        if (m[i].value >= best - 2 * doubt && fabs(m[i].value - there) > same)
            keep_larger(&far, fabs(m[i].t - *place));
        if (m[i].t == *place && m[i].value == there)
            keep_larger(&far, width_at(&m[i], doubt, 1));
    }
    *error = far;
}

/* The first t at which the density is largest, and the error of that t.

   A density that is the same all along, within `doubt`, has it at t = 0. What a rod passes backward, it passed forward
   before, with the same values; so only the way forward counts. doubt: the error of the largest value; of the local maxima
   whose values are the largest within `doubt`, the first counts. The error is the largest distance to a t at which a
   density with this error may be larger. Returns DONE or NO_MEMORY. */
int rod_first_peak(workspace *w, double doubt, double span, double barely, double *value, double *error)
{
    const double top = rod_largest(w, 1), begin = begin_of(w), same = equal_below(w, barely), varies = top - least_of(w);
    double place = 0, far = 0;
    int64_t count = 0;
    doubt = isnan(doubt) ? 0 : doubt;
    for (int64_t i = 0; i < w->count && !(varies <= same); i++) {
        const stretch *p = &w->parts[i];
        if (p->series[0] + range_of(p->series) < top - 4 * doubt - same)
            continue;
        if (rod_roomy((void **)&w->maxima, &w->maximum_room, count + MOST_ON_A_PART, sizeof(maximum)))
            return NO_MEMORY;
        count += maxima_on(w, p, begin, w->maxima + count);
    }
    if (!(varies <= same))
        first_of(w->maxima, count, doubt, same, &place, &far);
    if (varies <= doubt)
        place = 0;
    *value = isfinite(place) ? place : NAN, *error = smaller(far, span) + 8 * EPS * span;
    return DONE;
}

static void turn_over(workspace *w)
{
    for (int64_t i = 0; i < w->count; i++)
        for (int k = 0; k < AT; k++)
            w->parts[i].of.values[k] *= -1, w->parts[i].series[k] *= -1;
}

/* The times (most,) up to `until` at which the density, or with `turn` -1 minus it, is largest, all that are equal to `same`
   of it. Returns their number, -1 where memory is short. */
int rod_places(workspace *w, double turn, double until, double same, int most, double *t)
{
    const double begin = begin_of(w);
    double best = -INFINITY;
    int64_t count = 0;
    int found = 0;
    if (turn < 0)
        turn_over(w);
    for (int64_t i = 0; i < w->count; i++) {
        if (rod_roomy((void **)&w->maxima, &w->maximum_room, count + MOST_ON_A_PART, sizeof(maximum)))
            return -1;
        count += maxima_on(w, &w->parts[i], begin, w->maxima + count);
    }
    for (int64_t i = 0; i < count; i++)
        if (w->maxima[i].t <= until)
            keep_larger(&best, w->maxima[i].value);
    for (int64_t i = 0; i < count && found < most; i++)
        if (w->maxima[i].t <= until && w->maxima[i].value >= best - same * fabs(best))
            t[found++] = w->maxima[i].t;
    if (turn < 0)
        turn_over(w);
    return found;
}

/* The places in [-1, 1] of a part where the density turns, or, where it is the push, vanishes; returns their number. top: of the
   density along the rod. */
static int landmarks_on(const workspace *w, const stretch *p, double top, int push, double *x)
{
    double rate[AT];
    int count = 0;
    if (range_of(p->series) > FAINT * top) {
        w->use.through(p->series, w->by.differentiate, rate);
        count = turns_on(w, p, rate, 1, x);
        count += turns_on(w, p, rate, -1, x + count);
    }
    if (push && fabs(p->series[0]) - range_of(p->series) <= 0 && top > FAINT * highest(p->of.size)) {
        sign_changes found;
        rod_changes(w, p->of.values, p->series, &found);
        for (int k = 0; k < found.count; k++)
            x[count++] = found.x[k];
    }
    return count;
}

/* The times at which beta, the curvature and the push of one rod turn and the push changes its sign: t (most,), as many as
   there is room for. Returns their number, or -1 if there is no memory. The others: as of rod_measure. */
int64_t rod_landmarks(const rods *all, int64_t most, double *t, int lanes)
{
    static const int kinds[3] = {ANGLE, CURVATURE, OUTWARD};
    workspace *w = rod_workspace(all, lanes);
    int64_t count = 0;
    int failed = !w || rod_angles(w, 0);
    for (int k = 0; k < 3 && !failed; k++) {
        failed = rod_resolved(w, 0, kinds[k], SIGNS, all->goal);
        const double top = failed ? 0 : larger(rod_largest(w, 1), rod_largest(w, -1));
        for (int64_t i = 0; i < w->count && !failed; i++) {
            const stretch *p = &w->parts[i];
            double x[2 * AT + CROSSINGS];
            const int found = landmarks_on(w, p, top, kinds[k] == OUTWARD, x);
            for (int j = 0; j < found && count < most; j++)
                t[count++] = p->begin + (1 + x[j]) / 2 * p->time;
        }
    }
    rod_workspace_free(w);
    return failed ? -1 : count;
}
