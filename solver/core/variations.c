/* The variations of orbits: the state at the nodes of their panels, and the change of an orbit anywhere along the rod;
   solver/orbits/variations.py explains them. */

#include "variations.h"

#define NEAR 0.5 /* rad: the largest distance from a critical point at which its shift is split off */

static const int pairs_of[2][PAIRS] = {{0, 0, 0, 0, 1, 1, 1, 2, 2, 3}, {0, 1, 2, 3, 1, 2, 3, 2, 3, 3}};

INLINE void slopes_by_loads(double s, double c, double *out)
{
    out[0] = c, out[1] = -(c - s) * (c + s), out[2] = -s;
}

/* c of a panel, from |beta_t|, H and H' at its nodes. */
INLINE double scale_across(int n, const double *v, const double *H, const double *rate, double half)
{
    const double fastest = largest_size(n, v), slowest = smallest_size(n, v), most = larger(largest_size(n, rate), 1e-200);
    const double steepest = largest_size(n, H), flattest = smallest_size(n, H);
    const int slows = slowest < fastest / 2, levels = flattest < steepest / 2;
    const double ratio = square(fastest / steepest);
    double c = 1 / most;
    if (levels)
        c = fmin(c, 8 * ratio);
    if (levels && !slows)
        c = fmin(c, square(20 * half));
    return slows ? fmax(c, ratio / 2) : c;
}

/* Sines and cosines of the distances from a critical point: of x/2, x, 2 x and 4 x. */
typedef struct {
    double q[NODES], sx[NODES], cx[NODES], s2x[NODES], c2x[NODES];
} distances;

INLINE void distances_of(int n, const double *x, distances *out)
{
    double half[NODES], sh[NODES], ch[NODES];
    for (int i = 0; i < n; i++)
        half[i] = x[i] / 2;
    sin_cos_of(n, half, sh, ch);
    for (int i = 0; i < n; i++) {
        const double sx = 2 * sh[i] * ch[i], cx = 1 - 2 * sh[i] * sh[i];
        out->q[i] = sh[i] * sh[i], out->sx[i] = sx, out->cx[i] = cx;
        out->s2x[i] = 2 * sx * cx, out->c2x[i] = (cx - sx) * (cx + sx);
    }
}

/* The shift of the critical point, split off near it; gamma without the heights of critical points, and H_q + shift_q H', to
   relative accuracy in x. rest: H less its linear part. */
INLINE void vary_level(const double *loads, double s, double c, double steep, int n, const distances *d,
                       const double *rest, int near, varied_nodes *out)
{
    const double s2 = 2 * s * c, c2 = (c - s) * (c + s), s4 = 2 * s2 * c2, c4 = (c2 - s2) * (c2 + s2);
    const double turn = 4 * (loads[1] * s2 - c2 / 2), even = loads[0] * c - loads[2] * s;
    double at[3];
    slopes_by_loads(s, c, at);
    for (int k = 0; k < 3; k++)
        out->shift[k] = near ? -at[k] / steep : 0;
    for (int i = 0; i < n; i++) {
        const double q = d->q[i], sx = d->sx[i], cx = d->cx[i], s2x = d->s2x[i], c2x = d->c2x[i], sx2 = sx * sx;
        const double w = -2 * q - 2 * sx2 + 4 * q * sx2;
        double rate = -turn * (sx2 / 2 + q * cx) + c4 * (cx * w - sx * (sx * c2x + 2 * cx * s2x)) - sx * even;
        rate += s2x * (2 * loads[1] * c2 + s2) - s4 * 2 * s2x * c2x;
        const double r[3] = {2 * s * q, -2 * c2 * q * sx - s2 * sx2, 2 * c * q};
        const double r_x[3] = {s * sx, -c2 * (sx2 + 2 * q * cx) - s2 * s2x, c * sx};
        for (int k = 0; k < 3; k++) {
            const double left = near ? 0 : at[k];
            out->gamma[k][i] = r[k] - out->shift[k] * rest[i] - left * sx;
            out->H_q[k][i] = -r_x[k] + out->shift[k] * rate + left * cx;
        }
    }
}

