/* The numbers of one equilibrium and the linear equations between their changes: solver/equilibrium/orbit_rates.py. */

#include "orbit_rates.h"

enum { SHARES = 13 }; /* the ten elements of M, and alpha, z and the swirl */
#define SAME 1e-9     /* rad: critical points that are this near are one */

/* One orbit on its panels, in the order of travel: those of the forward arc, then those of the backward one. */
typedef struct {
    const ends_problem *p;
    const points *at;
    int64_t count[2], P, kind;
    double direction, duration[2], gain[2 * SHARES];
    varied_nodes *nodes;
    double *x, *since, *width, *shares; /* (P, n), (P,), (P,), (P, SHARES): integrals up to the near end of each */
    double *base;
} course;

static void free_course(course *o)
{
    free(o->nodes);
    free(o->x);
}

/* The panels of the arcs, with what does not depend on the other panels. */
static int course_of(const ends_problem *p, const arcs *from, const panels *cut, const points *at, course *o)
{
    const int n = (int)at->n;
    int64_t P = 0;
    for (int64_t i = cut->first; i >= 0; i = cut->rows[i].next)
        P++;
    *o = (course){.p = p, .at = at, .P = P, .kind = from->kind, .direction = from->direction};
    o->nodes = malloc(sizeof(varied_nodes) * (size_t)P);
    o->x = malloc(sizeof(double) * (size_t)(P * (n + 3 + SHARES)));
    if (!o->nodes || !o->x)
        return NO_MEMORY;
    o->since = o->x + P * n, o->width = o->since + P, o->base = o->width + P, o->shares = o->base + P;
    int64_t k = 0;
    for (int64_t i = cut->first; i >= 0; i = cut->rows[i].next, k++) {
        const piece *own = &from->pieces[cut->rows[i].piece];
        const double *series = cut->series + FUNCTIONS * (n + 1) * i;
        double v[NODES];
        o->since[k] = o->duration[own->arc], o->width[k] = cut->rows[i].duration, o->base[k] = own->base;
        o->duration[own->arc] += o->width[k];
        o->count[own->arc]++;
        product(n + 1, n, series, at->values, o->x + n * k);
        product(n + 1, n, series + n + 1, at->values, v);
        rod_varied_state(&p->lam, own->local.o, o->width[k] / 2, n, o->x + n * k, v, &o->nodes[k]);
    }
    return o->count[0] ? DONE : NOT_POSSIBLE;
}

/* sin, cos and their product at the nodes of a panel. */
static void directions_on(const course *o, int64_t k, double out[3][NODES])
{
    const int n = (int)o->at->n;
    for (int i = 0; i < n; i++) {
        const double angle = o->base[k] + o->x[n * k + i];
        out[0][i] = sin(angle), out[1][i] = cos(angle), out[2][i] = out[0][i] * out[1][i];
    }
}

/* The weights of the integral over a panel. */
static void weights_of(const points *at, double *out)
{
    double row[NODES + 1];
    const int n = (int)at->n;
    for (int i = 0; i < n; i++) {
        integral(n, at->analyse + n * i, row);
        out[i] = 0;
        for (int k = 0; k <= n; k++)
            out[i] += row[k];
    }
}

/* The variations of all panels; returns the number of the panel whose critical point the orbit comes closest to. */
static int64_t vary(course *o, int with_rates)
{
    const int n = (int)o->at->n;
    int64_t nearest = 0;
    double weight[NODES];
    weights_of(o->at, weight);
    for (int64_t k = 1; k < o->P; k++)
        if (o->nodes[k].least < o->nodes[nearest].least)
            nearest = k;
    for (int64_t k = 0; k < o->P; k++) {
        const int arc = k >= o->count[0];
        double jump[SHARES] = {0}, turned[3][NODES], *share = o->shares + SHARES * k, *gain = o->gain + SHARES * arc;
        if (with_rates) {
            rod_varied_rates(&o->p->lam, o->nodes[nearest].origin, n, o->x + n * k, &o->nodes[k]);
            rod_varied_entry(o->nodes, o->count, k, o->direction, jump);
        }
        directions_on(o, k, turned);
        for (int m = with_rates ? 0 : PAIRS; m < SHARES; m++) {
            const double *values = m < PAIRS ? o->nodes[k].M[m] : turned[m - PAIRS];
            double total = 0;
            for (int i = 0; i < n; i++)
                total += values[i] * weight[i];
            share[m] = gain[m] + jump[m];
            gain[m] = share[m] + total * (o->width[k] / 2);
        }
    }
    for (int arc = 0; arc < 2 && with_rates; arc++) {
        double closing[PAIRS];
        rod_varied_closing(o->nodes, o->count, arc, o->kind, o->direction, closing);
        for (int m = 0; m < PAIRS; m++)
            o->gain[SHARES * arc + m] += closing[m];
    }
    return nearest;
}

