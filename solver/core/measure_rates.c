/* How the numbers measured along rods answer changes of their orbits: solver/observe/observable_rates.py.

   A change of an orbit has a part a along its flow, which moves a density by a times its pace. That part is integrated by
   parts, so that what is summed depends on the angle alone: it is the integral of another density over the same parts of the
   rod, each as often as the rod passes it. */

#include "measure_rates.h"

/* What is summed along a rod: a density, its positive part, the length on which it is positive, and how far a place moves
   along the orbit. */
enum { WHOLE, ALONE, ATTACHED, COLUMNS, MOVED = COLUMNS };
enum { GAUSS = 5 };
#define GOAL 1e-12        /* of the series of a density that is integrated alone, relative */
#define SAME 1e-12        /* relative: extremes that differ by less are equal */
#define ONE_POINT 1e-9    /* rad: critical points that are this near are one */
#define STEP 1e-4         /* of the shortest time of a change: differences about a place */
#define NEAR_REST 0.1     /* rad: how near a critical point the difference of a density from that there is integrated */
#define UNEQUAL 1e-4      /* relative: derivatives that differ by more are different */
#define STILL 1e-9        /* of the largest pace of a density: one that changes less is stationary */
#define FAINT 1e-9        /* of the sum of the sizes of its terms: a derivative below this is rounding */
#define OBSERVED 1e-5     /* of the length: the place is the one that is observed */
#define WINDOW 0.2        /* of the shortest time of a change: where a derivative in t is read */
#define MERGED 1e-6       /* of the same: places nearer than this are one */
#define ZERO 1e-12        /* of the sum of the sizes of its terms: a value that only touches zero */


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

/* One rod. nearest: the panel that is closest to a critical point. shortest: a time in which a density changes at least. */
typedef struct {
    workspace *w;
    const read_orbits *of;
    const points *at;
    const varied_orbits *varied;
    const changes *by;
    int64_t b, nearest;
    const double *parts, *later;
    double span, period, shortest;
    double *a, *slopes, *faint; /* (CANDIDATES, F): of places */
    varied_place start;
} rod;

/* values . e, without the elements that do not change: next to a saddle a value may be infinite. */
static double along_e(const double *values, const double *parts)
{
    double total = 0;
    for (int k = 0; k < 4; k++)
        total += parts[k + 1] != 0 ? values[k] * parts[k + 1] : 0;
    return total;
}

INLINE void rate(int kind, const rod_loads *l, const states *at, rated *out)
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

IN_WIDTHS(rate, (int kind, const rod_loads *l, const states *at, rated *out), (kind, l, at, out))

/* The states at up to AT times, and how far the changes move each along the orbit, a (count, F). */
static void states_at(const rod *o, int count, const double *t, states *out, double *a)
{
    const int n = (int)o->of->coefficients;
    memset(out, 0, sizeof(states));
    for (int i = 0; i < count; i++) {
        varied_place place;
        phase where;
        double x;
        const int64_t panel = rod_place(o->of, o->b, t[i], &where, &x);
        rod_varied_place_at(o->of, o->varied, o->b, t[i], &place);
        const double turns = o->of->kind[o->b] == LIBRATION ? 0 : o->of->direction[o->b] * where.periods;
        out->base[i] = o->of->base[panel], out->x[i] = at_place(o->of->series + FUNCTIONS * n * panel, n, x);
        out->angles.beta[i] = out->base[i] + TAU * turns + out->x[i], out->angles.speed[i] = fabs(place.v);
        out->v[i] = place.v, out->H[i] = place.H, out->c[i] = place.c;
        for (int k = 0; k < 4; k++)
            out->shift[k][i] = place.shift[k], out->gamma[k][i] = place.gamma[k], place.M[k] -= o->start.M[k];
        for (int64_t f = 0; a && f < o->by->F; f++)
            a[o->by->F * i + f] = o->parts[PARTS * f] + along_e(place.M, o->parts + PARTS * f);
    }
    directions_of(&out->angles);
}

