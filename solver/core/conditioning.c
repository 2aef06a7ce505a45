/* The growth of changes along orbits: the condition number and estimated error of start problems, the response of
   equilibria to a change of the far angle, and the action. */

#include "orbit_parts.h"

/* The flow on one panel at its nodes: |beta_t|, H and the integral a(t) of the shear, in units of the problem.
   across: c; gain: what the panel adds to a, with what the change of c from the panel before it adds. */
typedef struct {
    double v[NODES], h[NODES], a[NODES], shear[NODES + 1];
    double across, gain;
} flow;

/* One orbit with its panels: `at` .. `at + count[0] + count[1]`. total: what each arc adds to the shear. */
typedef struct {
    const start_problem *problem;
    const read_orbits *all;
    const points *points;
    int64_t orbit, at, count[2];
    int n, librates;
    double ahead, back, period, direction, unit, speed, total[2];
    flow *flows;
} course;

static double sum(int n, const double *values)
{
    double total = 0;
    for (int k = 0; k < n; k++)
        total += values[k];
    return total;
}

static double load_size(const start_problem *p) { return fabs(p->lam) + fabs(p->mu) + fabs(p->phi); }

static course course_of(const start_problem *p, const read_orbits *all, const points *at, int64_t b, flow *room)
{
    course o = {.problem = p, .all = all, .points = at, .orbit = b, .n = (int)at->n, .flows = room};
    o.at = all->first[2 * b], o.count[0] = all->count[2 * b], o.count[1] = all->count[2 * b + 1];
    o.librates = all->kind[b] == LIBRATION;
    o.ahead = all->duration[2 * b], o.back = all->duration[2 * b + 1];
    o.period = (o.librates ? 2 : 1) * (o.ahead + o.back);
    o.direction = all->direction[b];
    o.unit = sqrt(load_size(p) + 1), o.speed = 1;
    return o;
}

static const double *series_of(const course *o, int64_t i, int function)
{
    return o->all->series + (FUNCTIONS * (o->at + i) + function) * o->all->coefficients;
}

/* beta and |beta_t| at the nodes of panel i. */
static void nodes_of(const course *o, int64_t i, double *beta, double *v)
{
    product(o->n + 1, o->n, series_of(o, i, 0), o->points->values, beta);
    for (int k = 0; k < o->n; k++)
        beta[k] += o->all->base[o->at + i];
    product(o->n + 1, o->n, series_of(o, i, 1), o->points->values, v);
}

/* H at the nodes as one moves away from the start: by its formula, or where that loses more, from the speed; but not
   from a speed that denies the formula by more than what the formula can lose, as on a panel as short as rounding. */
static void slope_along(const course *o, const double *sine, const double *cosine, const double *v, double half,
                        int backward, double *h)
{
    const start_problem *p = o->problem;
    const int n = o->n;
    const double unit = o->speed * o->unit, sign = o->direction * (backward ? -1 : 1);
    double most = v[0], size = 0, a[NODES], rate[NODES];
    for (int k = 0; k < n; k++) {
        most = larger(most, v[k]);
        size = larger(size, slope_size_by(p->lam, p->mu, p->phi, sine[k], cosine[k]));
        h[k] = sign * slope_by(p->lam, p->mu, p->phi, sine[k], cosine[k]) / unit;
    }
    const double loss = EPS * size / unit;
    if (loss < EPS * n * n * most / half)
        return;
    product(n, n, v, o->points->analyse, a);
    product(n, n, a, o->points->differentiate, rate);
    for (int k = 0; k < n; k++)
        if (fabs(h[k] + rate[k] / half) > n * n * loss)
            return;
    for (int k = 0; k < n; k++)
        h[k] = -rate[k] / half;
}

