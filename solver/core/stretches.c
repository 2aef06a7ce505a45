/* Densities on the pieces of a rod, and their extremes and changes of sign. */

#include "stretches.h"

enum { PATIENCE = 3, MOST = 1 << 19 }; /* halvings that may fail to shorten a series; parts of the pieces of a rod */

/* loads: NULL where they do not vary. */
INLINE void angles_on(int width, const rods *all, const rule *by, const stretch *p, node_angles *out, rod_loads *loads)
{
    const int n = (int)all->coefficients;
    const double *series = all->series + all->kinds * n * p->row, *polynomials = by->polynomials;
    double x[AT], inner[LONGEST * AT];
    if (p->low != -1 || p->high != 1) {
        for (int i = 0; i < AT; i++)
            x[i] = smaller(larger(p->low + (p->high - p->low) * (1 + by->nodes[i]) / 2, -1), 1);
        polynomials_at(n, x, inner);
        polynomials = inner;
    }
    angles_at(width, n, series, polynomials, out);
    if (loads)
        loads_at(width, n, series + 2 * n, polynomials, loads);
}

INLINE void expanded(int width, const rule *by, int kind, const node_angles *angles, const rod_loads *loads, stretch *p)
{
    density_slopes unread;
    density_of(kind, angles, loads, &p->of, &unread);
    product(width, AT, AT, p->of.values, by->analyse, p->series);
    p->tail = larger(larger(fabs(p->series[AT - 3]), fabs(p->series[AT - 2])), fabs(p->series[AT - 1]));
}

INLINE void through(int width, const double *values, const double *linear, double *out)
{
    product(width, AT, AT, values, linear, out);
}

IN_WIDTHS(angles_on, (const rods *all, const rule *by, const stretch *p, node_angles *out, rod_loads *loads),
          (WIDTH, all, by, p, out, loads))
IN_WIDTHS(expanded, (const rule *by, int kind, const node_angles *a, const rod_loads *l, stretch *p),
          (WIDTH, by, kind, a, l, p))
IN_WIDTHS(through, (const double *values, const double *linear, double *out), (WIDTH, values, linear, out))

/* T_k at a node is the cosine of k times its angle, a multiple of pi/(AT - 1). */
static void nodes_and_maps(rule *by)
{
    enum { LAST = AT - 1 };
    double cosine[2 * LAST], sine[2 * LAST];
    for (int k = 0; k < 2 * LAST; k++)
        cosine[k] = cos(PI * k / LAST), sine[k] = sin(PI * k / LAST);
    for (int i = 0; i < AT; i++) {
        const int angle = LAST - i, end = i == 0 || i == LAST;
        by->nodes[i] = -cosine[i];
        for (int k = 0; k < AT; k++) {
            const int at = k * angle % (2 * LAST), halved = k == 0 || k == LAST;
            by->analyse[AT * i + k] = cosine[at] * 2 / LAST / (end ? 2 : 1) / (halved ? 2 : 1);
            by->differentiate[AT * k + i] = end ? (i || k % 2 ? 1.0 : -1.0) * k * k : k * sine[at] / sine[angle];
        }
    }
}

static void prepare(rule *by, const rods *all)
{
    nodes_and_maps(by);
    for (int k = 0; k < AT; k++)
        by->mean[k] = k % 2 ? 0 : 1 / (1 - (double)k * k);
    for (int i = 0; i < AT; i++)
        by->weight[i] = total_of(by->analyse + AT * i, by->mean);
    polynomials_at((int)(all->coefficients > 2 ? all->coefficients : 2), by->nodes, by->polynomials);
}

/* Room for the rods `all`, or NULL. */
workspace *rod_workspace(const rods *all, int lanes)
{
    workspace *w = calloc(1, sizeof(workspace));
    if (w) {
        w->all = all;
        w->use = (kernels){FOR_LANES(lanes, angles_on), FOR_LANES(lanes, expanded), FOR_LANES(lanes, through)};
        prepare(&w->by, all);
    }
    return w;
}

void rod_workspace_free(workspace *w)
{
    if (w)
        free(w->angles), free(w->loads), free(w->parts), free(w->maxima);
    free(w);
}