static void read(const rod *o, int kind, int count, const double *t, rated *out, double *a)
{
    states at;
    states_at(o, count, t, &at, a);
    FOR_LANES(o->varied->lanes, rate)(kind, &o->w->steady, &at, out);
}

/* A density less that at rest at the base, to relative accuracy in x: Gauss' rule. */
INLINE void differences(int kind, const rod_loads *l, const states *at, double *out)
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

IN_WIDTHS(differences, (int kind, const rod_loads *l, const states *at, double *out), (kind, l, at, out))

/* A density at the places less `still`, what it is at rest at the critical point next to the orbit; near it by
   `differences`, where both agree. */
static void above_rest(const rod *o, int kind, double still, const states *at, const rated *by, double *out)
{
    double exact[AT], near = INFINITY;
    for (int i = 0; i < AT; i++)
        near = smaller(near, fabs(at->x[i])), out[i] = by->of.values[i] - still;
    if (!(near < NEAR_REST))
        return;
    FOR_LANES(o->varied->lanes, differences)(kind, &o->w->steady, at, exact);
    for (int i = 0; i < AT; i++)
        if (fabs(sin((at->base[i] - o->of->base[o->nearest]) / 2)) < ONE_POINT &&
            fabs(out[i] - exact[i]) <= rod_tuning.barely * (1 + fabs(still)))
            out[i] = exact[i];
}

/* What of a density at rest counts in its positive part. */
static double level_of(double still) { return still > rod_tuning.barely * (1 + still) ? still : 0; }

/* The columns at a place less those at rest; above: the density less that at rest. */
static void columns_at(double value, double above, double still, double out[COLUMNS])
{
    out[WHOLE] = above;
    out[ALONE] = !(value > 0) ? -level_of(still) : still > -rod_tuning.barely ? above : value;
    out[ATTACHED] = (value > 0) - (still > 0);
}

/* The states at the nodes of a part of a panel, moving away from the start, and the rates of the first row of M. */
INLINE void states_on(int width, const rod *o, const stretch *p, states *out, double M[4][AT])
{
    const read_orbits *of = o->of;
    const int backward = p->row - of->first[2 * o->b] >= of->count[2 * o->b], n = (int)o->at->n;
    const double way = backward ? -of->direction[o->b] : of->direction[o->b];
    const double *series = o->varied->series + varied_size(n + 1) * p->row, *constant = series + VARIED * (n + 1);
    double x[AT], polynomials[NODES * AT], one[NODES];
    double *rows[BY_LEVEL] = {out->v, out->H, out->gamma[1], out->gamma[2], out->gamma[3]};
    for (int i = 0; i < AT; i++) {
        x[i] = p->low + (p->high - p->low) * (1 + o->w->by.nodes[i]) / 2;
        out->c[i] = constant[0], out->shift[0][i] = 0, out->gamma[0][i] = 1;
        for (int k = 1; k < CONSTANTS; k++)
            out->shift[k][i] = constant[k];
    }
    polynomials_at(n, x, polynomials);
    product(width, n, AT, of->series + FUNCTIONS * (n + 1) * p->row, polynomials, out->x);
    for (int k = 0; k < BY_LEVEL; k++)
        product(width, n, AT, series + (n + 1) * k, polynomials, rows[k]);
    for (int k = 0; k < 4; k++) {
        product(width, n, n, o->varied->M + (PAIRS * p->row + k) * n, o->at->analyse, one);
        product(width, n, AT, one, polynomials, M[k]);
    }
    for (int i = 0; i < AT; i++) {
        out->base[i] = of->base[p->row], out->angles.beta[i] = out->base[i] + out->x[i];
        out->angles.speed[i] = larger(out->v[i], 0), out->v[i] = way * out->angles.speed[i];
    }
    directions_of(&out->angles);
}

IN_WIDTHS(states_on, (const rod *o, const stretch *p, states *out, double (*M)[AT]), (WIDTH, o, p, out, M))

