/* One half period of beta by Taylor's method, W problems at a time: one lane a problem.

   Included once for each width W; NAME(x) gives each function its own name. Every lane does the same operations in the
   same order whatever W is and whatever its neighbours are, so results are equal to the bit for all widths.

   H = lam cos b - mu cos 2b - phi sin b - sin(2b)/2 + sin(4b)/4, eq. (35) with its products written as multiple
   angles: every coefficient of the series of sin and cos follows from lower ones by sums of products. */

#include "vectors.h"

typedef struct {
    vec w[ROWS][ORDER + 1]; /* the series of the step */
    vec lam, mu, phi, goal, longest, heights, limit, beta0, way;
    vec beta, v, t, integral[3]; /* integral: of sin, cos and sin cos of beta since the start */
    vec a, b, c, d;              /* transfer matrix of a change of the start */
    vec pbb, pbv, pvv, lb, lv;   /* covariance of the errors of beta and beta_t; effect of the rounded loads */
    vec worst, fastest;
    int64_t rod[W];
    int part[W], step[W], used[W]; /* the rod of each lane (-1: none), its leg, the steps of this leg, of both */
    double *since[W], *width[W], *series[W], *grown[W];
} NAME(lanes);

/* Fills the table with the series about the points where beta and beta_t of each lane are. */
static inline TARGET void NAME(expand)(NAME(lanes) *p)
{
    vec(*w)[ORDER + 1] = p->w;
    const vec zero = ZERO, one = zero + 1.0;
    const vec lam = p->lam, mu = p->mu, phi = p->phi;
    w[B][0] = p->beta, w[B][1] = w[V][0] = p->v;
    NAME(sin_cos)(p->beta, &w[S][0], &w[C][0]);
    w[ETA][0] = one, w[ETA][1] = zero, w[ZETA][0] = zero, w[ZETA][1] = one;
    UNROLLED
    for (int k = 0; k < ORDER; k++) {
        const double share = 1.0 / (k + 1.0), both = -1.0 / ((k + 1.0) * (k + 2.0));
        w[S][k + 1] = NAME(product)(w[V], w[C], k) * share;
        w[C][k + 1] = NAME(product)(w[V], w[S], k) * -share;
        if (k == ORDER - 1)
            break;
        w[S2][k] = 2.0 * NAME(product)(w[S], w[C], k);
        w[C2][k] = (k == 0) - 2.0 * NAME(square)(w[S], k);
        const vec s4 = NAME(product)(w[S2], w[C2], k), c4 = (k == 0) - 2.0 * NAME(square)(w[S2], k);
        const vec force = lam * w[C][k] - mu * w[C2][k] - phi * w[S][k] - 0.5 * w[S2][k] + 0.5 * s4;
        w[RATE][k] = -lam * w[S][k] + 2.0 * mu * w[S2][k] - phi * w[C][k] - w[C2][k] + c4;
        w[V][k + 1] = force * -share;
        w[B][k + 2] = force * both;
        w[ETA][k + 2] = NAME(product)(w[RATE], w[ETA], k) * both;
        w[ZETA][k + 2] = NAME(product)(w[RATE], w[ZETA], k) * both;
    }
    w[V][ORDER] = w[S2][ORDER - 1] = zero;
}

/* The distance at which the last four terms of the series are below `goal`: one or two may vanish by chance. */
static inline TARGET vec NAME(reach)(const NAME(lanes) *p)
{
    vec least = ZERO + INFINITY;
    for (int k = ORDER - 3; k <= ORDER; k++) {
        const vec s = vabs(p->w[S][k - 1]), c = vabs(p->w[C][k - 1]);
        const vec size = vmax(vabs(p->w[B][k]), vmax(s, c) / (double)k);
        const vec power = (p->goal - NAME(log_2)(size)) / (double)k;
        least = PICK(MASK(size > 0) & MASK(power < least), power, least);
    }
    return NAME(exp_2)(least);
}

