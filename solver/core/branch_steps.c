/* Pseudo-arclength steps along a branch of equilibria: solver/branches/branch_following.py,
   branch_states.py, equilibrium_curve.py and numerics/arclength.py. Only ordinary steps are made here: a step on which
   anything else happens is not made, and is left to the caller. Continuation along a line of problems under dead loads
   is made of the same steps, in whichever coordinate they lead on; where they end before the last problem,
   solver/branches/continuation.py begins anew. */

#include "branch_points.h"

enum { MOST_AT_ONCE = 3 };
enum { LEFT_TO_CALLER, AT_END, IS_CLOSED, ENOUGH }; /* why the steps end */
#define RATIO 4 /* on a line of problems, by which the rate of the length may change in a step: more hides two folds */

static const double by_p[UNKNOWNS] = {0, 1};

/* What is kept of each point: `branch_states.Place`. */
typedef struct {
    double p, pin, sign, y;
    int64_t leaving, turns, index;
    double numbers[6];
} record;

/* A unit vector t with F' t = 0, next to that of the point before, and the way that keeps the sign of det [F'; t]. */
static int tangent_of(int n, const point *from, point *out)
{
    enum { WIDE_ROW = UNKNOWNS + 1 };
    double matrix[UNKNOWNS * WIDE_ROW] = {0}, size = 0;
    for (int i = 0; i < n; i++)
        memcpy(matrix + i * (n + 1), i < n - 1 ? out->jacobian + i * n : from->tangent, sizeof(double) * (size_t)n);
    matrix[n * (n + 1) - 1] = 1;
    const int sign = rod_eliminated(n, n + 1, matrix);
    for (int i = 0; i < n; i++)
        size += square(matrix[i * (n + 1) + n]);
    size = sqrt(size);
    if (!sign || !isfinite(size) || !(size > 0))
        return FAILED;
    /* the vector found leans to the tangent before, so det [F'; t] has the sign of the matrix */
    for (int i = 0; i < n; i++)
        out->tangent[i] = (sign > 0) == (from->sign > 0) ? matrix[i * (n + 1) + n] / size : -matrix[i * (n + 1) + n] / size;
    return DONE;
}

/* The point after a step. */
static int advanced(family *f, const point *from, double step, const double *across, point *out)
{
    const int n = unknowns_of(f);
    double guess[UNKNOWNS] = {0}, off = 0, turned = 0;
    for (int i = 0; i < n; i++)
        guess[i] = from->w[i] + step * from->tangent[i];
    int failed = rod_curve_corrected(f, from, guess, across ? across : from->tangent, out);
    if (failed)
        return failed;
    for (int i = 0; i < n; i++)
        off += square(out->w[i] - guess[i]);
    out->bend = larger(sqrt(off) - rod_tuning.small, 0) / step;
    if (out->bend > rod_tuning.off)
        return FAILED;
    failed = f->held ? DONE : rod_curve_jacobian(f, out);
    failed = failed ? failed : tangent_of(n, from, out);
    for (int i = 0; i < n && !failed; i++)
        turned += out->tangent[i] * from->tangent[i];
    return failed ? failed : turned >= rod_tuning.cosine ? DONE : FAILED;
}

/* Whether two charts have one coordinate. */
static int alike(const chart *one, const chart *other)
{
    const int same = one->kind == other->kind && one->logarithmic == other->logarithmic && one->at.sign == other->at.sign;
    return same && (one->kind != SADDLE_OF || fabs(sin((one->at.pin - other->at.pin) / 2)) < rod_tuning.same_saddle);
}

