/* The growth of changes along orbits: the condition number and estimated error of start problems, the response of
   equilibria to a change of the far angle, and the action. */

#include "variations.h"

/* One panel: its state, the integral a(t) of the shear, as a series and at the nodes, and what the panel adds to it. */
typedef struct {
    varied_nodes state;
    double a[NODES], shear[NODES + 1], gain;
} flow;

/* One orbit with its panels: `at` .. `at + count[0] + count[1]`. total: what each arc adds to the shear. */
typedef struct {
    const start_problem *problem;
    const read_orbits *all;
    const points *points;
    int64_t orbit, at, count[2], lanes;
    int n, librates;
    double ahead, back, period, direction, total[2];
    flow *flows;
} course;

static double load_size(const start_problem *p) { return fabs(p->lam) + fabs(p->mu) + fabs(p->phi); }

static course course_of(const start_problem *p, const read_orbits *all, const points *at, int64_t b, flow *room)
{
    course o = {.problem = p, .all = all, .points = at, .orbit = b, .n = (int)at->n, .flows = room};
    o.at = all->first[2 * b], o.count[0] = all->count[2 * b], o.count[1] = all->count[2 * b + 1];
    o.librates = all->kind[b] == LIBRATION;
    o.ahead = all->duration[2 * b], o.back = all->duration[2 * b + 1];
    o.period = (o.librates ? 2 : 1) * (o.ahead + o.back);
    o.direction = all->direction[b];
    return o;
}

static const double *series_of(const course *o, int64_t i, int function)
{
    return o->all->series + (FUNCTIONS * (o->at + i) + function) * o->all->coefficients;
}

/* The state of panel i, and the shear on it from its near end. */
static void flow_of(const course *o, int64_t i, flow *out)
{
    const int n = o->n;
    const double half = o->all->width[o->at + i] / 2;
    double pace[NODES];
    varied_nodes *s = &out->state;
    rod_vary_state(&o->problem->lam, o->all, o->at + i, o->points, 0, o->lanes, s);
    for (int k = 0; k < n; k++)
        pace[k] = shear_rate(s->v[k], s->H[k], s->rate[k], s->c) * half;
    integrated(o->points, pace, out->shear);
    out->gain = sum_of(n + 1, out->shear);
}

/* What the shear gains where the transversal changes from that of panel `last` to that of panel i. */
static double entered(const course *o, int64_t last, int64_t i)
{
    const varied_nodes *s = &o->flows[i].state;
    const double way = o->direction * (i >= o->count[0] ? -1 : 1);
    return shear_jump(way * s->v[0], s->H[0], o->flows[last].state.c, s->c);
}

/* The flows of all panels, each with the shear from the start of the orbit. */
static void flows_of(course *o)
{
    const int64_t P = o->count[0] + o->count[1];
    o->total[0] = o->total[1] = 0;
    for (int64_t i = 0; i < P; i++) {
        flow *one = &o->flows[i];
        double *before = &o->total[i >= o->count[0]];
        flow_of(o, i, one);
        /* the backward arc follows the forward one */
        const double more = i == 0 ? 0 : entered(o, i != o->count[0] ? i - 1 : 0, i);
        one->shear[0] += *before + more;
        *before += one->gain + more;
        plain_product(o->n + 1, o->n, one->shear, o->points->values, one->a);
    }
    for (int arc = 0; arc < 2 && !o->librates; arc++)
        if (o->count[arc]) {
            const int64_t start = arc ? o->count[0] : 0;
            o->total[arc] += entered(o, start + o->count[arc] - 1, start);
        }
}

/* A change of the orbit: its part along the flow, and across it, which stays. */
typedef struct {
    double along, across;
} change;

/* The change of beta where the shear is a, and the flow (v, -H) with the transversal (c H, v)/(v^2 + c H^2). */
static double change_at(change of, double a, double v, double H, double c)
{
    return (of.along + of.across * a) * v + of.across * (c * H / across_flow(v, H, c));
}

static double larger_at(const change of[2], double a, double v, double H, double c)
{
    return larger(fabs(change_at(of[0], a, v, H, c)), fabs(change_at(of[1], a, v, H, c)));
}

/* One passage of a panel by the rod: where the times of its nodes begin, their sign, and what is added to the shear. */
typedef struct {
    double begin, sign, shift, way;
} passage;

static int passages_of(const course *o, int backward, passage out[2])
{
    const double begin = backward ? 2 * o->ahead : 0, end = backward ? 2 * (o->ahead + o->back) : 2 * o->ahead;
    const double shift = backward ? 2 * o->total[0] : 0;
    out[0] = (passage){begin, 1, shift, 1};
    out[1] = (passage){end, -1, shift + 2 * o->total[backward], -1};
    return o->librates ? 2 : 1;
}

/* The larger of two changes at the nodes that the rod passes, in its first period and in its last: between them each
   grows evenly. At least `worst`. */