/* What the series of beta leaves out at h: a geometric rest, its ratio that of the last eight terms. */
static inline TARGET vec NAME(left_out)(const NAME(lanes) *p, vec h)
{
    const vec tiny = ZERO + 1e-300, most = ZERO + 0.8;
    vec power = h, earlier = ZERO, last = ZERO, sizes[8];
    for (int k = 0; k < ORDER - 8; k++)
        power *= h;
    for (int k = 0; k < 8; k++, power *= h)
        sizes[k] = vabs(p->w[B][ORDER - 7 + k]) * power;
    for (int k = 0; k < 4; k++)
        earlier = vmax(earlier, sizes[k]), last = vmax(last, sizes[4 + k]);
    const vec share = vroot(vroot(last / vmax(earlier, tiny))), ratio = PICK(MASK(share < most), share, most);
    power = ZERO + 1.0, last = ZERO;
    for (int k = 7; k >= 4; k--, power *= ratio)
        last = vmax(last, sizes[k] * power);
    return last * ratio / (1.0 - ratio);
}

/* Where in [0, h] the series of a lane passes `level`; monotone there, or with one change of sign of the distance. */
static TARGET double NAME(crossing)(const vec *row, int lane, int n, double level, double h)
{
    double c[ORDER + 1];
    (void)lane;
    for (int k = 0; k <= n; k++)
        c[k] = LANE(row[k], lane);
    return crossing(c, n, level, h);
}

/* The series that are kept for reading: beta and the integrals of sin, cos and sin cos of it. */
static inline TARGET void NAME(keep)(NAME(lanes) *p, vec kept[4][ORDER + 1])
{
    kept[0][0] = p->w[B][0];
    for (int m = 1; m < 4; m++)
        kept[m][0] = p->integral[m - 1];
    for (int i = 0; i < ORDER; i++) {
        const double share = 1.0 / (i + 1);
        kept[0][i + 1] = p->w[B][i + 1];
        kept[1][i + 1] = p->w[S][i] * share;
        kept[2][i + 1] = p->w[C][i] * share;
        kept[3][i + 1] = p->w[S2][i] * share / 2.0;
    }
}

