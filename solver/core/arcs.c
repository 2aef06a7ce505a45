/* The arcs of one orbit as pieces, from its start forward and backward to the turning points. */

#include "orbit_parts.h"

#define UNCERTAIN 64.0 /* times the rounding of an angle: how much the rounding of G may move the start */

local_potential rod_local(double lam, double mu, double phi, double o, double level)
{
    const double s = sin(o), c = cos(o);
    return (local_potential){lam, mu, phi, o, level, s, c, mu * (c - s) * (c + s), 2 * mu * s * c,
                             lam * s + phi * c - 2 * square(s * s)};
}

double rod_steepness(const local_potential *l, double x)
{
    const double sh = sin(x / 2), ch = cos(x / 2);
    double S, C, bracket;
    return steepness_by(l, sh, ch, near_of(l, sh, ch, &S, &C, &bracket));
}

double rod_drop(const local_potential *l, double x) { return square(sin(x / 2)) * rod_steepness(l, x); }

double rod_faintest(const local_potential *l) { return 1e-17 * (fabs(l->lam) + fabs(l->mu) + fabs(l->phi) + 1); }

double rod_weight(const local_potential *l, double reach)
{
    const double x = smaller(reach, 1);
    return fabs(l->lam) * fabs(l->s) + fabs(l->phi) * fabs(l->c) + fabs(l->bend) + fabs(l->turn) * x +
           square(fabs(l->s) + x);
}

typedef struct {
    const local_potential *local;
    double side, wanted;
} turning_point;

static void log_of_drop(const void *of, double y, double *value, double *rate)
{
    const turning_point *p = of;
    const local_potential *l = p->local;
    const double x = p->side * exp(y), sh = sin(x / 2), ch = cos(x / 2);
    double S, C, bracket;
    const double near = near_of(l, sh, ch, &S, &C, &bracket), K = steepness_by(l, sh, ch, near);
    const double cos_x = 1 - 2 * sh * sh, sin_x = 2 * sh * ch;
    const double fall = -C * (l->s * ch + l->c * sh) * bracket + 2 * C * C * (l->c * cos_x - l->s * sin_x) * (S + l->s);
    const double K_rate = 4 * (-l->turn * cos_x + l->bend * sin_x + fall);
    *rate = x * (1 / tan(x / 2) + K_rate / K);
    *value = log(sh * sh * fabs(K)) - p->wanted;
}

/* x with level + drop(x) = 0 between 0 and `limit`, to relative accuracy. */
static double turning(const local_potential *l, double limit)
{
    const turning_point p = {l, limit > 0 ? 1.0 : limit < 0 ? -1.0 : limit, log(fabs(l->level))};
    double known[8], y[8];
    int cell = 0;
    for (int k = 0; k < 8; k++) {
        known[k] = log(fabs(rod_drop(l, limit * (0.125 * (k + 1)))));
        y[k] = log(fabs(limit)) + log(0.125 * (k + 1));
        cell += known[k] < p.wanted;
    }
    cell = cell < 7 ? cell : 7;
    const double high = y[cell], low = cell ? y[cell - 1] : -700.0;
    const double rate = cell ? (known[cell] - known[cell - 1]) / (high - low) : 2.0;
    double guess = high + (p.wanted - known[cell]) / rate;
    if (!(guess >= low && guess <= high))
        guess = (low + high) / 2;
    return p.side * exp(rod_bracketed(log_of_drop, &p, low, high, guess));
}

/* a of x = a sinh(u): the distance from the saddle at which the speed grows */
static double passing_scale(const local_potential *l, double limit)
{
    const double bend = rod_steepness(l, 0) / 4, rise = rod_drop(l, limit) / (limit * limit);
    double a = sqrt(l->level / larger(bend, rise));
    /* a saddle with next to no curvature: the speed grows with a higher power of x */
    if (bend < 0.01 * rise && l->level < 0.1 * rise * (limit * limit))
        a = fabs(turning(l, limit));
    return isfinite(a) && a < 1e8 ? a : 1e8;
}

static double variable(int form, double scale, double x)
{
    const double ratio = x / scale;
    if (form == PASS)
        return asinh(ratio);
    return form == SADDLE ? acosh(larger(ratio, 1)) : asin(smaller(larger(ratio, -1), 1));
}