/* The same point in its own coordinate, made anew; FAILED where another one is better, if it need not be kept. */
static int recharted(family *f, point *at, double step, int keep, place *o)
{
    const int n = unknowns_of(f);
    path here;
    chart charts[CHARTS + 2];
    const double small = rod_tuning.share * step * fabs(at->tangent[1]);
    at->ahead = smaller(larger(small, rod_tuning.least), rod_tuning.ahead);
    const int failed = rod_curve_place(f, at, o, &here);
    if (failed)
        return failed;
    const int count = rod_charts(o, &here, charts);
    if (!count || (!keep && !alike(&charts[0], &at->chart)))
        return FAILED;
    for (int i = 0; i < count; i++) {
        if (!alike(&charts[i], &at->chart))
            continue;
        const double ratio = at->chart.scale / charts[i].scale;
        double size = square(at->tangent[0] * ratio);
        for (int k = 1; k < n; k++)
            size += square(at->tangent[k]);
        at->w[0] *= ratio, at->tangent[0] *= ratio;
        for (int k = 0; k < n - 1; k++)
            at->jacobian[n * k] /= ratio;
        for (int k = 0; k < n; k++)
            at->tangent[k] /= sqrt(size);
        at->chart = charts[i];
        break;
    }
    return DONE;
}

/* Whether the rod would be a helix at a parameter so near that its level leaves the range of floats there. */
static int is_near_helix(const place *o, double near)
{
    const ends_problem *p = &o->p;
    const double size = fabs(slope(p->lam, p->mu, p->phi, p->beta0));
    return o->start == o->end && size > 0 && size < near * (1 + fabs(p->lam) + fabs(p->mu) + fabs(p->phi));
}

/* An end of the rod less the saddle next to it. at: filled, the saddle. */
static double off_saddle(const place *o, double end, double *at)
{
    double nearest = INFINITY;
    for (int k = 0; k < o->found.count; k++) {
        const double off = apart(end, o->found.beta[k]);
        if (!o->found.centre[k] && fabs(off) < fabs(nearest))
            nearest = off, *at = o->found.beta[k];
    }
    return nearest;
}

/* Whether an end crosses a saddle nearer than a leap goes, at which the rod rests so long that the end crosses it within a
   range that floats cannot resolve: `branch_following.crosses_saddle`. */
static int crosses_saddle(family *f, const point *at, const place *o, int *crosses)
{
    const double ahead = at->ahead * f->over->scale, p = at->w[1] * f->over->scale;
    const double ends[2] = {o->start, o->end};
    *crosses = 0;
    for (int i = 0; i < 2 && !f->held && !*crosses; i++) {
        double saddle = 0, moved = 0;
        const double off = off_saddle(o, ends[i], &saddle);
        if (!(fabs(off) < rod_tuning.same_saddle))
            continue;
        path here;
        const place *beyond = NULL;
        if (!rod_path_at(o, &at->chart, at->w[0] * at->chart.scale, &here))
            return FAILED;
        const double gap = here.sign * exp(larger(here.y, rod_tuning.lowest)) + rod_place_fall(o, here.pin, saddle);
        const double bend = fabs(slope_rate(o->p.lam, o->p.mu, o->p.phi, saddle)), floor = rod_tuning.unresolved;
        if (!(fabs(gap) < floor * bend * larger(fabs(off), floor)))
            continue;
        const int failed = rod_curve_problem(f, p + ahead, &beyond);
        if (failed == NO_MEMORY || f->raised)
            return failed;
        if (!failed)
            moved = off_saddle(beyond, i ? beyond->end : beyond->start, &saddle) - off;
        *crosses = fabs(off) * at->ahead < rod_tuning.beside_saddle * fabs(moved);
    }
    return DONE;
}

/* The next value beyond p at which to halt. */
static double next_halt(const range *over, double p, int rises)
{
    if (rises) {
        for (int64_t i = 0; i < over->count; i++)
            if (over->halts[i] > p + over->rounding)
                return over->halts[i];
        return over->high;
    }
    for (int64_t i = over->count - 1; i >= 0; i--)
        if (over->halts[i] < p - over->rounding)
            return over->halts[i];
    return over->low;
}

/* Whether a value at which to halt lies strictly between two. */
static int halts_between(const range *over, double p, double q)
{
    const double low = smaller(p, q) + over->rounding, high = larger(p, q) - over->rounding;
    for (int64_t i = 0; i < over->count; i++)
        if (over->halts[i] > low && over->halts[i] < high)
            return 1;
    return 0;
}

