/* The changes of an orbit at W places of one panel; included for every width W, as vectors.h says. */

#include "vectors.h"

#if W == 1
typedef varied_place NAME(varied_places);
typedef varied_unit NAME(varied_units);
#else
/* `varied_place` and `varied_unit` in lanes. */
typedef struct {
    vec v, H, c, shift[4], gamma[4], M[PAIRS];
} NAME(varied_places);

typedef struct {
    vec by[5][PARTS];
} NAME(varied_units);
#endif

/* What a unit of each part of a change adds: `rod_varied_unit`. */
static inline ALWAYS TARGET void NAME(unit)(const varied_place *start, const NAME(varied_places) *there,
                                            NAME(varied_units) *out)
{
    static const int place[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    const vec one = ZERO + 1.0, D = there->v * there->v + there->c * there->H * there->H;
    const vec flow = PICK(MASK(D > 0), D, one), along = there->v / flow, across = there->c * there->H / flow;
    const double along0 = start->v / across_flow(start->v, start->H, start->c);
    for (int part = 0; part < PARTS; part++) {
        const int k = part - 1; /* of e; the part before is a, along the flow */
        const vec a = part ? there->M[place[0][k]] - start->M[place[0][k]] : one;
        const vec g = part ? there->gamma[k] : ZERO, shift = part ? there->shift[k] : ZERO;
        const double g0 = part ? start->gamma[k] : 0;
        const vec lift = g * along;
        const double lift0 = g0 * along0;
        out->by[BETA][part] = shift + a * there->v + g * across;
        out->by[RATE][part] = -a * there->H + lift;
        for (int q = 1; q < 4; q++) {
            const vec rise = part ? there->M[place[q][k]] - start->M[place[q][k]] : ZERO;
            const vec far = there->shift[q] * lift - a * (there->gamma[q] + there->shift[q] * there->H);
            const double near = start->shift[q] * lift0 - (part ? 0 : start->gamma[q] + start->shift[q] * start->H);
            out->by[LIFTS + q - 1][part] = rise + (far - near);
        }
    }
}

/* Series of a panel, (size, VARIED), at x, five at a time: those of |beta_t|, H and gamma, then M. */
static inline ALWAYS TARGET void NAME(series_at)(int size, const double *rows, vec x, vec *value)
{
    static const int columns[3][5] = {{0, 1, 6, 7, 8}, {9, 10, 11, 12, 13}, {14, 15, 16, 17, 18}};
    vec polynomial[NODES + 1];
    polynomial[0] = ZERO + 1.0, polynomial[1] = x;
    for (int m = 2; m < size; m++)
        polynomial[m] = 2 * x * polynomial[m - 1] - polynomial[m - 2];
    UNROLLED
    for (int k = 0; k < 3; k++) {
        vec sum[5];
        UNROLLED
        for (int j = 0; j < 5; j++)
            sum[j] = rows[columns[k][j]] + x * rows[VARIED + columns[k][j]];
        for (int m = 2; m < size; m++) {
            const double *row = rows + VARIED * m;
            UNROLLED
            for (int j = 0; j < 5; j++)
                sum[j] += polynomial[m] * row[columns[k][j]];
        }
        UNROLLED
        for (int j = 0; j < 5; j++)
            value[5 * k + j] = sum[j];
    }
}

/* What units of the parts add at `many` <= W places of a panel, from number `at` on. Beyond them it writes too; the next call
   writes over that. */
static TARGET void NAME(units)(const changed_orbit *of, const visits *p, int at, int many, double (*out)[VISITS + PAD])
{
    vec x, sign, periods, value[15];
    NAME(loose) second, mirrored, zero = {0};
    NAME(varied_places) here;
    NAME(varied_units) unit;
    for (int i = 0; i < W; i++) {
        const int from = at + (i < many ? i : many - 1);
        const phase *where = &p->where[from];
        LANE(x, i) = p->x[from], LANE(periods, i) = where->periods;
        LANE(sign, i) = of->direction * (where->second ? -1 : 1) * (where->mirrored ? -1 : 1);
        LANE(second, i) = where->second, LANE(mirrored, i) = where->mirrored;
    }
    const NAME(mask) is_second = MASK(second > 0), is_mirrored = MASK(mirrored > 0);
    const double *rows = of->series + VARIED * of->size * p->panel[at];
    NAME(series_at)(of->size, rows, x, value);
    here.v = value[0] * sign, here.H = value[1], here.c = ZERO + rows[2];
    here.shift[0] = ZERO, here.gamma[0] = ZERO + 1.0;
    for (int k = 0; k < 3; k++)
        here.shift[k + 1] = ZERO + rows[3 + k], here.gamma[k + 1] = value[2 + k];
    for (int m = 0; m < PAIRS; m++) { /* as `rod_unfolded` */
        const double gained = of->gain[m], later = of->gain[PAIRS + m], whole = of->librates ? 2 * (gained + later) : gained;
        const vec there = ZERO + gained, after = ZERO + later, limit = PICK(is_second, after, there);
        const vec folded = PICK(is_mirrored, 2 * limit - value[5 + m], value[5 + m]);
        here.M[m] = folded + PICK(is_second, 2 * there, zero) + periods * whole;
    }
    NAME(unit)(of->start, &here, &unit);
    for (int k = 0; k < 5 * PARTS; k++)
        *(NAME(loose) *)(out[k] + at) = unit.by[k / PARTS][k % PARTS];
}

#undef W
#undef SUFFIX
