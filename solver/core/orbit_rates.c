/* The numbers of one equilibrium and the linear equations between their changes: solver/branches/orbit_rates.py. */

#include "orbit_rates.h"

#define SAME 1e-9 /* rad: critical points that are this near are one */

/* Adds a share of the derivative of log|H'| at a saddle by each load: the time at the saddle goes with |H'|^(-1/2). */
static void add_steepness(const ends_problem *p, double saddle, double share, double *rates)
{
    const double s = sin(saddle), c = cos(saddle), steep = slope_rate_by(p->lam, p->mu, p->phi, s, c);
    const double by_load[3] = {-s, 4 * s * c, -c}, H_q[3] = {c, -(c - s) * (c + s), -s};
    double third;
    const double bend = higher_rates_by(p->lam, p->mu, p->phi, s, c, &third);
    for (int q = 0; q < 3; q++)
        rates[q] += share * (by_load[q] - bend * H_q[q] / steep) / steep;
}

/* What changes of the loads and of the level add to y. */
static void add_level(const place *o, const path *level, double nearest, double *values, double *rows, double *by_span)
{
    int is_critical = 0;
    for (int k = 0; k < o->found.count; k++)
        is_critical |= o->found.beta[k] == level->pin;
    values[Y] = level->y;
    if (is_critical) {
        const double gap = level->sign * exp(larger(level->y, rod_tuning.lowest));
        double above[3];
        rod_height_rates(fabs(sin((level->pin - nearest) / 2)) < SAME ? nearest : level->pin, nearest, above);
        rows[PARTS * Y] = 0, rows[PARTS * Y + 1] = 2 / gap, by_span[Y] = 0;
        for (int q = 0; q < 3; q++)
            rows[PARTS * Y + 2 + q] = 2 * above[q] / gap;
        if (level->y < rod_tuning.lowest)
            add_steepness(&o->p, level->pin, (level->y - rod_tuning.lowest) / 2, rows + PARTS * Y + 2);
        return;
    }
    const int end = level->pin == o->start ? DBETA0 : DBETAL;
    for (int part = 0; part < PARTS; part++)
        rows[PARTS * Y + part] = 2 * rows[PARTS * end + part] / values[end];
    by_span[Y] = 2 * by_span[end] / values[end];
}

/* The numbers of the orbit, and how they answer. level: NULL where y is not wanted; beta(L) is then that of the orbit. */
static void numbers_of(lone_orbit *o, const ends_problem *p, const points *by, const place *at, const path *level,
                       double length, orbit_numbers *out)
{
    double x, weights[NODES], *values = out->values, *rows = out->rows, *by_span = out->by_span;
    varied_place start, far;
    phase where;
    const int64_t first = rod_place(&o->of, 0, 0, &where, &x), last = rod_place(&o->of, 0, length, &where, &x);
    const int64_t only[2] = {first, last}, n = by->n;
    o->varied.M = NULL; /* it is not read */
    rod_panel_weights(by, weights);
    const int64_t nearest = rod_vary(&p->lam, &o->of, 0, by, weights, only, o->nodes, &o->varied);
    rod_varied_place_at(&o->of, &o->varied, 0, 0, &start), rod_varied_place_at(&o->of, &o->varied, 0, length, &far);
    const double turns = o->kind == LIBRATION ? 0 : o->direction * where.periods;
    const double end = o->of.base[last] + at_place(o->of.series + FUNCTIONS * (n + 1) * last, (int)n + 1, x) + TAU * turns;
    const double betaL = level ? p->betaL : end;
    double sums[3];
    for (int k = 0; k < 3; k++) {
        const double inside = at_place(o->of.series + (FUNCTIONS * last + 2 + k) * (n + 1), (int)n + 1, x);
        sums[k] = rod_unfolded(inside, &where, o->integrals[k], o->integrals[3 + k], o->kind == LIBRATION);
    }
    const double found[NUMBERS] = {p->beta0, betaL, start.v, far.v, sums[0], sums[2], sums[1], p->lam, p->mu, p->phi,
                                   level ? level->y : 0};
    memcpy(values, found, sizeof found);
    const double s = sin(betaL), c = cos(betaL);
    const double later[NUMBERS] = {0, far.v, 0, -far.H, s, s * c, c, 0, 0, 0, 0};
    static const int order[3] = {ALPHA, SWIRL, Z};
    varied_unit here, there;
    rod_varied_unit(&start, &start, &here), rod_varied_unit(&start, &far, &there);
    memset(rows, 0, sizeof(double) * NUMBERS * PARTS);
    memcpy(by_span, later, sizeof later);
    for (int part = 0; part < PARTS; part++) {
        rows[PARTS * BETA0 + part] = here.by[BETA][part], rows[PARTS * DBETA0 + part] = here.by[RATE][part];
        rows[PARTS * BETAL + part] = there.by[BETA][part], rows[PARTS * DBETAL + part] = there.by[RATE][part];
        for (int q = 0; q < 3; q++)
            rows[PARTS * order[q] + part] = (q == 1 ? -1 : 1) * there.by[LIFTS + q][part];
    }
    for (int q = 0; q < 3; q++)
        rows[PARTS * (LAM + q) + 2 + q] = 1;
    if (level)
        add_level(at, level, o->of.origin[nearest], values, rows, by_span);
}