static double largest_at_nodes(const course *o, const change of[2], double worst)
{
    const double span = o->problem->span, periods = floor(span / o->period);
    const double a_period = o->librates ? 2 * (o->total[0] + o->total[1]) : o->total[0];
    for (int64_t i = 0; i < o->count[0] + o->count[1]; i++) {
        const flow *one = &o->flows[i];
        const int backward = i >= o->count[0];
        const varied_nodes *s = &one->state;
        const double since = o->all->since[o->at + i], half = o->all->width[o->at + i] / 2;
        const double way = o->direction * (backward ? -1 : 1);
        passage ways[2];
        const int count = passages_of(o, backward, ways);
        for (int w = 0; w < count; w++)
            for (int k = 0; k < o->n; k++) {
                const double time = ways[w].begin + ways[w].sign * (since + half * (1 + o->points->nodes[k]));
                if (!(time <= span || periods > 0))
                    continue;
                const double a = ways[w].shift + ways[w].way * one->a[k], v = way * ways[w].sign * s->v[k];
                const double many = periods > 0 ? periods - (time + periods * o->period > span) : 0;
                worst = larger(worst, larger_at(of, a, v, s->H[k], s->c));
                if (many > 0)
                    worst = larger(worst, larger_at(of, a + a_period * many, v, s->H[k], s->c));
            }
    }
    return worst;
}

/* Two changes at the far end. */
static void changes_at_end(const course *o, const change of[2], double out[2])
{
    phase where;
    double x, H[NODES];
    const int64_t panel = rod_place(o->all, o->orbit, o->problem->span, &where, &x);
    const flow *one = &o->flows[panel - o->at];
    plain_product(o->n, o->n, one->state.H, o->points->analyse, H);
    const double way = o->direction * (where.second ? -1 : 1) * (where.mirrored ? -1 : 1);
    const double v = way * at_place(series_of(o, panel - o->at, 1), o->n + 1, x);
    const double a = rod_unfolded(at_place(one->shear, o->n + 1, x), &where, o->total[0], o->total[1], o->librates);
    for (int k = 0; k < 2; k++)
        out[k] = change_at(of[k], a, v, at_place(H, o->n, x), one->state.c);
}

/* The errors of the panels of all orbits: `Panels`. */
typedef struct {
    const double *fastest, *error, *time_error, *time_rounding;
} panel_errors;

/* The changes of the start by a unit of beta(0), and of beta_t(0); with the flows. */
static void vary_start(course *o, change out[2])
{
    double parts[PARTS][PARTS];
    flows_of(o);
    const varied_nodes *first = &o->flows[0].state;
    const varied_place start = {.v = o->direction * (o->count[0] ? 1 : -1) * first->v[0], .H = first->H[0], .c = first->c};
    rod_varied_directions(&start, parts);
    for (int k = 0; k < 2; k++)
        out[k] = (change){parts[0][k], parts[1][k]};
}

static double condition_of(course *o)
{
    double worst, end[2];
    const start_problem *p = o->problem;
    const double weight = rod_weight_of(p);
    const int steady = rod_beside_helix(p, weight, &worst);
    change by[2];
    if (o->all->kind[o->orbit] == HELIX || !(o->count[0] + o->count[1]) || steady)
        return worst;
    vary_start(o, by);
    by[1].along *= weight, by[1].across *= weight;
    worst = largest_at_nodes(o, by, 1);
    changes_at_end(o, by, end);
    worst = larger(worst, larger(fabs(end[0]), fabs(end[1])));
    return worst == worst ? worst : INFINITY;
}

/* The change of the start's angle that has the same effect as the rounding of H over this time. */
static double start_rounding(const start_problem *p, double time)
{
    const double lam = p->lam, mu = p->mu, phi = p->phi, s = sin(p->beta0), c = cos(p->beta0);
    double third;
    const double second = higher_rates_by(lam, mu, phi, s, c, &third), added = EPS * slope_size_by(lam, mu, phi, s, c);
    const double first = fmin(added * time * time / 2, 2 * added / fabs(slope_rate_by(lam, mu, phi, s, c)));
    return fmin(first, fmin(2 * sqrt(2 * added / fabs(second)), 2 * cbrt(6 * added / fabs(third))));
}

/* How far the series at t = 0 are from the given start, as a change of its angle. */
static double mismatch(const course *o)
{
    const start_problem *p = o->problem;
    if (!o->count[0])
        return 0;
    const double beta = o->all->base[o->at] + at_place(series_of(o, 0, 0), o->n + 1, -1);
    const double speed = at_place(series_of(o, 0, 1), o->n + 1, -1);
    const double v = fabs(p->dbeta0), quickest = sqrt(1 + load_size(p)) + v;
    const double slip = larger(fabs(speed - v) - 16 * EPS * quickest, 0); /* beyond the rounding of a speed */
    return fabs(beta - p->beta0) + slip * smaller(p->span, 1 / rod_weight_of(p));
}