static double value_at(const points *at, const double *values, double x)
{
    double series[NODES];
    product((int)at->n, (int)at->n, values, at->analyse, series);
    return at_place(series, (int)at->n, x);
}

static double integral_at(const points *at, const double *values, double x)
{
    double series[NODES + 1];
    integrated(at, values, series);
    return at_place(series, (int)at->n + 1, x);
}

/* The state where the rod is at time t, the integrals of sin, cos and sin cos of beta up to there, and beta. */
static double state_at(const course *o, double t, int with_rates, varied_place *out, double *integrals)
{
    const int n = (int)o->at->n;
    const int64_t none = 0, first[2] = {0, o->count[0]};
    const read_orbits of = {n + 1, o->P, &o->kind, first, o->count, NULL, &o->direction, o->duration, NULL, o->since,
                            o->width, NULL};
    phase where;
    double x, turned[3][NODES];
    const int64_t k = rod_place(&of, none, t, &where, &x);
    const varied_nodes *one = &o->nodes[k];
    const double half = o->width[k] / 2, sign = o->direction * (where.second ? -1 : 1) * (where.mirrored ? -1 : 1);
    const int librates = o->kind == LIBRATION;
    out->v = sign * value_at(o->at, one->v, x), out->H = value_at(o->at, one->H, x), out->c = one->c;
    out->shift[0] = 0, out->gamma[0] = 1;
    directions_on(o, k, turned);
    for (int m = with_rates ? 0 : PAIRS; m < SHARES; m++) {
        const double *values = m < PAIRS ? one->M[m] : turned[m - PAIRS], *gain = o->gain + m;
        const double own = o->shares[SHARES * k + m] + half * integral_at(o->at, values, x);
        *(m < PAIRS ? &out->M[m] : &integrals[m - PAIRS]) = rod_unfolded(own, &where, gain[0], gain[SHARES], librates);
    }
    for (int q = 0; q < 3 && with_rates; q++)
        out->shift[q + 1] = one->shift[q], out->gamma[q + 1] = value_at(o->at, one->gamma[q], x);
    return o->base[k] + value_at(o->at, o->x + n * k, x) + (librates ? 0 : TAU * o->direction * where.periods);
}

/* What changes of the loads and of the level add to y. */
static void add_level(const place *o, const path *level, double nearest, double *values, double *rows, double *by_span)
{
    int is_critical = 0;
    for (int k = 0; k < o->found.count; k++)
        is_critical |= o->found.beta[k] == level->pin;
    values[Y] = level->y;
    if (is_critical) {
        const double gap = level->sign * exp(larger(level->y, DEEPEST));
        double above[3];
        rod_height_rates(fabs(sin((level->pin - nearest) / 2)) < SAME ? nearest : level->pin, nearest, above);
        rows[PARTS * Y] = 0, rows[PARTS * Y + 1] = 2 / gap, by_span[Y] = 0;
        for (int q = 0; q < 3; q++)
            rows[PARTS * Y + 2 + q] = 2 * above[q] / gap;
        return;
    }
    const int end = level->pin == o->start ? DBETA0 : DBETAL;
    for (int part = 0; part < PARTS; part++)
        rows[PARTS * Y + part] = 2 * rows[PARTS * end + part] / values[end];
    by_span[Y] = 2 * by_span[end] / values[end];
}

/* The numbers of the orbit, and if rows are wanted how they answer. level: NULL where y is not wanted; beta(L) is then
   that of the orbit. */
static void numbers_of(course *o, const place *at, const path *level, double length, double *values, double *rows,
                       double *by_span)
{
    const ends_problem *p = o->p;
    varied_place start = {0}, far = {0};
    double integrals[3], none[3];
    const int64_t nearest = vary(o, rows != NULL);
    state_at(o, 0, rows != NULL, &start, none);
    const double end = state_at(o, length, rows != NULL, &far, integrals), betaL = level ? p->betaL : end;
    const double found[NUMBERS] = {p->beta0, betaL, start.v, far.v, integrals[0], integrals[2],
                                   integrals[1], p->lam, p->mu, p->phi, level ? level->y : 0};
    memcpy(values, found, sizeof found);
    if (!rows)
        return;
    const double s = sin(betaL), c = cos(betaL);
    const double later[NUMBERS] = {0, far.v, 0, -far.H, s, s * c, c, 0, 0, 0, 0};
    static const int order[3] = {ALPHA, SWIRL, Z};
    memset(rows, 0, sizeof(double) * NUMBERS * PARTS);
    memcpy(by_span, later, sizeof later);
    for (int part = 0; part < PARTS; part++) {
        double unit[PARTS] = {0}, here[5], there[5];
        unit[part] = 1;
        rod_varied_change(&start, &start, unit, here);
        rod_varied_change(&start, &far, unit, there);
        rows[PARTS * BETA0 + part] = here[BETA], rows[PARTS * DBETA0 + part] = here[RATE];
        rows[PARTS * BETAL + part] = there[BETA], rows[PARTS * DBETAL + part] = there[RATE];
        for (int q = 0; q < 3; q++)
            rows[PARTS * order[q] + part] = (q == 1 ? -1 : 1) * there[LIFTS + q];
    }
    for (int q = 0; q < 3; q++)
        rows[PARTS * (LAM + q) + 2 + q] = 1;
    if (level)
        add_level(at, level, o->nodes[nearest].origin, values, rows, by_span);
}

