/* The numbers measured along each rod, integrals and extremes of densities: solver/observe/quadrature.py and
   measurement.py. One rod at a time; the result for a rod does not depend on the others. */

#include "densities.h"

enum { ROUNDS = 48, PATIENCE = 3, MOST = 1 << 19, CROSSINGS = 4 * AT };
enum { ANGLES, CURVATURES, BENDINGS, POTENTIALS, PUSHES, PUSH_ALONE, LIFT_OFFS, TENSIONS, DIRECTIONS }; /* GROUPS */
enum { LOW, HIGH, CURVED, TIGHTEST, BENT, POTENTIAL_ENERGY, PUSHED, PULLED, SHARE, LEAST, GREATEST, PUSHED_ALONE, LIFTS,
       LARGEST_TENSION, TURNED, RISEN, NUMBERS };
#define ROUNDING (64 * EPS) /* of the terms of a density, and of beta: a series cannot end below that */
#define BARELY (64 * EPS)   /* of the size of its terms: a push below this is rounding */
#define SURELY 1e4          /* times that: a push beyond this is none by the series of either */

/* The pieces of the rods, those of rod b from first[b] to first[b + 1]: `rod_pieces.Pieces`. The others: (n,). */
typedef struct {
    int64_t coefficients, monotone, groups;
    double goal;
    const double *series;
    const int64_t *first, *row;
    const double *low, *high, *time, *count, *begin, *lam, *mu, *phi, *span, *beta0, *sign, *error;
    points at;
} rods;

/* A piece, or a part of one, with a density on it. tail: what its series leaves out. */
typedef struct {
    int64_t row;
    double low, high, time, count, begin, series[AT], tail;
    density of;
} stretch;

/* A stretch that may have to be halved. before: the tail of the one of which it is a half. */
typedef struct {
    stretch part;
    double before;
    int stuck, round;
} candidate;

typedef struct {
    double mean[AT], weight[AT], polynomials[LONGEST * AT];
} rule;

/* The functions in which most time is spent, for the lanes of the processor; all give the same bits. */
typedef struct {
    void (*angles)(const rods *, const rule *, const stretch *, node_angles *);
    void (*expanded)(const rods *, int kind, const node_angles *, const rod_loads *, stretch *);
    void (*through)(const double *values, const double *linear, double *out);
} kernels;

/* What a call needs: room for the angles of the pieces of a rod, and for the stretches of a density. */
typedef struct {
    const rods *all;
    rule by;
    kernels use;
    int64_t angle_room, room, count;
    node_angles *angles;
    stretch *parts;
    candidate waiting[2 * ROUNDS + 4];
} workspace;

static int roomy(void **array, int64_t *room, int64_t wanted, size_t size)
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

INLINE double highest(const double *values)
{
    double best = values[0];
    for (int i = 1; i < AT; i++)
        best = larger(best, values[i]);
    return best;
}

INLINE double total_of(const double *values, const double *weight)
{
    double total = 0;
    for (int i = 0; i < AT; i++)
        total += values[i] * weight[i];
    return total;
}

/* How far a series may be from its first coefficient. */
INLINE double range_of(const double *series)
{
    double total = 0;
    for (int k = 1; k < AT; k++)
        total += fabs(series[k]);
    return total;
}

/* Keeps the best, as np.fmax.at does. */
INLINE void keep_larger(double *best, double value)
{
    if (value > *best)
        *best = value;
}

INLINE void angles_on(const rods *all, const rule *by, const stretch *p, node_angles *out)
{
    const int n = (int)all->coefficients;
    const double *series = all->series + 2 * n * p->row;
    if (p->low == -1 && p->high == 1) {
        angles_at(n, series, by->polynomials, out);
        return;
    }
    double x[AT], polynomials[LONGEST * AT];
    for (int i = 0; i < AT; i++)
        x[i] = smaller(larger(p->low + (p->high - p->low) * (1 + all->at.nodes[i]) / 2, -1), 1);
    polynomials_at(n, x, polynomials);
    angles_at(n, series, polynomials, out);
}

