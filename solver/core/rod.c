/* Half periods of beta by Taylor's method, and what is read of them. C11, libm only.

   A leg goes from the start of the rod to the turning point ahead or behind, or once round. It keeps its series for
   reading, the transfer matrix of a change of its start for the condition number, and the covariance of what its steps
   leave out and round off, carried along by the steps' own transfer matrices. */

#include "orbit_parts.h"

#define ORDER 20
#define MOST 60    /* steps of a leg: more are needed only next to a saddle or by very large loads */
#define LOOKS 2    /* at each step, where the growth of a change is looked at */
#define STEADY 1e6 /* a growth beyond this leaves the march too few digits to tell where the orbit goes */
#define SERIES (4 * (ORDER + 1)) /* numbers kept of a step: the series of beta, alpha, z and the swirl */

enum { B, V, S, C, S2, C2, RATE, ETA, ZETA, ROWS };
enum { LOST, TURNS, GOES_ROUND, GOES_ON };

/* What is known of a leg. */
typedef struct {
    double time, alpha, z, swirl, error, late, fastest, steps, amplitude, e11, e12, e21, e22;
} leg;

/* What is known of an orbit. sound: the error is within the tolerance and far below a radian, and the condition number
   is finite. evaluations: derivatives of the equation that were computed. first: the number of its first step, where they
   are kept. */
typedef struct {
    double error, condition;
    leg legs[2];
    int64_t status[2], count[2], sound, evaluations, first;
} orbit;

/* Room for steps, those of one orbit after the other, in any order: since (room,), width (room,) and series (room, 4,
   ORDER + 1). used: how many there are, beyond the room those for which there is none. */
typedef struct {
    int64_t room, used;
    double *since, *width, *series;
} step_room;

static double crossing(const double *row, int n, double level, double h)
{
    double lo = 0, hi = h, x = h;
    const int above = value_1(row, n, h) > level;
    for (int round = 0; round < 60; round++) {
        double rate;
        const double y = value_and_rate_1(row, n, x, &rate);
        if (y == level)
            return x;
        if ((y > level) == above)
            hi = x;
        else
            lo = x;
        double next = rate != 0 ? x - (y - level) / rate : -INFINITY;
        if (!(lo < next && next < hi))
            next = (lo + hi) / 2;
        if (fabs(next - x) <= 1e-16 * h)
            return next;
        x = next;
    }
    return x;
}

/* S E^-1 S E with S = diag(1, -1), det E = 1: the transfer out to a turning point and back. */
static void and_back(const leg *e, double out[4])
{
    out[0] = out[3] = e->e22 * e->e11 + e->e12 * e->e21;
    out[1] = 2 * e->e12 * e->e22, out[2] = 2 * e->e11 * e->e21;
}

typedef struct {
    double span, period, rounds, more[4]; /* more: what the transfer of one period adds */
} times;

/* The largest growth of beta at the first n nodes of a leg travelled one way, at the times begin + sign t. */
static double most_of(const double *grown, int n, const double m[4], double sign, double begin, const times *when,
                      double weight, double best)
{
    for (int k = 0; k < n; k++) {
        const double time = begin + sign * grown[3 * k];
        if (time > when->span * (1 + 4 * EPS))
            continue;
        const double p = grown[3 * k + 1], q = grown[3 * k + 2];
        double x = p * m[0] + q * m[2], y = p * m[1] + q * m[3];
        best = max_1(best, max_1(fabs(x), weight * fabs(y)));
        if (when->rounds > 0) {
            const double many = time + when->rounds * when->period <= when->span ? when->rounds : when->rounds - 1;
            const double xx = x + many * (x * when->more[0] + y * when->more[2]);
            y = y + many * (x * when->more[1] + y * when->more[3]), x = xx;
            best = max_1(best, max_1(fabs(x), weight * fabs(y)));
        }
    }
    return best;
}

/* The largest values on [0, span] of the two solutions of eta_tt = -rate eta that begin as 1 and as t. */
static void largest(double rate, double span, double *even, double *odd)
{
    const double root = sqrt(fabs(rate)), angle = smaller(root * span, 700.0);
    *even = 1, *odd = span;
    if (!(angle > 1e-150))
        return;
    if (rate > 0)
        *odd = (angle < PI / 2 ? sin(angle) : 1.0) / root;
    else
        *even = cosh(angle), *odd = sinh(angle) / root;
}

double rod_weight_of(const start_problem *p)
{
    double s, c;
    sin_cos_1(p->beta0, &s, &c);
    return larger(larger(1, fabs(p->dbeta0)), sqrt(fabs(slope_rate_by(p->lam, p->mu, p->phi, s, c))));
}