/* The course of an orbit that is no helix; to be freed in any case. */
static int course_from(const start_problem *start, double pin, double gap, const critical *found, const ends_problem *p,
                       const points *at, const cutting *how, course *out)
{
    arcs from, cut;
    panels made = {0};
    int failed = rod_arcs(start, pin, gap, found, &from);
    if (failed || from.kind == HELIX || !from.count)
        return failed ? failed : NOT_POSSIBLE;
    cut = from;
    for (int i = 0; i < cut.count; i++)
        cut.pieces[i].base = 0;
    failed = rod_panelled(start, cut.pieces, cut.count, at, how, &made);
    failed = failed ? failed : course_of(p, &from, &made, at, out);
    rod_panels_free(&made);
    return failed;
}

/* The length at which the path meets beta(L). */
static int length_of(const place *o, const path *level, const points *at, const cutting *how, double *length)
{
    search room = {.at = at, .how = *how};
    double off;
    room.how.times_only = 1;
    const int failed = rod_excess_of(&room, o, 1, level, &off);
    rod_panels_free(&room.room);
    *length = off + o->p.span;
    return failed ? failed : isfinite(*length) ? DONE : NO_ORBIT;
}

int rod_orbit_numbers(const place *o, const path *level, const points *at, const cutting *times, const cutting *how,
                      int rates, orbit_numbers *out)
{
    const ends_problem *p = &o->p;
    course on = {0};
    if (at->n > NODES || at->n < 4 || !(level->y >= DEEPEST) || !isfinite(level->pin) || level->turns < 0 ||
        level->turns > 1000000000)
        return NOT_POSSIBLE;
    int failed = length_of(o, level, at, times, &out->length);
    if (failed)
        return failed;
    const double gap = level->sign * exp(level->y), v2 = gap + rod_place_fall(o, level->pin, o->start);
    const double speed = (double)level->leaving * sqrt(larger(v2, 0));
    const start_problem start = {p->lam, p->mu, p->phi, out->length, o->start, speed};
    failed = course_from(&start, level->pin, gap, &o->found, p, at, how, &on);
    if (!failed)
        numbers_of(&on, o, level, out->length, out->values, rates ? out->rows : NULL, out->by_span);
    free_course(&on);
    return failed;
}

/* Those of the orbit of a start problem at its far end, which has the rows of a rod at rest at both ends too; y has
   none. Returns DONE, NO_MEMORY or NOT_POSSIBLE. */
int rod_start_rates(const start_problem *of, const grid *by, const points *at, const cutting *how, int rates,
                    orbit_numbers *out)
{
    const ends_problem p = {of->lam, of->mu, of->phi, of->span, of->beta0, of->beta0};
    critical found;
    course on = {0};
    const double *numbers = &of->lam;
    for (int k = 0; k < 6; k++)
        if (!isfinite(numbers[k]))
            return NOT_POSSIBLE;
    if (at->n > NODES || at->n < 4)
        return NOT_POSSIBLE;
    int failed = rod_critical(p.lam, p.mu, p.phi, by->m, by->angles, by->table, &found);
    failed = failed ? failed : course_from(of, wrapped(of->beta0), square(of->dbeta0), &found, &p, at, how, &on);
    if (!failed)
        numbers_of(&on, NULL, NULL, of->span, out->values, rates ? out->rows : NULL, out->by_span);
    out->length = of->span;
    free_course(&on);
    return failed;
}

/* The same from the numbers of the problem. Returns DONE, NO_MEMORY, NO_ORBIT or NOT_POSSIBLE. */
int rod_orbit_rates(const ends_problem *of, const path *level, const grid *by, const points *at, const cutting *times,
                    const cutting *how, int rates, orbit_numbers *out)
{
    place o;
    const int failed = rod_place_of(of, by, &o);
    return failed ? failed : rod_orbit_numbers(&o, level, at, times, how, rates, out);
}
