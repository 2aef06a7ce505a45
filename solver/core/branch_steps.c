/* Pseudo-arclength steps along a branch of equilibria under dead loads: solver/boundary/branch_following.py,
   branch_states.py, equilibrium_curve.py and numerics/arclength.py. Only ordinary steps are made here: a step on which
   anything else happens is not made, and is left to the caller. */

#include "branches.h"

enum { KEPT = 4, ROUNDS = 10, MOST_AT_ONCE = 3 };
enum { LEFT_TO_CALLER, AT_END, IS_CLOSED, ENOUGH }; /* why the steps end */
enum { FAILED = 100 };                              /* besides NO_MEMORY and NOT_POSSIBLE */
#define CONTRACTION 0.5  /* largest ratio of two corrections */
#define SMALL 1e-9       /* a correction that may be as large as the one before: rounding */
#define SETTLED 1e-12    /* size of the last correction */
#define OFF 0.25         /* largest distance from the predictor, as a share of the step */
#define COSINE 0.92      /* of the largest turn of the tangent */
#define LONGEST 0.25     /* step */
#define NARROW 1e-3      /* length of a step below which the caller tries other ways */
#define EASY_BEND 0.05   /* distance from the predictor, as a share of the step, that the next step aims at */
#define STEEP 0.2        /* dp along the branch, in scales, above which a step may end at a given p */
#define SHARE 0.1        /* of the change of p in a step, over which differences in p are taken */
#define LEAST 1e-10      /* the least and the largest of it, in scales of p */
#define AHEAD 1e-6
#define BESIDE_HELIX 1e-6 /* of the size of G: H at the ends of a rod that is nearly a helix */
#define SAME_SADDLE 0.1   /* half of the largest angle by which a saddle moves in a step */
#define BACK 1e-6         /* in scales: an equilibrium as near to the first is the first */

/* The problem at a value of the parameter p; 0 where there is one. */
typedef int problem_at(double p, double *numbers);

/* The parameter: its scale, the values at which to halt (rising, the ends of the range among them), and when two values
   are one. */
typedef struct {
    double scale, low, high, rounding;
    int64_t count;
    const double *halts;
} range;

/* A point of the branch, w = (x, p) over their scales: `arclength.Node` and `EquilibriumCurve`. */
typedef struct {
    double w[2], jacobian[2], tangent[2], sign, bend, ahead;
    chart chart;
} point;

/* What is kept of each point: `branch_states.Place`. */
typedef struct {
    double p, pin, sign, y;
    int64_t leaving, turns, index;
    double numbers[6];
} record;

typedef struct {
    problem_at *problem;
    const range *over;
    grid by;
    search room;
    int newest;
    double at[KEPT];
    place known[KEPT];
} family;

static int place_at(family *f, double p, const place **out)
{
    for (int k = 0; k < KEPT; k++)
        if (f->at[k] == p) {
            *out = &f->known[k];
            return DONE;
        }
    ends_problem of;
    if (f->problem(p, &of.lam))
        return FAILED;
    const double *numbers = &of.lam;
    for (int k = 0; k < 6; k++)
        if (!isfinite(numbers[k]))
            return FAILED;
    f->newest = (f->newest + 1) % KEPT;
    f->at[f->newest] = NAN;
    const int failed = rod_place_of(&of, &f->by, &f->known[f->newest]);
    if (failed)
        return failed;
    f->at[f->newest] = p;
    *out = &f->known[f->newest];
    return DONE;
}

/* The excess of length at (x, p); FAILED where there is no such path. */
static int excess(family *f, const chart *c, int count, const double *x, double p, double *off)
{
    const place *o = NULL;
    int failed = place_at(f, p, &o);
    failed = failed ? failed : rod_excess_at(&f->room, o, c, count, x, off);
    for (int i = 0; i < count && !failed; i++)
        failed = isfinite(off[i]) ? DONE : FAILED;
    return failed;
}

/* The derivatives of the excess by w, by differences. */
static int jacobian_at(family *f, point *at)
{
    const double scale = at->chart.scale, x = at->w[0] * scale, p = at->w[1] * f->over->scale, nudge = NUDGE * scale;
    const double three[3] = {x - nudge, x, x + nudge};
    double ahead = at->ahead * f->over->scale, off[3], beyond;
    int failed = excess(f, &at->chart, 3, three, p, off);
    if (failed)
        return failed;
    if (excess(f, &at->chart, 1, &x, p + ahead, &beyond)) {
        ahead = -ahead;
        failed = excess(f, &at->chart, 1, &x, p + ahead, &beyond);
    }
    at->jacobian[0] = (off[2] - off[0]) / (2 * nudge) * scale;
    at->jacobian[1] = (beyond - off[1]) / ahead * f->over->scale;
    return failed;
}

