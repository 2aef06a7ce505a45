/* How the numbers measured along rods answer changes of their orbits: solver/sensitivity/observable_rates.py.

   A change of an orbit has a part a along its flow, which moves a density by a times its pace. That part is integrated by
   parts, so that what is summed depends on the angle alone and whole periods add by their number. */

#include "measure_rates.h"

/* what is summed: the densities, the push without the pull, and the share of push */
enum { PUSH = 3, INTEGRALS, ALONE = INTEGRALS, ATTACHED, COLUMNS };
enum { HALVINGS = 8, QUERIES = 3, GAUSS = 5 };
#define SAME 1e-12        /* relative: extremes that differ by less are equal */
#define ONE_POINT 1e-9    /* rad: critical points that are this near are one */
#define STEP 1e-4         /* of the shortest time of a change: differences about a place */
#define NEAR_REST 0.1     /* rad: how near a critical point the difference of a density from that there is integrated */
#define GOAL 1e-11        /* of the series of a density, relative */
#define UNEQUAL 1e-4      /* relative: derivatives that differ by more are different */
#define STILL 1e-9        /* of the largest pace of a density: one that changes less is stationary */
#define FAINT 1e-9        /* of the sum of the sizes of its terms: a derivative below this is rounding */
#define OBSERVED 1e-5     /* of the length: the place is the one that is observed */
#define WINDOW 0.2        /* of the shortest time of a change: where a derivative in t is read */
#define MERGED 1e-6       /* of the same: places nearer than this are one */
#define ZERO 1e-12        /* of the sum of the sizes of its terms: a value that only touches zero */

static const int kinds[INTEGRALS] = {CURVATURE, BENDING, POTENTIAL, OUTWARD}, of_whole[PUSH] = {CURVED, BENT, STORED};
static const double query_shares[QUERIES] = {1, 1.0 / 3, 2.0 / 3};

/* AT places of one orbit, at `angles.beta` = base + x up to whole turns. v: beta_t with its sign. */
typedef struct {
    node_angles angles;
    double base[AT], x[AT], v[AT], H[AT], c[AT], shift[4][AT], gamma[4][AT];
} states;

/* A density there. pace: its change along the orbit in a unit of time. moved: its change by a unit of each element of e
   where nothing moves along the orbit. */
typedef struct {
    density of;
    double pace[AT], moved[4][AT];
} rated;

/* A part of a panel, from `low` to `high` on it, which lasts `time`. M: the rates of the first row of M. by: of the
   densities that are integrated. */
typedef struct {
    double low, high, time, M[4][AT];
    states at;
    rated by[INTEGRALS];
} leaf;

/* One rod. integrates: which densities. nearest: the panel that is closest to a critical point; still: the densities at rest
   there. shortest: a time in which a density changes at least. top: the largest coefficients of the values and changes of
   each density; most_pace: of the push. panel: that is integrated over; rates: its rates of the first row of M. */
typedef struct {
    workspace *w;
    const read_orbits *of;
    const points *at;
    const varied_orbits *varied;
    const changes *by;
    int64_t b, panel, nearest;
    int integrates[INTEGRALS];
    const double *parts, *later;
    double span, period, shortest, most_pace, still[INTEGRALS], top[INTEGRALS][5], rates[4][NODES];
    double *a, *slopes, *faint; /* (CANDIDATES, F): of places */
    leaf *panels;               /* whole ones */
    varied_place start;
} rod;

static int wants(const rod *o, int rate) { return (int)(o->by->wanted >> rate & 1); }

/* values . e, without the elements that do not change: next to a saddle a value may be infinite. */
static double along_e(const double *values, const double *parts)
{
    double total = 0;
    for (int k = 0; k < 4; k++)
        total += parts[k + 1] != 0 ? values[k] * parts[k + 1] : 0;
    return total;
}