INLINE void vary_state(int width, const double *loads, const read_orbits *of, int64_t i, const points *at, int by_loads,
                       varied_nodes *out)
{
    const int n = (int)at->n;
    const double *series = of->series + FUNCTIONS * of->coefficients * i, origin = of->origin[i];
    double x[NODES], v[NODES];
    product_of_two(width, n + 1, n, series, series + n + 1, at->values, x, v);
    const double lam = loads[0], mu = loads[1], phi = loads[2], s = sin(origin), c = cos(origin);
    const double s2 = 2 * s * c, c2 = (c - s) * (c + s), s4 = 2 * s2 * c2, c4 = (c2 - s2) * (c2 + s2);
    const double steep = slope_rate_by(lam, mu, phi, s, c), turn = 4 * (mu * s2 - c2 / 2), even = lam * c - phi * s;
    double rest[NODES], angle[NODES], passed[NODES];
    distances d;
    distances_of(n, x, &d);
    for (int i = 0; i < n; i++) {
        const double q = d.q[i], sx = d.sx[i], sx2 = sx * sx, w = -2 * q - 2 * sx2 + 4 * q * sx2;
        rest[i] = -turn * q * sx + c4 * sx * w - 2 * q * even + sx2 * (2 * mu * c2 + s2) -
                  s4 * d.s2x[i] * d.s2x[i] / 2;
        out->v[i] = v[i] > 0 ? v[i] : 0;
        out->H[i] = steep * sx + rest[i];
        angle[i] = origin + x[i];
    }
    /* farther from a point that is about to vanish, its large shift would cancel; nearer, an orbit in a gap far below
       floats has no digits without it */
    const double far = largest_size(n, x), bent = largest_size(n, rest);
    if (by_loads)
        vary_level(loads, s, c, steep, n, &d, rest, far < NEAR && steep != 0 && bent <= fabs(steep) * far, out);
    sin_cos_of(n, angle, out->sine, out->cosine);
    for (int i = 0; i < n; i++)
        out->rate[i] = slope_rate_by(lam, mu, phi, out->sine[i], out->cosine[i]);
    out->c = scale_across(n, out->v, out->H, out->rate, of->width[i] / 2);
    for (int i = 0; i < n; i++)
        passed[i] = square(out->v[i]) + out->c * square(out->H[i]);
    out->origin = origin, out->least = smallest_size(n, passed);
}

IN_WIDTHS(vary_state,
          (const double *loads, const read_orbits *of, int64_t i, const points *at, int by_loads, varied_nodes *out),
          (WIDTH, loads, of, i, at, by_loads, out))

void rod_vary_state(const double *loads, const read_orbits *of, int64_t i, const points *at, int by_loads, int64_t lanes,
                    varied_nodes *out)
{
    FOR_LANES(lanes, vary_state)(loads, of, i, at, by_loads, out);
}

void rod_height_rates(double angle, double other, double *out)
{
    /* products, so that points that are mirror images have exactly the same height where the load cannot tell them
       apart */
    const double half = (angle - other) / 2, mean = (angle + other) / 2, sine = sin(half);
    out[0] = angle == other ? 0 : -(2 * cos(mean) * sine);
    out[1] = angle == other ? 0 : cos(2 * mean) * sin(2 * half);
    out[2] = angle == other ? 0 : 2 * sin(mean) * sine;
}

