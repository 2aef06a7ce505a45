/* Coordinates on the equilibria of one path: solver/branches/charts.py. */

#include "branches.h"

#define MOST_TURNS 1e15 /* between two ends: above, an angle has no digit left of a turn */
/* Of a gap: a shelf that is less high counts as so high. Of 26 branches of random rods with a shelf, x10: one branch stops before
   its fold; a tenth: none differs */
#define LOWEST_SHELF 1e-7
/* Heights of a shelf, over which a step changes the level. Of 97 branches of 39 random rods, half of them with a shelf and half of
   them held, x10: a step beside a shelf lands on another part, so that one branch counts as closed; a tenth: beside shelves up to
   1.7 times the steps, the same folds */
#define SHELVES 100

static int is_critical(const place *o, double angle)
{
    for (int k = 0; k < o->found.count; k++)
        if (o->found.beta[k] == angle)
            return 1;
    return 0;
}

/* A path whose pin, a critical point or an end, rounding has moved, with the one of this problem; see `Boundary.own_pin`. */
path rod_own_path(const place *o, const path *at)
{
    path own = *at;
    double nearest = rod_tuning.moved;
    for (int k = 0; k < o->found.count + 2; k++) {
        const double angle = k < o->found.count ? o->found.beta[k] : k == o->found.count ? o->low : o->high;
        const double off = fabs(sin((angle - at->pin) / 2));
        if (off < nearest)
            nearest = off, own.pin = angle;
    }
    return own;
}

double rod_place_fall(const place *o, double pin, double beta)
{
    return rod_fall(o->p.lam, o->p.mu, o->p.phi, pin, beta, is_critical(o, pin));
}

int rod_is_tied(const place *o) { return o->start == o->end || rod_place_fall(o, o->start, o->end) == 0; }

/* The critical point next to an angle in [-pi, pi). */
static double nearest_critical(const place *o, double angle)
{
    int nearest = 0;
    for (int k = 1; k < o->found.count; k++)
        if (fabs(apart(angle, o->found.beta[k])) < fabs(apart(angle, o->found.beta[nearest])))
            nearest = k;
    return o->found.beta[nearest];
}

int rod_place_of(const ends_problem *of, const grid *by, place *o)
{
    o->p = *of;
    const ends_problem p = *of;
    const double *numbers = &of->lam;
    for (int k = 0; k < 6; k++)
        if (!isfinite(numbers[k]))
            return NOT_POSSIBLE;
    const int failed = rod_critical(p.lam, p.mu, p.phi, by, &o->found);
    if (failed)
        return failed;
    const double height = 1 + fabs(p.lam) + fabs(p.mu) + fabs(p.phi);
    o->helix = p.beta0 == p.betaL && fabs(slope(p.lam, p.mu, p.phi, p.beta0)) <= rod_tuning.at_rest * height;
    o->rising = p.beta0 <= p.betaL;
    const double lower = o->rising ? p.beta0 : p.betaL, upper = o->rising ? p.betaL : p.beta0;
    double around[2] = {wrapped(lower), wrapped(upper)};
    int behind[2] = {-1, -1};
    if (o->helix)
        around[0] = around[1] = nearest_critical(o, around[0]);
    for (int i = 0; i < 2; i++) {
        const double b = around[i];
        for (int k = o->found.count - 1; k >= 0; k--)
            if (fabs(apart(b, o->found.beta[k])) < rod_tuning.on)
                around[i] = o->found.beta[k];
        for (int k = 0; k < o->found.count; k++)
            behind[i] += o->found.beta[k] <= around[i];
    }
    o->low = around[0], o->high = around[1];
    const double turns = rint((upper - lower - (o->high - o->low + (o->high < o->low ? TAU : 0))) / TAU);
    if (!(fabs(turns) < MOST_TURNS))
        return NOT_POSSIBLE;
    o->whole_turns = (int64_t)turns;
    o->passed = behind[1] - behind[0] + (o->high < o->low ? o->found.count : 0);
    o->start = o->rising ? o->low : o->high, o->end = o->rising ? o->high : o->low;
    return DONE;
}

/* How often the path has each of the three times: crossing, above and below. */
void rod_path_counts(const place *o, const path *one, int64_t counts[3])
{
    const int64_t turns = one->turns, half = (turns + 1) / 2, up = one->leaving == UP;
    counts[0] = 2 * floored(turns - (up != o->rising), 2) + 1;
    counts[1] = 2 * (up ? half : turns / 2), counts[2] = 2 * (up ? turns / 2 : half);
}

