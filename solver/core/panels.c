/* Panels of one orbit: short parts of an arc on which beta and the developed curve are Chebyshev series in time. */

#include "orbit_parts.h"

enum { ROUNDS = 14, PATIENCE = 3, CROWD = 16, NEWTON = 12, ARCS = 4 };
enum { SPACE = 48 }; /* for NODES in whole registers, three of eight numbers at once */
#define TOO_LONG 1e4 /* times the rod's length: a first panel that lasts longer is cut */
#define LONG 8.0     /* in u: a piece longer than this is stretched along a saddle */

/* sinh and cosh, |u| < 700 */
INLINE void sinh_cosh_of(int n, const double *restrict u, double *restrict sinh_, double *restrict cosh_)
{
    const double nearest = 0x1.8p52, high = 0x1.62e42fee00000p-1, low = 0x1.a39ef35793c76p-33;
    for (int i = 0; i < n; i++) {
        const double shifted = u[i] * 1.44269504088896340736 + nearest, k = shifted - nearest;
        const double r = (u[i] - k * high) - k * low;
        double e = 1.0 / 6227020800.0;
        e = e * r + 1.0 / 479001600.0;
        e = e * r + 1.0 / 39916800.0;
        e = e * r + 1.0 / 3628800.0;
        e = e * r + 1.0 / 362880.0;
        e = e * r + 1.0 / 40320.0;
        e = e * r + 1.0 / 5040.0;
        e = e * r + 1.0 / 720.0;
        e = e * r + 1.0 / 120.0;
        e = e * r + 1.0 / 24.0;
        e = e * r + 1.0 / 6.0;
        e = e * r + 0.5;
        e = 1.0 + (r + r * r * e);
        e *= number_of((int64_t)((uint64_t)(bits_of(shifted) - 0x4338000000000000 + 1023) << 52));
        const double inverse = 1 / e, q = u[i] * u[i];
        double s = 1.0 / 355687428096000.0; /* small u: the difference would lose its digits */
        s = s * q + 1.0 / 1307674368000.0;
        s = s * q + 1.0 / 6227020800.0;
        s = s * q + 1.0 / 39916800.0;
        s = s * q + 1.0 / 362880.0;
        s = s * q + 1.0 / 5040.0;
        s = s * q + 1.0 / 120.0;
        s = s * q + 1.0 / 6.0;
        s = u[i] + u[i] * q * s;
        sinh_[i] = q < 1 ? s : (e - inverse) / 2, cosh_[i] = (e + inverse) / 2;
    }
}

/* sqrt(speed2(x) / (x^2 + scale^2)) from sin and cos of x/2 */
INLINE void passing(const piece *p, int n, const double *restrict x, const double *restrict sh,
                    const double *restrict ch, double *restrict root)
{
    const local_potential l = p->local;
    const double scale2 = p->scale * p->scale;
    for (int i = 0; i < n; i++) {
        double S, C, bracket;
        const double K = steepness_by(&l, sh[i], ch[i], near_of(&l, sh[i], ch[i], &S, &C, &bracket));
        root[i] = sqrt((l.level + sh[i] * sh[i] * K) / (x[i] * x[i] + scale2));
    }
}