INLINE void vary_rates(double nearest, int n, varied_nodes *out)
{
    double above[3], plain[3], *gamma[3];
    const double across = out->c, *s = out->sine, *c = out->cosine, *rate = out->rate;
    rod_height_rates(out->origin, nearest, above);
    for (int k = 0; k < 3; k++) {
        gamma[k] = out->gamma[k];
        for (int i = 0; i < n; i++)
            gamma[k][i] += above[k];
    }
    for (int i = 0; i < n; i++) {
        const double v = out->v[i], H = out->H[i], sigma = shear_rate(v, H, rate[i], across);
        const double lever = across * H / across_flow(v, H, across);
        const double g[4] = {1, gamma[0][i], gamma[1][i], gamma[2][i]};
        const double h[4] = {0, out->H_q[0][i], out->H_q[1][i], out->H_q[2][i]};
        const double k[4] = {0, out->shift[0], out->shift[1], out->shift[2]};
        slopes_by_loads(s[i], c[i], plain);
        const double p[4] = {0, plain[0], plain[1], plain[2]};
        for (int m = 0; m < PAIRS; m++) {
            const int a = pairs_of[0][m], b = pairs_of[1][m];
            out->M[m][i] = g[a] * g[b] * sigma + lever * (g[a] * h[b] + g[b] * h[a]) +
                           (k[a] * p[b] + k[b] * p[a] + k[a] * rate[i] * k[b]);
        }
    }
}

IN_WIDTHS(vary_rates, (double nearest, int n, varied_nodes *out), (nearest, n, out))

/* What M gains where the transversal and the shift change from those of one panel to those at the near end of another.
   sign: of beta_t on the latter, away from the start. */
static void jump_between(const varied_nodes *old, const varied_nodes *now, double sign, double *out)
{
    const double v = sign * now->v[0], H = now->H[0];
    const double turn = shear_jump(v, H, old->c, now->c), lift = v / across_flow(v, H, now->c), raised = lift * H;
    double full[4] = {1}, was[4] = {0}, is[4] = {0}, g[4], less[4];
    for (int k = 0; k < 3; k++) {
        was[k + 1] = old->shift[k], is[k + 1] = now->shift[k];
        full[k + 1] = now->gamma[k][0] + now->shift[k] * H;
    }
    for (int k = 0; k < 4; k++)
        g[k] = full[k] - was[k] * H, less[k] = was[k] - is[k];
    for (int m = 0; m < PAIRS; m++) {
        const int a = pairs_of[0][m], b = pairs_of[1][m];
        out[m] = turn * g[a] * g[b] + lift * (less[a] * full[b] + full[a] * less[b]) -
                 raised * (was[a] * was[b] - is[a] * is[b]);
    }
}

static void vary_entry(const varied_nodes *nodes, const int64_t *count, int64_t i, double direction, double *out)
{
    memset(out, 0, sizeof(double) * PAIRS);
    if (i) /* the backward arc follows the forward one */
        jump_between(&nodes[i == count[0] ? 0 : i - 1], &nodes[i], direction * (i >= count[0] ? -1 : 1), out);
}

static void vary_closing(const varied_nodes *nodes, const int64_t *count, int arc, int64_t kind, double direction,
                        double *out)
{
    const varied_nodes *start = nodes + (arc ? count[0] : 0);
    memset(out, 0, sizeof(double) * PAIRS);
    if (count[arc] && kind != LIBRATION)
        jump_between(start + count[arc] - 1, start, direction * (arc ? -1 : 1), out);
}

void rod_panel_weights(const points *at, double *out)
{
    double row[NODES + 1];
    const int n = (int)at->n;
    for (int i = 0; i < n; i++) {
        integral(n, at->analyse + n * i, row);
        out[i] = sum_of(n + 1, row);
    }
}

