/* A branch of equilibria as a curve: solver/branches/equilibrium_curve.py. */

#include "branch_points.h"

/* So many numbers of the problem at p, as the caller gives them. */
static int numbers_at(family *f, double p, int count, double *out)
{
    question asked = {.p = p};
    for (int k = 0; k < GIVEN + 2; k++)
        asked.numbers[k] = NAN;
    const int answer = f->raised ? RAISED : f->problem(&asked);
    f->raised = answer == RAISED;
    memcpy(out, asked.numbers, sizeof(double) * (size_t)count);
    return answer == THERE ? DONE : FAILED;
}

/* The problem under dead loads at p. */
static int dead_problem(family *f, double p, ends_problem *out)
{
    if (!f->line)
        return numbers_at(f, p, 6, &out->lam);
    const double *first = &f->line[0].lam, *last = &f->line[1].lam;
    for (int k = 0; k < 6; k++)
        (&out->lam)[k] = fabs(p - 1) <= f->over->rounding ? last[k] : (1 - p) * first[k] + p * last[k];
    return DONE;
}

int rod_curve_problem(family *f, double p, const place **out)
{
    for (int k = 0; k < KEPT; k++)
        if (f->at[k] == p) {
            *out = &f->known[k];
            return DONE;
        }
    ends_problem of;
    if (dead_problem(f, p, &of))
        return FAILED;
    f->newest = (f->newest + 1) % KEPT;
    f->at[f->newest] = NAN;
    const int failed = rod_place_of(&of, f->by, &f->known[f->newest]);
    if (failed)
        return failed;
    f->at[f->newest] = p;
    *out = &f->known[f->newest];
    return DONE;
}

int rod_curve_excess(family *f, const chart *c, int count, const double *x, double p, double *off)
{
    const place *o = NULL;
    int failed = rod_curve_problem(f, p, &o);
    failed = failed ? failed : rod_excess_at(&f->room, o, c, count, x, off);
    for (int i = 0; i < count && !failed; i++)
        failed = isfinite(off[i]) ? DONE : FAILED;
    return failed;
}

int rod_curve_jacobian(family *f, point *at) /* by differences */
{
    const double scale = at->chart.scale, x = at->w[0] * scale, p = at->w[1] * f->over->scale, nudge = at->chart.nudge;
    const double three[3] = {x - nudge, x, x + nudge};
    double ahead = at->ahead * f->over->scale, off[3], beyond;
    int failed = rod_curve_excess(f, &at->chart, 3, three, p, off);
    if (failed)
        return failed;
    if (rod_curve_excess(f, &at->chart, 1, &x, p + ahead, &beyond)) {
        ahead = -ahead;
        failed = rod_curve_excess(f, &at->chart, 1, &x, p + ahead, &beyond);
    }
    at->jacobian[0] = (off[2] - off[0]) / (2 * nudge) * scale;
    at->jacobian[1] = (beyond - off[1]) / ahead * f->over->scale;
    return failed;
}

static const int free_of[GIVEN] = {BETA0, BETAL, LAM, MU, PHI}; /* the unknowns behind x and p */

static double scale_of(const family *f, int k) { return k < 2 ? 1 : f->held->loads; }

/* The problem under dead loads, from what is given at p and the unknowns, of which those that are given are set. */
static int held_problem(family *f, double *w, double *given, ends_problem *out)
{
    double number[NUMBERS] = {0};
    if (numbers_at(f, w[1] * f->over->scale, GIVEN + 2, given))
        return FAILED;
    for (int k = 0; k < GIVEN; k++)
        number[free_of[k]] = w[2 + k] * scale_of(f, k);
    for (int k = 0; k < GIVEN; k++)
        if (f->held->given[k] < NUMBERS)
            number[f->held->given[k]] = given[k];
    for (int k = 0; k < GIVEN; k++)
        for (int i = 0; i < GIVEN; i++)
            if (f->held->given[i] == free_of[k])
                w[2 + k] = given[i] / scale_of(f, k);
    *out = (ends_problem){number[LAM], number[MU], number[PHI], given[GIVEN], number[BETA0], number[BETAL]};
    for (int k = 0; k < GIVEN + 2; k++)
        if (!isfinite(given[k]))
            return FAILED;
    return DONE;
}

