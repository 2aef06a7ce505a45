/* Continuation of one equilibrium along a line of ends problems: solver/boundary/continuation.py,
   continuation_steps.py and branch_coordinates.py, but for helices and leaps, which are left to those. */

#include "panels.h"

enum { UP = 1, DOWN = -1, MOST_STEPS = 4000, CORRECTIONS = 12, CHARTS = CRITICAL + 4 };
enum { SADDLE_OF, START_OF, END_OF }; /* where the level of a chart is measured from */
enum { FAILED = 100 };                /* besides NO_MEMORY and NOT_POSSIBLE */
#define NUDGE 1e-5    /* of the unknown's scale, for differences */
#define SHORTEST 1e-6 /* share of the line below which a step is abandoned */
#define EASY 1e-3     /* length of a step above which only the best coordinate is tried */
#define REACH 0.25    /* largest change of the unknown in a step, in its scales */
#define DEEPEST -575.0
#define ON 1e-110 /* an end this near to a saddle lies on it */

typedef struct {
    double lam, mu, phi, span, beta0, betaL;
} ends_problem;

/* One equilibrium: `branch_coordinates.Path`. */
typedef struct {
    double pin, sign, y;
    int64_t leaving, turns;
} path;

typedef struct {
    int kind, logarithmic;
    double own, scale;
    path at;
} chart;

/* One ends problem on the line, with the critical points of its G. */
typedef struct {
    ends_problem p;
    critical found;
    double low, high, start, end;
    int rising, whole_turns, passed;
} place;

typedef struct {
    ends_problem first, last;
    int64_t m;
    const double *angles, *table;
    search room;
} line;

static int64_t floored(int64_t a, int64_t b) { return a / b - (a % b != 0 && (a % b < 0) != (b < 0)); }
static int direction(const path *one, int at_end) { return (int)(at_end && one->turns % 2 ? -one->leaving : one->leaving); }

static int is_critical(const place *o, double angle)
{
    for (int k = 0; k < o->found.count; k++)
        if (o->found.beta[k] == angle)
            return 1;
    return 0;
}

static double fall(const place *o, double pin, double beta)
{
    return rod_fall(o->p.lam, o->p.mu, o->p.phi, pin, beta, is_critical(o, pin));
}

/* The problem at a share of the line. A rod that is a helix from end to end is left to the caller. */
static int place_at(const line *l, double share, place *o)
{
    const double *first = &l->first.lam, *last = &l->last.lam;
    double *mixed = &o->p.lam;
    for (int k = 0; k < 6; k++)
        mixed[k] = share >= 1 ? last[k] : (1 - share) * first[k] + share * last[k];
    const ends_problem p = o->p;
    const int failed = rod_critical(p.lam, p.mu, p.phi, l->m, l->angles, l->table, &o->found);
    if (failed)
        return failed;
    const double height = 1 + fabs(p.lam) + fabs(p.mu) + fabs(p.phi);
    if (p.beta0 == p.betaL && fabs(slope(p.lam, p.mu, p.phi, p.beta0)) <= 4e-16 * height)
        return NOT_POSSIBLE;
    o->rising = p.beta0 <= p.betaL;
    const double lower = o->rising ? p.beta0 : p.betaL, upper = o->rising ? p.betaL : p.beta0;
    double around[2] = {wrapped(lower), wrapped(upper)};
    int behind[2] = {-1, -1};
    for (int i = 0; i < 2; i++) {
        const double b = around[i];
        for (int k = o->found.count - 1; k >= 0; k--)
            if (fabs(apart(b, o->found.beta[k])) < ON)
                around[i] = o->found.beta[k];
        for (int k = 0; k < o->found.count; k++)
            behind[i] += o->found.beta[k] <= around[i];
    }
    o->low = around[0], o->high = around[1];
    const double turns = rint((upper - lower - (o->high - o->low + (o->high < o->low ? TAU : 0))) / TAU);
    if (!(fabs(turns) < 1e6))
        return NOT_POSSIBLE;
    o->whole_turns = (int)turns;
    o->passed = behind[1] - behind[0] + (o->high < o->low ? o->found.count : 0);
    o->start = o->rising ? o->low : o->high, o->end = o->rising ? o->high : o->low;
    return DONE;
}