int rod_beside_helix(const start_problem *p, double weight, double *condition)
{
    const double lam = p->lam, mu = p->mu, phi = p->phi, span = p->span;
    double s, c, third;
    sin_cos_1(p->beta0, &s, &c);
    const double force = slope_by(lam, mu, phi, s, c), rate = slope_rate_by(lam, mu, phi, s, c);
    const double second = higher_rates_by(lam, mu, phi, s, c, &third);
    double even, odd, half, unused;
    largest(rate, span, &even, &odd);
    largest(rate, span / 2, &unused, &half);
    const double strays = fabs(p->dbeta0) * odd + 2 * fabs(force) * half * half;
    const double change = fabs(second) * strays + (fabs(lam) + 8 * fabs(mu) + fabs(phi) + 20) * strays * strays / 2;
    const double root = sqrt(fabs(rate)), time = root > 0 ? smaller(span, 1 / root) : span;
    *condition = larger(1.0, larger(even, odd * weight));
    return change * span * time < 0.1;
}

/* Error and condition of an orbit from its legs.

   At the end of the way out the transfer is E; reflected at the turning point it comes back as S E^-1 S E, and the way
   back is the way out's own transfer applied to S times that. A period adds a multiple of one shear. */
static void judge(const start_problem *p, double weight, const double *grown[2], orbit *o)
{
    const double span = p->span;
    const leg *l = o->legs;
    const int swings = o->status[0] == TURNS, n = (int)o->count[0] * LOOKS, k = (int)o->count[1] * LOOKS;
    const double ahead = l[0].time, back = l[1].time, period = swings ? 2 * (ahead + back) : ahead;
    times when = {span, period, floor(span / period), {0}};
    double out[4] = {1, 0, 0, 1}, whole[4], other[4];
    if (swings) {
        and_back(&l[0], out);
        memcpy(whole, out, sizeof out);
        if (k > 0) {
            and_back(&l[1], other);
            for (int i = 0; i < 2; i++)
                for (int j = 0; j < 2; j++)
                    whole[2 * i + j] = other[2 * i] * out[j] + other[2 * i + 1] * out[2 + j];
        }
    } else
        whole[0] = l[0].e11, whole[1] = l[0].e12, whole[2] = l[0].e21, whole[3] = l[0].e22;
    for (int i = 0; i < 4; i++)
        when.more[i] = whole[i] - (i == 0 || i == 3);
    const double unit[4] = {1, 0, 0, 1};
    double best = most_of(grown[0], n, unit, 1, 0, &when, weight, 1);
    if (swings) {
        const double turned[4] = {out[0], out[1], -out[2], -out[3]};
        best = most_of(grown[0], n, turned, -1, 2 * ahead, &when, weight, best);
        if (k > 0) {
            const double again[4] = {whole[0], whole[1], -whole[2], -whole[3]};
            best = most_of(grown[1], k, out, 1, 2 * ahead, &when, weight, best);
            best = most_of(grown[1], k, again, -1, period, &when, weight, best);
        }
    }
    /* what the products of large transfers round off, as often as it is repeated */
    double most = 1;
    for (int part = 0; part < 2; part++)
        for (int i = 0; i < (part ? k : n); i++)
            most = max_1(most, max_1(fabs(grown[part][3 * i + 1]), fabs(grown[part][3 * i + 2]) * weight));
    o->condition = EPS * most * most * larger(1, when.rounds) < 0.1 * best ? best : INFINITY;
    double late = when.rounds * l[0].late;
    if (swings) {
        late = 2 * (when.rounds + (span > when.rounds * period + ahead)) * l[0].late;
        late += 2 * (when.rounds + (span > when.rounds * period + 2 * ahead + back)) * l[1].late;
    }
    const double fastest = larger(l[0].fastest, l[1].fastest);
    double shift = fastest * late;
    if (swings)
        shift = smaller(shift, l[0].amplitude + l[1].amplitude);
    o->error = rod_tuning.safety * (larger(l[0].error, l[1].error) + shift) + EPS * (span * fastest + larger(1, fabs(p->beta0)));
}

/* Whether the numbers of a problem can be squared. */
static int in_range(const start_problem *p)
{
    const double most = larger(larger(larger(fabs(p->lam), fabs(p->mu)), larger(fabs(p->phi), fabs(p->span))),
                               larger(fabs(p->beta0), fabs(p->dbeta0)));
    return most < 1e100 && p->span > 1e-200;
}

/* What a step may leave out of beta: an error of the time repeats in each period. */
static double goal_of(const start_problem *p, double tol)
{
    return larger(0.002 * tol / larger(1, p->span * steepness_of(p->lam, p->mu, p->phi) / 6), 1e-17);
}

/* Where the values at stations go, each (rods, stations): the first four, or alpha and z alone, and swirl; others are NULL. */
typedef struct {
    double *beta, *rate, *alpha, *z, *swirl;
} values;

enum { AT_ONCE = 512, PAD = 8 }; /* stations that are read together; what a group may write beyond its end */

/* Of each station: the time within a leg, the direction, in which leg, and what is added to beta, alpha, z, swirl. */
typedef struct {
    double local[AT_ONCE + PAD], sign[AT_ONCE + PAD], more[4][AT_ONCE + PAD];
    int64_t second[AT_ONCE + PAD];
} places;

/* The steps of the rod that is being marched: room for both its legs. */
typedef struct {
    double since[2 * MOST], width[2 * MOST], series[2 * MOST * SERIES], grown[2][MOST * LOOKS * 3];
} room;