static void rate(int kind, const rod_loads *l, const states *at, rated *out)
{
    density_slopes by = {0};
    density_of(kind, &at->angles, l, &out->of, &by);
    const double *own[4] = {NULL, by.lam, by.mu, by.phi};
    for (int i = 0; i < AT; i++) {
        const double v = at->v[i], H = at->H[i], D2 = v * v + at->c[i] * H * H, D = D2 > 0 ? D2 : 1;
        const double by_rate = v < 0 ? -by.speed[i] : by.speed[i];
        const double across = by.beta[i] * (at->c[i] * H / D) + by_rate * (v / D);
        out->pace[i] = by.beta[i] * v - by_rate * H;
        for (int k = 0; k < 4; k++)
            out->moved[k][i] = at->gamma[k][i] * across + at->shift[k][i] * by.beta[i] + (k ? own[k][i] : 0);
    }
}

/* Writes place i of the states, at x of a panel after so many whole turns. */
static void write_state(const rod *o, int i, int64_t panel, double x, double turns, const varied_place *place, states *out)
{
    const int n = (int)o->of->coefficients;
    out->base[i] = o->of->base[panel], out->x[i] = at_place(o->of->series + FUNCTIONS * n * panel, n, x);
    out->angles.beta[i] = out->base[i] + TAU * turns + out->x[i], out->angles.speed[i] = fabs(place->v);
    out->v[i] = place->v, out->H[i] = place->H, out->c[i] = place->c;
    for (int k = 0; k < 4; k++)
        out->shift[k][i] = place->shift[k], out->gamma[k][i] = place->gamma[k];
}

/* The states at up to AT times, and how far the changes move each along the orbit, a (count, F). */
static void states_at(const rod *o, int count, const double *t, states *out, double *a)
{
    memset(out, 0, sizeof(states));
    for (int i = 0; i < count; i++) {
        varied_place place;
        phase where;
        double x;
        const int64_t panel = rod_place(o->of, o->b, t[i], &where, &x);
        rod_varied_place_at(o->of, o->varied, o->b, t[i], &place);
        const double turns = o->of->kind[o->b] == LIBRATION ? 0 : o->of->direction[o->b] * where.periods;
        write_state(o, i, panel, x, turns, &place, out);
        for (int k = 0; k < 4; k++)
            place.M[k] -= o->start.M[k];
        for (int64_t f = 0; a && f < o->by->F; f++)
            a[o->by->F * i + f] = o->parts[PARTS * f] + along_e(place.M, o->parts + PARTS * f);
    }
    directions_of(&out->angles);
}

static void read(const rod *o, int kind, int count, const double *t, rated *out, double *a)
{
    states at;
    states_at(o, count, t, &at, a);
    rate(kind, &o->w->steady, &at, out);
}

/* A density less that at rest at the base, to relative accuracy in x: Gauss' rule. */
static void differences(int kind, const rod_loads *l, const states *at, double *out)
{
    static const double nodes[GAUSS] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                        0.9061798459386640};
    static const double weights[GAUSS] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
    memset(out, 0, sizeof(double) * AT);
    for (int g = 0; g < GAUSS; g++) {
        const double share = (1 + nodes[g]) / 2;
        node_angles a;
        density unread;
        density_slopes by = {0};
        for (int i = 0; i < AT; i++)
            a.beta[i] = at->base[i] + share * at->x[i], a.speed[i] = share * at->angles.speed[i];
        directions_of(&a);
        density_of(kind, &a, l, &unread, &by);
        for (int i = 0; i < AT; i++)
            out[i] += weights[g] / 2 * (by.beta[i] * at->x[i] + by.speed[i] * at->angles.speed[i]);
    }
}

/* All columns at the places less those at rest at the critical point next to the orbit; near it, the densities by
   `differences`, where both agree. */