/* u at the start, from beta_t, which loses no digits next to a turning point; may move the scale of a first piece. */
double rod_start_variable(int form, double *scale, double x, double v, int first, const local_potential *l)
{
    const double root = rod_slope_over_root(l, *scale, x);
    const double sine = v == 0 ? 0.0 : fabs(v) / (fabs(*scale) * root);
    if (form == PASS)
        return asinh(x / *scale);
    const double u = form == SADDLE ? asinh(sine) : atan2(fabs(x / *scale), sine);
    const double doubt = first ? rod_weight(l, fabs(x)) / (root * root) : 0;
    if (!(doubt > UNCERTAIN))
        return u;
    if (doubt * square(sine) > UNCERTAIN)
        return variable(form, *scale, x);
    *scale = x / (form == SADDLE ? cosh(u) : sin(u));
    return u;
}

/* How far the nearest angle from pin is at which G is what it is at beta: beta itself, or its image under a symmetry of G.
   So mirror images are as high, where rounding would decide next to which of them a rod rests longer. */
static double nearest_as_high(double lam, double mu, double phi, double pin, double beta)
{
    const int even = lam == 0 && mu == 0, about_the_side = mu == 0 && phi == 0, half_a_turn = lam == 0 && phi == 0;
    const double images[] = {even ? -beta : beta, about_the_side ? PI - beta : beta, half_a_turn ? PI + beta : beta};
    double nearest = apart(beta, pin);
    for (int k = 0; k < 3; k++) {
        const double x = apart(wrapped(images[k]), pin);
        nearest = fabs(x) < fabs(nearest) ? x : nearest;
    }
    return nearest;
}

/* G(pin) less G(beta), to relative accuracy in beta - pin; 0 for angles far apart where it is less than rounding.
   extremum: whether pin is a critical point. */
double rod_fall(double lam, double mu, double phi, double pin, double beta, int extremum)
{
    const local_potential at = rod_local(lam, mu, phi, pin, 0);
    const double x = nearest_as_high(lam, mu, phi, pin, beta);
    double value = rod_drop(&at, x);
    if (!extremum)
        value -= 2 * slope(lam, mu, phi, pin) * sin(x);
    const int far = fabs(apart(beta, pin)) > 1e-3;
    return far && fabs(value) < 4e-16 * (1 + fabs(lam) + fabs(mu) + fabs(phi)) ? 0 : value;
}

/* G at every critical point less G at an angle, and the distance of the angle from it. */
static void falls(const start_problem *p, const critical *found, double angle, double *drop, double *x)
{
    for (int k = 0; k < found->count; k++) {
        x[k] = apart(angle, found->beta[k]);
        drop[k] = rod_fall(p->lam, p->mu, p->phi, found->beta[k], angle, 1);
    }
}

/* eta - G at every critical point. */
static void levels(const start_problem *p, const critical *found, double pinned, double gap, double *level)
{
    double drop[CRITICAL], x[CRITICAL], about[CRITICAL], unused[CRITICAL];
    int nearest = 0;
    falls(p, found, pinned, drop, x);
    for (int k = 1; k < found->count; k++)
        if (fabs(x[k]) < fabs(x[nearest]))
            nearest = k;
    if (x[nearest] != 0) {
        /* those of the same height as the nearest critical point must be as high as that point */
        const double own = drop[nearest];
        falls(p, found, found->beta[nearest], about, unused);
        for (int k = 0; k < found->count; k++)
            if (fabs(x[nearest]) < 1e-3 || about[k] == 0)
                drop[k] = about[k] + own;
    }
    for (int k = 0; k < found->count; k++) {
        /* within rounding of the saddle's own level either sign is as good; zero is not */
        const double floor = 2e-17 * (fabs(gap) + fabs(drop[k])) + 1e-300;
        level[k] = gap - drop[k];
        if (fabs(level[k]) < floor)
            level[k] = level[k] > 0 ? floor : -floor;
    }
}

/* How many critical points an orbit passes before the one that is too high; -1 where none is. */
static int blocked(const critical *found, const double *level, int behind, double direction)
{
    for (int rank = 0; rank < found->count; rank++)
        if (level[modulo(direction > 0 ? behind + 1 + rank : behind - rank, found->count)] <= 0)
            return rank;
    return -1;
}

/* The orbit that is cut into pieces. last, around: the rank of the piece that ends at the turning point, of the one
   that closes a whole turn; -1 for none. */
typedef struct {
    const start_problem *problem;
    const critical *found;
    const double *level;
    double start;
    int behind;
} whole;