/* beta_t over sqrt(x1^2 - x^2), kept above zero where the turning point is next to a helix */
INLINE void slope_over_root(const piece *p, int n, const double *restrict x, const double *restrict sh,
                    const double *restrict ch, double *restrict root)
{
    const local_potential l = p->local;
    const double turn = p->scale, sh1 = sin(turn / 2), ch1 = cos(turn / 2), faintest = rod_faintest(&l);
    double S1, C1, unused;
    near_of(&l, sh1, ch1, &S1, &C1, &unused);
    const double twice = 2 * C1 * C1, more = 4 * sh1 * sh1, sin2o = 2 * l.s * l.c, cos2o = (l.c - l.s) * (l.c + l.s);
    for (int i = 0; i < n; i++) {
        const double s = sh[i], c = ch[i], d = (x[i] - turn) / 2, q = d * d;
        double S, C, bracket;
        const double K = steepness_by(&l, s, c, near_of(&l, s, c, &S, &C, &bracket));
        const double sin_mid = s * ch1 + c * sh1, cos_mid = c * ch1 - s * sh1;
        double inner = twice * (l.c * cos_mid - l.s * sin_mid) * (S + S1 + 2 * l.s);
        inner = inner - bracket * (sin2o * cos_mid + cos2o * sin_mid) - 2 * l.turn * cos_mid;
        const double W = sin_mid * (K + 2 * more * l.bend) + more * inner;
        double series = 1.0 / 355687428096000.0;
        series = series * q - 1.0 / 1307674368000.0;
        series = series * q + 1.0 / 6227020800.0;
        series = series * q - 1.0 / 39916800.0;
        series = series * q + 1.0 / 362880.0;
        series = series * q - 1.0 / 5040.0;
        series = series * q + 1.0 / 120.0;
        series = series * q - 1.0 / 6.0;
        series = series * q + 1.0;
        const double apart_ = (s * ch1 - c * sh1) / d; /* sin(d)/d */
        const double sinc = q < 0.25 ? series : apart_;
        const double ratio = fabs(0.5 * sinc * W / (x[i] + turn));
        root[i] = sqrt(ratio < faintest ? faintest : ratio);
    }
}

INLINE void pace_of(const piece *p, int n, const double *u, double *x, double *pace, double *speed)
{
    double form[NODES], rate[NODES], half[NODES], sh[NODES], ch[NODES], root[NODES];
    const double far = largest_size(n, u);
    if (p->kind == CENTRE)
        sin_cos_of(n, u, form, rate);
    else if (far < 700)
        sinh_cosh_of(n, u, p->kind == PASS ? form : rate, p->kind == PASS ? rate : form);
    else
        for (int i = 0; i < n; i++) {
            form[i] = p->kind == PASS ? sinh(u[i]) : cosh(u[i]);
            rate[i] = p->kind == PASS ? cosh(u[i]) : sinh(u[i]);
        }
    for (int i = 0; i < n; i++)
        x[i] = p->scale * form[i], half[i] = x[i] / 2;
    sin_cos_of(n, half, sh, ch);
    if (p->kind == PASS)
        passing(p, n, x, sh, ch, root);
    else
        slope_over_root(p, n, x, sh, ch, root);
    for (int i = 0; i < n; i++)
        pace[i] = 1 / root[i], speed[i] = fabs(p->scale * rate[i]) * root[i];
}

/* Where in [-1, 1] the clock shows the nodes' shares of the duration, (SPACE,); whether Newton converged. */
INLINE int inverted(int width, const points *at, const double *clock, const double *rate, double duration, double *place)
{
    const int n = (int)at->n;
    double padded[NODES + 1], shown[SPACE], paced[SPACE], change[NODES], wanted[NODES], step[NODES], worst = INFINITY;
    memcpy(padded, rate, sizeof(double) * (size_t)n);
    padded[n] = 0;
    product_of_two(width, n + 1, n, clock, padded, at->values, shown, paced);
    product(width, n, n, rate, at->differentiate, change);
    for (int i = 0; i < n; i++) {
        wanted[i] = duration * ((1 + at->nodes[i]) / 2);
        const double early = (wanted[i] - shown[i]) / paced[i];
        place[i] = at->nodes[i] + early * (1 - 0.5 * (change[i] / paced[i]) * early);
        place[i] = smaller(larger(place[i], -1), 1);
    }
    place[0] = -1, place[n - 1] = 1;
    for (int i = n; i < SPACE; i++)
        place[i] = 0;
    for (int round = 0; round < NEWTON && !(worst <= 1e-8); round++) { /* the next step is its square */
        TWO_SERIES(width)(width == 8 ? 3 : 2, n, clock, padded, place, shown, paced);
        for (int i = 1; i < n - 1; i++) {
            step[i] = (shown[i] - wanted[i]) / paced[i];
            place[i] = smaller(larger(place[i] - step[i], -1), 1);
        }
        worst = largest_size(n - 2, step + 1);
        if (worst != worst)
            break;
    }
    return worst < 1e-7;
}

