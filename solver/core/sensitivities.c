/* The derivatives of start problems by fields of their cases, in one pass over each orbit: solver/observe. */

#include "measure_rates.h"

enum { MARKS = 4 };

/* What is asked of B start problems. along: their shapes, whose `out` is filled. marks: (B, 5, F, MARKS), filled with the
   same in units of rho at the shares 0, 1/3, 2/3 and 1 of the length. of, varied: the orbit of the only problem and its
   variations, where they are known, with the parts (F, PARTS) of its changes; NULL where the orbits are made here.
   sign, error: (B,), as of `rods`. wanted: bits of rates; groups: of numbers along the whole rod, and partly: of those over
   its first and second third. lifts, peak: (B,), what is observed; NULL for what is measured. Filled: kind (B,), of the
   orbits, LOST where there is none; half_period (B, F); found (3, B), numbers along the rod, over its first third, and over
   two; rates (B, F, RATES). Of helices and where there is no orbit the kind alone is filled,
   and the derivatives of the shape are NaN; LOST is also an orbit of which one of these is not finite. Where nothing is measured marks, half_period, found and rates
   are NULL. */
typedef struct {
    shapes along;
    double *marks;
    const read_orbits *of;
    const varied_orbits *varied;
    const double *parts;
    const start_problem *problems;
    const double *sign, *error, *lifts, *peak;
    int64_t wanted, groups, partly;
    double goal, rates_goal;
    int64_t *kind;
    double *half_period, *rates;
    numbers *found;
} sensitivities;

/* What a thread needs; of, varied: of the rod in hand. */
typedef struct {
    const sensitivities *all;
    const grid *by;
    const points *at;
    const cutting *how;
    workspace *w;
    rods rod;
    const read_orbits *of;
    const varied_orbits *varied;
    lone_orbit orbit;
    double *parts, *room, *thirds, *pieces, weights[NODES];
    int64_t piece_room;
    varied_place start;
} worker;

static void change_marks(worker *o, int64_t b)
{
    const shapes *along = &o->all->along;
    const int n = (int)o->of->coefficients;
    double t[MARKS], beta[MARKS], rate[MARKS];
    static const double z[MARKS] = {0};
    for (int k = 0; k < MARKS; k++) {
        varied_place place;
        phase where;
        double x;
        t[k] = along->span[b] * (k / (double)(MARKS - 1));
        const int64_t panel = rod_place(o->of, 0, t[k], &where, &x);
        rod_varied_place_at(o->of, o->varied, 0, t[k], &place);
        beta[k] = o->of->base[panel] + at_place(o->of->series + FUNCTIONS * n * panel, n, x), rate[k] = place.v;
    }
    const shapes marks = {.size = 1, .stations = MARKS, .F = along->F, .t = t, .beta = beta, .rate = rate, .z = z,
                          .loads = along->loads + 3 * b, .span = along->span + b, .later = along->later + along->F * b,
                          .out = o->all->marks + 5 * MARKS * along->F * b};
    rod_change_orbit(o->of, o->varied, 0, &marks, 0, o->parts);
}