static void above_rest(const rod *o, int near, const states *at, const rated *by, double out[COLUMNS][AT])
{
    const double nearest = o->of->base[o->nearest], push = o->still[PUSH], level = larger(push, 0);
    memset(out, 0, sizeof(double) * COLUMNS * AT);
    for (int d = 0; d < INTEGRALS; d++) {
        double exact[AT];
        if (!o->integrates[d])
            continue;
        if (near)
            differences(kinds[d], &o->w->steady, at, exact);
        for (int i = 0; i < AT; i++) {
            out[d][i] = by[d].of.values[i] - o->still[d];
            if (near && fabs(sin((at->base[i] - nearest) / 2)) < ONE_POINT &&
                fabs(out[d][i] - exact[i]) <= BARELY * (1 + fabs(o->still[d])))
                out[d][i] = exact[i];
        }
    }
    for (int i = 0; i < AT && o->integrates[PUSH]; i++) {
        const double value = by[PUSH].of.values[i];
        if (value > 0)
            out[ALONE][i] = push > -BARELY ? out[PUSH][i] : value;
        else
            out[ALONE][i] = level > BARELY * (1 + level) ? -level : 0;
        out[ATTACHED][i] = (value > 0) - (push > 0);
    }
}

static void begin_leaf(const rod *o, double low, double high, leaf *out)
{
    const int backward = o->panel - o->of->first[2 * o->b] >= o->of->count[2 * o->b], n = (int)o->at->n;
    double x[AT], polynomials[NODES * AT];
    out->low = low, out->high = high, out->time = o->of->width[o->panel] * (high - low) / 2;
    for (int i = 0; i < AT; i++) {
        varied_place place;
        x[i] = low + (high - low) * (1 + o->w->by.nodes[i]) / 2;
        rod_varied_place_on(o->varied, n + 1, o->panel, x[i], &place);
        place.v = larger(place.v, 0) * (backward ? -o->of->direction[o->b] : o->of->direction[o->b]);
        write_state(o, i, o->panel, x[i], 0, &place, &out->at);
    }
    polynomials_at(n, x, polynomials);
    for (int k = 0; k < 4; k++)
        product(n, AT, o->rates[k], polynomials, out->M[k]);
    directions_of(&out->at.angles);
    for (int d = 0; d < INTEGRALS; d++)
        if (o->integrates[d] || (d == PUSH && wants(o, PEAK)))
            rate(kinds[d], &o->w->steady, &out->at, &out->by[d]);
}

/* The largest coefficient of a series from number `first` on. */
static double highest_term(const rod *o, const double *values, int first)
{
    double a[AT], most = 0;
    o->w->use.through(values, o->w->by.analyse, a);
    for (int k = first; k < AT; k++)
        most = larger(most, fabs(a[k]));
    return most;
}

static int is_coarse(const rod *o, const leaf *part)
{
    for (int d = 0; d < INTEGRALS; d++)
        for (int k = 0; k < 5 && o->integrates[d]; k++)
            if (highest_term(o, k ? part->by[d].moved[k - 1] : part->by[d].of.values, AT - 2) > GOAL * o->top[d][k])
                return 1;
    return 0;
}

/* The integral over [-1, x]. */
static double integral_to(const rod *o, const double *values, double x)
{
    double a[AT], b[AT + 1];
    if (x == 1)
        return 2 * total_of(values, o->w->by.weight);
    o->w->use.through(values, o->w->by.analyse, a);
    integral(AT, a, b);
    return at_place(b, AT + 1, x);
}

/* The places inside a part where the push changes its sign, rising; returns their number. */
static int zeros_on(const rod *o, const leaf *part, double *out)
{
    const double *push = part->by[PUSH].of.values;
    double series[AT];
    int count = 0;
    sign_changes found;
    o->w->use.through(push, o->w->by.analyse, series);
    rod_changes(o->w, push, series, &found);
    for (int i = 0; i < found.count; i++) {
        int k = count;
        if (!(fabs(found.x[i]) < 1 - 1e-12))
            continue;
        for (; k > 0 && out[k - 1] > found.x[i]; k--)
            out[k] = out[k - 1];
        out[k] = found.x[i], count++;
    }
    return count;
}

/* Sums from the start along an arc. pushes: whether the cylinder does where they end, -1 at the start. */
typedef struct {
    double total[COLUMNS][4];
    int pushes;
} sums;