/* The series of a panel but for the constants of its sums, and its constants: `varied_size`. */
INLINE void keep_series(int width, const varied_nodes *one, const points *at, double half, double *restrict series)
{
    const int n = (int)at->n, size = n + 1;
    const double *values[VARIED] = {one->v, one->H, one->gamma[0], one->gamma[1], one->gamma[2]};
    double rates[VARIED][NODES + 2], share[NODES + 1], *out[VARIED];
    for (int m = 0; m < PAIRS; m++)
        values[BY_LEVEL + m] = one->M[m];
    for (int m = 0; m < VARIED; m++)
        out[m] = m < BY_LEVEL ? series + size * m : rates[m], out[m][n] = rates[m][n] = rates[m][n + 1] = 0;
    for (int m = 0; m < VARIED; m += 3)
        PRODUCTS(width)(3, 3, 1, n / 2, n, values + m, at->analyse, out + m);
    for (int k = 1; k <= n; k++)
        share[k] = half / (2 * k);
    for (int m = BY_LEVEL; m < VARIED; m++) { /* `integral` of all sums at once */
        double *own = series + size * m;
        for (int k = 1; k <= n; k++)
            own[k] = (rates[m][k - 1] - rates[m][k + 1]) * share[k];
        own[1] = (2 * rates[m][0] - rates[m][2]) * share[1]; /* a number changed before would be waited for */
    }
    double first[PAIRS] = {0};
    for (int k = 1; k <= n; k++)
        for (int m = 0; m < PAIRS; m++)
            first[m] += (k % 2 ? 1 : -1) * series[size * (BY_LEVEL + m) + k];
    for (int m = 0; m < PAIRS; m++)
        series[size * (BY_LEVEL + m)] = first[m];
    series[size * VARIED] = one->c;
    memcpy(series + size * VARIED + 1, one->shift, sizeof one->shift);
}

IN_WIDTHS(keep_series, (const varied_nodes *one, const points *at, double half, double *series), (WIDTH, one, at, half, series))

int64_t rod_vary(const double *loads, const read_orbits *of, int64_t b, const points *at, const double *weights,
                 const int64_t *only, varied_nodes *nodes, const varied_orbits *out)
{
    const int n = (int)at->n;
    const int64_t first = of->first[2 * b], P = of->count[2 * b] + of->count[2 * b + 1];
    const int64_t *count = of->count + 2 * b;
    int64_t nearest = 0;
    double total[2][PAIRS] = {{0}};
    for (int64_t i = 0; i < P; i++) {
        rod_vary_state(loads, of, first + i, at, 1, out->lanes, &nodes[i]);
        out->least[first + i] = nodes[i].least;
        if (nodes[i].least < nodes[nearest].least)
            nearest = i;
    }
    for (int64_t i = 0; i < P; i++) {
        const int backward = i >= count[0], wanted = !only || i == only[0] || i == only[1];
        const double half = of->width[first + i] / 2;
        double *jump = out->jump + PAIRS * (first + i), *series = out->series + varied_size(n + 1) * (first + i);
        FOR_LANES(out->lanes, vary_rates)(of->origin[first + nearest], n, &nodes[i]);
        vary_entry(nodes, count, i, of->direction[b], jump);
        if (wanted)
            FOR_LANES(out->lanes, keep_series)(&nodes[i], at, half, series);
        double gained[PAIRS] = {0};
        for (int k = 0; k < n; k++)
            for (int m = 0; m < PAIRS; m++)
                gained[m] += nodes[i].M[m][k] * weights[k];
        for (int m = 0; m < PAIRS; m++) {
            total[backward][m] += jump[m];
            if (wanted)
                series[(BY_LEVEL + m) * (n + 1)] += total[backward][m];
            if (out->M)
                memcpy(out->M + (PAIRS * (first + i) + m) * n, nodes[i].M[m], sizeof(double) * (size_t)n);
            total[backward][m] += gained[m] * half;
        }
    }
    for (int arc = 0; arc < 2; arc++) {
        double *closing = out->closing + PAIRS * (2 * b + arc);
        vary_closing(nodes, count, arc, of->kind[b], of->direction[b], closing);
        for (int m = 0; m < PAIRS; m++)
            out->gain[PAIRS * (2 * b + arc) + m] = total[arc][m] + closing[m];
    }
    return nearest;
}

int64_t rod_most_panels(const read_orbits *of, int64_t n)
{
    int64_t most = 1;
    for (int64_t b = 0; b < n; b++) {
        const int64_t P = of->count[2 * b] + of->count[2 * b + 1];
        most = P > most ? P : most;
    }
    return most;
}

/* The variations of n orbits, none of them a helix.

   loads: (n, 3). The arrays of `out` are filled. Returns DONE, NO_MEMORY or, of points that `rod_vary` does not take,
   NOT_POSSIBLE. */