/* How an orbit is read at its stations; each width of lanes has its own, and all give the same bits. */
typedef void reader(const orbit *, const double *, const double *, const double *, const double *, int64_t,
                    const values *, int64_t);

/* The problems from `begin` to `end`, the allowed error of beta, and what is done with each orbit: it is read at `stations`
   times t (rods, stations), and its steps are kept where there is room for them. */
typedef struct {
    int64_t begin, end, stations;
    const start_problem *rods;
    double tol;
    reader *read;
    const double *t;
    values out;
    step_room *kept;
} task;

static void settle(const task *work, int64_t rod, orbit *o, const room *own)
{
    const start_problem *p = &work->rods[rod];
    const double *grown[2] = {own->grown[0], own->grown[1]}, weight = rod_weight_of(p);
    double steady;
    judge(p, weight, grown, o);
    if (rod_beside_helix(p, weight, &steady))
        o->condition = steady;
    o->sound = o->error <= smaller(work->tol, rod_tuning.shapeless) && o->condition < INFINITY;
    o->evaluations = ORDER * (o->count[0] + o->count[1]);
    if (work->stations > 0)
        work->read(o, own->since, own->width, own->series, work->t + rod * work->stations, work->stations, &work->out,
                   rod * work->stations);
    step_room *kept = work->kept;
    const int64_t steps = o->count[0] + o->count[1];
    if (!kept)
        return;
    o->first = __atomic_fetch_add(&kept->used, steps, __ATOMIC_RELAXED); /* several threads share the room */
    if (o->first + steps > kept->room)
        return;
    memcpy(kept->since + o->first, own->since, sizeof(double) * steps);
    memcpy(kept->width + o->first, own->width, sizeof(double) * steps);
    memcpy(kept->series + SERIES * o->first, own->series, sizeof(double) * SERIES * steps);
}

#define LANES "lanes.h"
#include "widths.h"

#ifndef ROD_SOURCES
#define ROD_SOURCES ""
#endif

/* A digest of the sources, by which the loader recognises a library that was compiled from others. */
const char *rod_sources(void) { return ROD_SOURCES; }

#if defined(__x86_64__)
#include <cpuid.h>

/* 8 where the processor and the system hold eight numbers in a register (AVX-512 F and DQ), 4 (AVX2), else 2.
   Not by __builtin_cpu_supports, which finds nothing in a library that zig has compiled. */
static int widest(void)
{
    unsigned a, b, c, d, saved, unused;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c >> 27 & 1)) /* OSXSAVE */
        return 2;
    __asm__("xgetbv" : "=a"(saved), "=d"(unused) : "c"(0));
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d))
        return 2;
    if ((saved & 0xe6) == 0xe6 && (b >> 16 & 1) && (b >> 17 & 1))
        return 8;
    return (saved & 6) == 6 && (b >> 5 & 1) ? 4 : 2;
}
#endif

/* The widest lanes that the processor has; slow on a virtual machine, so callers ask once and keep the answer. */
int rod_lanes(void)
{
#if defined(__x86_64__)
    return widest();
#else
    return 2;
#endif
}

static values values_in(double *out, int64_t each, double *swirl)
{
    return out ? (values){out, out + each, out + 2 * each, out + 3 * each, swirl} : (values){.swirl = swirl};
}

static reader *reader_for(int64_t most) { return FOR_WIDTH(most > 2 ? most : 2, read); }

/* March the problems from `begin` to `end` of n, (n, 6), read each at its times t (n, stations), and keep its steps.

   tol: the allowed error of beta. orbits: (n,), filled. out: (4, n, stations), beta, beta_t, alpha and z, and swirl: (n,
   stations), filled but for rods that are lost; each may be NULL. kept: room for the steps, or NULL, and none is kept. lanes:
   their width, 0 for the widest that the problems fill; most: what rod_lanes says. Returns 0, or 1 if there is no memory. */
int rod_march(int64_t begin, int64_t end, int64_t n, const start_problem *rods, double tol, orbit *orbits, int64_t stations,
              const double *t, double *out, double *swirl, step_room *kept, int64_t lanes, int64_t most)
{
    const int64_t w = lanes > 0 && lanes <= most ? lanes : end - begin < most ? 1 : most;
    const task work = {
        .begin = begin, .end = end, .stations = out || swirl ? stations : 0, .rods = rods, .tol = tol,
        .read = reader_for(most), .t = t, .out = values_in(out, n * stations, swirl), .kept = kept,
    };
    return FOR_WIDTH(w, run)(&work, orbits);
}

/* Read alpha and z of one of the orbits whose steps were kept, as `rod_march` does, (stations,); NaN where it is
   lost. most: as above. */
void rod_read(int64_t rod, const orbit *orbits, const step_room *kept, int64_t stations, const double *t, double *alpha,
              double *z, int64_t most)
{
    const values to = {.alpha = alpha, .z = z};
    const int64_t at = orbits[rod].first;
    if (orbits[rod].status[0] != LOST)
        reader_for(most)(&orbits[rod], kept->since + at, kept->width + at, kept->series + SERIES * at, t, stations, &to, 0);
    else
        for (int64_t i = 0; i < stations; i++)
            alpha[i] = z[i] = NAN;
}