static double snapped(const range *over, double p)
{
    for (int64_t i = 0; i < over->count; i++)
        if (fabs(over->halts[i] - p) <= over->rounding)
            return over->halts[i];
    return p;
}

/* The Morse index under dead loads. */
static int64_t dead_index(const point *at, const path *here)
{
    const double x = at->w[0] * at->chart.scale;
    const double rate = at->jacobian[0] * (at->chart.logarithmic ? here->sign : x); /* > 0: the length grows */
    const int64_t index = here->turns - (rate > 0);
    return index > 0 ? index : 0;
}

/* The point as it is kept. The index with held ends is left to the caller. */
static int recorded(family *f, const point *at, record *out)
{
    place o;
    path here;
    const int failed = rod_curve_place(f, at, &o, &here);
    if (failed)
        return failed;
    *out = (record){snapped(f->over, at->w[1] * f->over->scale), here.pin, here.sign, here.y, here.leaving, here.turns,
                    dead_index(at, &here), {o.p.lam, o.p.mu, o.p.phi, o.p.span, o.p.beta0, o.p.betaL}};
    return DONE;
}

/* One step from a point in its own coordinate. left: whether something happens on the way. FAILED: a shorter step may
   succeed. */
static int stepped(family *f, const point *from, double step, const place *o, point *there, int *left)
{
    const range *over = f->over;
    const double p = from->w[1] * over->scale, rises = from->tangent[1];
    const double ahead = rises != 0 ? (next_halt(over, p, rises > 0) / over->scale - from->w[1]) / rises : INFINITY;
    const int ends = (f->line || fabs(rises) > rod_tuning.steep) && ahead > 0 && ahead <= step;
    const int failed = advanced(f, from, ends ? ahead : step, ends ? by_p : NULL, there);
    if (failed)
        return failed;
    const int at_rest = !from->chart.logarithmic && from->w[0] * there->w[0] < 0; /* beta_t passes through 0 at an end */
    if (f->line) {
        const double share = there->jacobian[0] / from->jacobian[0];
        if (!(1 / RATIO < share && share < RATIO))
            return FAILED;
    }
    *left = (at_rest && rod_is_tied(o)) || rises * there->tangent[1] < 0 ||
            halts_between(over, p, there->w[1] * over->scale);
    if (*left || f->line || f->held)
        return DONE;
    path here, beyond;
    place last;
    if (!rod_path_at(o, &from->chart, from->w[0] * from->chart.scale, &here) || rod_curve_place(f, there, &last, &beyond))
        return FAILED;
    /* where nothing happens the index stays, or the step has led to another branch, as over a fold to its other side */
    return dead_index(from, &here) == dead_index(there, &beyond) ? DONE : FAILED;
}

/* Whether the branch is back where it began. */
static int is_same(const record *one, const record *first)
{
    const double back = rod_tuning.alike;
    return one->leaving == first->leaving && one->turns == first->turns && one->sign == first->sign &&
           fabs(one->p - first->p) < back && fabs(one->pin - first->pin) < back && fabs(one->y - first->y) < back;
}

typedef struct {
    record *places;
    orbit_numbers *rates; /* with held ends */
} records;