int rod_curve_place(family *f, const point *at, place *o, path *here)
{
    double given[GIVEN + 2], w[UNKNOWNS];
    const place *known = NULL;
    ends_problem of;
    memcpy(w, at->w, sizeof w);
    int failed = f->held ? held_problem(f, w, given, &of) : rod_curve_problem(f, at->w[1] * f->over->scale, &known);
    if (!failed && f->held)
        failed = rod_place_of(&of, f->by, o);
    else if (!failed)
        *o = *known;
    return failed || (rod_path_at(o, &at->chart, at->w[0] * at->chart.scale, here) && here->turns >= 0) ? failed : FAILED;
}

/* The given numbers and the length of the orbit less what they should be, (6,). */
static void held_off(const family *f, const double *w, const double *given, double *off)
{
    const orbit_numbers *on = &f->numbers;
    for (int k = 0; k < GIVEN; k++) {
        const int64_t which = f->held->given[k];
        double value = which == TURN ? given[6] * on->values[MU] * on->length - on->values[SWIRL] : 0;
        if (which != TURN)
            value = on->values[which];
        for (int i = 0; i < GIVEN; i++)
            if (free_of[i] == which)
                value = w[2 + i] * scale_of(f, i);
        off[k] = value - given[k];
    }
    off[GIVEN] = on->length - given[GIVEN];
}

/* What the parts of a change of the orbit, and a change of its length, add to the coordinate. */
static void coordinate_row(const chart *c, double x, const orbit_numbers *on, double *out)
{
    const int which = c->kind == SADDLE_OF ? Y : c->kind == START_OF ? DBETA0 : DBETAL;
    double factor = 1;
    if (c->kind != SADDLE_OF && c->logarithmic)
        factor = 2 / (direction(&c->at, c->kind == END_OF) * exp(x / 2));
    for (int k = 0; k < PARTS; k++)
        out[k] = factor * on->rows[PARTS * which + k];
    out[PARTS] = factor * on->by_span[which];
}

/* The parts of a change of the orbit, and of its length, by a unit of the coordinate and of each unknown behind p. */
static int parts_of(const chart *c, double x, const orbit_numbers *on, double parts[EQUATIONS][EQUATIONS])
{
    enum { WIDE_ROW = 2 * EQUATIONS };
    double matrix[EQUATIONS * WIDE_ROW] = {0}, column[EQUATIONS] = {0};
    coordinate_row(c, x, on, matrix);
    for (int i = 0; i < GIVEN; i++) {
        memcpy(matrix + (i + 1) * WIDE_ROW, on->rows + PARTS * free_of[i], sizeof(double) * PARTS);
        matrix[(i + 1) * WIDE_ROW + PARTS] = on->by_span[free_of[i]];
    }
    for (int k = 0; k < EQUATIONS; k++)
        for (int i = 0; i < EQUATIONS; i++)
            column[k] = larger(column[k], fabs(matrix[i * WIDE_ROW + k]));
    for (int i = 0; i < EQUATIONS; i++) {
        double most = 0;
        for (int k = 0; k < EQUATIONS; k++)
            matrix[i * WIDE_ROW + k] /= column[k], most = larger(most, fabs(matrix[i * WIDE_ROW + k]));
        for (int k = 0; k < EQUATIONS; k++)
            matrix[i * WIDE_ROW + k] /= most;
        matrix[i * WIDE_ROW + EQUATIONS + i] = 1 / most;
    }
    if (!rod_eliminated(EQUATIONS, WIDE_ROW, matrix))
        return FAILED;
    for (int i = 0; i < EQUATIONS; i++)
        for (int k = 0; k < EQUATIONS; k++)
            parts[i][k] = matrix[i * WIDE_ROW + EQUATIONS + k] / column[i];
    return DONE;
}