/* What a part adds to the positive part of its density and to the length on which it is positive. */
static void add_positive(const rod *o, double still, const stretch *p, const rated *by, const double *above,
                         double (*M)[AT], double (*sum)[4])
{
    const workspace *w = o->w;
    const double length = p->time * p->count;
    const int first = p->of.values[0] > 0;
    double column[AT], series[AT], pace[AT];
    sign_changes zeros = {0};
    if (fabs(p->series[0]) <= range_of(p->series))
        rod_changes(w, p->of.values, p->series, &zeros);
    w->use.through(by->pace, w->by.analyse, pace);
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < AT; i++)
            column[i] = by->moved[k][i] - (still > -rod_tuning.barely ? above[i] : by->of.values[i]) * M[k][i];
        const double lies = total_of(M[k], w->by.weight), all = total_of(column, w->by.weight);
        const double positive = rod_positive_mean(w, M[k], lies, &zeros, first);
        sum[ALONE][k] += length * (rod_positive_mean(w, column, all, &zeros, first) + level_of(still) * (lies - positive));
        sum[ATTACHED][k] += length * ((still > 0) * lies - positive);
        if (zeros.count)
            w->use.through(by->moved[k], w->by.analyse, series);
        for (int z = 0; z < zeros.count; z++)
            sum[ATTACHED][k] += p->count * at_place(series, AT, zeros.x[z]) / fabs(at_place(pace, AT, zeros.x[z]));
    }
}

/* Adds what a part of the rod adds by a unit of each element of e. */
static void add_part(const rod *o, int kind, double still, const stretch *p, double sum[COLUMNS + 1][4])
{
    double above[AT], M[4][AT], first[COLUMNS];
    states at;
    rated by;
    FOR_LANES(o->varied->lanes, states_on)(o, p, &at, M);
    FOR_LANES(o->varied->lanes, rate)(kind, &o->w->steady, &at, &by);
    above_rest(o, kind, still, &at, &by, above);
    columns_at(by.of.values[0], above[0], still, first);
    for (int k = 0; k < 4; k++) {
        const double entered = p->low == -1 ? p->count * o->varied->jump[PAIRS * p->row + k] : 0;
        double column[AT];
        for (int c = 0; c < COLUMNS; c++)
            sum[c][k] -= entered * first[c];
        for (int i = 0; i < AT; i++)
            column[i] = by.moved[k][i] - above[i] * M[k][i];
        sum[WHOLE][k] += p->time * p->count * total_of(column, o->w->by.weight);
        sum[MOVED][k] += p->time * p->count * total_of(M[k], o->w->by.weight) + entered;
    }
    if (kind == OUTWARD)
        add_positive(o, still, p, &by, above, M, sum);
}

/* The rates of the integral of a density, of its positive part and of the length on which it is positive by each change, into
   out (F, COLUMNS). The density is on the parts of the workspace. */