/* Adds the columns of a part on which the push has one sign, up to x of it. */
static void add_leaf(const rod *o, const leaf *part, double x, sums *to)
{
    const rated *push = &part->by[PUSH];
    const int pushes = o->integrates[PUSH] && total_of(push->of.values, o->w->by.weight) > 0;
    double column[AT], above[COLUMNS][AT], far = 0;
    for (int i = 0; i < AT; i++)
        far = larger(far, fabs(part->at.x[i]));
    above_rest(o, far < NEAR_REST, &part->at, part->by, above);
    for (int c = 0; c < COLUMNS; c++) {
        const int d = c < INTEGRALS ? c : PUSH, moves = c < INTEGRALS || (c == ALONE && pushes);
        for (int k = 0; k < 4 && o->integrates[d]; k++) {
            for (int i = 0; i < AT; i++) {
                const double lies = c == ATTACHED ? pushes - (o->still[PUSH] > 0) : above[c][i];
                column[i] = (moves ? part->by[d].moved[k][i] : 0) - lies * part->M[k][i];
            }
            to->total[c][k] += part->time / 2 * integral_to(o, column, x);
        }
    }
    if (to->pushes >= 0 && to->pushes != pushes) /* the push changed its sign where the part begins */
        for (int k = 0; k < 4; k++)
            to->total[ATTACHED][k] += push->moved[k][0] / fabs(push->pace[0]);
    to->pushes = pushes;
}

/* A time up to which is summed, where it is on the orbit, and the sums. */
typedef struct {
    double x;
    int64_t panel;
    phase where;
    sums of;
} query;

static void add_to_all(const rod *o, const leaf *part, query *queries, sums *to)
{
    for (query *q = queries; q < queries + QUERIES; q++)
        if (q->panel == o->panel && q->x > part->low) {
            q->of = *to;
            add_leaf(o, part, smaller(2 * (q->x - part->low) / (part->high - part->low) - 1, 1), &q->of);
        }
    add_leaf(o, part, 1, to);
}

/* Adds a part, halved until the series of the densities and of their changes end, and cut where the push is zero. */
static void add_part(const rod *o, const leaf *part, int halvings, query *queries, sums *to)
{
    const double middle = (part->low + part->high) / 2, half = (part->high - part->low) / 2;
    double low = part->low, zeros[CROSSINGS];
    leaf own;
    if (halvings < HALVINGS && is_coarse(o, part)) {
        begin_leaf(o, low, middle, &own), add_part(o, &own, halvings + 1, queries, to);
        begin_leaf(o, middle, part->high, &own), add_part(o, &own, halvings + 1, queries, to);
        return;
    }
    const int count = o->integrates[PUSH] ? zeros_on(o, part, zeros) : 0;
    for (int z = 0; z < count; z++, low = own.high)
        begin_leaf(o, low, middle + half * zeros[z], &own), add_to_all(o, &own, queries, to);
    if (count)
        begin_leaf(o, low, part->high, &own);
    add_to_all(o, count ? &own : part, queries, to);
}

static void enter_panel(rod *o, int64_t panel)
{
    const int n = (int)o->at->n;
    o->panel = panel;
    for (int k = 0; k < 4; k++)
        product(n, n, o->varied->M + (PAIRS * panel + k) * n, o->at->analyse, o->rates[k]);
}

/* The sums along the arcs up to the queries. first: the columns at the start less those at rest. */
static void sum_up(rod *o, double first[COLUMNS][AT], query *queries)
{
    const int64_t *begin = o->of->first + 2 * o->b, *count = o->of->count + 2 * o->b;
    double gain[2][COLUMNS][4], above[COLUMNS][AT];
    for (int arc = 0; arc < 2; arc++) {
        sums to = {.pushes = -1};
        for (int64_t panel = begin[arc]; panel < begin[arc] + count[arc]; panel++) {
            const leaf *whole = &o->panels[panel - begin[0]];
            enter_panel(o, panel);
            above_rest(o, 1, &whole->at, whole->by, above);
            for (int c = 0; c < COLUMNS; c++)
                for (int k = 0; k < 4; k++)
                    to.total[c][k] -= above[c][0] * o->varied->jump[PAIRS * panel + k];
            for (query *q = queries; q < queries + QUERIES; q++)
                if (q->panel == panel)
                    q->of = to;
            add_part(o, whole, 0, queries, &to);
        }
        for (int c = 0; c < COLUMNS; c++)
            for (int k = 0; k < 4; k++)
                gain[arc][c][k] = to.total[c][k] - first[c][0] * o->varied->closing[PAIRS * (2 * o->b + arc) + k];
    }
    for (query *q = queries; q < queries + QUERIES; q++)
        for (int c = 0; c < COLUMNS; c++)
            for (int k = 0; k < 4; k++)
                q->of.total[c][k] = rod_unfolded(q->of.total[c][k], &q->where, gain[0][c][k], gain[1][c][k],
                                                 o->of->kind[o->b] == LIBRATION);
}