int rod_variations(int64_t n, const double *loads, const read_orbits *of, const points *at, const varied_orbits *out)
{
    if (at->n > NODES || at->n < 8 || at->n % 2 || of->coefficients != at->n + 1)
        return NOT_POSSIBLE;
    varied_nodes *nodes = malloc(sizeof(varied_nodes) * (size_t)rod_most_panels(of, n));
    double weights[NODES];
    rod_panel_weights(at, weights);
    for (int64_t b = 0; nodes && b < n; b++)
        rod_vary(loads + 3 * b, of, b, at, weights, NULL, nodes, out);
    const int failed = nodes ? DONE : NO_MEMORY;
    free(nodes);
    return failed;
}

/* Places of an orbit: their panels and where in these, those of one panel after each other, with the number of each; then in
   their own order the sign of beta_t, the whole periods before, and whether they lie on the second arc, or on a way back. */
enum { VISITS = 256, BUCKETS = 64, PAD = 8 };
typedef struct {
    int64_t panel[VISITS];
    int place[VISITS];
    double x[VISITS + PAD], sign[VISITS + PAD], periods[VISITS + PAD], second[VISITS + PAD], mirrored[VISITS + PAD];
} visits;

/* What is known of the shape at those places, along the rod: numbers of `shapes`, sin and cos of beta, and H. */
typedef struct {
    double t[VISITS + PAD], rate[VISITS + PAD], z[VISITS + PAD], s[VISITS + PAD], c[VISITS + PAD], H[VISITS + PAD];
} known_places;

INLINE void know_places(const shapes *of, int64_t row, int64_t begin, int many, known_places *out)
{
    const int64_t at = row * of->stations + begin;
    const size_t size = sizeof(double) * (size_t)many, rest = sizeof(double) * PAD;
    const double *from[3] = {of->t + at, of->rate + at, of->z + at}, *loads = of->loads + 3 * row;
    double *rows[6] = {out->t, out->rate, out->z, out->s, out->c, out->H};
    for (int k = 0; k < 3; k++)
        memcpy(rows[k], from[k], size);
    sin_cos_of(many, of->beta + at, out->s, out->c);
    for (int i = 0; i < many; i++)
        out->H[i] = slope_by(loads[0], loads[1], loads[2], out->s[i], out->c[i]);
    for (int k = 0; k < 6; k++) /* read in lanes, and not used */
        memset(rows[k] + many, 0, rest);
}

IN_WIDTHS(know_places, (const shapes *of, int64_t row, int64_t begin, int many, known_places *out),
          (of, row, begin, many, out))

/* What the derivatives of a shape by one field are made of beside its changes. over: 1/rho. twist: d (mu ratio). */
typedef struct {
    double longer, rho, over, d_rho, alpha, gamma, twist, swirl;
} known_field;

static known_field know_field(const shapes *of, int64_t row, int64_t f)
{
    const int64_t table = of->size * of->F, own = row * of->F + f;
    const double mu = of->loads[3 * row + 1], longer = of->later[own] / of->span[row];
    if (!of->by)
        return (known_field){.longer = longer, .rho = 1, .over = 1};
    const double *by = of->by + own, rho = of->rho[row], ratio = of->ratio[row];
    const double twist = by[table * BY_MU] * ratio + mu * by[table * BY_RATIO];
    return (known_field){longer, rho, 1 / rho, by[table * BY_RHO], by[table * BY_AZIMUTH], by[table * BY_TWIST], twist, mu * ratio};
}

enum { TOGETHER = 8 }; /* lanes of places whose units are at hand at once */

/* The orbit whose changes are read; size: of the series. */
typedef struct {
    const double *series, *gain;
    const varied_place *start;
    int size, librates;
} changed_orbit;

#define LANES "change_lanes.h"
#include "widths.h"

void rod_varied_unit(const varied_place *start, const varied_place *there, varied_unit *out) { unit_1(start, there, out); }