/* The derivatives of the equations by w, (6, 7). */
static int held_jacobian(family *f, const point *at, const double *given, double *out)
{
    const orbit_numbers *on = &f->numbers;
    double parts[EQUATIONS][EQUATIONS], beyond[GIVEN + 2], ahead = at->ahead * f->over->scale;
    const double p = at->w[1] * f->over->scale;
    int failed = numbers_at(f, p + ahead, GIVEN + 2, beyond);
    if (failed) {
        ahead = -ahead;
        failed = numbers_at(f, p + ahead, GIVEN + 2, beyond);
    }
    if (failed || parts_of(&at->chart, at->w[0] * at->chart.scale, on, parts))
        return FAILED;
    for (int i = 0; i < EQUATIONS; i++) {
        const int64_t which = i < GIVEN ? f->held->given[i] : -1;
        double row[EQUATIONS] = {0}, drift = -(i < GIVEN ? beyond[i] - given[i] : beyond[GIVEN] - given[GIVEN]) / ahead;
        for (int k = 0; k < PARTS && which >= 0; k++)
            row[k] = which == TURN ? given[6] * on->length * on->rows[PARTS * MU + k] - on->rows[PARTS * SWIRL + k]
                                   : on->rows[PARTS * which + k];
        if (which == TURN) {
            row[PARTS] = given[6] * on->values[MU] - on->by_span[SWIRL];
            drift += (beyond[6] - given[6]) / ahead * on->values[MU] * on->length;
        } else {
            row[PARTS] = which < 0 ? 1 : on->by_span[which];
        }
        for (int j = 0; j < EQUATIONS; j++) {
            double value = 0;
            for (int k = 0; k < EQUATIONS; k++)
                value += row[k] * parts[k][j];
            out[i * UNKNOWNS + (j ? j + 1 : 0)] =
                value * (j == 0 ? at->chart.scale : scale_of(f, j - 1));
        }
        out[i * UNKNOWNS + 1] = drift * f->over->scale;
        for (int j = 0; j < UNKNOWNS; j++)
            if (!isfinite(out[i * UNKNOWNS + j]))
                return FAILED;
    }
    return DONE;
}

/* The equations at a point, and their derivatives. */
static int held_equations(family *f, point *at, double *off)
{
    double given[GIVEN + 2];
    ends_problem of;
    place o;
    path here;
    int failed = held_problem(f, at->w, given, &of);
    failed = failed ? failed : rod_place_of(&of, f->by, &o);
    if (failed || !rod_path_at(&o, &at->chart, at->w[0] * at->chart.scale, &here) || here.turns < 0)
        return failed ? failed : FAILED;
    failed = rod_orbit_numbers(&o, &here, f->nodes, &f->times, &f->orbits, &f->numbers);
    if (failed)
        return failed;
    held_off(f, at->w, given, off);
    for (int k = 0; k < EQUATIONS; k++)
        if (!isfinite(off[k]))
            return FAILED;
    return held_jacobian(f, at, given, at->jacobian);
}

/* The equations at a point, and their derivatives: with held ends computed anew in each round, under dead loads those of
   the round before, corrected by what the last move shows (Broyden's method). */
static int equations(family *f, point *at, const double *move, int round, double *off)
{
    if (f->held)
        return held_equations(f, at, off);
    const double x = at->w[0] * at->chart.scale, before = off[0];
    const int failed = rod_curve_excess(f, &at->chart, 1, &x, at->w[1] * f->over->scale, off);
    if (failed || !round)
        return failed;
    double *row = at->jacobian;
    const double share = (off[0] - before - (row[0] * move[0] + row[1] * move[1])) / (square(move[0]) + square(move[1]));
    row[0] += share * move[0], row[1] += share * move[1];
    return DONE;
}

/* By Newton's rule. */
static int corrected(family *f, point *at, const double *guess, const double *across)
{
    const int n = unknowns_of(f), columns = n + 1;
    double matrix[UNKNOWNS * (UNKNOWNS + 1)], off[EQUATIONS] = {0}, move[UNKNOWNS] = {0}, last = INFINITY;
    memcpy(at->w, guess, sizeof(double) * n);
    for (int round = 0; round < rod_tuning.rounds; round++) {
        double size = 0, plane = 0;
        const int failed = equations(f, at, move, round, off);
        if (failed)
            return failed;
        for (int j = 0; j < n; j++)
            plane += across[j] * (at->w[j] - guess[j]);
        for (int i = 0; i < n; i++) {
            memcpy(matrix + i * columns, i < n - 1 ? at->jacobian + i * n : across, sizeof(double) * n);
            matrix[i * columns + n] = -(i < n - 1 ? off[i] : plane);
        }
        if (!rod_eliminated(n, columns, matrix))
            return FAILED;
        for (int i = 0; i < n; i++)
            move[i] = matrix[i * columns + n], size += square(move[i]);
        size = sqrt(size);
        if (!(size <= larger(rod_tuning.contraction * last, rod_tuning.small)))
            return FAILED;
        for (int i = 0; i < n; i++)
            at->w[i] += move[i];
        if (size <= rod_tuning.settled || (f->held && round && size <= rod_tuning.close && size <= 1e-2 * last) ||
            (size <= rod_tuning.small && size >= rod_tuning.contraction * last))
            return DONE;
        last = size;
    }
    return last <= rod_tuning.small ? DONE : FAILED;
}

int rod_curve_corrected(family *f, const point *from, const double *guess, const double *across, point *out)
{
    *out = *from;
    return corrected(f, out, guess, across);
}