static void flow_of(const course *o, int64_t i, flow *out)
{
    const start_problem *p = o->problem;
    double beta[NODES], s[NODES], c[NODES], rate[NODES], pace[NODES];
    const int n = o->n;
    const double half = o->all->width[o->at + i] / 2 * o->unit;
    nodes_of(o, i, beta, out->v);
    for (int k = 0; k < n; k++)
        out->v[k] /= o->speed;
    sin_cos_of(n, beta, s, c);
    slope_along(o, s, c, out->v, half, i >= o->count[0], out->h);
    for (int k = 0; k < n; k++)
        rate[k] = slope_rate_by(p->lam, p->mu, p->phi, s[k], c[k]) / square(o->unit);
    out->across = rod_across(n, out->v, out->h, rate, half);
    for (int k = 0; k < n; k++)
        pace[k] = shear_rate(out->v[k], out->h[k], rate[k], out->across) * half;
    integrated(o->points, pace, out->shear);
    out->gain = sum(n + 1, out->shear);
}

/* The flows of all panels, each with the shear from the start of the orbit. */
static void flows_of(course *o)
{
    const int64_t P = o->count[0] + o->count[1];
    double before[2] = {0};
    for (int64_t i = 0; i < P; i++) {
        flow *one = &o->flows[i];
        const int backward = i >= o->count[0];
        flow_of(o, i, one);
        /* the backward arc follows the forward one */
        const int64_t last = i != o->count[0] ? i - 1 : 0;
        const double more = i == 0 ? 0 : shear_jump(one->v[0], one->h[0], o->flows[last].across, one->across);
        one->shear[0] += before[backward] + more;
        before[backward] += one->gain + more;
        product(o->n + 1, o->n, one->shear, o->points->values, one->a);
    }
    for (int arc = 0; arc < 2; arc++) {
        const int64_t start = arc ? o->count[0] : 0;
        const flow *one = &o->flows[start];
        o->total[arc] = before[arc];
        if (!o->librates && o->count[arc])
            o->total[arc] += shear_jump(one->v[0], one->h[0], o->flows[start + o->count[arc] - 1].across, one->across);
    }
}

/* A change of the orbit: its part along the flow, and across it, which stays. */
typedef struct {
    double along, across;
} change;

/* The change of beta where the shear is a, and the flow (v, -h) with the transversal (c h, v)/(v^2 + c h^2). */
static double change_at(change of, double a, double v, double h, double c)
{
    return (of.along + of.across * a) * v + of.across * (c * h / (v * v + c * h * h));
}

static double larger_at(const change of[2], double a, double v, double h, double c)
{
    return larger(fabs(change_at(of[0], a, v, h, c)), fabs(change_at(of[1], a, v, h, c)));
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
        const double since = o->all->since[o->at + i], half = o->all->width[o->at + i] / 2, way = backward ? -1 : 1;
        passage ways[2];
        const int count = passages_of(o, backward, ways);
        for (int w = 0; w < count; w++)
            for (int k = 0; k < o->n; k++) {
                const double time = ways[w].begin + ways[w].sign * (since + half * (1 + o->points->nodes[k]));
                if (!(time <= span || periods > 0))
                    continue;
                const double a = ways[w].shift + ways[w].way * one->a[k], v = way * ways[w].sign * one->v[k];
                const double many = periods > 0 ? periods - (time + periods * o->period > span) : 0;
                worst = larger(worst, larger_at(of, a, v, way * one->h[k], one->across));
                if (many > 0)
                    worst = larger(worst, larger_at(of, a + a_period * many, v, way * one->h[k], one->across));
            }
    }
    return worst;
}

/* Two changes at the far end. */
static void changes_at_end(const course *o, const change of[2], double out[2])
{
    phase where;
    double x, h[NODES];
    const int64_t panel = rod_place(o->all, o->orbit, o->problem->span, &where, &x);
    const flow *one = &o->flows[panel - o->at];
    product(o->n, o->n, one->h, o->points->analyse, h);
    double v = at_place(series_of(o, panel - o->at, 1), o->n + 1, x) / o->speed, a = at_place(one->shear, o->n + 1, x);
    a = rod_unfolded(a, &where, o->total[0], o->total[1], o->librates);
    const double way = where.second ? -1 : 1;
    for (int k = 0; k < 2; k++)
        out[k] = change_at(of[k], a, way * (where.mirrored ? -v : v), way * at_place(h, o->n, x), one->across);
}

/* The errors of the panels of all orbits: `Panels`. */
typedef struct {
    const double *fastest, *error, *time_error, *time_rounding;
} panel_errors;

