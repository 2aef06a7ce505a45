/* Continuation of one equilibrium along a line of ends problems under dead loads. The only equation is that the path has
   the length of the rod, in the coordinate of a chart; solver/branches/continuation.py has six, for any five given
   numbers. Where the steps end, at a helix or before a leap, the whole line is left to it, from the first problem on. */

#include "branches.h"

enum { MOST_STEPS = 4000, CORRECTIONS = 12 };
enum { FAILED = 100 };                /* besides NO_MEMORY and NOT_POSSIBLE */
#define SHORTEST 1e-6 /* share of the line below which a step is abandoned */
#define EASY 1e-3     /* length of a step above which only the best coordinate is tried */
#define REACH 0.25    /* largest change of the unknown in a step, in its scales */

typedef struct {
    ends_problem first, last;
    const grid *by;
    search room;
} line;

/* The problem at a share of the line. A rod that is a helix from end to end is left to the caller. */
static int place_at(const line *l, double share, place *o)
{
    const double *first = &l->first.lam, *last = &l->last.lam;
    ends_problem p;
    double *mixed = &p.lam;
    for (int k = 0; k < 6; k++)
        mixed[k] = share >= 1 ? last[k] : (1 - share) * first[k] + share * last[k];
    const int failed = rod_place_of(&p, l->by, o);
    return failed ? failed : o->helix ? NOT_POSSIBLE : DONE;
}

/* The root of length - span next to a guess; rate: the derivative one step before. */
static int corrected(line *l, const place *o, const chart *c, double guess, double rate, path *out)
{
    const double nudge = NUDGE * c->scale;
    double x = guess, best = INFINITY, off[3];
    for (int round = 0; round < CORRECTIONS; round++) {
        const double at[3] = {x - nudge, x, x + nudge};
        const int failed = rod_excess_at(&l->room, o, c, 3, at, off);
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
    if (!rod_path_at(o, c, x, out) || !rod_joined_at(o, out) || best > 1e-9 * larger(fabs(x), c->scale))
        return FAILED;
    return DONE;
}

/* The path with its level corrected on its own problem. */
static int settled(line *l, const place *o, path *at)
{
    chart charts[CHARTS + 2];
    const int count = rod_charts(o, at, charts);
    for (int i = 0; i < count; i++) {
        const double x = coordinate(&charts[i]), nudge = NUDGE * charts[i].scale, both[2] = {x - nudge, x + nudge};
        double off[2];
        int failed = rod_excess_at(&l->room, o, &charts[i], 2, both, off);
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
    int failed = rod_excess_at(&l->room, o, c, 3, at, off);
    failed = failed ? failed : place_at(l, share + ahead, there);
    failed = failed ? failed : rod_excess_at(&l->room, there, c, 1, &x, &next);
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
    const int count = rod_charts(o, at, charts), easy = *step > EASY;
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
int rod_continued(const double *first, const double *last, const grid *by, const points *at, const cutting *how,
                  double *level, int64_t *way)
{
    line l = {.by = by};
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