/* The pieces of the first share of the rod. Returns DONE or NO_MEMORY. */
static int cover_rod(worker *o, int64_t b, double share)
{
    const read_orbits *of = o->of;
    const int64_t P = of->panels, n = of->coefficients, kept = 2 * n * (P + 1);
    const start_problem *p = &o->all->problems[b];
    const double span = share * p->span;
    if (rod_roomy((void **)&o->pieces, &o->piece_room, kept + 7 * 3 * P + 7 + 2, sizeof(double)))
        return NO_MEMORY;
    double *series = o->pieces, *at = series + kept;
    const int64_t m = 3 * P + 1;
    int64_t *row = (int64_t *)at, *rod = row + m, *first = (int64_t *)(at + 7 * m);
    const covered out = {rod, row, at + 2 * m, at + 3 * m, at + 4 * m, at + 5 * m, at + 6 * m};
    for (int64_t i = 0; i < P; i++) {
        memcpy(series + 2 * n * i, of->series + FUNCTIONS * n * i, sizeof(double) * (size_t)(2 * n));
        series[2 * n * i] += o->of->base[i];
    }
    first[0] = 0, first[1] = rod_cover(of, 1, &span, &out);
    if (!first[1]) { /* nothing moves */
        memset(series + 2 * n * P, 0, sizeof(double) * (size_t)(2 * n));
        series[2 * n * P] = p->beta0;
        row[0] = P, out.low[0] = -1, out.high[0] = 1, out.time[0] = span, out.count[0] = 1, out.begin[0] = 0;
        first[1] = 1;
    }
    o->rod = (rods){n, 2, 1, o->rod.groups, o->rod.goal, series, first, row, out.low, out.high, out.time, out.count,
                    out.begin, &p->lam, &p->mu, &p->phi, &p->span, &p->beta0, o->all->sign + b, o->all->error + b};
    return DONE;
}

/* Numbers and rates along the whole rod, then over its first third and over two, whose difference the middle third is. */
static int measure_rod(worker *o, int64_t b)
{
    const sensitivities *all = o->all;
    const int64_t F = all->along.F, B = all->along.size, middle = all->wanted >> MIDDLE_PUSH & 1;
    double *whole = all->rates + RATES * F * b, *less = o->thirds, *more = less + RATES * F;
    double *rates[3] = {whole, less, more};
    for (int third = 0; third < 3; third++) {
        numbers *found = all->found + B * third + b;
        const int64_t wanted = third ? middle << PUSHED : all->wanted & ~((int64_t)1 << MIDDLE_PUSH);
        const double share = third ? third / 3.0 : 1;
        o->rod.groups = third ? all->partly : all->groups, o->rod.goal = all->goal;
        if (!wanted && !o->rod.groups)
            continue;
        if (cover_rod(o, b, share) || rod_measured_numbers(o->w, 0, found))
            return NO_MEMORY;
        const changes by = {F, wanted, o->parts, all->along.later + F * b, share,
                            all->lifts ? all->lifts[b] : found->value[FIRST_LIFT],
                            all->peak ? all->peak[b] : found->value[PEAK]};
        o->rod.goal = all->rates_goal;
        if (wanted && rod_rates(o->w, o->of, o->at, o->varied, &by, 0, o->room, rates[third]))
            return NO_MEMORY;
    }
    for (int64_t f = 0; f < F && middle; f++)
        whole[RATES * f + MIDDLE_PUSH] = more[RATES * f + PUSHED] - less[RATES * f + PUSHED];
    return DONE;
}

/* The orbit of rod b and its variations; its kind is LOST where a number is not finite, or critical points could not be told
   apart. Returns DONE or NO_MEMORY. */
static int vary_rod(worker *o, int64_t b)
{
    const start_problem *p = &o->all->problems[b];
    const int failed = rod_lone_orbit(p, NULL, NULL, o->by, o->at, o->how, &o->orbit);
    o->all->kind[b] = failed && o->orbit.kind != HELIX ? LOST : o->orbit.kind;
    if (failed)
        return failed == NO_MEMORY ? failed : DONE;
    if (!o->all->marks)
        o->orbit.varied.M = NULL; /* it is not read */
    rod_vary(&p->lam, &o->orbit.of, 0, o->at, o->weights, NULL, o->orbit.nodes, &o->orbit.varied);
    o->of = &o->orbit.of, o->varied = &o->orbit.varied;
    return DONE;
}