/* One step of every lane. end: how the leg of each lane goes on (GOES_ON) or ends; late: the error of the time then. */
static TARGET void NAME(advance)(NAME(lanes) *p, int end[W], double late[W], double at[W])
{
    NAME(expand)(p);
    const vec one = ZERO + 1.0;
    vec h, far, speed;
    h = NAME(reach)(p);
    h = PICK(MASK(h < p->longest), h, p->longest);
    for (int i = 0; i < W; i++)
        end[i] = LANE(h, i) > 0 ? GOES_ON : LOST;
    far = NAME(value)(p->w[V], ORDER - 1, h);
    for (int i = 0; i < W; i++)
        if (p->step[i] == 0 && LANE(p->way, i) == 0)
            LANE(p->way, i) = (LANE(far, i) > 0) - (LANE(far, i) < 0);
    far = NAME(value_and_rate)(p->w[B], ORDER, h, &speed);
    for (int i = 0; i < W; i++) {
        if (end[i] == LOST || p->rod[i] < 0)
            continue;
        if (LANE(speed, i) * LANE(p->way, i) < 0) {
            LANE(h, i) = NAME(crossing)(p->w[V], i, ORDER - 1, 0.0, LANE(h, i));
            end[i] = TURNS;
        } else if (fabs(LANE(far, i) - LANE(p->beta0, i)) >= 2 * PI) {
            LANE(h, i) = NAME(crossing)(p->w[B], i, ORDER, LANE(p->beta0, i) + LANE(p->way, i) * 2 * PI, LANE(h, i));
            end[i] = GOES_ROUND;
        }
    }
    vec kept[4][ORDER + 1];
    NAME(keep)(p, kept);
    const vec ends = p->t + h;
    vec x, e, f, ev, fv;
    int last[W];
    for (int i = 0; i < W; i++) {
        last[i] = LANE(p->t, i) < LANE(p->limit, i) && LANE(p->limit, i) < LANE(ends, i);
        LANE(x, i) = last[i] ? LANE(p->limit, i) - LANE(p->t, i) : LANE(h, i) / 2;
    }
    const vec size = vmax(one, vabs(p->beta));
    e = NAME(value)(p->w[ETA], ORDER, x), f = NAME(value)(p->w[ZETA], ORDER, x);
    int any = 0;
    for (int i = 0; i < W; i++)
        any |= last[i];
    if (any) {
        const vec here = vroot(e * e * p->pbb + 2.0 * e * f * p->pbv + f * f * p->pvv) + vabs(e * p->lb + f * p->lv) +
                         NAME(left_out)(p, x) + EPS * (size + p->heights * x * x) / 2.0;
        for (int i = 0; i < W; i++)
            if (last[i])
                LANE(p->worst, i) = max_1(LANE(p->worst, i), LANE(here, i));
    }
    const vec middle[3] = {p->t + x, e * p->a + f * p->c, e * p->b + f * p->d};
    e = NAME(value_and_rate)(p->w[ETA], ORDER, h, &ev);
    f = NAME(value_and_rate)(p->w[ZETA], ORDER, h, &fv);
    const vec far_nodes[3] = {ends, e * p->a + f * p->c, e * p->b + f * p->d};
    p->c = ev * p->a + fv * p->c, p->d = ev * p->b + fv * p->d;
    p->a = far_nodes[1], p->b = far_nodes[2];
    const vec out = NAME(left_out)(p, h);
    const vec qb = out + EPS * size / 2.0;
    const vec qv = out * (ORDER + 1.0) / h + EPS * (vabs(p->v) + p->heights * h) / 2.0;
    const vec pbb = e * e * p->pbb + 2.0 * e * f * p->pbv + f * f * p->pvv + qb * qb;
    const vec pbv = e * ev * p->pbb + (e * fv + f * ev) * p->pbv + f * fv * p->pvv;
    p->pvv = ev * ev * p->pbb + 2.0 * ev * fv * p->pbv + fv * fv * p->pvv + qv * qv;
    p->pbb = pbb, p->pbv = pbv;
    const vec lb = e * p->lb + f * p->lv + EPS * p->heights * h * h / 4.0;
    p->lv = ev * p->lb + fv * p->lv + EPS * p->heights * h / 2.0;
    p->lb = lb;
    const vec eb = vroot(p->pbb) + vabs(p->lb), es = vroot(p->pvv) + vabs(p->lv);
    p->fastest = vmax(p->fastest, vabs(NAME(value)(p->w[V], ORDER - 1, h / 2.0)));
    p->beta = NAME(value_and_rate)(p->w[B], ORDER, h, &p->v);
    p->fastest = vmax(p->fastest, vabs(p->v));
    vec bend;
    NAME(value_and_rate)(p->w[V], ORDER - 1, h, &bend);
    for (int m = 1; m < 4; m++)
        p->integral[m - 1] = NAME(value)(kept[m], ORDER, h);
    for (int i = 0; i < W; i++) {
        if (p->rod[i] < 0)
            continue;
        const int k = p->used[i];
        double *series = p->series[i] + 4 * (ORDER + 1) * k, *grown = p->grown[i] + 3 * LOOKS * p->step[i];
        p->since[i][k] = LANE(p->t, i), p->width[i][k] = LANE(h, i);
        for (int m = 0; m < 4; m++)
            for (int j = 0; j <= ORDER; j++)
                series[m * (ORDER + 1) + j] = LANE(kept[m][j], i);
        for (int m = 0; m < 3; m++)
            grown[m] = LANE(middle[m], i), grown[3 + m] = LANE(far_nodes[m], i);
        const double by_angle = max_1(fabs(LANE(p->a, i)), fabs(LANE(p->c, i)));
        const double most = max_1(by_angle, max_1(fabs(LANE(p->b, i)), fabs(LANE(p->d, i))));
        if (!(most < STEADY))
            end[i] = LOST;
        if (LANE(ends, i) <= LANE(p->limit, i))
            LANE(p->worst, i) = max_1(LANE(p->worst, i), LANE(eb, i));
        late[i] = end[i] == TURNS ? LANE(es, i) / fabs(LANE(bend, i)) : LANE(eb, i) / fabs(LANE(p->v, i));
        at[i] = LANE(ends, i);
        p->used[i]++, p->step[i]++;
        if (end[i] == GOES_ON && p->step[i] == MOST)
            end[i] = LOST;
    }
    p->t = ends;
}