void rod_varied_directions(const varied_place *start, double out[PARTS][PARTS])
{
    const double v = start->v, H = start->H, c = start->c, D = across_flow(v, H, c);
    memset(out, 0, sizeof(double) * PARTS * PARTS);
    out[0][0] = v / D, out[1][0] = H, out[0][1] = -c * H / D, out[1][1] = v;
    for (int q = 1; q < 4; q++) {
        out[q + 1][q + 1] = 1;
        out[0][q + 1] = -start->shift[q] * v / D, out[1][q + 1] = -(start->gamma[q] + start->shift[q] * H);
    }
}

void rod_varied_place_on(const varied_orbits *varied, int size, int64_t panel, double x, varied_place *out)
{
    const double *series = varied->series + varied_size(size) * panel, *constant = series + VARIED * size;
    double value[VARIED];
    values_at(VARIED, series, size, x, value);
    out->v = value[0], out->H = value[1], out->c = constant[0], out->shift[0] = 0, out->gamma[0] = 1;
    memcpy(out->shift + 1, constant + 1, sizeof(double) * 3), memcpy(out->gamma + 1, value + 2, sizeof(double) * 3);
    memcpy(out->M, value + BY_LEVEL, sizeof out->M);
}

/* The state of orbit b at t. */
void rod_varied_place_at(const read_orbits *of, const varied_orbits *varied, int64_t b, double t, varied_place *out)
{
    const double *gain = varied->gain + 2 * PAIRS * b;
    double x;
    phase where;
    const int64_t panel = rod_place(of, b, t, &where, &x);
    rod_varied_place_on(varied, (int)of->coefficients, panel, x, out);
    out->v *= of->direction[b] * (where.second ? -1 : 1) * (where.mirrored ? -1 : 1);
    for (int m = 0; m < PAIRS; m++)
        out->M[m] = rod_unfolded(out->M[m], &where, gain[m], gain[PAIRS + m], of->kind[b] == LIBRATION);
}

/* The panels in which an orbit is at `many` times, sorted by them as far as BUCKETS allow. */
static void visit(const read_orbits *of, int64_t b, const double *t, int many, visits *out)
{
    int64_t panel[VISITS];
    phase where[VISITS];
    double x[VISITS];
    int from[BUCKETS + 1] = {0};
    rod_places_at(of, b, many, t, panel, where, x);
    for (int i = 0; i < many; i++) {
        out->sign[i] = of->direction[b] * (where[i].second ? -1 : 1) * (where[i].mirrored ? -1 : 1);
        out->periods[i] = where[i].periods, out->second[i] = where[i].second, out->mirrored[i] = where[i].mirrored;
        from[panel[i] % BUCKETS + 1]++;
    }
    for (int k = 0; k < BUCKETS; k++)
        from[k + 1] += from[k];
    for (int i = 0; i < many; i++) {
        const int to = from[panel[i] % BUCKETS]++;
        out->panel[to] = panel[i], out->x[to] = x[i], out->place[to] = i;
    }
    for (int i = many; i < many + PAD; i++) /* read in lanes, and not used */
        out->x[i] = out->sign[i] = out->periods[i] = out->second[i] = out->mirrored[i] = 0;
}

void rod_change_orbit(const read_orbits *of, const varied_orbits *varied, int64_t b, const shapes *along, int64_t row,
                      const double *parts)
{
    const int lanes = (int)varied->lanes;
    varied_place start;
    visits sorted;
    known_places known;
    double values[VARIED + CONSTANTS][VISITS + PAD];
    rod_varied_place_at(of, varied, b, 0, &start);
    const changed_orbit one = {varied->series, varied->gain + 2 * PAIRS * b, &start, (int)of->coefficients,
                               of->kind[b] == LIBRATION};
    for (int64_t begin = 0; begin < along->stations; begin += VISITS) {
        const int many = (int)(along->stations - begin < VISITS ? along->stations - begin : VISITS);
        visit(of, b, along->t + row * along->stations + begin, many, &sorted);
        if (along->beta)
            FOR_LANES(lanes, know_places)(along, row, begin, many, &known);
        for (int k = 0; k < VARIED + CONSTANTS; k++)
            memset(values[k] + many, 0, sizeof(double) * PAD);
        for (int at = 0, next; at < many; at = next) {
            for (next = at + 1; next < many && next < at + lanes && sorted.panel[next] == sorted.panel[at]; next++)
                ;
            FOR_WIDTH(lanes, values)(&one, &sorted, at, next - at, values);
        }
        FOR_WIDTH(lanes, changes)(&one, &sorted, many, values, parts, along, row, begin, &known);
    }
}