/* The pace at the nodes of a panel, its series and the clock's; the duration is set. */
INLINE void clocked(int width, const piece *p, const points *at, panel *out, double *u, double *x, double *pace, double *rate,
                    double *clock)
{
    const int n = (int)at->n;
    const double middle = (out->near + out->far) / 2, half = (out->far - out->near) / 2;
    double speed[NODES], shares[NODES];
    for (int i = 0; i < n; i++)
        u[i] = middle + half * at->nodes[i];
    pace_of(p, n, u, x, pace, speed);
    for (int i = 0; i < n; i++)
        shares[i] = pace[i] * fabs(half);
    product(width, n, n, shares, at->analyse, rate);
    integral(n, rate, clock);
    out->duration = sum_of(n + 1, clock);
}

INLINE void series_of(int width, const piece *p, const points *at, int wanted, panel *out, double *series)
{
    const int n = (int)at->n;
    const double middle = (out->near + out->far) / 2, half = (out->far - out->near) / 2;
    double u[NODES], x[NODES], pace[NODES], speed[NODES], rate[NODES], clock[NODES + 1], place[SPACE], angle[NODES];
    double directions[3][NODES], cut[FUNCTIONS][NODES];
    clocked(width, p, at, out, u, x, pace, rate, clock);
    const double quickest = largest_size(n, pace), late = largest_size(3, clock + n - 2);
    const int converged = inverted(width, at, clock, rate, out->duration, place);
    for (int i = 0; i < n; i++)
        u[i] = middle + half * place[i];
    pace_of(p, n, u, x, pace, speed);
    for (int i = 0; i < n; i++)
        angle[i] = p->base + x[i];
    sin_cos_of(n, angle, directions[0], directions[1]);
    product_of_two(width, n, n, x, speed, at->analyse, cut[0], cut[1]);
    for (int k = 0; k < OF_ANGLE; k++) {
        memcpy(series + k * (n + 1), cut[k], sizeof(double) * (size_t)n);
        series[k * (n + 1) + n] = 0;
    }
    if (wanted == FUNCTIONS) {
        for (int i = 0; i < n; i++)
            directions[2][i] = directions[0][i] * directions[1][i];
        product_of_two(width, n, n, directions[0], directions[1], at->analyse, cut[2], cut[3]);
        product(width, n, n, directions[2], at->analyse, cut[4]);
    } else
        for (int k = 0; k < 2; k++) { /* the last two alone, which measure the error */
            double *last = cut[2 + k] + n - 2;
            last[0] = last[1] = 0;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < 2; j++)
                    last[j] += directions[k][i] * at->analyse[n * i + n - 2 + j];
        }
    for (int k = OF_ANGLE; k < wanted; k++) {
        double *row = series + k * (n + 1);
        integral(n, cut[k], row);
        for (int i = 0; i <= n; i++)
            row[i] *= out->duration / 2;
    }
    out->fastest = largest_size(n, speed);
    out->error = larger(larger(largest_size(2, cut[0] + n - 2), largest_size(2, cut[2] + n - 2)), largest_size(2, cut[3] + n - 2));
    out->error = larger(out->error, late * out->fastest);
    out->time_error = late / out->duration;
    if (!converged) /* all that is known of beta is that it lies within the panel */
        out->error = fabs(x[n - 1] - x[0]);
    out->time_rounding = EPS / 2 * rod_weight(&p->local, largest_size(n, x)) * square(quickest);
}

INLINE void times_of(int width, const piece *p, const points *at, panel *out)
{
    double u[NODES], x[NODES], pace[NODES], rate[NODES], clock[NODES + 1];
    clocked(width, p, at, out, u, x, pace, rate, clock);
    out->time_error = largest_size(3, clock + at->n - 2) / out->duration;
    out->error = out->fastest = out->time_rounding = 0;
}

