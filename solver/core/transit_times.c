/* The times that orbits of one level take between two end angles, and the levels at which a path has the length of the
   rod: solver/orbits/boundary.py and level_search.py. */

#include "orbit_parts.h"

/* The pieces of the arcs from low, the upward one cut at high: arc 0 from low to high, 1 below low, 2 beyond high. */
static int three(const boundary *of, const arcs *from, double v_high, piece *out)
{
    int count = 0, beyond = 0;
    piece above[PIECES], below[PIECES];
    int under = 0;
    for (int i = 0; i < from->count; i++) {
        piece p = from->pieces[i];
        if (p.arc == 1) {
            below[under++] = p;
            continue;
        }
        if (p.rank == of->passed) {
            piece cut = p;
            double scale = p.scale, x = apart(of->high, p.local.o);
            const double to = p.scale * (p.kind == PASS ? sinh(p.u1) : p.kind == SADDLE ? cosh(p.u1) : sin(p.u1));
            x = to > 0 && x < 0 ? x + TAU : !(to > 0) && x > 0 ? x - TAU : x;
            const double u = rod_start_variable((int)p.kind, &scale, x, v_high, 0, &p.local);
            cut.u1 = smaller(larger(u, smaller(p.u0, p.u1)), larger(p.u0, p.u1));
            if (cut.u1 != cut.u0)
                out[count++] = cut;
            p.u0 = cut.u1;
        }
        if (p.rank < of->passed)
            out[count++] = p;
        else if (p.u0 != p.u1)
            above[beyond] = p, above[beyond++].arc = 2;
    }
    memcpy(out + count, below, sizeof(piece) * (size_t)under);
    memcpy(out + count + under, above, sizeof(piece) * (size_t)beyond);
    return count + under + beyond;
}

/* The times crossing, above and below at one level, and what a unit of falling y adds to each. */
int rod_transit_at(search *s, int64_t pin, double sign, double y, int deep, transit *out)
{
    const boundary *of = s->of;
    const double gap = sign * exp(larger(y, of->deepest));
    const double low2 = gap + of->falls[2 * pin], high2 = gap + of->falls[2 * pin + 1];
    const int joins = low2 > 0 && high2 > 0;
    const start_problem start = {of->lam, of->mu, of->phi, of->span, of->low, joins ? sqrt(low2) : 1};
    arcs from;
    piece pieces[PIECES + 1];
    *out = (transit){{NAN, NAN, NAN}, {NAN, NAN, NAN}, 0, 0};
    if (!joins)
        return DONE;
    int failed = rod_arcs(&start, of->pin[pin], gap, &s->found, &from);
    if (failed)
        return failed;
    const int count = three(of, &from, sqrt(high2), pieces);
    s->room.count = 0;
    failed = rod_panelled(&start, pieces, count, s->at, &s->how, &s->room);
    if (failed)
        return failed;
    s->calls += s->at->n * s->room.count;
    static const int place[3] = {0, 2, 1};
    double time[3] = {0}, rate[3] = {0};
    for (int64_t i = count ? 0 : -1; i >= 0; i = s->room.rows[i].next)
        time[place[pieces[s->room.rows[i].piece].arc]] += s->room.rows[i].duration;
    for (int i = 0; i < count; i++)
        rate[place[pieces[i].arc]] += rod_half_passage(&pieces[i], gap, 0) + rod_half_passage(&pieces[i], gap, 1);
    out->rotates = from.kind == ROTATION;
    /* a libration that turns before a saddle between the two ends does not come to the other one */
    out->joins = out->rotates || (of->whole_turns == 0 && from.turns_at >= of->passed);
    if (!out->joins)
        return DONE;
    if (out->rotates) {
        time[0] += (double)of->whole_turns * (time[0] + time[1]), time[1] = time[2] = 0;
        rate[0] += (double)of->whole_turns * (rate[0] + rate[1]), rate[1] = rate[2] = 0;
    }
    const double below = deep ? larger(of->deepest - y, 0) : 0;
    for (int k = 0; k < 3; k++) {
        out->time[k] = below > 0 ? time[k] + rate[k] * below : time[k];
        out->rate[k] = rate[k];
    }
    return DONE;
}

int rod_search(search *s, const boundary *of, int64_t count, const double *beta, const int64_t *centre,
                 const points *at, const cutting *how)
{
    if (count < 2 || count > CRITICAL || at->n > NODES || at->n < 4)
        return NOT_POSSIBLE;
    s->of = of, s->at = at, s->how = *how, s->room = (panels){0}, s->calls = 0;
    s->how.series = 0;
    s->found.count = (int)count;
    for (int64_t k = 0; k < count; k++)
        s->found.beta[k] = beta[k], s->found.centre[k] = centre[k] != 0;
    return DONE;
}

/* The times at n levels.

   beta, centre: (count,), the critical points. pin, sign, y: (n,), the levels. time, rate: (3, n), filled; NaN where no
   orbit joins the ends. rotates: (n,). calls: evaluations of G. Returns DONE, NO_MEMORY or NOT_POSSIBLE. */