INLINE void expanded(const rods *all, int kind, const node_angles *angles, const rod_loads *loads, stretch *p)
{
    density_of(kind, angles, loads, &p->of);
    product(AT, AT, p->of.values, all->at.analyse, p->series);
    p->tail = larger(larger(fabs(p->series[AT - 3]), fabs(p->series[AT - 2])), fabs(p->series[AT - 1]));
}

/* The kernels above for lanes of one width. */
#define KERNELS(TARGET, SUFFIX)                                                                                        \
    static TARGET void angles_##SUFFIX(const rods *all, const rule *by, const stretch *p, node_angles *out)            \
    {                                                                                                                  \
        angles_on(all, by, p, out);                                                                                    \
    }                                                                                                                  \
    static TARGET void expanded_##SUFFIX(const rods *all, int kind, const node_angles *a, const rod_loads *l,          \
                                         stretch *p)                                                                   \
    {                                                                                                                  \
        expanded(all, kind, a, l, p);                                                                                  \
    }                                                                                                                  \
    static TARGET void through_##SUFFIX(const double *values, const double *linear, double *out)                       \
    {                                                                                                                  \
        product(AT, AT, values, linear, out);                                                                          \
    }

#define NARROW
KERNELS(NARROW, narrow)
#ifdef WIDE
KERNELS(WIDE, wide)
#endif

static kernels kernels_for(int lanes)
{
#ifdef WIDE
    if (lanes >= 4)
        return (kernels){angles_wide, expanded_wide, through_wide};
#endif
    (void)lanes;
    return (kernels){angles_narrow, expanded_narrow, through_narrow};
}

/* Which precision a density needs: of its integral, of its largest value, or of all values. */
enum { INTEGRAL, EXTREMES, SIGNS };

typedef struct {
    int kind, precision;
    double goal, total, top, beta0;
} wanted;

static double absolute_top(const stretch *p)
{
    double best = fabs(p->of.values[0]);
    for (int i = 1; i < AT; i++)
        best = larger(best, fabs(p->of.values[i]));
    return best;
}

static int insufficient(const wanted *goal, const stretch *p)
{
    const double top = absolute_top(p), length = p->time * p->count;
    int bad = p->tail * length > goal->goal * goal->total / 8;
    if (goal->precision == SIGNS)
        bad |= p->tail > goal->goal * top;
    else if (goal->precision == EXTREMES)
        bad |= (p->tail > goal->goal * top) & (top + 16 * p->tail >= goal->top);
    if (!bad)
        return 0;
    double floor_[AT];
    for (int i = 0; i < AT; i++)
        floor_[i] = p->of.size[i] + p->of.spread[i] * goal->beta0;
    return p->tail > ROUNDING * highest(floor_);
}

static void halved(const stretch *p, int second, stretch *out)
{
    const double middle = (p->low + p->high) / 2;
    out->row = p->row, out->count = p->count, out->time = p->time / 2;
    out->low = second ? middle : p->low, out->high = second ? p->high : middle;
    out->begin = p->begin + (second ? out->time : 0.0);
}

/* Adds the parts of a piece on which the series of the density converges. */
static int refined(workspace *w, const wanted *goal, const rod_loads *loads, const stretch *piece)
{
    int waiting = 1;
    node_angles angles;
    w->waiting[0] = (candidate){*piece, INFINITY, 0, 0};
    while (waiting > 0) {
        const candidate one = w->waiting[--waiting];
        const int stuck = one.stuck + (one.part.tail > 0.7 * one.before);
        if (insufficient(goal, &one.part) && stuck < PATIENCE && one.round < ROUNDS &&
            one.part.high - one.part.low > 1e-13 && w->count < MOST) {
            for (int second = 1; second >= 0; second--) {
                candidate *half = &w->waiting[waiting++];
                halved(&one.part, second, &half->part);
                half->before = one.part.tail, half->stuck = stuck, half->round = one.round + 1;
                w->use.angles(w->all, &w->by, &half->part, &angles);
                w->use.expanded(w->all, goal->kind, &angles, loads, &half->part);
            }
            continue;
        }
        if (roomy((void **)&w->parts, &w->room, w->count + 1, sizeof(stretch)))
            return NO_MEMORY;
        w->parts[w->count++] = one.part;
    }
    return DONE;
}