static void integral_rates(rod *o, int kind, double (*out)[COLUMNS])
{
    const double t[2] = {0, o->span};
    double sum[COLUMNS + 1][4] = {{0}}, above[AT], ends[2][COLUMNS], x;
    states at = {.angles = {.beta = {o->of->base[o->nearest]}}};
    rated by;
    phase where;
    directions_of(&at.angles);
    FOR_LANES(o->varied->lanes, rate)(kind, &o->w->steady, &at, &by);
    const double still = by.of.values[0];
    for (int64_t i = 0; i < o->w->count; i++)
        if (o->w->parts[i].row < o->of->panels) /* else nothing moves */
            add_part(o, kind, still, &o->w->parts[i], sum);
    states_at(o, 2, t, &at, NULL);
    FOR_LANES(o->varied->lanes, rate)(kind, &o->w->steady, &at, &by);
    above_rest(o, kind, still, &at, &by, above);
    for (int end = 0; end < 2; end++)
        columns_at(by.of.values[end], above[end], still, ends[end]);
    rod_place(o->of, o->b, o->span, &where, &x);
    for (int k = 0; k < 4; k++) { /* where a whole turn is closed */
        const double closed = where.periods * o->varied->closing[2 * PAIRS * o->b + k];
        sum[MOVED][k] += closed;
        for (int c = 0; c < COLUMNS; c++)
            sum[c][k] -= closed * ends[0][c];
    }
    const double end = by.of.values[1], kept[COLUMNS] = {end, larger(end, 0), end > 0};
    for (int64_t f = 0; f < o->by->F; f++) {
        const double *parts = o->parts + PARTS * f, moved = parts[0] + along_e(sum[MOVED], parts);
        for (int c = 0; c < COLUMNS; c++)
            out[f][c] = along_e(sum[c], parts) + kept[c] * o->by->share * o->later[f] - parts[0] * ends[0][c] + moved * ends[1][c];
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
            o->faint[F * i + f] = FAINT * (sizes + fabs(shifted)) + rod_tuning.barely * one->size * most;
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

/* The first t of the largest push, where (df/dt)(t, q) = 0 gives dt/dq = -(d2f/dt dq)/(d2f/dt2). At the start of the rod it
   is 0, at the far end the change of the length. NaN where several places reach the largest value unequally, where the push
   is stationary at an end and the maximum moves off it, and where another place is observed. */
static void peak_of(rod *o, const places *of, double seen, double *out)
{
    const int64_t F = o->by->F;
    double most_pace = 0;
    int k = -1;
    for (int64_t i = 0; i < o->w->count; i++) {
        double pace[AT];
        o->w->use.through(o->w->parts[i].series, o->w->by.differentiate, pace);
        for (int j = 0; j < AT; j++)
            most_pace = larger(most_pace, fabs(pace[j]) * 2 / o->w->parts[i].time);
    }
    for (int i = 0; i < of->count; i++)
        if (of->at[i].known && (k < 0 || fabs(of->at[i].t - seen) < fabs(of->at[k].t - seen)))
            k = i;
    for (int64_t f = 0; f < F && (k < 0 || fabs(of->at[k].t - seen) > OBSERVED * o->span); f++)
        out[RATES * f + PEAK] = NAN;
    if (k < 0)
        return;
    const place_of_extreme *one = &of->at[k];
    const double half = smaller(WINDOW * o->shortest, o->span / 2), least = STILL * most_pace;
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
}

/* The first t with a negative push, or the whole length where there is none: f(t, q) = 0 gives dt/dq = -(df/dq)/(df/dt).
   NaN where f only touches zero on the way, and a change of f there lets that t jump. */
static void lift_off_of(rod *o, const places *lowest, double seen, double *out)
{
    const int64_t F = o->by->F;
    rated at;
    read(o, OUTWARD, 1, &seen, &at, o->a);
    for (int64_t f = 0; f < F; f++) {
        const double moved[4] = {at.moved[0][0], at.moved[1][0], at.moved[2][0], at.moved[3][0]};
        const double inside = -o->a[f] - along_e(moved, o->parts + PARTS * f) / at.pace[0];
        double *found = out + RATES * f + FIRST_LIFT;
        *found = seen >= o->span ? o->later[f] : seen > 0 ? inside : 0;
        for (int i = 0; i < lowest->count; i++)
            if (lowest->at[i].known && fabs(lowest->at[i].value) <= ZERO * lowest->at[i].size &&
                fabs(o->slopes[F * i + f]) > o->faint[F * i + f])
                *found = NAN;
    }
}

/* The rates of a density that is on the parts of the workspace: of its integral, or of what `largest` and `smallest` say of its
   extremes. */
#define INTEGRAL_OF(group, id, name, rated, density) {density, id, 0, 0},
static const struct {
    int kind, rate, largest, smallest;
} rows[] = {
    INTEGRAL_ROWS(INTEGRAL_OF) /* those without rates are never wanted */
    {ANGLE, LOW, 0, 1},      {ANGLE, HIGH, 1, 0},      {CURVATURE, CURVED, 0, 0}, {CURVATURE, TIGHTEST, 1, 0},
    {OUTWARD, PUSHED, 0, 0}, {OUTWARD, LEAST, 0, 1},   {OUTWARD, GREATEST, 1, 0}, {OUTWARD, PEAK, 1, 0},
    {OUTWARD, FIRST_LIFT, 0, 1}, {TENSION, LARGEST_TENSION, 1, 1},
};

static void write_integral(rod *o, int kind, int rate_of, double *out)
{
    double (*found)[COLUMNS] = (double (*)[COLUMNS])o->slopes;
    integral_rates(o, kind, found);
    for (int64_t f = 0; f < o->by->F; f++, out += RATES) {
        if (kind == OUTWARD)
            out[PUSHED] = found[f][ALONE], out[PULLED] = found[f][ALONE] - found[f][WHOLE], out[SHARE] = found[f][ATTACHED];
        else
            out[rate_of] = found[f][WHOLE];
    }
}

/* The rates of what the places where a density is largest, or smallest, say. Returns DONE or NO_MEMORY. */
static int extreme_of(rod *o, int kind, int largest, int smallest, int rate_of, double *out)
{
    const int lifts = rate_of == FIRST_LIFT;
    const double until = lifts ? o->by->lifts : o->span;
    places at = {0};
    if ((largest && add_places(o, kind, 1, until, !lifts, &at)) || (smallest && add_places(o, kind, -1, until, !lifts, &at)))
        return NO_MEMORY;
    judge_places(o, kind, largest && smallest, &at);
    for (int64_t f = 0; f < o->by->F && !lifts; f++)
        out[RATES * f + rate_of] = slope_of(o, &at, f);
    if (lifts)
        lift_off_of(o, &at, until, out);
    if (rate_of == PEAK)
        peak_of(o, &at, o->by->peak, out);
    return DONE;
}

static int rates_of(rod *o, double *out)
{
    const int64_t pushes = 1 << PUSHED | 1 << PULLED | 1 << SHARE;
    int resolved = -1, failed = DONE;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && !failed; i++) {
        const int kind = rows[i].kind, rate_of = rows[i].rate, extreme = rows[i].largest || rows[i].smallest;
        if (!(o->by->wanted & (rate_of == PUSHED ? pushes : (int64_t)1 << rate_of)))
            continue;
        if (!extreme)
            failed = rod_resolved(o->w, 0, kind, SIGNS, GOAL);
        else if (kind != resolved)
            failed = rod_resolved(o->w, 0, kind, EXTREMES, o->w->all->goal);
        resolved = extreme ? kind : -1;
        if (!failed && !extreme)
            write_integral(o, kind, rate_of, out);
        else if (!failed)
            failed = extreme_of(o, kind, rows[i].largest, rows[i].smallest, rate_of, out);
    }
    return failed;
}

/* Which panel is nearest to a critical point, and the shortest time of a change. */
static void prepare_rod(rod *o)
{
    const int64_t begin = o->of->first[2 * o->b], end = begin + o->of->count[2 * o->b] + o->of->count[2 * o->b + 1];
    double fastest = 0;
    o->nearest = begin;
    for (int64_t panel = begin; panel < end; panel++)
        if (o->varied->least[panel] < o->varied->least[o->nearest])
            o->nearest = panel;
    for (int64_t i = 0; i < o->w->all->first[1]; i++)
        for (int k = 0; k < AT; k++)
            fastest = larger(fastest, fabs(o->w->angles[i].speed[k]));
    o->shortest = 1 / sqrt(square(o->w->steady.steepness[0]) + fastest * fastest);
}

int rod_rates(workspace *w, const read_orbits *of, const points *at, const varied_orbits *varied, const changes *by,
              int64_t b, double *room, double *out)
{
    rod one = {.w = w, .of = of, .at = at, .varied = varied, .by = by, .b = b};
    const double both = of->duration[2 * b] + of->duration[2 * b + 1];
    one.a = room, one.slopes = room + CANDIDATES * by->F, one.faint = one.slopes + CANDIDATES * by->F;
    one.parts = by->parts, one.later = by->later, one.span = by->share * *w->all->span;
    one.period = of->kind[b] == LIBRATION ? 2 * both : both;
    rod_varied_place_at(of, varied, b, 0, &one.start);
    if (rod_angles(w, 0))
        return NO_MEMORY;
    prepare_rod(&one);
    return rates_of(&one, out);
}