/* The parts of the changes of an orbit by those of its start. */
static void part_start(worker *o, int64_t b)
{
    static const int given[PARTS] = {BY_BETA0, BY_END, BY_LAM, BY_MU, BY_PHI};
    const shapes *along = &o->all->along;
    double by_start[PARTS][PARTS];
    rod_varied_directions(&o->start, by_start);
    for (int64_t f = 0; f < along->F; f++)
        for (int part = 0; part < PARTS; part++) {
            double *out = &o->parts[PARTS * f + part];
            *out = 0;
            for (int k = 0; k < PARTS; k++)
                *out += by_start[part][k] * along->by[along->F * (along->size * given[k] + b) + f];
        }
}

/* No number is a derivative of shape b. */
static void leave_out(const shapes *of, int64_t b)
{
    const int64_t own = of->F * of->stations;
    for (int64_t k = 0; k < 5; k++)
        for (int64_t i = 0; i < own; i++)
            of->out[(of->size * k + b) * own + i] = NAN;
}

INLINE void check_shape(int width, const shapes *of, int64_t b, int *finite)
{
    (void)width;
    const int64_t own = of->F * of->stations;
    *finite = 1;
    for (int64_t k = 0; k < 5; k++)
        *finite &= largest_size((int)own, of->out + (of->size * k + b) * own) < INFINITY;
}
IN_WIDTHS(check_shape, (const shapes *of, int64_t b, int *finite), (WIDTH, of, b, finite))

static int derive_rod(worker *o, int64_t b)
{
    const sensitivities *all = o->all;
    const int64_t F = all->along.F;
    if (all->of)
        o->of = all->of, o->varied = all->varied, all->kind[b] = all->of->kind[0];
    const int failed = all->of ? DONE : vary_rod(o, b);
    if (failed || all->kind[b] == LOST || all->kind[b] == HELIX) {
        leave_out(&all->along, b);
        return failed;
    }
    rod_varied_place_at(o->of, o->varied, 0, 0, &o->start);
    if (all->parts)
        memcpy(o->parts, all->parts, sizeof(double) * (size_t)(PARTS * F));
    else
        part_start(o, b);
    rod_change_orbit(o->of, o->varied, 0, &all->along, b, o->parts);
    int finite; /* asked here, where the numbers are still at hand */
    FOR_LANES(o->how->lanes, check_shape)(&all->along, b, &finite);
    if (!finite)
        all->kind[b] = LOST;
    if (!finite || !all->marks)
        return DONE;
    for (int64_t f = 0; f < F; f++) {
        double *later = &all->half_period[b * F + f];
        *later = 0;
        for (int k = 0; k < 4; k++)
            *later -= (o->varied->gain[k] + o->varied->gain[PAIRS + k]) * o->parts[PARTS * f + 1 + k];
    }
    change_marks(o, b);
    return all->wanted || all->groups || all->partly ? measure_rod(o, b) : DONE;
}

/* The derivatives of start problems from `begin` to `end`. Returns DONE or NO_MEMORY, or NOT_POSSIBLE for other points. */
int rod_sensitivities(const sensitivities *all, const grid *by, const points *at, const cutting *how, int64_t begin,
                      int64_t end)
{
    if (at->n > NODES || at->n < 4)
        return NOT_POSSIBLE;
    const int64_t F = all->along.F;
    worker *o = calloc(1, sizeof(worker));
    int failed = o ? DONE : NO_MEMORY;
    if (o) {
        rod_panel_weights(at, o->weights);
        o->all = all, o->by = by, o->at = at, o->how = how, o->rod.coefficients = at->n + 1;
        o->parts = malloc(sizeof(double) * (size_t)((PARTS + 3 * CANDIDATES + 2 * RATES) * F));
        o->w = rod_workspace(&o->rod, how->lanes);
        o->room = o->parts + PARTS * F, o->thirds = o->room + 3 * CANDIDATES * F;
        failed = o->parts && o->w ? DONE : NO_MEMORY;
    }
    for (int64_t b = begin; b < end && !failed; b++)
        failed = derive_rod(o, b);
    if (o)
        rod_lone_orbit_free(&o->orbit), rod_workspace_free(o->w), free(o->parts), free(o->pieces);
    free(o);
    return failed;
}