/* The point of the curve in the plane through a guess with the normal `across`, by Broyden's method. */
static int corrected(family *f, point *at, const double *guess, const double *across, const double *jacobian)
{
    double a = jacobian[0], b = jacobian[1], c = across[0], d = across[1];
    double move[2] = {0, 0}, off[2] = {0, 0}, last = INFINITY;
    at->w[0] = guess[0], at->w[1] = guess[1];
    for (int round = 0; round < ROUNDS; round++) {
        const double x = at->w[0] * at->chart.scale;
        double now[2];
        const int failed = excess(f, &at->chart, 1, &x, at->w[1] * f->over->scale, &now[0]);
        if (failed)
            return failed;
        now[1] = across[0] * (at->w[0] - guess[0]) + across[1] * (at->w[1] - guess[1]);
        if (round) {
            const double size2 = move[0] * move[0] + move[1] * move[1];
            const double r = (now[0] - off[0] - (a * move[0] + b * move[1])) / size2;
            const double s = (now[1] - off[1] - (c * move[0] + d * move[1])) / size2;
            a += r * move[0], b += r * move[1], c += s * move[0], d += s * move[1];
        }
        const double determinant = a * d - b * c;
        off[0] = now[0], off[1] = now[1];
        move[0] = -(d * off[0] - b * off[1]) / determinant, move[1] = -(a * off[1] - c * off[0]) / determinant;
        const double size = hypot(move[0], move[1]);
        if (!(size <= larger(CONTRACTION * last, SMALL)))
            return FAILED;
        at->w[0] += move[0], at->w[1] += move[1];
        if (size <= SETTLED || (size <= SMALL && size >= CONTRACTION * last))
            return DONE;
        last = size;
    }
    return last <= SMALL ? DONE : FAILED;
}

/* The point after a step. */
static int advanced(family *f, const point *from, double step, const double *across, point *out)
{
    const double guess[2] = {from->w[0] + step * from->tangent[0], from->w[1] + step * from->tangent[1]};
    *out = *from;
    int failed = corrected(f, out, guess, across ? across : from->tangent, from->jacobian);
    if (failed)
        return failed;
    out->bend = larger(hypot(out->w[0] - guess[0], out->w[1] - guess[1]) - SMALL, 0) / step;
    if (out->bend > OFF)
        return FAILED;
    failed = jacobian_at(f, out);
    const double *j = out->jacobian, size = hypot(j[0], j[1]), t[2] = {-j[1] / size, j[0] / size};
    if (failed || !(size > 0))
        return failed ? failed : FAILED;
    const double way = (j[0] * t[1] - j[1] * t[0] > 0) == (from->sign > 0) ? 1 : -1;
    out->tangent[0] = way * t[0], out->tangent[1] = way * t[1];
    const double turned = out->tangent[0] * from->tangent[0] + out->tangent[1] * from->tangent[1];
    return turned >= COSINE ? DONE : FAILED;
}

/* Whether two charts have one coordinate. */
static int alike(const chart *one, const chart *other)
{
    const int same = one->kind == other->kind && one->logarithmic == other->logarithmic && one->at.sign == other->at.sign;
    return same && (one->kind != SADDLE_OF || fabs(sin((one->at.pin - other->at.pin) / 2)) < SAME_SADDLE);
}

/* The same point in its own coordinate, made anew; FAILED where another one is better, if it need not be kept. */
static int recharted(family *f, point *at, double step, int keep)
{
    const place *o = NULL;
    path here;
    chart charts[CHARTS + 2];
    const double small = SHARE * step * fabs(at->tangent[1]);
    at->ahead = smaller(larger(small, LEAST), AHEAD);
    int failed = place_at(f, at->w[1] * f->over->scale, &o);
    if (failed || !rod_path_at(o, &at->chart, at->w[0] * at->chart.scale, &here) || here.turns < 0)
        return failed ? failed : FAILED;
    const int count = rod_charts(o, &here, charts);
    if (!count || (!keep && !alike(&charts[0], &at->chart)))
        return FAILED;
    for (int i = 0; i < count; i++) {
        if (!alike(&charts[i], &at->chart))
            continue;
        const double ratio = at->chart.scale / charts[i].scale, size = hypot(at->tangent[0] * ratio, at->tangent[1]);
        at->w[0] *= ratio, at->jacobian[0] /= ratio;
        at->tangent[0] *= ratio / size, at->tangent[1] /= size;
        at->chart = charts[i];
        break;
    }
    return DONE;
}