/* The density on the parts of rod b: `quadrature.resolve`. */
static int resolved(workspace *w, int64_t b, int kind, int precision, double allowed, const rod_loads *loads)
{
    const rods *all = w->all;
    const int64_t pieces = all->first[b + 1] - all->first[b];
    wanted goal = {kind, precision, allowed, 0, -INFINITY, larger(1, fabs(all->beta0[b]))};
    w->count = 0;
    if (roomy((void **)&w->parts, &w->room, pieces, sizeof(stretch)))
        return NO_MEMORY;
    for (int64_t i = 0; i < pieces; i++) {
        const int64_t j = all->first[b] + i;
        stretch *p = &w->parts[i];
        p->row = all->row[j], p->low = all->low[j], p->high = all->high[j];
        p->time = all->time[j], p->count = all->count[j], p->begin = all->begin[j];
        w->use.expanded(all, kind, &w->angles[i], loads, p);
        double absolute[AT];
        for (int k = 0; k < AT; k++)
            absolute[k] = fabs(p->of.values[k]);
        goal.total += total_of(absolute, w->by.weight) * p->time * p->count;
        keep_larger(&goal.top, highest(absolute));
    }
    int64_t kept = 0;
    w->count = pieces;
    for (int64_t i = 0; i < pieces; i++) { /* those that suffice close up, the parts of the others stand behind them */
        const stretch piece = w->parts[i];
        if (!insufficient(&goal, &piece))
            w->parts[kept++] = piece;
        else if (refined(w, &goal, loads, &piece))
            return NO_MEMORY;
    }
    if (w->count > pieces)
        memmove(w->parts + kept, w->parts + pieces, sizeof(stretch) * (size_t)(w->count - pieces));
    w->count -= pieces - kept;
    return DONE;
}

/* A series and how often it has been differentiated, as `rod_bracketed` reads it. */
static void series_and_rate(const void *of, double x, double *value, double *rate)
{
    const double *c = of;
    double b1 = 0, b2 = 0, d1 = 0, d2 = 0;
    for (int k = AT - 1; k > 0; k--) {
        const double b0 = 2 * x * b1 - b2 + c[k], d0 = 2 * x * d1 - d2 + 2 * b1;
        b2 = b1, b1 = b0, d2 = d1, d1 = d0;
    }
    *value = x * b1 - b2 + c[0], *rate = x * d1 - d2 + b1;
}

static double series_value(const double *c, double x)
{
    double value, rate;
    series_and_rate(c, x, &value, &rate);
    return value;
}

/* Where the derivative of a series, times `sign` rising through zero between two places, is zero. */
static double turning_place(const double *c, double sign, double low, double high)
{
    double slopes[AT + 1] = {0};
    for (int k = AT - 1; k > 0; k--)
        slopes[k - 1] = (k + 1 < AT ? slopes[k + 1] : 0) + 2 * k * sign * c[k];
    slopes[0] /= 2;
    return rod_bracketed(series_and_rate, slopes, low, high, (low + high) / 2);
}

/* The largest value, times sign. */
static double largest_of(const workspace *w, double sign)
{
    const double *nodes = w->all->at.nodes;
    double best = -INFINITY;
    for (int64_t i = 0; i < w->count; i++) {
        double values[AT];
        for (int k = 0; k < AT; k++)
            values[k] = sign * w->parts[i].of.values[k];
        keep_larger(&best, highest(values));
    }
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double rate[AT];
        if (sign * p->series[0] + range_of(p->series) <= best)
            continue;
        w->use.through(p->series, w->all->at.differentiate, rate);
        for (int k = 0; k + 1 < AT; k++) {
            const double r0 = sign * rate[k], r1 = sign * rate[k + 1], width = nodes[k + 1] - nodes[k];
            if (!(r0 > 0 && r1 < 0))
                continue;
            const double v0 = sign * p->of.values[k], v1 = sign * p->of.values[k + 1];
            if (larger(v0 + r0 * width, v1 - r1 * width) > best)
                keep_larger(&best, sign * series_value(p->series, turning_place(p->series, -sign, nodes[k], nodes[k + 1])));
        }
    }
    return best;
}