static int followed(family *f, point *at, double *step, int64_t *kept, const record *first, int64_t most, records out,
                    int64_t *count, int64_t *why)
{
    const range *over = f->over;
    *why = LEFT_TO_CALLER;
    while (*count < most) {
        place o;
        point here = *at, there;
        record *one = &out.places[*count];
        int left = 0, crosses = 0, failed = recharted(f, &here, *step, *kept > 0, &o);
        failed = failed ? failed : crosses_saddle(f, &here, &o, &crosses);
        if (failed || crosses || is_near_helix(&o, f->held ? rod_tuning.beside_held_helix : rod_tuning.beside_helix))
            return failed;
        failed = stepped(f, &here, *step, &o, &there, &left);
        if (failed == FAILED && !f->raised && *step / 2 >= rod_tuning.narrow) {
            *at = here, *kept -= 1, *step /= 2;
            continue;
        }
        failed = failed || left ? failed : recorded(f, &there, one);
        if (failed || left)
            return failed;
        if (f->held)
            out.rates[*count] = f->numbers;
        *at = there, *kept -= 1, *count += 1;
        const double share = sqrt(rod_tuning.easy_bend / larger(there.bend, 1e-6));
        *step = smaller(rod_tuning.longest, *step * smaller(larger(share, rod_tuning.slower), rod_tuning.faster));
        *why = IS_CLOSED;
        if (is_same(one, first))
            return DONE;
        *why = AT_END;
        if (there.tangent[1] > 0 ? one->p >= over->high - over->rounding : one->p <= over->low + over->rounding)
            return DONE;
        *why = LEFT_TO_CALLER;
    }
    *why = ENOUGH;
    return DONE;
}

/* What the core is told of the problems over p. held: NULL under dead loads; orbits: how panels of orbits are cut. */
typedef struct {
    problem_at *problem;
    const range *over;
    const held_ends *held;
    const grid *by;
    const points *nodes;
    const cutting *times, *orbits;
} curve;

static family family_of(const curve *of)
{
    family f = {.problem = of->problem, .over = of->over, .held = of->held, .by = of->by, .nodes = of->nodes};
    for (int k = 0; k < KEPT; k++)
        f.at[k] = NAN;
    f.times = *of->times, f.orbits = *of->orbits;
    f.times.series = 0, f.orbits.series = FUNCTIONS;
    f.room = (search){.at = f.nodes, .how = f.times};
    return f;
}

static int is_usable(const curve *of) { return of->nodes->n <= NODES && of->nodes->n >= 4; }

/* The excess of length at n values of x (n,) and one of p; FAILED where there is none, INTERRUPTED. */
int rod_branch_excess(const curve *of, const chart *in, double p, int64_t n, const double *x, double *off)
{
    if (!is_usable(of) || n > MOST_AT_ONCE)
        return FAILED;
    family f = family_of(of);
    const int failed = rod_curve_excess(&f, in, (int)n, x, p, off);
    rod_panels_free(&f.room.room);
    return f.raised ? INTERRUPTED : failed == NOT_POSSIBLE ? FAILED : failed;
}

/* Steps along a branch from a point, which is replaced by the last one.

   step, kept: length of the next step, and for how many more the coordinate is kept; replaced. first: where the branch
   begins, to tell whether it is closed. out, rates: (most,), filled, rates with held ends. count, why: how many, and why
   there are no more. Returns DONE, NO_MEMORY or INTERRUPTED. */
int rod_branch_steps(const curve *of, point *at, double *step, int64_t *kept, const record *first, int64_t most,
                     record *out, orbit_numbers *rates, int64_t *count, int64_t *why)
{
    *count = 0, *why = LEFT_TO_CALLER;
    if (!is_usable(of))
        return DONE;
    family f = family_of(of);
    const int failed = followed(&f, at, step, kept, first, most, (records){out, rates}, count, why);
    rod_panels_free(&f.room.room);
    return f.raised ? INTERRUPTED : failed == NO_MEMORY ? NO_MEMORY : DONE;
}

enum { MOST_STEPS = 4000, AT_ONCE = 16 };

/* The point of a line of problems at p on an equilibrium near a path, in a chart, on the way along which p rises. */
static int begun(family *f, const chart *in, double p, point *out)
{
    point guess = {.w = {coordinate(in) / in->scale, p / f->over->scale}, .ahead = rod_tuning.ahead, .chart = *in};
    int failed = isfinite(guess.w[0]) ? rod_curve_jacobian(f, &guess) : FAILED;
    failed = failed ? failed : rod_curve_corrected(f, &guess, guess.w, by_p, out);
    if (failed)
        return failed;
    const double turn = -guess.jacobian[1] / guess.jacobian[0], size = sqrt(1 + square(turn));
    memcpy(out->jacobian, guess.jacobian, sizeof out->jacobian);
    out->tangent[0] = turn / size, out->tangent[1] = 1 / size;
    out->sign = guess.jacobian[0] > 0 ? 1 : -1;
    return isfinite(size) ? DONE : FAILED;
}