/* Length of each path less that of the rod, all with the pin and the sign of the first. */
static int excesses(line *l, const place *o, int count, const path *some, double *off)
{
    const double pin = some[0].pin, falls[2] = {fall(o, pin, o->low), fall(o, pin, o->high)};
    const boundary of = {o->p.lam, o->p.mu, o->p.phi, o->p.span, o->low, o->high, DEEPEST, o->whole_turns, o->passed, 1,
                         &pin, falls};
    int failed = DONE;
    l->room.of = &of, l->room.found = o->found;
    for (int i = 0; i < count && !failed; i++) {
        const int64_t turns = some[i].turns, half = (turns + 1) / 2, up = some[i].leaving == UP;
        const int64_t counts[3] = {2 * floored(turns - (up != o->rising), 2) + 1, 2 * (up ? half : turns / 2),
                                   2 * (up ? turns / 2 : half)};
        failed = rod_excess(&l->room, 0, some[0].sign, counts, some[i].y, &off[i]);
    }
    l->room.of = NULL;
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

/* The path at x; 0 where its saddle no longer exists or there is no such path. */
static int path_at(const place *o, const chart *c, double x, path *out)
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
    const double pin = out->pin = c->kind == START_OF ? o->start : o->end;
    out->sign = 1, out->y = c->logarithmic ? x : 2 * log(larger(fabs(x), 1e-150));
    const int now = x > 0 ? UP : DOWN;
    if (c->logarithmic || now == direction(&c->at, c->kind == END_OF))
        return 1;
    /* beta_t passes through 0 at this end, and at the other one too where G is as high there */
    const int tied = o->start == o->end || fall(o, o->start, o->end) == 0;
    const int arriving = direction(&c->at, 1);
    if (c->kind == START_OF || tied) {
        out->turns += turns_gained(o, o->start, (int)c->at.leaving);
        out->leaving = -c->at.leaving;
    }
    if (c->kind == END_OF || tied)
        out->turns += turns_gained(o, o->end, -arriving);
    return out->turns >= 0;
}