/* The angles and loads at the nodes of the pieces of rod b. */
int rod_angles(workspace *w, int64_t b)
{
    const rods *all = w->all;
    const int64_t pieces = all->first[b + 1] - all->first[b];
    const int vary = all->kinds > 2;
    if (rod_roomy((void **)&w->angles, &w->angle_room, pieces, sizeof(node_angles)) ||
        rod_roomy((void **)&w->loads, &w->load_room, vary ? pieces : 0, sizeof(rod_loads)))
        return NO_MEMORY;
    steady_loads(all->lam[b], all->mu[b], all->phi[b], all->sign[b], &w->steady);
    for (int64_t i = 0; i < pieces; i++) {
        const int64_t j = all->first[b] + i;
        const stretch p = {.row = all->row[j], .low = all->low[j], .high = all->high[j]};
        if (vary)
            w->loads[i] = w->steady;
        w->use.angles(all, &w->by, &p, &w->angles[i], vary ? &w->loads[i] : NULL);
    }
    return DONE;
}

typedef struct {
    int kind, precision;
    double goal, total, top, beta0;
} wanted;

static int insufficient(const wanted *goal, const stretch *p)
{
    const double top = largest_size(AT, p->of.values), length = p->time * p->count;
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
    return p->tail > rod_tuning.barely * highest(floor_); /* a series cannot end below that */
}

static void halved(const stretch *p, int second, stretch *out)
{
    const double middle = (p->low + p->high) / 2;
    out->row = p->row, out->count = p->count, out->time = p->time / 2;
    out->low = second ? middle : p->low, out->high = second ? p->high : middle;
    out->begin = p->begin + (second ? out->time : 0.0);
}

/* Adds the parts of a piece on which the series of the density converges. */
static int refined(workspace *w, const wanted *goal, const stretch *piece)
{
    int waiting = 1;
    node_angles angles;
    rod_loads loads = w->steady;
    rod_loads *varying = w->all->kinds > 2 ? &loads : NULL;
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
                w->use.angles(w->all, &w->by, &half->part, &angles, varying);
                w->use.expanded(&w->by, goal->kind, &angles, &loads, &half->part);
            }
            continue;
        }
        if (rod_roomy((void **)&w->parts, &w->room, w->count + 1, sizeof(stretch)))
            return NO_MEMORY;
        w->parts[w->count++] = one.part;
    }
    return DONE;
}

/* The density on the parts of rod b, whose angles are there.

   allowed: error of the integral, relative to that of the density's size. precision: what else is to be known to
   `allowed` of the largest value. Returns DONE or NO_MEMORY. */
int rod_resolved(workspace *w, int64_t b, int kind, int precision, double allowed)
{
    const rods *all = w->all;
    const int64_t pieces = all->first[b + 1] - all->first[b];
    wanted goal = {kind, precision, allowed, 0, -INFINITY, larger(1, fabs(all->beta0[b]))};
    w->count = 0;
    if (rod_roomy((void **)&w->parts, &w->room, pieces, sizeof(stretch)))
        return NO_MEMORY;
    for (int64_t i = 0; i < pieces; i++) {
        const int64_t j = all->first[b] + i;
        stretch *p = &w->parts[i];
        p->row = all->row[j], p->low = all->low[j], p->high = all->high[j];
        p->time = all->time[j], p->count = all->count[j], p->begin = all->begin[j];
        w->use.expanded(&w->by, kind, &w->angles[i], all->kinds > 2 ? &w->loads[i] : &w->steady, p);
        double absolute[AT];
        for (int k = 0; k < AT; k++)
            absolute[k] = fabs(p->of.values[k]);
        goal.total += total_of(absolute, w->by.weight) * p->time * p->count;
        keep_larger(&goal.top, highest(absolute));
    }
    int64_t kept = 0;
    w->count = pieces;
    for (int64_t i = 0; i < pieces; i++) { /* those that suffice close up, the parts of the others stand behind them */
        if (insufficient(&goal, &w->parts[i])) {
            const stretch piece = w->parts[i]; /* the room of the parts may move */
            if (refined(w, &goal, &piece))
                return NO_MEMORY;
        } else if (kept++ < i)
            w->parts[kept - 1] = w->parts[i];
    }
    if (w->count > pieces)
        memmove(w->parts + kept, w->parts + pieces, sizeof(stretch) * (size_t)(w->count - pieces));
    w->count -= pieces - kept;
    return DONE;
}