typedef struct {
    int count;
    double x[CROSSINGS], sign[CROSSINGS];
} sign_changes;

static void add_change(sign_changes *found, const double *c, double low, double high, int rises)
{
    found->x[found->count] = rod_bracketed(series_and_rate, c, low, high, (low + high) / 2);
    found->sign[found->count++] = rises ? 1 : -1;
}

/* Where values with these coefficients change sign, twice in a cell included: `Resolved.crossings`. */
static void changes_of(const workspace *w, const double *values, const double *c, sign_changes *found)
{
    const points *at = &w->all->at;
    double rate[AT];
    found->count = 0;
    for (int k = 0; k + 1 < AT; k++) {
        const double a = at->nodes[k], b = at->nodes[k + 1];
        const int up = values[k + 1] > 0;
        if (up != (values[k] > 0))
            add_change(found, c, up ? a : b, up ? b : a, up);
    }
    w->use.through(c, at->differentiate, rate);
    for (int k = 0; k + 1 < AT; k++) {
        const double a = at->nodes[k], b = at->nodes[k + 1], sign = values[k] > 0 ? 1 : -1;
        const double v0 = sign * values[k], v1 = sign * values[k + 1], r0 = sign * rate[k], r1 = sign * rate[k + 1];
        if ((values[k] > 0) != (values[k + 1] > 0) || !(r0 < 0 && r1 > 0))
            continue;
        if (!(v0 + r0 * (b - a) < 0 || v1 - r1 * (b - a) < 0))
            continue;
        const double x = turning_place(c, sign, a, b);
        if (!(sign * series_value(c, x) < 0))
            continue;
        if (sign > 0)
            add_change(found, c, x, a, 0), add_change(found, c, x, b, 1);
        else
            add_change(found, c, a, x, 1), add_change(found, c, b, x, 0);
    }
}

typedef struct {
    double value[NUMBERS], error[NUMBERS];
} numbers;

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
static void integrated(const workspace *w, double error, double *value, double *doubt)
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
            doubt[k] = p->of.spread[k] * (2 * error) + (push ? 2 * p->tail + BARELY * p->of.size[k] : 0);
        keep_larger(&worst, highest(doubt) + 2 * p->tail + EPS * highest(p->of.size));
    }
    return worst;
}

/* What one stretch adds: the share on which the cylinder pushes, and its error; and the mean of the push there. */
typedef struct {
    double area, share, unsure;
} parted;

static parted parted_on(const workspace *w, const stretch *p, double whole, double largest_doubt)
{
    const points *at = &w->all->at;
    double left[AT], c[AT], integral_[AT + 1];
    const double clear = fabs(p->series[0]) - range_of(p->series), size = highest(p->of.size);
    if (clear > SURELY * BARELY * size)
        return p->series[0] > 0 ? (parted){whole, 1, 0} : (parted){0, 0, 0};
    for (int k = 0; k < AT; k++)
        left[k] = p->of.values[k] - BARELY * p->of.size[k];
    sign_changes found;
    w->use.through(left, at->analyse, c);
    changes_of(w, left, c, &found);
    const int first = left[0] > 0;
    parted out = {first ? whole : 0, first, 0};
    if (!found.count)
        return out;
    integral(AT, p->series, integral_);
    double end = 0;
    for (int k = 0; k <= AT; k++)
        end += integral_[k];
    for (int i = 0; i < found.count; i++) {
        double rate, value, before = series_value(integral_, found.x[i]);
        before += integral_[AT] * cos(AT * acos(smaller(larger(found.x[i], -1), 1)));
        series_and_rate(c, found.x[i], &value, &rate);
        const double moved = largest_doubt / fabs(rate);
        out.area += found.sign[i] * (end - before) / 2;
        out.share += found.sign[i] * (1 - found.x[i]) / 2;
        out.unsure += moved < 1 ? moved : 1;
    }
    out.share = smaller(larger(out.share, 0), 1);
    return out;
}