static double error_of(const course *o, const panel_errors *of, double growth)
{
    const start_problem *p = o->problem;
    double error = 0, fastest = 0, longest = 0, late = 0, range = 0;
    for (int64_t i = 0; i < o->count[0] + o->count[1]; i++) {
        const int64_t at = o->at + i;
        const double width = o->all->width[at];
        const double stay = p->span - o->all->since[at] - (i >= o->count[0] ? 2 * o->ahead : 0);
        if (!(stay > 0))
            continue;
        const double *beta = series_of(o, i, 0);
        double odd = 0;
        for (int k = 1; k <= o->n; k += 2)
            odd += beta[k];
        error = larger(error, of->error[at]), fastest = larger(fastest, of->fastest[at]);
        longest = larger(longest, width), range += 2 * fabs(odd);
        late += smaller(stay, width) * (of->time_error[at] + of->time_rounding[at]);
    }
    /* no faster than the steepest fall from the start allows */
    fastest = smaller(fastest, fabs(p->dbeta0) + (load_size(p) + 2) * p->span);
    const double period = o->all->kind[o->orbit] == HELIX ? INFINITY : o->period;
    late = late * (o->librates ? 2 : 1) * larger(1, p->span / period) + EPS * p->span;
    /* however late, beta stays between its turning points; alpha and z are sums as long as the duration of a panel */
    const double shift = o->librates ? smaller(fastest * late, range) : fastest * late;
    const double sums = EPS * longest / larger(1, p->span);
    const double start = start_rounding(p, smaller(p->span, o->ahead + o->back));
    const double inputs = larger(1, fabs(p->beta0)) + start / EPS;
    return 2 * error + shift + sums + growth * (mismatch(o) + 2 * EPS * inputs);
}

/* eta(L) of the change with eta(0) = 0 and eta_t(0) = 1, and the largest |eta(t)/eta(L)|. */
static void response_of(course *o, double *largest, double *end)
{
    const start_problem *p = o->problem;
    const double waves = sqrt(larger(slope_rate(p->lam, p->mu, p->phi, p->beta0), 0)) * p->span;
    change by[2];
    double ends[2];
    *end = NAN;
    if (o->all->kind[o->orbit] == HELIX) {
        *largest = waves > PI / 2 ? 1 / fabs(sin(waves)) : 1;
        return;
    }
    *largest = 1;
    if (!(o->count[0] + o->count[1]))
        return;
    vary_start(o, by);
    by[0] = by[1];
    changes_at_end(o, by, ends);
    const double ratio = largest_at_nodes(o, by, 0) / fabs(ends[1]);
    *largest = isfinite(ratio) ? larger(ratio, 1) : INFINITY, *end = ends[1];
}

/* The condition number and the estimated error of n start problems from their orbits, (n,) each; or, with `held`, the
   answers of those whose beta(0) is held to a change of their far angle: `orbits.response`. lanes: as of `cutting`. */
int rod_orbits_judge(int64_t n, const start_problem *problems, const read_orbits *all, const points *at,
                     const panel_errors *of, int64_t held, int64_t lanes, double *first, double *second)
{
    flow *room = malloc(sizeof(flow) * (size_t)rod_most_panels(all, n));
    if (!room)
        return NO_MEMORY;
    for (int64_t b = 0; b < n; b++) {
        course o = course_of(&problems[b], all, at, b, room);
        o.lanes = lanes;
        if (held)
            response_of(&o, &first[b], &second[b]);
        else
            first[b] = condition_of(&o), second[b] = error_of(&o, of, first[b]);
    }
    free(room);
    return DONE;
}

/* The integral of beta_t^2 over n rods, (n,): `orbits.action`. */
void rod_orbits_action(int64_t n, const start_problem *problems, const read_orbits *all, const points *at, double *out)
{
    for (int64_t b = 0; b < n; b++) {
        course o = course_of(&problems[b], all, at, b, NULL);
        double v[NODES], series[NODES + 1], before[2] = {0}, value = 0, x;
        phase where;
        out[b] = 0;
        if (all->kind[b] == HELIX || !(o.count[0] + o.count[1]))
            continue;
        const int64_t panel = rod_place(all, b, problems[b].span, &where, &x) - o.at;
        for (int64_t i = 0; i < o.count[0] + o.count[1]; i++) {
            plain_product(o.n + 1, o.n, series_of(&o, i, 1), at->values, v);
            for (int k = 0; k < o.n; k++)
                v[k] = v[k] * v[k] * (all->width[o.at + i] / 2);
            integrated(at, v, series);
            if (i == panel)
                value = before[i >= o.count[0]] + at_place(series, o.n + 1, x);
            before[i >= o.count[0]] += sum_of(o.n + 1, series);
        }
        out[b] = rod_unfolded(value, &where, before[0], before[1], o.librates);
    }
}