/* The rates of all integrals by F changes into out (F, RATES). */
static void integrals_of(rod *o, double *out)
{
    query queries[QUERIES];
    double t[1 + QUERIES] = {0}, above[COLUMNS][AT];
    states at;
    rated by[INTEGRALS];
    for (int q = 0; q < QUERIES; q++) {
        t[1 + q] = query_shares[q] * o->span;
        queries[q].panel = rod_place(o->of, o->b, t[1 + q], &queries[q].where, &queries[q].x);
    }
    states_at(o, 1 + QUERIES, t, &at, o->a);
    for (int d = 0; d < INTEGRALS; d++)
        rate(kinds[d], &o->w->steady, &at, &by[d]);
    above_rest(o, 1, &at, by, above);
    sum_up(o, above, queries);
    for (int64_t f = 0; f < o->by->F; f++, out += RATES) {
        const double *parts = o->parts + PARTS * f;
        double sum[QUERIES][COLUMNS];
        for (int q = 0; q < QUERIES; q++) {
            const double later = query_shares[q] * o->later[f], push = by[PUSH].of.values[1 + q];
            for (int c = 0; c < COLUMNS; c++) {
                const double kept = c < INTEGRALS ? by[c].of.values[1 + q] : c == ALONE ? larger(push, 0) : push > 0;
                sum[q][c] = along_e(queries[q].of.total[c], parts) + kept * later - parts[0] * above[c][0] +
                            o->a[o->by->F * (1 + q) + f] * above[c][1 + q];
            }
        }
        out[CURVED] = sum[0][0], out[BENT] = sum[0][1], out[STORED] = sum[0][2];
        out[PUSHED] = sum[0][ALONE], out[PULLED] = sum[0][ALONE] - sum[0][PUSH], out[SHARE] = sum[0][ATTACHED];
        out[MIDDLE_PUSH] = sum[2][ALONE] - sum[1][ALONE];
    }
}

/* A place where a density may be largest, or with `turn` -1 smallest. known: whether it is. */
typedef struct {
    double t, turn, value, size, pace, moved[4];
    int known, first, last;
} place_of_extreme;

/* The places of one extreme; their a, the derivatives of their values and what of these is rounding are in the rod. */
typedef struct {
    int count;
    place_of_extreme at[CANDIDATES];
} places;

/* The place near t where the density is stationary, by a step of Newton's; t where that leads away. */
static double stationary_place(const rod *o, int kind, double t)
{
    const double step = STEP * o->shortest, near[3] = {t - step, t + step, t};
    rated by;
    read(o, kind, 3, near, &by, NULL);
    const double off = 2 * step * by.pace[2] / (by.pace[1] - by.pace[0]);
    return smaller(larger(fabs(off) < step ? t - off : t, 0), o->span);
}

/* Adds the ends, if they count, and where the density is largest, or with `turn` -1 smallest, up to a time. The density is
   on the parts of the workspace. Returns DONE or NO_MEMORY. */