/* Some steps along a line from a path at p, both replaced by where they lead, and `here`, the point there. count: the
   steps, none where no chart leads on. */
static int carried_on(family *f, path *at, double *p, double *step, int64_t *count, point *here)
{
    static const record unlike = {.turns = -1};
    const place *known = NULL;
    chart charts[CHARTS + 2];
    int failed = rod_curve_problem(f, *p, &known);
    if (failed || known->helix)
        return failed ? failed : NOT_POSSIBLE;
    const int most = rod_charts(known, at, charts);
    *count = 0;
    for (int i = 0; i < most && !*count && failed != NO_MEMORY; i++) {
        record places[AT_ONCE];
        int64_t kept = i ? rod_tuning.steps_kept : 0, why;
        failed = begun(f, &charts[i], *p, here);
        if (failed)
            continue;
        failed = followed(f, here, step, &kept, &unlike, AT_ONCE, (records){places, NULL}, count, &why);
        if (*count) {
            const record *last = &places[*count - 1];
            *at = (path){last->pin, last->sign, last->y, last->leaving, last->turns}, *p = last->p;
        }
    }
    return failed == NO_MEMORY ? NO_MEMORY : *count ? DONE : FAILED;
}

/* The path at p = 1 on the branch of a path at p = 0. */
static int carried(family *f, path *at)
{
    double p = 0, step = rod_tuning.longest;
    int64_t count;
    place o;
    point here, last;
    for (int64_t steps = 0; p < 1 && steps < MOST_STEPS; steps += count) {
        const int failed = carried_on(f, at, &p, &step, &count, &here);
        if (failed)
            return failed;
    }
    if (p != 1)
        return FAILED;
    here.w[1] = 1 / f->over->scale; /* so far to the rounding of p */
    int failed = rod_curve_corrected(f, &here, here.w, by_p, &last);
    failed = failed ? failed : rod_curve_place(f, &last, &o, at);
    return failed ? failed : rod_joined_at(&o, at) ? DONE : FAILED;
}

/* Follows an equilibrium of the problem `first` to `last` (6 numbers each: lam, mu, phi, span, beta(0), beta(L)).

   level: pin, sign, y; way: leaving, turns; of the equilibrium, replaced by those of the one found. Returns DONE; where
   the branch ends, or a leap or a helix would be needed, any other number. */
int rod_continued(const double *first, const double *last, const grid *by, const points *at, const cutting *how,
                  double *level, int64_t *way)
{
    static const double halts[2] = {0, 1};
    double rate = 0;
    ends_problem line[2];
    for (int k = 0; k < 6; k++) {
        if (!isfinite(first[k]) || !isfinite(last[k]) || (k > 3 && !(fabs(first[k]) < FAR && fabs(last[k]) < FAR)))
            return NOT_POSSIBLE;
        rate = larger(rate, fabs(last[k] - first[k]) / (1 + fabs(first[k])));
    }
    const range over = {1 / larger(rate, 1e-12), 0, 1, 1e-15, 2, halts};
    const curve of = {.over = &over, .by = by, .nodes = at, .times = how, .orbits = how};
    if (!is_usable(&of) || !(way[1] >= 0 && way[1] < 1000000000))
        return NOT_POSSIBLE;
    memcpy(line, first, sizeof line[0]);
    memcpy(line + 1, last, sizeof line[1]);
    family f = family_of(&of);
    f.line = line;
    path one = {level[0], level[1], level[2], way[0], way[1]};
    const int failed = carried(&f, &one);
    rod_panels_free(&f.room.room);
    if (!failed)
        level[0] = one.pin, level[1] = one.sign, level[2] = one.y, way[0] = one.leaving, way[1] = one.turns;
    return failed;
}