int rod_transit_times(const boundary *of, int64_t count, const double *beta, const int64_t *centre, const points *at,
                      const cutting *how, int64_t n, const int64_t *pin, const double *sign, const double *y,
                      int64_t deep, double *time, double *rate, uint8_t *rotates, int64_t *calls)
{
    search s;
    int failed = rod_search(&s, of, count, beta, centre, at, how);
    if (failed)
        return failed;
    for (int64_t i = 0; i < n && !failed; i++) {
        transit one = {{0}, {0}, 0, 0};
        failed = pin[i] < 0 || pin[i] >= of->pins ? NOT_POSSIBLE : rod_transit_at(&s, pin[i], sign[i], y[i], deep != 0, &one);
        for (int k = 0; k < 3; k++)
            time[k * n + i] = one.time[k], rate[k * n + i] = one.rate[k];
        rotates[i] = (uint8_t)one.rotates;
    }
    *calls += s.calls;
    rod_panels_free(&s.room);
    return failed;
}

int rod_excess(search *s, int64_t pin, double sign, const int64_t *counts, double y, double *off)
{
    transit one;
    const int failed = rod_transit_at(s, pin, sign, y, 1, &one);
    *off = (double)counts[0] * one.time[0] + (double)counts[1] * one.time[1] + (double)counts[2] * one.time[2];
    if (one.rotates && counts[1] + counts[2] > 0)
        *off = NAN;
    *off -= s->of->span;
    return failed;
}

static int sign_of(double x) { return (x > 0) - (x < 0); }

/* The root of the excess between two levels, by Chandrupatla's rule; NaN where the two have one sign. */
static int root_between(search *s, int64_t pin, double sign, const int64_t *counts, double low, double high,
                        double *root)
{
    double x1 = low, x2 = high, f1, f2, x3 = 0, f3 = 0, t = 0.5;
    int failed = rod_excess(s, pin, sign, counts, x1, &f1);
    failed = failed ? failed : rod_excess(s, pin, sign, counts, x2, &f2);
    if (failed)
        return failed;
    const double ends[2] = {f1, f2};
    *root = NAN;
    for (int round = 0; round <= 60 && !failed; round++) {
        const double best = fabs(f1) < fabs(f2) ? x1 : x2, least = fabs(f1) < fabs(f2) ? f1 : f2;
        const double tol = fabs(best) * 1e-15 + 1e-14, width = fabs(x2 - x1);
        if (fabs(least) <= DBL_MIN || (sign_of(f1) != sign_of(f2) && width < tol)) {
            *root = best;
            break;
        }
        if (sign_of(f1) == sign_of(f2) || f1 != f1 || f2 != f2)
            break;
        if (round > 0) {
            const double xi = (x1 - x2) / (x3 - x2), fraction = (f1 - f2) / (f3 - f2), alpha = (x3 - x1) / (x2 - x1);
            t = 0.5;
            if (1 - sqrt(1 - xi) < fraction && fraction < sqrt(xi))
                t = f1 / (f1 - f2) * f3 / (f3 - f2) - alpha * f1 / (f3 - f1) * f2 / (f2 - f3);
            t = smaller(larger(t, 0.5 * tol / width), 1 - 0.5 * tol / width);
        }
        const double x = x1 + t * (x2 - x1);
        double f;
        failed = rod_excess(s, pin, sign, counts, x, &f);
        x3 = x2, f3 = f2;
        if (sign_of(f) == sign_of(f1))
            x3 = x1, f3 = f1;
        else
            x2 = x1, f2 = f1;
        x1 = x, f1 = f;
    }
    if (*root != *root) { /* within rounding of one end of its bracket */
        const double first = fabs(ends[0]), second = fabs(ends[1]);
        if (fmin(first, second) < 1e-9 * s->of->span)
            *root = !(second < first) && first == first ? low : high;
    }
    return failed;
}

/* The root of the excess of n paths, each between two levels of one pin and sign.

   counts: (n, 3). low, high: (n,), low < high. roots: (n,), filled; NaN where none was found. */
int rod_level_roots(const boundary *of, int64_t count, const double *beta, const int64_t *centre, const points *at,
                    const cutting *how, int64_t n, const int64_t *pin, const double *sign, const int64_t *counts,
                    const double *low, const double *high, double *roots, int64_t *calls)
{
    search s;
    int failed = rod_search(&s, of, count, beta, centre, at, how);
    if (failed)
        return failed;
    for (int64_t i = 0; i < n && !failed; i++) {
        if (pin[i] < 0 || pin[i] >= of->pins)
            failed = NOT_POSSIBLE;
        else
            failed = root_between(&s, pin[i], sign[i], counts + 3 * i, low[i], high[i], &roots[i]);
    }
    *calls += s.calls;
    rod_panels_free(&s.room);
    return failed;
}