static int add_places(rod *o, int kind, double turn, double until, int with_ends, places *to)
{
    double t[PLACES];
    const int begin = to->count, found = rod_places(o->w, turn, smaller(until, o->period), SAME, PLACES, t);
    if (found < 0)
        return NO_MEMORY;
    if (with_ends)
        to->at[to->count++].t = 0, to->at[to->count++].t = o->span;
    for (int k = 0; k < found; k++) {
        const int inside = t[k] > 0 && t[k] < o->span * (1 - SAME);
        to->at[to->count++].t = inside ? stationary_place(o, kind, t[k]) : t[k];
    }
    for (int i = begin; i < to->count; i++) {
        place_of_extreme *one = &to->at[i];
        one->turn = turn, one->known = 1, one->first = one->t <= 0, one->last = one->t >= o->span * (1 - SAME);
        for (int j = begin; j < i; j++)
            one->known &= !(fabs(one->t - to->at[j].t) < MERGED * o->shortest);
    }
    return DONE;
}

/* Reads the density at the places, keeps those of the extreme, and differentiates their values; `size`: their sizes. */
static void judge_places(rod *o, int kind, int size, places *of)
{
    const int64_t F = o->by->F;
    double best = -INFINITY;
    for (int i = 0; i < of->count; i += AT) {
        const int many = of->count - i < AT ? of->count - i : AT;
        double t[AT];
        rated by;
        for (int k = 0; k < many; k++)
            t[k] = of->at[i + k].t;
        read(o, kind, many, t, &by, o->a + F * i);
        for (int k = 0; k < many; k++) {
            place_of_extreme *one = &of->at[i + k];
            one->value = by.of.values[k], one->size = by.of.size[k], one->pace = by.pace[k];
            for (int m = 0; m < 4; m++)
                one->moved[m] = by.moved[m][k];
            if (one->known)
                keep_larger(&best, one->turn * one->value);
        }
    }
    for (int i = 0; i < of->count; i++) {
        place_of_extreme *one = &of->at[i];
        one->known &= one->turn * one->value >= best - SAME * larger(fabs(best), 1e-300);
        for (int64_t f = 0; f < F; f++) {
            const double *e = o->parts + PARTS * f + 1;
            double shifted = 0, most = 0, sizes = 0;
            if (one->first || one->last)
                shifted = one->pace * (o->a[F * i + f] + (one->last ? o->later[f] : 0));
            for (int k = 0; k < 4; k++)
                most = larger(most, fabs(e[k])), sizes += e[k] != 0 ? fabs(one->moved[k] * e[k]) : 0;
            o->slopes[F * i + f] = (along_e(one->moved, e - 1) + shifted) * (size ? one->turn : 1);
            o->faint[F * i + f] = FAINT * (sizes + fabs(shifted)) + BARELY * one->size * most;
        }
    }
}

/* The derivative of the extreme by change f; NaN where several places reach it unequally. */
static double slope_of(const rod *o, const places *of, int64_t f)
{
    const int64_t F = o->by->F;
    int chosen = 0;
    while (chosen < of->count - 1 && !of->at[chosen].known)
        chosen++;
    const double slope = o->slopes[F * chosen + f];
    for (int i = 0; i < of->count; i++) {
        const double other = o->slopes[F * i + f];
        if (of->at[i].known && fabs(other - slope) > UNEQUAL * (fabs(other) + fabs(slope)) + o->faint[F * i + f])
            return NAN;
    }
    return slope;
}

static int extreme_of(rod *o, int kind, int largest, int smallest, int rate_of, double *out)
{
    places at = {0};
    if ((largest && add_places(o, kind, 1, o->span, 1, &at)) ||
        (smallest && add_places(o, kind, -1, o->span, 1, &at)))
        return NO_MEMORY;
    judge_places(o, kind, largest && smallest, &at);
    for (int64_t f = 0; f < o->by->F; f++)
        out[RATES * f + rate_of] = slope_of(o, &at, f);
    return DONE;
}

/* The first t of the largest push, where (df/dt)(t, q) = 0 gives dt/dq = -(d2f/dt dq)/(d2f/dt2). At the start of the rod it
   is 0, at the far end the change of the length. NaN where several places reach the largest value unequally, where the push
   is stationary at an end and the maximum moves off it, and where another place is observed. */