/* The length at which the path meets beta(L). */
static int length_of(const place *o, const path *level, const points *at, const cutting *how, double *length)
{
    search room = {.at = at, .how = *how};
    double off;
    room.how.series = 0;
    const int failed = rod_excess_of(&room, o, 1, level, &off);
    rod_panels_free(&room.room);
    *length = off + o->p.span;
    return failed ? failed : isfinite(*length) ? DONE : NO_ORBIT;
}

int rod_orbit_numbers(const place *o, const path *of, const points *at, const cutting *times, const cutting *how,
                      orbit_numbers *out)
{
    const ends_problem *p = &o->p;
    lone_orbit on = {0};
    if (at->n > NODES || at->n < 4 || !isfinite(of->y) || !isfinite(of->pin) || of->turns < 0 || of->turns > 1000000000)
        return NOT_POSSIBLE;
    const path own = rod_own_path(o, of), *level = &own;
    int failed = length_of(o, level, at, times, &out->length);
    if (failed)
        return failed;
    const double y = larger(level->y, rod_tuning.lowest), gap = level->sign * exp(y), v2 = gap + rod_place_fall(o, level->pin, o->start);
    const double speed = (double)level->leaving * sqrt(larger(v2, 0));
    const start_problem start = {p->lam, p->mu, p->phi, out->length, o->start, speed};
    failed = rod_lone_orbit(&start, (double[]){level->pin, gap, y - level->y}, &o->found, NULL, at, how, &on);
    if (!failed)
        numbers_of(&on, p, at, o, level, out->length, out);
    rod_lone_orbit_free(&on);
    return failed;
}

/* Those of the orbit of a start problem at its far end, which has the rows of a rod at rest at both ends too; y has
   none. pinned: its level, as of `rod_cut_orbit`, or NULL. Returns DONE, NO_MEMORY or NOT_POSSIBLE. */
int rod_start_rates(const start_problem *of, const double *pinned, const grid *by, const points *at, const cutting *how,
                    orbit_numbers *out)
{
    const ends_problem p = {of->lam, of->mu, of->phi, of->span, of->beta0, of->beta0};
    lone_orbit on = {0};
    const int failed = rod_lone_orbit(of, pinned, NULL, by, at, how, &on);
    if (!failed)
        numbers_of(&on, &p, at, NULL, NULL, of->span, out);
    out->length = of->span;
    rod_lone_orbit_free(&on);
    return failed;
}

/* The same from the numbers of the problem. Returns DONE, NO_MEMORY, NO_ORBIT or NOT_POSSIBLE. */
int rod_orbit_rates(const ends_problem *of, const path *level, const grid *by, const points *at, const cutting *times,
                    const cutting *how, orbit_numbers *out)
{
    place o;
    const int failed = rod_place_of(of, by, &o);
    return failed ? failed : rod_orbit_numbers(&o, level, at, times, how, out);
}