int rod_excess_of(search *room, const place *o, int count, const path *some, double *off)
{
    const double pin = some[0].pin, falls[2] = {rod_place_fall(o, pin, o->low), rod_place_fall(o, pin, o->high)};
    const boundary of = {o->p.lam, o->p.mu, o->p.phi, o->p.span, o->low, o->high, rod_tuning.lowest,
                         o->whole_turns, o->passed, 1, &pin, falls};
    int failed = DONE;
    room->of = &of, room->found = o->found;
    for (int i = 0; i < count && !failed; i++) {
        int64_t counts[3];
        rod_path_counts(o, &some[i], counts);
        failed = rod_excess(room, 0, some[0].sign, counts, some[i].y, &off[i]);
    }
    room->of = NULL;
    return failed;
}

/* The turning points that a rod gains where beta_t passes through 0 at one end; -1: it loses one. inward: UP or DOWN,
   where beta goes from that end before. At an end on a centre it gains none. */
static int turns_gained(const place *o, double end, int inward)
{
    if (is_critical(o, end))
        return 0;
    const int lower = slope(o->p.lam, o->p.mu, o->p.phi, end) < 0;
    return lower == (inward == UP) ? 1 : -1;
}

int rod_path_at(const place *o, const chart *c, double x, path *out)
{
    *out = c->at;
    if (c->kind == SADDLE_OF) {
        double nearest = INFINITY;
        for (int k = 0; k < o->found.count; k++) {
            const double d = o->found.beta[k] - c->at.pin + PI, off = fabs(d - TAU * floor(d / TAU) - PI);
            if (!o->found.centre[k] && off < nearest)
                nearest = off, out->pin = o->found.beta[k];
        }
        out->y = x;
        return nearest <= 0.3;
    }
    out->pin = c->kind == START_OF ? o->start : o->end;
    out->sign = 1, out->y = c->logarithmic ? x : 2 * log(larger(fabs(x), 1e-150));
    const int now = x > 0 ? UP : DOWN;
    if (c->logarithmic || now == direction(&c->at, c->kind == END_OF))
        return 1;
    /* beta_t passes through 0 at this end, and at the other one too where G is as high there */
    const int tied = rod_is_tied(o);
    const int arriving = direction(&c->at, 1);
    if (c->kind == START_OF || tied) {
        out->turns += turns_gained(o, o->start, (int)c->at.leaving);
        out->leaving = -c->at.leaving;
    }
    if (c->kind == END_OF || tied)
        out->turns += turns_gained(o, o->end, -arriving);
    return out->turns >= 0;
}

int rod_excess_at(search *room, const place *o, const chart *c, int count, const double *x, double *off)
{
    path some[3];
    for (int i = 0; i < count; i++) {
        off[i] = NAN;
        if (!rod_path_at(o, c, x[i], &some[i])) {
            for (int k = 0; k < count; k++)
                off[k] = NAN;
            return DONE;
        }
    }
    return rod_excess_of(room, o, count, some, off);
}

/* The number of the last critical point not above an angle, counted on through whole turns. */
static int64_t behind_of(const place *o, double angle)
{
    const double turns = floor((angle + PI) / TAU);
    int64_t count = -1;
    for (int k = 0; k < o->found.count; k++)
        count += o->found.beta[k] <= angle - TAU * turns;
    return count + o->found.count * (int64_t)turns;
}

/* Whether the saddle k is among the critical points numbered from low to high. */
static int among(int k, int m, int64_t low, int64_t high)
{
    const int64_t next = low + modulo(k - low, m);
    return next <= high;
}

static double scale_of(double y) { return larger(1, 0.2 * fabs(y)); }

/* A chart of the log of a gap, or of beta_t, whose square is the gap. change: the least change of the level by which the orbit
   passes a shelf, which moves with the parameter: a step that follows it passes many times its height. */
static chart chart_in(int kind, int logarithmic, double own, double gap, double scale, double change, path at)
{
    const double least = larger(change, LOWEST_SHELF * gap), shelf = logarithmic ? least / gap : sqrt(gap + least) - sqrt(gap);
    return (chart){kind, logarithmic, own, smaller(scale, SHELVES * shelf), rod_tuning.nudge * smaller(scale, shelf), at};
}

static void put(chart *charts, int *count, chart one)
{
    int k = (*count)++;
    for (; k > 0 && charts[k - 1].own > one.own; k--)
        charts[k] = charts[k - 1];
    charts[k] = one;
}