static int peak_of(rod *o, double seen, double *out)
{
    const int64_t F = o->by->F;
    places at = {0};
    int k = -1;
    if (add_places(o, OUTWARD, 1, o->span, 1, &at))
        return NO_MEMORY;
    judge_places(o, OUTWARD, 0, &at);
    for (int i = 0; i < at.count; i++)
        if (at.at[i].known && (k < 0 || fabs(at.at[i].t - seen) < fabs(at.at[k].t - seen)))
            k = i;
    for (int64_t f = 0; f < F; f++)
        out[RATES * f + PEAK] = k < 0 || fabs(at.at[k].t - seen) > OBSERVED * o->span ? NAN : slope_of(o, &at, f);
    if (k < 0)
        return DONE;
    const place_of_extreme *one = &at.at[k];
    const double half = smaller(WINDOW * o->shortest, o->span / 2), least = STILL * o->most_pace;
    const double middle = smaller(larger(one->t, half), o->span - half), x = (one->t - middle) / half;
    double t[AT], series[AT], unused, bend;
    rated by;
    for (int i = 0; i < AT; i++)
        t[i] = middle + half * o->w->by.nodes[i];
    read(o, OUTWARD, AT, t, &by, o->a);
    o->w->use.through(by.pace, o->w->by.analyse, series);
    rod_series_and_rate(series, x, &unused, &bend);
    for (int64_t f = 0; f < F; f++) {
        double changed[AT], turn;
        for (int i = 0; i < AT; i++) {
            const double moved[4] = {by.moved[0][i], by.moved[1][i], by.moved[2][i], by.moved[3][i]};
            changed[i] = along_e(moved, o->parts + PARTS * f) + o->a[F * i + f] * by.pace[i];
        }
        o->w->use.through(changed, o->w->by.analyse, series);
        rod_series_and_rate(series, x, &unused, &turn);
        const double inner = fabs(bend) / half <= least ? NAN : -turn / bend, end = one->last ? o->later[f] : 0;
        const int stays = fabs(one->pace) > least ||
                          fabs(inner - end) <= 1e-6 * (fabs(inner) + fabs(end)) + 1e-9 * fabs(o->span);
        double *found = out + RATES * f + PEAK;
        *found = *found != *found ? NAN : !(one->first || one->last) ? inner : stays ? end : NAN;
    }
    return DONE;
}

/* The first t with a negative push, or the whole length where there is none: f(t, q) = 0 gives dt/dq = -(df/dq)/(df/dt).
   NaN where f only touches zero on the way, and a change of f there lets that t jump. */
static int lift_off_of(rod *o, double seen, double *out)
{
    const int64_t F = o->by->F;
    places lowest = {0};
    rated at;
    if (add_places(o, OUTWARD, -1, seen, 0, &lowest))
        return NO_MEMORY;
    judge_places(o, OUTWARD, 0, &lowest);
    read(o, OUTWARD, 1, &seen, &at, o->a);
    for (int64_t f = 0; f < F; f++) {
        const double moved[4] = {at.moved[0][0], at.moved[1][0], at.moved[2][0], at.moved[3][0]};
        const double inside = -o->a[f] - along_e(moved, o->parts + PARTS * f) / at.pace[0];
        double *found = out + RATES * f + FIRST_LIFT;
        *found = seen >= o->span ? o->later[f] : seen > 0 ? inside : 0;
        for (int i = 0; i < lowest.count; i++)
            if (lowest.at[i].known && fabs(lowest.at[i].value) <= ZERO * lowest.at[i].size &&
                fabs(o->slopes[F * i + f]) > o->faint[F * i + f])
                *found = NAN;
    }
    return DONE;
}