/* The parts of the rod on which the cylinder pushes and pulls: `measurement._parted`; the error of the push alone. */
static void pushes_of(const workspace *w, double error, numbers *out)
{
    double pushed = 0, pulled = 0, share = 0, unsure = 0, wrong = 0;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double doubt[AT], faint = 0;
        for (int k = 0; k < AT; k++) {
            doubt[k] = p->of.spread[k] * (2 * error) + 2 * p->tail + BARELY * p->of.size[k];
            faint += (fabs(p->of.values[k]) < doubt[k]) & (p->of.values[k] != 0);
        }
        const double length = p->time * p->count, whole = total_of(p->series, w->by.mean);
        const parted part = parted_on(w, p, whole, highest(doubt));
        pushed += part.area * length, pulled += (part.area - whole) * length, share += part.share * length;
        unsure += (smaller(larger(part.unsure, faint / AT), 1) + EPS) * length;
        wrong += total_of(doubt, w->by.weight) * length;
    }
    out->value[PUSHED] = out->value[PUSHED_ALONE] = pushed, out->value[PULLED] = pulled, out->value[SHARE] = share;
    out->error[PUSHED] = out->error[PUSHED_ALONE] = out->error[PULLED] = wrong, out->error[SHARE] = unsure;
}

/* The least t at which the push is less than `barely` times its rounding and `doubted` times its doubt. */
static double first_below(const workspace *w, double error, double barely, double doubted)
{
    double first = INFINITY;
    for (int64_t i = 0; i < w->count; i++) {
        const stretch *p = &w->parts[i];
        double left[AT], c[AT];
        for (int k = 0; k < AT; k++) {
            const double doubt = p->of.spread[k] * (2 * error) + 2 * p->tail + BARELY * p->of.size[k];
            left[k] = p->of.values[k] - (doubted != 0 ? doubted * doubt : barely * (BARELY * p->of.size[k]));
        }
        sign_changes found;
        w->use.through(left, w->all->at.analyse, c);
        changes_of(w, left, c, &found);
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
    const double first = smaller(first_below(w, error, -1, 0), span);
    const double early = smaller(first_below(w, error, 0, 1), span), late = smaller(first_below(w, error, 0, -1), span);
    out->value[LIFTS] = first, out->error[LIFTS] = larger(late - first, first - early) + 8 * EPS * span;
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

static int angles_of(workspace *w, int64_t b)
{
    const rods *all = w->all;
    const int64_t pieces = all->first[b + 1] - all->first[b];
    if (roomy((void **)&w->angles, &w->angle_room, pieces, sizeof(node_angles)))
        return NO_MEMORY;
    for (int64_t i = 0; i < pieces; i++) {
        const int64_t j = all->first[b] + i;
        const stretch p = {.row = all->row[j], .low = all->low[j], .high = all->high[j]};
        w->use.angles(all, &w->by, &p, &w->angles[i]);
    }
    return DONE;
}

/* Integrals, of all groups asked for that need no extremes. */
static int integrals_of(workspace *w, int64_t b, const rod_loads *loads, double error, numbers *out)
{
    static const int kinds[4] = {BENDING, POTENTIAL, ACROSS, ALONG}, names[4] = {BENT, POTENTIAL_ENERGY, TURNED, RISEN};
    static const int groups[4] = {BENDINGS, POTENTIALS, DIRECTIONS, DIRECTIONS};
    for (int i = 0; i < 4; i++) {
        if (!(w->all->groups >> groups[i] & 1))
            continue;
        if (resolved(w, b, kinds[i], INTEGRAL, w->all->goal, loads))
            return NO_MEMORY;
        integrated(w, error, &out->value[names[i]], &out->error[names[i]]);
    }
    return DONE;
}

static int measured(workspace *w, int64_t b, numbers *out)
{
    const rods *all = w->all;
    const double lam = all->lam[b], mu = all->mu[b], phi = all->phi[b], error = all->error[b];
    const rod_loads loads = {lam, mu, phi, all->sign[b], sqrt(fabs(lam) + 2 * fabs(mu) + fabs(phi) + 2)};
    const int64_t groups = all->groups;
    if (angles_of(w, b))
        return NO_MEMORY;
    if (groups >> ANGLES & 1) {
        out->error[LOW] = out->error[HIGH] = error;
        if (all->monotone)
            range_of_angles(w, all->first[b + 1] - all->first[b], out);
        else if (resolved(w, b, ANGLE, EXTREMES, INFINITY, &loads))
            return NO_MEMORY;
        else
            out->value[LOW] = -largest_of(w, -1), out->value[HIGH] = largest_of(w, 1);
    }
    if (groups >> CURVATURES & 1) {
        if (resolved(w, b, CURVATURE, EXTREMES, all->goal, &loads))
            return NO_MEMORY;
        integrated(w, error, &out->value[CURVED], &out->error[CURVED]);
        out->value[TIGHTEST] = largest_of(w, 1), out->error[TIGHTEST] = worst_of(w, error, 0);
    }
    if (groups & (1 << PUSHES | 1 << PUSH_ALONE | 1 << LIFT_OFFS)) {
        if (resolved(w, b, OUTWARD, SIGNS, all->goal, &loads))
            return NO_MEMORY;
        if (groups & (1 << PUSHES | 1 << PUSH_ALONE))
            pushes_of(w, error, out);
        if (groups >> PUSHES & 1) {
            out->value[LEAST] = -largest_of(w, -1), out->value[GREATEST] = largest_of(w, 1);
            out->error[LEAST] = out->error[GREATEST] = worst_of(w, error, 1);
        }
        if (groups >> LIFT_OFFS & 1)
            lift_offs_of(w, error, all->span[b], out);
    }
    if (groups >> TENSIONS & 1) {
        if (resolved(w, b, TENSION, EXTREMES, all->goal, &loads))
            return NO_MEMORY;
        out->value[LARGEST_TENSION] = larger(fabs(largest_of(w, 1)), fabs(largest_of(w, -1)));
        out->error[LARGEST_TENSION] = worst_of(w, error, 0);
    }
    return integrals_of(w, b, &loads, error, out);
}

static void prepare(rule *by, const rods *all)
{
    for (int k = 0; k < AT; k++)
        by->mean[k] = k % 2 ? 0 : 1 / (1 - (double)k * k);
    for (int i = 0; i < AT; i++)
        by->weight[i] = total_of(all->at.analyse + AT * i, by->mean);
    polynomials_at((int)(all->coefficients > 2 ? all->coefficients : 2), all->at.nodes, by->polynomials);
}

/* Measures rods from `begin` to `end` into out: (n, 2, NUMBERS), values and errors of the groups asked for.

   lanes: what rod_lanes says, or fewer; changes no bit. Returns DONE, NO_MEMORY or NOT_POSSIBLE: other nodes than AT, or
   series longer than LONGEST. */
int rod_measure(const rods *all, numbers *out, int64_t begin, int64_t end, int lanes)
{
    if (all->at.n != AT || all->coefficients < 1 || all->coefficients > LONGEST)
        return NOT_POSSIBLE;
    workspace *w = calloc(1, sizeof(workspace));
    int failed = w ? DONE : NO_MEMORY;
    if (w) {
        w->all = all, w->use = kernels_for(lanes);
        prepare(&w->by, all);
    }
    for (int64_t b = begin; b < end && !failed; b++)
        failed = measured(w, b, out + b);
    if (w)
        free(w->angles), free(w->parts), free(w);
    return failed;
}