/* alpha and z, and where wanted beta and beta_t, at W stations of one step, which share its coefficients. */
static inline ALWAYS TARGET void NAME(stations)(const double *series, const double *x, int angles, NAME(loose) out[4])
{
    const NAME(loose) at = *(const NAME(loose) *)x, zero = {0};
    const double *c0 = series, *c1 = series + ORDER + 1, *c2 = series + 2 * (ORDER + 1);
    NAME(loose) b = zero + c0[ORDER], v = zero, a = zero + c1[ORDER], h = zero + c2[ORDER];
    for (int k = ORDER - 1; k >= 0; k--) {
        if (angles)
            v = v * at + b, b = b * at + c0[k];
        a = a * at + c1[k];
        h = h * at + c2[k];
    }
    out[0] = b, out[1] = v, out[2] = a, out[3] = h;
}

/* The integral of sin(beta) cos(beta) at W stations of one step. */
static inline TARGET NAME(loose) NAME(swirl)(const double *series, const double *x)
{
    const NAME(loose) at = *(const NAME(loose) *)x, zero = {0};
    const double *c = series + 3 * (ORDER + 1);
    NAME(loose) total = zero + c[ORDER];
    for (int k = ORDER - 1; k >= 0; k--)
        total = total * at + c[k];
    return total;
}

/* Where the times are in the period of the orbit, and what the periods before have added. */
static TARGET void NAME(fold)(const orbit *o, double turn, const double *t, int m, places *p)
{
    const NAME(loose) zero = {0};
    const int swings = o->status[0] == TURNS;
    const NAME(mask) swinging = (NAME(mask)){0} - swings;
    const NAME(mask) twofold = (NAME(mask)){0} - (swings && o->count[1] > 0); /* at rest at its start a rod has one leg */
    const leg *l = o->legs;
    const double ahead = l[0].time, back = swings ? l[1].time : 0, period = swings ? 2 * (ahead + back) : ahead;
    const double gains[3][2] = {{l[0].alpha, l[1].alpha}, {l[0].z, l[1].z}, {l[0].swirl, l[1].swirl}};
    for (int j = 0; j < m; j += W) {
        NAME(loose) time = {0};
        memcpy(&time, t + j, sizeof(double) * (m - j < W ? m - j : W));
        NAME(loose) rounds = time / period;
        for (int i = 0; i < W; i++)
            LANE(rounds, i) = floor(LANE(rounds, i));
        const NAME(loose) left = time - rounds * period, rest = PICK(MASK(left > 0), left, zero);
        const NAME(mask) second = twofold & MASK(rest > 2 * ahead);
        const NAME(loose) along = PICK(second, rest - 2 * ahead, rest), length = PICK(second, zero + back, zero + ahead);
        const NAME(mask) mirrored = swinging & MASK(along > length);
        const NAME(loose) turned = 2 * length - along, inside = PICK(MASK(turned > 0), turned, zero);
        *(NAME(loose) *)(p->local + j) = PICK(mirrored, inside, along);
        *(NAME(loose) *)(p->sign + j) = PICK(mirrored, zero - 1.0, zero + 1.0);
        *(NAME(mask) *)(p->second + j) = second;
        *(NAME(loose) *)(p->more[0] + j) = turn * rounds;
        for (int i = 0; i < 3; i++) {
            const double *g = gains[i], whole = swings ? 2 * (g[0] + g[1]) : g[0];
            const NAME(loose) reflected = PICK(second, zero + 2 * g[1], zero + 2 * g[0]);
            *(NAME(loose) *)(p->more[i + 1] + j) =
                rounds * whole + PICK(second, zero + 2 * g[0], zero) + PICK(mirrored, reflected, zero);
        }
    }
}

/* The values of an orbit at t[0 .. n), written to `out` from `offset` on. Stations of one step are read together.

   since, width, series: of the steps of both legs, one leg after the other. */