int rod_charts(const place *o, const path *of, chart *out)
{
    const path own = rod_own_path(o, of), *at = &own;
    const int m = o->found.count;
    const double gap = at->sign * exp(larger(at->y, rod_tuning.lowest)), shift = o->p.beta0 - wrapped(o->p.beta0);
    const int64_t behind = behind_of(o, o->p.beta0 - shift), far = behind_of(o, o->p.betaL - shift);
    const int64_t near_end = behind < far ? behind : far, far_end = behind < far ? far : behind;
    int64_t lowest = behind + 1, highest = behind + m;
    double level[CRITICAL], nearest = INFINITY, change = INFINITY;
    int stops = 0, signed_count = 0, count = 0;
    for (int k = 0; k < m; k++) {
        level[k] = gap + rod_place_fall(o, at->pin, o->found.beta[k]);
        if (level[k] > 0)
            continue;
        const int64_t above = k - m * floored(k - behind - 1, m), below = k + m * floored(behind - k, m);
        highest = stops && highest < above ? highest : above;
        lowest = stops && lowest > below ? lowest : below;
        stops = 1;
    }
    const int64_t low = at->turns > 1 || (at->turns == 1 && at->leaving != UP) ? lowest : near_end + 1;
    const int64_t high = at->turns > 1 || (at->turns == 1 && at->leaving == UP) ? highest : far_end;
    const double rounding = rod_tuning.as_high * (1 + fabs(o->p.lam) + fabs(o->p.mu) + fabs(o->p.phi));
    chart first[2], second[CHARTS];
    for (int k = 0; k < m; k++)
        if (!o->found.centre[k] && among(k, m, lowest, highest))
            nearest = smaller(nearest, fabs(level[k]));
    if (!isfinite(nearest))
        return 0;
    for (int k = 0; k < o->found.shelves; k++) {
        const double off = fabs(gap + rod_place_fall(o, at->pin, o->found.shelf[k]));
        if (among((int)modulo(behind_of(o, o->found.shelf[k]), m), m, lowest, highest - 1))
            change = smaller(change, larger(off, o->found.height[k]));
    }
    for (int kind = START_OF; kind <= END_OF; kind++) {
        const double angle = kind == START_OF ? o->start : o->end;
        const double own = larger(gap + rod_place_fall(o, at->pin, angle), 0);
        const double y = at->pin == angle && at->sign > 0 ? at->y : log(larger(own, 1e-300));
        const path one = {angle, 1, y, at->leaving, at->turns};
        put(first, &signed_count, chart_in(kind, 0, own, own, sqrt(nearest), change, one));
        put(second, &count, chart_in(kind, 1, own, own, scale_of(y), change, one));
    }
    for (int k = 0; k < m; k++) {
        if (o->found.centre[k] || !among(k, m, lowest, highest) || !among(k, m, low, high))
            continue;
        const double angle = o->found.beta[k], sign = (level[k] > 0) - (level[k] < 0);
        const int known = at->sign == sign && fabs(at->pin - angle) < 1e-9;
        const double y = known ? at->y : log(larger(fabs(level[k]), 1e-300));
        /* of two saddles as high, the one from which the level is measured stays the best */
        const double own = fabs(level[k]) + (known ? 0 : rounding);
        const path one = {angle, sign, y, at->leaving, at->turns};
        put(second, &count, chart_in(SADDLE_OF, 1, own, fabs(level[k]), scale_of(y), change, one));
    }
    const int slow = first[0].own < 0.5 * nearest; /* at one end */
    memcpy(out + (slow ? 0 : count), first, sizeof(chart) * 2);
    memcpy(out + (slow ? 2 : 0), second, sizeof(chart) * (size_t)count);
    return count + 2;
}

/* `rod_charts` of a problem, into out (CHARTS + 2,); 0 where the problem is not possible, too. */
int rod_charts_of(const ends_problem *of, const path *at, const grid *by, chart *out)
{
    place o;
    return rod_place_of(of, by, &o) ? 0 : rod_charts(&o, at, out);
}

/* `rod_path_at` of a problem. */
int rod_chart_path(const ends_problem *of, const chart *c, double x, const grid *by, path *out)
{
    place o;
    return !rod_place_of(of, by, &o) && rod_path_at(&o, c, x, out);
}

int rod_joined_at(const place *o, const path *of)
{
    const path own = rod_own_path(o, of), *at = &own;
    double best = rod_place_fall(o, o->low, o->high) < 0 ? o->high : o->low;
    int extremum = is_critical(o, best);
    for (int k = 0; k < o->found.count; k++) {
        const double s = o->found.beta[k];
        const int inside = o->high >= o->low ? s >= o->low && s <= o->high : s >= o->low || s <= o->high;
        if (o->found.centre[k] || !(o->whole_turns || inside))
            continue;
        const double rise = rod_fall(o->p.lam, o->p.mu, o->p.phi, s, best, 1);
        if (rise > 0 || (rise == 0 && !extremum))
            best = s, extremum = 1;
    }
    const double gap = at->sign * exp(larger(at->y, rod_tuning.lowest));
    return (at->pin == best && at->sign > 0) || gap + rod_place_fall(o, at->pin, best) >= 0;
}