/* What is needed of all panels: which is nearest to a critical point, the densities there, and their largest sizes. */
static void prepare_rod(rod *o)
{
    const int64_t begin = o->of->first[2 * o->b], end = begin + o->of->count[2 * o->b] + o->of->count[2 * o->b + 1];
    double fastest = 0;
    for (int d = 0; d < INTEGRALS; d++)
        o->integrates[d] = d < PUSH ? wants(o, of_whole[d])
                                      : wants(o, PUSHED) | wants(o, PULLED) | wants(o, SHARE) | wants(o, MIDDLE_PUSH);
    o->nearest = begin;
    for (int64_t panel = begin; panel < end; panel++)
        if (o->varied->least[panel] < o->varied->least[o->nearest])
            o->nearest = panel;
    states rest = {.angles = {.beta = {o->of->base[o->nearest]}}};
    directions_of(&rest.angles);
    for (int d = 0; d < INTEGRALS; d++) {
        rated found;
        rate(kinds[d], &o->w->steady, &rest, &found);
        o->still[d] = found.of.values[0];
    }
    for (int64_t panel = begin; panel < end; panel++) {
        leaf *whole = &o->panels[panel - begin];
        enter_panel(o, panel);
        begin_leaf(o, -1, 1, whole);
        for (int i = 0; i < AT; i++) {
            if (wants(o, PEAK))
                o->most_pace = larger(o->most_pace, fabs(whole->by[PUSH].pace[i]));
            fastest = larger(fastest, whole->at.angles.speed[i]);
        }
        for (int d = 0; d < INTEGRALS; d++)
            for (int k = 0; k < 5 && o->integrates[d]; k++)
                o->top[d][k] = larger(
                    o->top[d][k], highest_term(o, k ? whole->by[d].moved[k - 1] : whole->by[d].of.values, 0));
    }
    o->shortest = 1 / sqrt(square(o->w->steady.steepness[0]) + fastest * fastest);
}

/* The extremes by their densities: whether the largest and the smallest values count. */
static const struct {
    int kind, rate, largest, smallest;
} extremes[] = {
    {ANGLE, LOW, 0, 1},   {ANGLE, HIGH, 1, 0},      {CURVATURE, TIGHTEST, 1, 0}, {TENSION, LARGEST_TENSION, 1, 1},
    {OUTWARD, LEAST, 0, 1}, {OUTWARD, GREATEST, 1, 0}, {OUTWARD, PEAK, 1, 0},      {OUTWARD, FIRST_LIFT, 0, 1},
};

static int rates_of(rod *o, double *out)
{
    int resolved = -1;
    if (rod_angles(o->w, 0))
        return NO_MEMORY;
    prepare_rod(o);
    if (o->integrates[0] || o->integrates[1] || o->integrates[2] || o->integrates[PUSH])
        integrals_of(o, out);
    for (size_t i = 0; i < sizeof extremes / sizeof *extremes; i++) {
        const int kind = extremes[i].kind, rate_of = extremes[i].rate;
        if (!wants(o, rate_of))
            continue;
        if (kind != resolved && rod_resolved(o->w, 0, kind, EXTREMES, o->w->all->goal))
            return NO_MEMORY;
        resolved = kind;
        const int failed = rate_of == PEAK         ? peak_of(o, o->by->peak, out)
                           : rate_of == FIRST_LIFT ? lift_off_of(o, o->by->lifts, out)
                                                   : extreme_of(o, kind, extremes[i].largest, extremes[i].smallest,
                                                                rate_of, out);
        if (failed)
            return failed;
    }
    return DONE;
}

int rod_rates(workspace *w, const read_orbits *of, const points *at, const varied_orbits *varied, const changes *by,
              int64_t b, double *room, double *out)
{
    rod one = {.w = w, .of = of, .at = at, .varied = varied, .by = by, .b = b};
    const double both = of->duration[2 * b] + of->duration[2 * b + 1];
    one.a = room, one.slopes = room + CANDIDATES * by->F, one.faint = one.slopes + CANDIDATES * by->F;
    one.parts = by->parts, one.later = by->later, one.span = *w->all->span;
    one.period = of->kind[b] == LIBRATION ? 2 * both : both;
    rod_varied_place_at(of, varied, b, 0, &one.start);
    one.panels = malloc(sizeof(leaf) * (size_t)(of->count[2 * b] + of->count[2 * b + 1]));
    const int failed = one.panels ? rates_of(&one, out) : NO_MEMORY;
    free(one.panels);
    return failed;
}