static TARGET void NAME(read)(const orbit *o, const double *since, const double *width, const double *series,
                              const double *t, int64_t n, const values *out, int64_t offset)
{
    const int swings = o->status[0] == TURNS, first = (int)o->count[0], steps = first + (int)o->count[1];
    const double turn = swings ? 0.0 : series[1] > 0 ? 2 * PI : series[1] < 0 ? -2 * PI : 0.0;
    places p;
    double x[AT_ONCE + PAD], read[5][AT_ONCE + PAD];
    int step[AT_ONCE], place[AT_ONCE], from[2 * MOST + 1];
    for (int64_t done = 0; done < n; done += AT_ONCE) {
        const int m = (int)(n - done < AT_ONCE ? n - done : AT_ONCE);
        NAME(fold)(o, turn, t + done, m, &p);
        memset(from, 0, sizeof(int) * (steps + 1));
        for (int j = 0, k = 0; j < m; j++) {
            const int low = p.second[j] ? first : 0, high = p.second[j] ? steps : first;
            k = k < low ? low : k >= high ? high - 1 : k;
            while (k > low && p.local[j] < since[k])
                k--;
            while (k + 1 < high && p.local[j] >= since[k + 1])
                k++;
            step[j] = k, from[k + 1]++;
        }
        for (int i = 0; i < steps; i++)
            from[i + 1] += from[i];
        for (int j = 0; j < m; j++) {
            const int k = step[j], i = from[k]++;
            place[j] = i;
            x[i] = smaller(p.local[j] - since[k], width[k]);
        }
        for (int i = 0; i < PAD; i++)
            x[m + i] = 0;
        /* a group of W writes beyond the end of its step; the next step writes over that */
        for (int i = 0, j = 0; i < steps; j = from[i++])
            for (; j < from[i]; j += W) {
                const double *own = series + SERIES * (int64_t)i;
                NAME(loose) group[4];
                if (out->beta)
                    NAME(stations)(own, x + j, 1, group);
                else if (out->alpha)
                    NAME(stations)(own, x + j, 0, group);
                for (int q = out->beta ? 0 : 2; out->alpha && q < 4; q++)
                    *(NAME(loose) *)(read[q] + j) = group[q];
                if (out->swirl)
                    *(NAME(loose) *)(read[4] + j) = NAME(swirl)(own, x + j);
            }
        for (int j = 0; out->alpha && j < m; j++) {
            const int64_t i = place[j], k = offset + done + j;
            if (out->beta)
                out->beta[k] = read[0][i] + p.more[0][j], out->rate[k] = p.sign[j] * read[1][i];
            out->alpha[k] = p.sign[j] * read[2][i] + p.more[1][j];
            out->z[k] = p.sign[j] * read[3][i] + p.more[2][j];
        }
        for (int j = 0; out->swirl && j < m; j++)
            out->swirl[offset + done + j] = p.sign[j] * read[4][place[j]] + p.more[3][j];
    }
}

/* The lane takes rod i, or nothing where i < 0; its leg `part` begins. */
static TARGET void NAME(begin)(NAME(lanes) *p, int lane, int part, const start_problem *q, double goal, double limit)
{
    const double v = part ? -q->dbeta0 : q->dbeta0;
    LANE(p->lam, lane) = q->lam, LANE(p->mu, lane) = q->mu, LANE(p->phi, lane) = q->phi;
    LANE(p->goal, lane) = log_2_1(goal), LANE(p->limit, lane) = limit;
    LANE(p->heights, lane) = fabs(q->lam) + fabs(q->mu) + fabs(q->phi) + 1;
    /* two zeros of beta_t lie at least pi / sqrt(max H') apart (Sturm): no step holds two */
    LANE(p->longest, lane) = 3.0 / steepness_of(q->lam, q->mu, q->phi);
    LANE(p->beta0, lane) = LANE(p->beta, lane) = q->beta0;
    LANE(p->v, lane) = v, LANE(p->way, lane) = (v > 0) - (v < 0);
    LANE(p->t, lane) = 0;
    LANE(p->integral[0], lane) = LANE(p->integral[1], lane) = LANE(p->integral[2], lane) = 0;
    LANE(p->a, lane) = LANE(p->d, lane) = 1, LANE(p->b, lane) = LANE(p->c, lane) = 0;
    LANE(p->pbb, lane) = LANE(p->pbv, lane) = LANE(p->pvv, lane) = LANE(p->lb, lane) = LANE(p->lv, lane) = 0;
    LANE(p->worst, lane) = 0, LANE(p->fastest, lane) = fabs(v);
    p->part[lane] = part, p->step[lane] = 0;
}