/* The changes of the start by a unit of beta(0), and of beta_t(0) in the course's unit of time; with the flows. */
static void vary_start(course *o, const panel_errors *of, change out[2])
{
    double fastest = 0;
    for (int64_t i = o->at; i < o->at + o->count[0] + o->count[1]; i++)
        fastest = larger(fastest, of->fastest[i]);
    o->speed = fastest > 0 ? fastest : 1;
    flows_of(o);
    const flow *first = &o->flows[0];
    const double c = first->across, v = first->v[0], h = first->h[0] * (o->count[0] ? 1 : -1), size = v * v + c * h * h;
    out[0] = (change){v / size, h}, out[1] = (change){-c * h / size, v};
}

static double condition_of(course *o, const panel_errors *of)
{
    double worst, end[2];
    const start_problem *p = o->problem;
    const double weight = rod_weight_of(p);
    const int steady = rod_beside_helix(p, weight, &worst);
    change by[2];
    if (o->all->kind[o->orbit] == HELIX || !(o->count[0] + o->count[1]) || steady)
        return worst;
    vary_start(o, of, by);
    by[1].along *= weight / o->unit, by[1].across *= weight / o->unit;
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

/* The most panels of one of n orbits. */
static int64_t most_panels(const read_orbits *all, int64_t n)
{
    int64_t most = 1;
    for (int64_t b = 0; b < n; b++)
        most = all->count[2 * b] + all->count[2 * b + 1] > most ? all->count[2 * b] + all->count[2 * b + 1] : most;
    return most;
}

/* eta(L) of the change with eta(0) = 0 and eta_t(0) = 1, and the largest |eta(t)/eta(L)|. */
static void response_of(course *o, const panel_errors *of, double *largest, double *end)
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
    vary_start(o, of, by);
    by[0] = by[1];
    changes_at_end(o, by, ends);
    const double ratio = largest_at_nodes(o, by, 0) / fabs(ends[1]);
    *largest = isfinite(ratio) ? larger(ratio, 1) : INFINITY, *end = ends[1] / o->unit;
}

/* The condition number and the estimated error of n start problems from their orbits, (n,) each; or, with `held`, the
   answers of those whose beta(0) is held to a change of their far angle: `orbits.response`. */
int rod_orbits_judge(int64_t n, const start_problem *problems, const read_orbits *all, const points *at,
                     const panel_errors *of, int64_t held, double *first, double *second)
{
    flow *room = malloc(sizeof(flow) * (size_t)most_panels(all, n));
    if (!room)
        return NO_MEMORY;
    for (int64_t b = 0; b < n; b++) {
        course o = course_of(&problems[b], all, at, b, room);
        if (held)
            response_of(&o, of, &first[b], &second[b]);
        else
            first[b] = condition_of(&o, of), second[b] = error_of(&o, of, first[b]);
    }
    free(room);
    return DONE;
}

/* The integral of beta_t^2 over n rods, (n,): `orbits.action`. */
void rod_orbits_action(int64_t n, const start_problem *problems, const read_orbits *all, const points *at, double *out)
{
    for (int64_t b = 0; b < n; b++) {
        course o = course_of(&problems[b], all, at, b, NULL);
        double beta[NODES], v[NODES], series[NODES + 1], before[2] = {0}, value = 0, x;
        phase where;
        out[b] = 0;
        if (all->kind[b] == HELIX || !(o.count[0] + o.count[1]))
            continue;
        const int64_t panel = rod_place(all, b, problems[b].span, &where, &x) - o.at;
        for (int64_t i = 0; i < o.count[0] + o.count[1]; i++) {
            nodes_of(&o, i, beta, v);
            for (int k = 0; k < o.n; k++)
                v[k] = v[k] * v[k] * (all->width[o.at + i] / 2);
            integrated(at, v, series);
            if (i == panel)
                value = before[i >= o.count[0]] + at_place(series, o.n + 1, x);
            before[i >= o.count[0]] += sum(o.n + 1, series);
        }
        out[b] = rod_unfolded(value, &where, before[0], before[1], o.librates);
    }
}
