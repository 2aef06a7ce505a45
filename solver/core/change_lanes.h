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

/* The values of all series at `many` <= W places of a panel, from number `at` of the sorted ones on, put where the places lie
   along the rod. */
static TARGET void NAME(values)(const changed_orbit *of, const visits *p, int at, int many, double (*out)[VISITS + PAD])
{
    const double *rows = of->series + VARIED * of->size * p->panel[at];
    double own[VARIED][W];
    vec value[15];
    NAME(series_at)(of->size, rows, *(const NAME(loose) *)(p->x + at), value);
    for (int k = 0; k < 4; k++)
        *(NAME(loose) *)own[2 + k] = ZERO + rows[2 + k];
    for (int k = 0; k < 15; k++)
        *(NAME(loose) *)own[k < 2 ? k : k + 4] = value[k];
    for (int k = 0; k < VARIED; k++)
        for (int i = 0; i < many; i++)
            out[k][p->place[at + i]] = own[k][i];
}

/* What units of the parts add at W neighbouring places, from number `at` on. */
static inline ALWAYS TARGET void NAME(units_at)(const changed_orbit *of, const visits *p, int at,
                                                const double (*values)[VISITS + PAD], NAME(varied_units) *out)
{
    const NAME(loose) zero = {0};
    const vec sign = *(const NAME(loose) *)(p->sign + at), periods = *(const NAME(loose) *)(p->periods + at);
    const NAME(mask) second = MASK(*(const NAME(loose) *)(p->second + at) > 0);
    const NAME(mask) mirrored = MASK(*(const NAME(loose) *)(p->mirrored + at) > 0);
    vec value[VARIED];
    NAME(varied_places) here;
    for (int k = 0; k < VARIED; k++)
        value[k] = *(const NAME(loose) *)(values[k] + at);
    here.v = value[0] * sign, here.H = value[1], here.c = value[2];
    here.shift[0] = ZERO, here.gamma[0] = ZERO + 1.0;
    for (int k = 0; k < 3; k++)
        here.shift[k + 1] = value[3 + k], here.gamma[k + 1] = value[6 + k];
    for (int m = 0; m < PAIRS; m++) { /* as `rod_unfolded` */
        const double gained = of->gain[m], later = of->gain[PAIRS + m], whole = of->librates ? 2 * (gained + later) : gained;
        const vec there = ZERO + gained, after = ZERO + later, limit = PICK(second, after, there);
        const vec folded = PICK(mirrored, 2 * limit - value[9 + m], value[9 + m]);
        here.M[m] = folded + PICK(second, 2 * there, zero) + periods * whole;
    }
    NAME(unit)(of->start, &here, out);
}

/* The changes at `many` places by F directions, from what units of their parts add there. */
static TARGET void NAME(changes)(const changed_orbit *of, const visits *p, int many, const double (*values)[VISITS + PAD],
                                 int64_t F, const double *parts, int64_t apart, int64_t each, double *out)
{
    for (int at = 0; at < many; at += W) {
        const size_t size = sizeof(double) * (many - at < W ? many - at : W);
        NAME(varied_units) unit;
        NAME(units_at)(of, p, at, values, &unit);
        for (int64_t f = 0; f < F; f++) {
            double *to = out + apart * f + at;
            const double *own = parts + PARTS * f;
            UNROLLED
            for (int k = 0; k < 5; k++) {
                NAME(loose) sum = {0};
                UNROLLED
                for (int part = 0; part < PARTS; part++)
                    if (own[part] != 0)
                        sum += unit.by[k][part] * own[part];
                if (size == sizeof sum)
                    *(NAME(loose) *)(to + each * k) = sum;
                else
                    memcpy(to + each * k, &sum, size);
            }
        }
    }
}

#undef W
#undef SUFFIX