/* What is known of the leg that a lane has finished. */
static TARGET void NAME(finish)(const NAME(lanes) *p, int lane, double late, double at, leg *l)
{
    l->time = at;
    l->alpha = LANE(p->integral[0], lane), l->z = LANE(p->integral[1], lane), l->swirl = LANE(p->integral[2], lane);
    l->error = LANE(p->worst, lane), l->late = late, l->fastest = LANE(p->fastest, lane);
    l->steps = p->step[lane], l->amplitude = fabs(LANE(p->beta, lane) - LANE(p->beta0, lane));
    l->e11 = LANE(p->a, lane), l->e12 = LANE(p->b, lane), l->e21 = LANE(p->c, lane), l->e22 = LANE(p->d, lane);
}

/* The lane takes rod i of the problems, if it can be solved at all. */
static TARGET int NAME(take)(NAME(lanes) *p, int lane, int64_t i, const task *work, room *own, orbit *o)
{
    const start_problem *q = &work->rods[i];
    memset(o, 0, sizeof *o);
    o->error = o->condition = INFINITY;
    if (!in_range(q))
        return 0;
    p->rod[lane] = i, p->used[lane] = 0;
    p->since[lane] = own->since, p->width[lane] = own->width, p->series[lane] = own->series;
    p->grown[lane] = own->grown[0];
    NAME(begin)(p, lane, 0, q, goal_of(q, work->tol), q->span);
    return 1;
}

/* March the rods, W at a time: a lane whose rod is done takes the next. `done` is called for each that is solved. */
static TARGET int NAME(run)(const task *work, orbit *orbits)
{
    static const start_problem idle = {0, 0, 0, 1, 0.5, 0};
    room *rooms = malloc(W * sizeof(room));
    /* aligned by hand: Windows has no aligned_alloc */
    char *memory = malloc(sizeof(NAME(lanes)) + 63);
    if (!rooms || !memory) {
        free(rooms), free(memory);
        return 1;
    }
    NAME(lanes) *p = (NAME(lanes) *)(((uintptr_t)memory + 63) & ~(uintptr_t)63);
    int64_t next = work->begin;
    int busy = 0, end[W];
    double late[W], at[W];
    for (int i = 0; i < W; i++)
        p->rod[i] = -1;
    for (;;) {
        for (int i = 0; i < W; i++) {
            for (; p->rod[i] < 0 && next < work->end; next++)
                busy += NAME(take)(p, i, next, work, rooms + i, orbits + next);
            if (p->rod[i] < 0) /* an idle lane marches a rod that nobody reads */
                NAME(begin)(p, i, 0, &idle, 1e-9, 0);
        }
        if (!busy)
            break;
        NAME(advance)(p, end, late, at);
        for (int i = 0; i < W; i++) {
            const int64_t rod = p->rod[i];
            if (rod < 0 || end[i] == GOES_ON)
                continue;
            const start_problem *q = &work->rods[rod];
            orbit *o = orbits + rod;
            const int part = p->part[i];
            o->status[part] = end[i];
            if (end[i] != LOST) {
                NAME(finish)(p, i, late[i], at[i], &o->legs[part]);
                o->count[part] = p->step[i];
                if (part == 0 && end[i] == TURNS && q->dbeta0 != 0) {
                    p->grown[i] = rooms[i].grown[1];
                    NAME(begin)(p, i, 1, q, goal_of(q, work->tol), q->span - 2 * o->legs[0].time);
                    continue;
                }
            }
            p->rod[i] = -1, busy--;
            if (end[i] == LOST || (part == 1 && end[i] != TURNS))
                o->status[0] = LOST, o->count[0] = o->count[1] = 0;
            else
                settle(work, rod, o, rooms + i);
        }
    }
    free(rooms), free(memory);
    return 0;
}

#undef W
#undef SUFFIX