INLINE void one_panel(int width, const piece *p, const points *at, int wanted, panel *out, double *series)
{
    if (wanted)
        series_of(width, p, at, wanted, out, series);
    else
        times_of(width, p, at, out);
}
IN_WIDTHS(one_panel, (const piece *p, const points *at, int wanted, panel *out, double *series),
          (WIDTH, p, at, wanted, out, series))

/* Room for one panel more, with its series. */
static int extended(panels *all, const points *at, int series)
{
    const size_t size = sizeof(double) * (size_t)(FUNCTIONS * (at->n + 1));
    const int failed = rod_roomy((void **)&all->rows, &all->room, all->count + 1, sizeof(panel));
    return failed || !series ? failed : rod_roomy((void **)&all->series, &all->series_room, all->count + 1, size);
}

double rod_slope_over_root(const local_potential *l, double turn, double x)
{
    const piece p = {.scale = turn, .local = *l};
    const double sh = sin(x / 2), ch = cos(x / 2);
    double root;
    slope_over_root(&p, 1, &x, &sh, &ch, &root);
    return root;
}

/* The pieces in equal parts of about `length` in u, linked in their order. */
static int first_cuts(const piece *pieces, int count, const points *at, const cutting *how, panels *all)
{
    all->first = all->count;
    for (int p = 0; p < count; p++) {
        const double u0 = pieces[p].u0, u1 = pieces[p].u1;
        double wide = fabs(u1 - u0);
        wide = isfinite(wide) ? wide : 0; /* beyond a float: one panel, without a number, which is refused */
        const double share = larger(ceil(wide / (wide > LONG ? how->stretch * how->length : how->length)), 1);
        if (share > rod_tuning.most_panels)
            return NOT_POSSIBLE;
        const int64_t parts = (int64_t)share;
        const double step = (u1 - u0) / share;
        for (int64_t k = 0; k < parts; k++) {
            if (extended(all, at, how->series))
                return NO_MEMORY;
            panel *one = &all->rows[all->count];
            *one = (panel){.piece = p, .next = all->count + 1, .open = 1, .order = (double)k};
            one->base = pieces[p].base, one->origin = pieces[p].local.o;
            one->near = u0 + (double)k * step, one->far = k + 1 == parts ? u1 : u0 + (double)(k + 1) * step;
            all->count++;
        }
    }
    if (all->count > all->first)
        all->rows[all->count - 1].next = -1;
    return DONE;
}

/* Marks which of the open panels are good enough; how many are left. share: of a panel, where it is cut, or NULL. */
static int64_t judged(const start_problem *p, const piece *pieces, const cutting *how, panels *all, int round,
                      int64_t *made)
{
    const double steep = 4 * (2 * fabs(p->lam) + 2 * fabs(p->phi) + fabs(p->mu) + 1);
    const double repeats = larger(1, p->span * sqrt(p->dbeta0 * p->dbeta0 + steep));
    const double goal = larger(how->goal, 20 * EPS), in_time = larger(how->goal / repeats, 40 * EPS);
    int64_t left[ARCS] = {0}, open = 0;
    for (int64_t i = all->first; i < all->count; i++) {
        panel *one = &all->rows[i];
        if (!one->open)
            continue;
        const piece *own = &pieces[one->piece];
        const int leads = one->piece == 0 || own[-1].arc != own->arc;
        int enough = one->error <= goal && one->time_error <= in_time;
        /* a rod that ends long before its first panel needs a shorter one: sums over the long one would swamp its own */
        const int too_long = one->order == 0 && leads && one->duration > TOO_LONG * larger(1, p->span);
        one->open = enough && !too_long ? 1 : too_long ? 3 : 2;
        left[own->arc] += one->open > 1;
        made[own->arc / 2]++;
    }
    for (int64_t i = all->first; i < all->count; i++) {
        panel *one = &all->rows[i];
        if (!one->open)
            continue;
        const int64_t arc = pieces[one->piece].arc;
        /* panels beside a singularity are few; many that halving does not help are at the limit of rounding */
        const int hopeless = (round >= PATIENCE && left[arc] > CROWD) || round == ROUNDS || !isfinite(one->error) ||
                             !isfinite(one->duration) || made[arc / 2] > rod_tuning.most_panels;
        if (one->open == 1 || hopeless)
            one->open = 0;
        open += one->open > 0;
    }
    return open;
}