/* The changes of n orbits, none of them a helix, by F directions with the parts (n, F, PARTS) at t (n, stations), into
   out (5, n, F, stations). */
void rod_variations_changes(const read_orbits *of, const varied_orbits *varied, int64_t n, int64_t stations, int64_t F,
                            const double *t, const double *parts, double *out)
{
    const shapes along = {.size = n, .stations = stations, .F = F, .t = t, .out = out};
    for (int64_t b = 0; b < n; b++)
        rod_change_orbit(of, varied, b, &along, b, parts + b * F * PARTS);
}

/* The derivatives of shapes from changes that are in their `out`. */
void rod_shape_rates(const shapes *of, int64_t lanes)
{
    known_places known;
    for (int64_t b = 0; b < of->size; b++)
        for (int64_t begin = 0; begin < of->stations; begin += VISITS) {
            const int many = (int)(of->stations - begin < VISITS ? of->stations - begin : VISITS);
            FOR_LANES(lanes, know_places)(of, b, begin, many, &known);
            FOR_WIDTH((int)lanes, derivatives)(of, b, begin, many, &known);
        }
}

void rod_lone_orbit_free(lone_orbit *o)
{
    free(o->nodes);
    free(o->rows);
    free(o->room);
    rod_panels_free(&o->made);
}

static int fill(lone_orbit *o, const points *at, const cutting *how)
{
    const panels *cut = &o->made;
    const int64_t P = cut->count, size = at->n + 1, each = FUNCTIONS * size, varied = varied_size(size);
    const int64_t numbers = P * (PANEL_COLUMNS + 2 + PAIRS * size + each + varied);
    if (rod_roomy((void **)&o->nodes, &o->node_room, P, sizeof(varied_nodes)) ||
        rod_roomy((void **)&o->rows, &o->row_room, P, sizeof(int64_t)) ||
        rod_roomy((void **)&o->room, &o->number_room, numbers, sizeof(double)))
        return NO_MEMORY;
    double *width = o->room, *since = width + P * PANEL_COLUMNS, *series = since + P;
    double *least = series + P * each, *jump = least + P, *kept = jump + P * PAIRS, *M = kept + P * varied;
    const panel_arrays to = {P, o->rows, width, series};
    rod_copy_panels(cut, cut->first, size, how->series, 0, &to);
    rod_orbits_sum(2, P, size, to.arc, width, how->series == FUNCTIONS ? series : NULL, since, o->first, o->count, o->duration, o->integrals);
    o->of = (read_orbits){size, P, &o->kind, o->first, o->count, NULL, &o->direction, o->duration, o->integrals, since, width,
                          width + P, width + 2 * P, series};
    o->varied = (varied_orbits){least, M, jump, o->closing, kept, o->gain, how->lanes};
    return o->count[0] ? DONE : NOT_POSSIBLE;
}

int rod_lone_orbit(const start_problem *start, const double *pinned, const critical *known, const grid *by,
                   const points *at, const cutting *how, lone_orbit *out)
{
    arcs from;
    out->kind = LOST, out->made.count = 0;
    const int failed = rod_cut_orbit(start, pinned, known, by, at, how, &from, &out->made);
    if (failed)
        return failed;
    out->kind = from.kind, out->direction = from.direction;
    return out->made.count ? fill(out, at, how) : NOT_POSSIBLE;
}