/* The piece of one monotone interval of G; 0 where it has no length. */
static int piece_of(const whole *o, int arc, int rank, double sign, int last, int around, piece *out)
{
    const start_problem *p = o->problem;
    const critical *found = o->found;
    const int m = found->count, low = o->behind + (sign > 0 ? rank : -rank);
    const int i = modulo(low, m), j = modulo(low + 1, m);
    const double c_low = found->beta[i], c_high = found->beta[j], g_low = o->level[i], g_high = o->level[j];
    const double turn_low = TAU * ((low - i) / m), turn_high = TAU * ((low + 1 - j) / m);
    const double width = c_high - c_low + (j == 0 ? TAU : 0.0);
    if (width <= 0) /* between a saddle and a centre that coincide */
        return 0;
    /* the start in its interval, from either end (also one turn on, where a rotation closes) */
    double x_low = apart(o->start, c_low), x_high = apart(o->start, c_high);
    x_low = x_low < 0 ? x_low + TAU : x_low, x_high = x_high > 0 ? x_high - TAU : x_high;
    x_low = fabs(x_low) < TINY ? 0 : x_low, x_high = fabs(x_high) < TINY ? 0 : x_high;
    const int saddle_low = !found->centre[i], at_rest = fabs(p->dbeta0) < TINY;
    const double g_saddle = saddle_low ? g_low : g_high;
    const int passes = g_saddle > 0;
    /* the origin of x: the saddle, or the centre where the orbit turns on its half of the interval */
    local_potential local = rod_local(p->lam, p->mu, p->phi, saddle_low ? c_low : c_high, g_saddle);
    const double half = (saddle_low ? width : -width) / 2;
    const int near_centre = !passes && local.level + rod_drop(&local, half) < 0;
    const int on_low = saddle_low ^ near_centre;
    if (near_centre)
        local = rod_local(p->lam, p->mu, p->phi, on_low ? c_low : c_high, on_low ? g_low : g_high);
    const double x_start = on_low ? x_low : x_high, limit = on_low ? width : -width;
    double scale = passes ? passing_scale(&local, limit) : turning(&local, limit);
    if (!passes && at_rest && rank == 0) /* a rod that starts with beta_t = 0 starts at its turning point */
        scale = x_start;
    const double x_first = on_low ? 0.0 : -width, x_second = on_low ? width : 0.0;
    const int form = passes ? PASS : near_centre ? CENTRE : SADDLE;
    const double here = rod_start_variable(form, &scale, x_start, at_rest ? 0.0 : p->dbeta0, rank == 0, &local);
    const double u_from = variable(form, scale, sign > 0 ? x_first : x_second);
    const double u_to = variable(form, scale, sign > 0 ? x_second : x_first);
    const double base = (on_low ? c_low + turn_low : c_high + turn_high) + (p->beta0 - o->start);
    *out = (piece){arc, rank, form, base, scale, rank == 0 ? here : u_from,
                   rank == last ? (form == CENTRE ? PI / 2 : 0.0) : rank == around ? here : u_to, local};
    return out->u0 != out->u1;
}

int rod_arcs(const start_problem *p, double pin, double gap, const critical *found, arcs *out)
{
    double level[CRITICAL];
    const int m = found->count;
    const double start = wrapped(p->beta0), v = p->dbeta0;
    whole o = {p, found, level, start, -1};
    int near = 0;
    if (m < 2)
        return NOT_POSSIBLE;
    for (int k = 0; k < m; k++) {
        o.behind += found->beta[k] <= start;
        near |= fabs(apart(start, found->beta[k])) < TINY;
    }
    levels(p, found, pin, gap, level);
    const int rest = fabs(v) < TINY;
    /* a rod that starts with beta_t = 0 goes downhill: up where the extremum above it is a centre */
    out->direction = rest ? (found->centre[modulo(o.behind + 1, m)] ? 1 : -1) : v > 0 ? 1 : -1;
    out->count = 0;
    out->kind = HELIX;
    if (rest && (near || slope(p->lam, p->mu, p->phi, start) == 0))
        return DONE;
    const int forward = blocked(found, level, o.behind, out->direction);
    const int backward = blocked(found, level, o.behind, -out->direction);
    out->kind = forward >= 0 ? LIBRATION : ROTATION, out->turns_at = forward;
    const int counts[2] = {forward >= 0 ? forward + 1 : m + 1, forward < 0 || rest ? 0 : backward + 1};
    for (int arc = 0; arc < 2; arc++)
        for (int rank = 0; rank < counts[arc]; rank++)
            out->count += piece_of(&o, arc, rank, arc ? -out->direction : out->direction,
                                   forward >= 0 ? counts[arc] - 1 : -1, forward >= 0 ? -1 : m, &out->pieces[out->count]);
    return DONE;
}