/* Whether the rod would be a helix at a parameter so near that its level leaves the range of floats there. */
static int is_near_helix(const place *o)
{
    const ends_problem *p = &o->p;
    const double size = fabs(slope(p->lam, p->mu, p->phi, p->beta0));
    return o->start == o->end && size > 0 && size < BESIDE_HELIX * (1 + fabs(p->lam) + fabs(p->mu) + fabs(p->phi));
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

/* The point as it is kept; 0 where there is no path. */
static int recorded(family *f, const point *at, record *out)
{
    const place *o = NULL;
    path here;
    const double x = at->w[0] * at->chart.scale, p = at->w[1] * f->over->scale;
    const int failed = place_at(f, p, &o);
    if (failed || !rod_path_at(o, &at->chart, x, &here) || here.turns < 0)
        return failed ? failed : FAILED;
    const double rate = at->jacobian[0] * (at->chart.logarithmic ? here.sign : x); /* > 0: the length grows */
    const int64_t index = here.turns - (rate > 0);
    *out = (record){snapped(f->over, p), here.pin, here.sign, here.y, here.leaving, here.turns, index > 0 ? index : 0,
                    {o->p.lam, o->p.mu, o->p.phi, o->p.span, o->p.beta0, o->p.betaL}};
    return DONE;
}

/* One step from a point in its own coordinate. FAILED: a shorter one may succeed; LEFT_TO_CALLER: none here will. */
static int stepped(family *f, const point *from, double step, point *there, int *left)
{
    static const double by_p[2] = {0, 1};
    const range *over = f->over;
    const place *o = NULL;
    const double p = from->w[1] * over->scale, rises = from->tangent[1];
    const double ahead = rises != 0 ? (next_halt(over, p, rises > 0) / over->scale - from->w[1]) / rises : INFINITY;
    const int ends = fabs(rises) > STEEP && ahead > 0 && ahead <= step;
    int failed = advanced(f, from, ends ? ahead : step, ends ? by_p : NULL, there);
    if (failed)
        return failed;
    if (!from->chart.logarithmic && from->w[0] * there->w[0] < 0) { /* beta_t passes through 0 at an end */
        failed = place_at(f, p, &o);
        *left = failed || rod_is_tied(o);
    }
    *left |= rises * there->tangent[1] < 0 || halts_between(over, p, there->w[1] * over->scale);
    return failed;
}

static int followed(family *f, point *at, double *step, int64_t *kept, const record *first, int64_t most, record *out,
                    int64_t *count, int64_t *why)
{
    *why = LEFT_TO_CALLER;
    while (*count < most) {
        const place *o = NULL;
        point here = *at, there;
        int left = 0, failed = recharted(f, &here, *step, *kept > 0);
        failed = failed ? failed : place_at(f, here.w[1] * f->over->scale, &o);
        if (failed || is_near_helix(o))
            return failed;
        failed = stepped(f, &here, *step, &there, &left);
        if (failed == FAILED && *step / 2 >= NARROW) {
            *at = here, *kept -= 1, *step /= 2;
            continue;
        }
        record *one = &out[*count];
        failed = failed || left ? failed : recorded(f, &there, one);
        if (failed || left)
            return failed;
        *at = there, *kept -= 1, *count += 1;
        const double share = sqrt(EASY_BEND / larger(there.bend, 1e-6));
        *step = smaller(LONGEST, *step * smaller(larger(share, 0.3), 2.0));
        if (one->leaving == first->leaving && one->turns == first->turns && one->sign == first->sign &&
            fabs(one->p - first->p) < BACK && fabs(one->pin - first->pin) < BACK && fabs(one->y - first->y) < BACK) {
            *why = IS_CLOSED;
            return DONE;
        }
        const range *over = f->over;
        if (there.tangent[1] > 0 ? one->p >= over->high - over->rounding : one->p <= over->low + over->rounding) {
            *why = AT_END;
            return DONE;
        }
    }
    *why = ENOUGH;
    return DONE;
}

static family family_of(problem_at *problem, const range *over, const grid *by, const points *nodes, const cutting *how)
{
    family f = {.problem = problem, .over = over, .by = *by, .at = {NAN, NAN, NAN, NAN}};
    f.room = (search){.at = nodes, .how = *how};
    f.room.how.times_only = 1;
    return f;
}

/* The excess of length at n values of x (n,) and one of p; FAILED where there is none. */
int rod_branch_excess(problem_at *problem, double scale, const grid *by, const points *nodes, const cutting *how,
                      const chart *in, double p, int64_t n, const double *x, double *off)
{
    if (nodes->n > NODES || nodes->n < 4 || n > MOST_AT_ONCE)
        return FAILED;
    const range over = {.scale = scale};
    family f = family_of(problem, &over, by, nodes, how);
    const int failed = excess(&f, in, (int)n, x, p, off);
    rod_panels_free(&f.room.room);
    return failed == NOT_POSSIBLE ? FAILED : failed;
}

/* Steps along a branch from a point, which is replaced by the last one.

   step, kept: length of the next step, and for how many more the coordinate is kept; replaced. first: where the branch
   begins, to tell whether it is closed. out: (most,), filled. count, why: how many, and why there are no more. Returns
   DONE or NO_MEMORY. */
int rod_branch_steps(problem_at *problem, const range *over, const grid *by, const points *nodes, const cutting *how,
                     point *at, double *step, int64_t *kept, const record *first, int64_t most, record *out,
                     int64_t *count, int64_t *why)
{
    *count = 0, *why = LEFT_TO_CALLER;
    if (nodes->n > NODES || nodes->n < 4)
        return DONE;
    family f = family_of(problem, over, by, nodes, how);
    const int failed = followed(&f, at, step, kept, first, most, out, count, why);
    rod_panels_free(&f.room.room);
    return failed == NO_MEMORY ? NO_MEMORY : DONE;
}