static int excess_at(line *l, const place *o, const chart *c, int count, const double *x, double *off)
{
    path some[3];
    for (int i = 0; i < count; i++) {
        off[i] = NAN;
        if (!path_at(o, c, x[i], &some[i])) {
            for (int k = 0; k < count; k++)
                off[k] = NAN;
            return DONE;
        }
    }
    return excesses(l, o, count, some, off);
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

static void put(chart *charts, int *count, chart one)
{
    int k = (*count)++;
    for (; k > 0 && charts[k - 1].own > one.own; k--)
        charts[k] = charts[k - 1];
    charts[k] = one;
}

/* Coordinates in which the equilibrium can be followed, the best first; their number, 0 where there is none. */
static int charts_of(const place *o, const path *at, chart *out)
{
    const int m = o->found.count;
    const double gap = at->sign * exp(larger(at->y, DEEPEST)), shift = o->p.beta0 - wrapped(o->p.beta0);
    const int64_t behind = behind_of(o, o->p.beta0 - shift), far = behind_of(o, o->p.betaL - shift);
    const int64_t near_end = behind < far ? behind : far, far_end = behind < far ? far : behind;
    int64_t lowest = behind + 1, highest = behind + m;
    double level[CRITICAL], nearest = INFINITY;
    int stops = 0, signed_count = 0, count = 0;
    for (int k = 0; k < m; k++) {
        level[k] = gap + fall(o, at->pin, o->found.beta[k]);
        if (level[k] > 0)
            continue;
        const int64_t above = k - m * floored(k - behind - 1, m), below = k + m * floored(behind - k, m);
        highest = stops && highest < above ? highest : above;
        lowest = stops && lowest > below ? lowest : below;
        stops = 1;
    }
    const int64_t low = at->turns > 1 || (at->turns == 1 && at->leaving != UP) ? lowest : near_end + 1;
    const int64_t high = at->turns > 1 || (at->turns == 1 && at->leaving == UP) ? highest : far_end;
    chart first[2], second[CHARTS];
    for (int k = 0; k < m; k++)
        if (!o->found.centre[k] && among(k, m, lowest, highest))
            nearest = smaller(nearest, fabs(level[k]));
    if (!isfinite(nearest))
        return 0;
    for (int kind = START_OF; kind <= END_OF; kind++) {
        const double angle = kind == START_OF ? o->start : o->end;
        const double own = larger(gap + fall(o, at->pin, angle), 0);
        const double y = at->pin == angle && at->sign > 0 ? at->y : log(larger(own, 1e-300));
        const path one = {angle, 1, y, at->leaving, at->turns};
        put(first, &signed_count, (chart){kind, 0, own, sqrt(nearest), one});
        put(second, &count, (chart){kind, 1, own, scale_of(y), one});
    }
    for (int k = 0; k < m; k++) {
        if (o->found.centre[k] || !among(k, m, lowest, highest) || !among(k, m, low, high))
            continue;
        const double angle = o->found.beta[k], sign = (level[k] > 0) - (level[k] < 0);
        const int known = at->sign == sign && fabs(at->pin - angle) < 1e-9;
        const double y = known ? at->y : log(larger(fabs(level[k]), 1e-300));
        put(second, &count, (chart){SADDLE_OF, 1, fabs(level[k]), scale_of(y), {angle, sign, y, at->leaving, at->turns}});
    }
    const int slow = first[0].own < 0.5 * nearest; /* at one end */
    memcpy(out + (slow ? 0 : count), first, sizeof(chart) * 2);
    memcpy(out + (slow ? 2 : 0), second, sizeof(chart) * (size_t)count);
    return count + 2;
}

static double coordinate(const chart *c)
{
    return c->logarithmic ? c->at.y : direction(&c->at, c->kind == END_OF) * exp(c->at.y / 2);
}

/* Whether the level lies above every maximum of G between the two ends. */
static int joined_at(const place *o, const path *at)
{
    double best = fall(o, o->low, o->high) < 0 ? o->high : o->low;
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
    return (at->pin == best && at->sign > 0) || at->sign * exp(larger(at->y, DEEPEST)) + fall(o, at->pin, best) >= 0;
}

/* The root of length - span next to a guess; rate: the derivative one step before. */
static int corrected(line *l, const place *o, const chart *c, double guess, double rate, path *out)
{
    const double nudge = NUDGE * c->scale;
    double x = guess, best = INFINITY, off[3];
    for (int round = 0; round < CORRECTIONS; round++) {
        const double at[3] = {x - nudge, x, x + nudge};
        const int failed = excess_at(l, o, c, 3, at, off);
        if (failed)
            return failed;
        const double here = (off[2] - off[0]) / (2 * nudge), share = here / rate, step = -off[1] / here;
        if (!isfinite(off[0] + off[1] + off[2]) || !(0.25 < share && share < 4))
            return FAILED;
        if (round > 2 && fabs(step) >= best)
            break;
        best = fabs(step);
        x += step;
        if (fabs(x - guess) > REACH * c->scale)
            return FAILED;
        if (fabs(step) <= 4e-16 * larger(fabs(x), c->scale))
            break;
    }
    if (!path_at(o, c, x, out) || !joined_at(o, out) || best > 1e-9 * larger(fabs(x), c->scale))
        return FAILED;
    return DONE;
}

/* The path with its level corrected on its own problem. */
static int settled(line *l, const place *o, path *at)
{
    chart charts[CHARTS + 2];
    const int count = charts_of(o, at, charts);
    for (int i = 0; i < count; i++) {
        const double x = coordinate(&charts[i]), nudge = NUDGE * charts[i].scale, both[2] = {x - nudge, x + nudge};
        double off[2];
        int failed = excess_at(l, o, &charts[i], 2, both, off);
        const double rate = (off[1] - off[0]) / (2 * nudge);
        if (!failed && isfinite(rate) && rate != 0)
            failed = corrected(l, o, &charts[i], x, rate, at);
        else if (!failed)
            failed = FAILED;
        if (failed != FAILED)
            return failed;
    }
    return FAILED;
}

static int advance(line *l, const place *o, const chart *c, double share, double *step, place *there, path *out)
{
    const double x = coordinate(c), nudge = NUDGE * c->scale, at[3] = {x - nudge, x, x + nudge};
    const double ahead = smaller(1e-6, *step);
    double off[3], next;
    int failed = excess_at(l, o, c, 3, at, off);
    failed = failed ? failed : place_at(l, share + ahead, there);
    failed = failed ? failed : excess_at(l, there, c, 1, &x, &next);
    if (failed)
        return failed;
    const double rate = (off[2] - off[0]) / (2 * nudge), drift = (next - off[1]) / ahead, speed = -drift / rate;
    if (!isfinite(rate) || !isfinite(drift) || rate == 0)
        return FAILED;
    if (fabs(speed) * *step > REACH * c->scale) {
        *step = REACH * c->scale / fabs(speed);
        if (*step < SHORTEST)
            return FAILED;
    }
    failed = place_at(l, share + *step, there);
    return failed ? failed : corrected(l, there, c, x + speed * *step, rate, out);
}

/* The equilibrium after at most one step, which is set to the step taken. */
static int advanced(line *l, const place *o, const path *at, double share, double *step, place *there, path *out)
{
    chart charts[CHARTS + 2];
    const int count = charts_of(o, at, charts), easy = *step > EASY;
    const double wanted = *step;
    for (int i = 0; i < (easy && count ? 1 : count); i++) {
        *step = wanted;
        const int failed = advance(l, o, &charts[i], share, step, there, out);
        if (failed != FAILED)
            return failed;
    }
    return FAILED;
}

static int followed(line *l, path *at)
{
    place o, there;
    double share = 0, step = 1;
    int failed = place_at(l, 0, &o);
    failed = failed ? failed : settled(l, &o, at);
    if (!memcmp(&l->first, &l->last, sizeof l->first))
        return failed;
    for (int round = 0; round < MOST_STEPS && !failed && share < 1; round++) {
        path next;
        double taken = smaller(step, 1 - share);
        failed = advanced(l, &o, at, share, &taken, &there, &next);
        if (failed == FAILED) {
            step = smaller(step, 1 - share) / 4;
            failed = step >= SHORTEST ? DONE : FAILED;
            continue;
        }
        o = there, *at = next;
        share = taken >= 1 - share ? 1 : share + taken;
        step = 2 * taken;
    }
    return failed ? failed : share >= 1 ? DONE : FAILED;
}

/* Follows an equilibrium of the problem `first` to `last` (6 numbers each: lam, mu, phi, span, beta(0), beta(L)).

   level: pin, sign, y; way: leaving, turns; of the equilibrium, replaced by those of the one found. Returns DONE; where
   the branch ends, or a leap or a helix would be needed, any other number. */
int rod_continued(const double *first, const double *last, int64_t m, const double *angles, const double *table,
                  const points *at, const cutting *how, double *level, int64_t *way)
{
    line l = {.m = m, .angles = angles, .table = table};
    for (int k = 0; k < 6; k++)
        if (!isfinite(first[k]) || !isfinite(last[k]) || fabs(first[4]) > 1e6 || fabs(last[4]) > 1e6 ||
            fabs(first[5]) > 1e6 || fabs(last[5]) > 1e6)
            return NOT_POSSIBLE;
    if (at->n > NODES || at->n < 4 || !(way[1] >= 0 && way[1] < 1000000000))
        return NOT_POSSIBLE;
    memcpy(&l.first, first, sizeof l.first);
    memcpy(&l.last, last, sizeof l.last);
    l.room = (search){.at = at, .how = *how};
    l.room.how.times_only = 1;
    path one = {level[0], level[1], level[2], way[0], way[1]};
    const int failed = followed(&l, &one);
    rod_panels_free(&l.room.room);
    if (!failed)
        level[0] = one.pin, level[1] = one.sign, level[2] = one.y, way[0] = one.leaving, way[1] = one.turns;
    return failed;
}