/* A series and how often it has been differentiated, as `rod_bracketed` reads it. */
void rod_series_and_rate(const void *of, double x, double *value, double *rate)
{
    const double *c = of;
    double b1 = 0, b2 = 0, d1 = 0, d2 = 0;
    for (int k = AT - 1; k > 0; k--) {
        const double b0 = 2 * x * b1 - b2 + c[k], d0 = 2 * x * d1 - d2 + 2 * b1;
        b2 = b1, b1 = b0, d2 = d1, d1 = d0;
    }
    *value = x * b1 - b2 + c[0], *rate = x * d1 - d2 + b1;
}

/* The series of the derivative. */
void rod_derivative(const double *c, double *out)
{
    double slopes[AT + 1] = {0};
    for (int k = AT - 1; k > 0; k--)
        slopes[k - 1] = slopes[k + 1] + 2 * k * c[k];
    slopes[0] /= 2;
    memcpy(out, slopes, AT * sizeof(double));
}

/* Where the derivative of a series, times `sign` rising through zero between two places, is zero. */
double rod_turning_place(const double *c, double sign, double low, double high)
{
    double slopes[AT];
    rod_derivative(c, slopes);
    for (int k = 0; k < AT; k++)
        slopes[k] *= sign;
    return rod_bracketed(rod_series_and_rate, slopes, low, high, (low + high) / 2);
}

/* The largest value, times sign. */
double rod_largest(const workspace *w, double sign)
{
    const double *nodes = w->by.nodes;
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
        w->use.through(p->series, w->by.differentiate, rate);
        for (int k = 0; k + 1 < AT; k++) {
            const double r0 = sign * rate[k], r1 = sign * rate[k + 1], width = nodes[k + 1] - nodes[k];
            if (!(r0 > 0 && r1 < 0))
                continue;
            const double v0 = sign * p->of.values[k], v1 = sign * p->of.values[k + 1];
            if (!(larger(v0 + r0 * width, v1 - r1 * width) > best))
                continue;
            const double x = rod_turning_place(p->series, -sign, nodes[k], nodes[k + 1]);
            keep_larger(&best, sign * at_place(p->series, AT, x));
        }
    }
    return best;
}

static void add_change(sign_changes *found, const double *c, double low, double high, int rises)
{
    found->x[found->count] = rod_bracketed(rod_series_and_rate, c, low, high, (low + high) / 2);
    found->sign[found->count++] = rises ? 1 : -1;
}

/* Where values with these coefficients change sign, twice in a cell included. */
void rod_changes(const workspace *w, const double *values, const double *c, sign_changes *found)
{
    const double *nodes = w->by.nodes;
    double rate[AT];
    found->count = 0;
    for (int k = 0; k + 1 < AT; k++) {
        const double a = nodes[k], b = nodes[k + 1];
        const int up = values[k + 1] > 0;
        if (up != (values[k] > 0))
            add_change(found, c, up ? a : b, up ? b : a, up);
    }
    w->use.through(c, w->by.differentiate, rate);
    for (int k = 0; k + 1 < AT; k++) {
        const double a = nodes[k], b = nodes[k + 1], sign = values[k] > 0 ? 1 : -1;
        const double v0 = sign * values[k], v1 = sign * values[k + 1], r0 = sign * rate[k], r1 = sign * rate[k + 1];
        if ((values[k] > 0) != (values[k + 1] > 0) || !(r0 < 0 && r1 > 0))
            continue;
        if (!(v0 + r0 * (b - a) < 0 || v1 - r1 * (b - a) < 0))
            continue;
        const double x = rod_turning_place(c, sign, a, b);
        if (!(sign * at_place(c, AT, x) < 0))
            continue;
        if (sign > 0)
            add_change(found, c, x, a, 0), add_change(found, c, x, b, 1);
        else
            add_change(found, c, a, x, 1), add_change(found, c, b, x, 0);
    }
}


/* The mean of values at the nodes over [-1, 1], counted only where something is positive that changes its sign there; mean:
   that over all; first: whether it is positive at -1. */
double rod_positive_mean(const workspace *w, const double *values, double mean, const sign_changes *found, int first)
{
    double series[AT], sum[AT + 1], total = first ? mean : 0;
    if (!found->count)
        return total;
    w->use.through(values, w->by.analyse, series);
    integral(AT, series, sum);
    const double end = sum_of(AT + 1, sum);
    for (int i = 0; i < found->count; i++)
        total += found->sign[i] * (end - at_place(sum, AT + 1, found->x[i])) / 2;
    return total;
}