/* Each open panel as two. */
static int halved(const start_problem *p, const points *at, const cutting *how, panels *all, int round)
{
    const int64_t count = all->count;
    for (int64_t i = all->first; i < count; i++) {
        if (!all->rows[i].open)
            continue;
        if (extended(all, at, how->series))
            return NO_MEMORY;
        panel *one = &all->rows[i], *second = &all->rows[all->count];
        const double share = one->open == 3 ? smaller(4 * p->span / one->duration, 0.5) : 0.5;
        const double middle = one->near + share * (one->far - one->near);
        one->open = 1;
        *second = *one;
        one->far = second->near = middle;
        second->order = one->order + ldexp(1.0, -round - 1);
        one->next = all->count++;
    }
    return DONE;
}

/* The panels of the pieces of one problem behind those that are there. Arcs 0 .. 3. */
int rod_panelled(const start_problem *p, const piece *pieces, int count, const points *at, const cutting *how,
                 panels *all)
{
    const int64_t size = FUNCTIONS * (at->n + 1);
    int64_t made[ARCS / 2] = {0};
    int failed = first_cuts(pieces, count, at, how, all);
    for (int round = 0; !failed && round <= ROUNDS; round++) {
        for (int64_t i = all->first; i < all->count; i++)
            if (all->rows[i].open) {
                panel *one = &all->rows[i];
                double *series = how->series ? all->series + i * size : NULL;
                FOR_LANES(how->lanes, one_panel)(&pieces[one->piece], at, how->series, one, series);
            }
        if (!judged(p, pieces, how, all, round, made))
            break;
        failed = halved(p, at, how, all, round);
    }
    return failed;
}

double rod_half_passage(const piece *p, double gap, int at_far_end)
{
    const double level = p->local.level, end = at_far_end ? p->u1 : p->u0;
    if (p->kind == CENTRE || end != 0 || !(fabs(fabs(level) - fabs(gap)) < 1e-9 * fabs(level)))
        return 0;
    return 0.5 / sqrt(larger(rod_steepness(&p->local, 0) / 4, 1e-30));
}

int rod_rest(const piece *pieces, int count, double gap, double deeper, const points *at, panels *all)
{
    const int64_t width = at->n + 1;
    for (int end = 0; end < 2 * count; end++) {
        const piece *p = &pieces[end / 2];
        const double stay = rod_half_passage(p, gap, end % 2) * deeper, s = sin(p->base), c = cos(p->base);
        const double rates[3] = {s, c, s * c};
        if (!(stay > 0))
            continue;
        if (extended(all, at, FUNCTIONS))
            return NO_MEMORY;
        int64_t *link = &all->first; /* before the panels of the piece, or behind them */
        while (*link >= 0 && all->rows[*link].piece < end / 2 + end % 2)
            link = &all->rows[*link].next;
        double *series = all->series + FUNCTIONS * width * all->count;
        memset(series, 0, sizeof(double) * (size_t)(FUNCTIONS * width));
        for (int k = 0; k < 3; k++)
            series[(2 + k) * width] = series[(2 + k) * width + 1] = rates[k] * stay / 2;
        all->rows[all->count] = (panel){.piece = end / 2, .next = *link, .base = p->base, .origin = p->local.o, .duration = stay};
        *link = all->count++;
    }
    return DONE;
}

void rod_panels_free(panels *all)
{
    free(all->rows);
    free(all->series);
    *all = (panels){0};
}
