/* The changes of an orbit at W places of one panel, and of its shape; included for every width W, as vectors.h says. */

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
    UNROLLED
    for (int part = 0; part < PARTS; part++) {
        const int k = part - 1; /* of e; the part before is a, along the flow */
        const vec a = part ? there->M[place[0][k]] - start->M[place[0][k]] : one;
        const vec g = part ? there->gamma[k] : ZERO, shift = part ? there->shift[k] : ZERO;
        const double g0 = part ? start->gamma[k] : 0;
        const vec lift = g * along;
        const double lift0 = g0 * along0;
        out->by[BETA][part] = shift + a * there->v + g * across;
        out->by[RATE][part] = -a * there->H + lift;
        UNROLLED
        for (int q = 1; q < 4; q++) {
            const vec rise = part ? there->M[place[q][k]] - start->M[place[q][k]] : ZERO;
            const vec far = there->shift[q] * lift - a * (there->gamma[q] + there->shift[q] * there->H);
            const double near = start->shift[q] * lift0 - (part ? 0 : start->gamma[q] + start->shift[q] * start->H);
            out->by[LIFTS + q - 1][part] = rise + (far - near);
        }
    }
}

/* Series of a panel, (VARIED, size), at x, five at a time. */
static inline ALWAYS TARGET void NAME(series_at)(int size, const double *series, vec x, vec *value)
{
    vec polynomial[NODES + 1];
    polynomial[0] = ZERO + 1.0, polynomial[1] = x;
    for (int m = 2; m < size; m++)
        polynomial[m] = 2 * x * polynomial[m - 1] - polynomial[m - 2];
    UNROLLED
    for (int k = 0; k < VARIED; k += 5) {
        vec sum[5];
        UNROLLED
        for (int j = 0; j < 5; j++)
            sum[j] = series[size * (k + j)] + x * series[size * (k + j) + 1];
        for (int m = 2; m < size; m++) {
            UNROLLED
            for (int j = 0; j < 5; j++)
                sum[j] += polynomial[m] * series[size * (k + j) + m];
        }
        UNROLLED
        for (int j = 0; j < 5; j++)
            value[k + j] = sum[j];
    }
}

/* The values of all series at `many` <= W places of a panel, from number `at` of the sorted ones on, put where the places lie
   along the rod. */
static TARGET void NAME(values)(const changed_orbit *of, const visits *p, int at, int many, double (*out)[VISITS + PAD])
{
    const double *series = of->series + varied_size(of->size) * p->panel[at], *constant = series + VARIED * of->size;
    const int first = p->place[at], neighbours = many == W && p->place[at + W - 1] == first + W - 1;
    vec value[VARIED + CONSTANTS];
    NAME(series_at)(of->size, series, *(const NAME(loose) *)(p->x + at), value);
    UNROLLED
    for (int k = 0; k < CONSTANTS; k++)
        value[VARIED + k] = ZERO + constant[k];
    UNROLLED
    for (int k = 0; k < VARIED + CONSTANTS; k++) {
        const vec own = value[k];
        if (neighbours)
            *(NAME(loose) *)(out[k] + first) = own;
        else
            for (int i = 0; i < many; i++)
                out[k][p->place[at + i]] = LANE(own, i);
    }
}

/* What units of the parts add at W neighbouring places, from number `at` on. */
static inline ALWAYS TARGET void NAME(units_at)(const changed_orbit *of, const visits *p, int at,
                                                const double (*values)[VISITS + PAD], NAME(varied_units) *out)
{
    const NAME(loose) zero = {0};
    const vec sign = *(const NAME(loose) *)(p->sign + at), periods = *(const NAME(loose) *)(p->periods + at);
    const NAME(mask) second = MASK(*(const NAME(loose) *)(p->second + at) > 0);
    const NAME(mask) mirrored = MASK(*(const NAME(loose) *)(p->mirrored + at) > 0);
    vec value[VARIED + CONSTANTS];
    NAME(varied_places) here;
    UNROLLED
    for (int k = 0; k < VARIED + CONSTANTS; k++)
        value[k] = *(const NAME(loose) *)(values[k] + at);
    here.v = value[0] * sign, here.H = value[1], here.c = value[VARIED];
    here.shift[0] = ZERO, here.gamma[0] = ZERO + 1.0;
    for (int k = 0; k < 3; k++)
        here.shift[k + 1] = value[VARIED + 1 + k], here.gamma[k + 1] = value[2 + k];
    UNROLLED
    for (int m = 0; m < PAIRS; m++) { /* as `rod_unfolded` */
        const double gained = of->gain[m], later = of->gain[PAIRS + m], whole = of->librates ? 2 * (gained + later) : gained;
        const vec there = ZERO + gained, after = ZERO + later, limit = PICK(second, after, there);
        const vec folded = PICK(mirrored, 2 * limit - value[BY_LEVEL + m], value[BY_LEVEL + m]);
        here.M[m] = folded + PICK(second, 2 * there, zero) + periods * whole;
    }
    NAME(unit)(of->start, &here, out);
}

/* The derivatives of a shape by one field at W neighbouring places, from the changes, in place. */
static inline ALWAYS TARGET void NAME(derive)(const known_field *by, const known_places *p, int at, NAME(loose) *change)
{
    const vec t = *(const NAME(loose) *)(p->t + at), v = *(const NAME(loose) *)(p->rate + at);
    const vec s = *(const NAME(loose) *)(p->s + at), c = *(const NAME(loose) *)(p->c + at);
    const vec z = *(const NAME(loose) *)(p->z + at), H = *(const NAME(loose) *)(p->H + at);
    const vec later = by->longer * t, turned = change[2], swirled = change[3], risen = change[4];
    change[0] = change[0] + v * later;
    change[1] = (change[1] - H * later - v * by->d_rho * by->over) * by->over;
    change[2] = by->alpha + turned + s * later;
    change[3] = by->rho * (risen + c * later) + z * by->d_rho;
    change[4] = by->gamma + by->twist * t + by->swirl * later + swirled - s * c * later;
}

/* Five rows of W numbers, of which `many` each count. */
static inline ALWAYS TARGET void NAME(put)(const NAME(loose) *rows, int many, int64_t each, double *to)
{
    UNROLLED
    for (int k = 0; k < 5; k++) {
        const NAME(loose) row = rows[k];
        if (many >= W)
            *(NAME(loose) *)(to + each * k) = row;
        else
            for (int i = 0; i < W; i++)
                if (i < many)
                    to[each * k + i] = LANE(row, i);
    }
}

/* The changes at `many` places from `begin` on, from what units of their parts add there, or the derivatives of the shape. */
static TARGET void NAME(changes)(const changed_orbit *of, const visits *p, int many, const double (*values)[VISITS + PAD],
                                 const double *parts, const shapes *along, int64_t row, int64_t begin,
                                 const known_places *known)
{
    const int64_t n = along->stations, F = along->F;
    NAME(varied_units) unit[TOGETHER];
    for (int first = 0; first < many; first += TOGETHER * W) {
        const int end = many < first + TOGETHER * W ? many : first + TOGETHER * W;
        for (int at = first; at < end; at += W)
            NAME(units_at)(of, p, at, values, &unit[(at - first) / W]);
        for (int64_t f = 0; f < F; f++) {
            const double *own = parts + PARTS * f;
            const known_field by = along->beta ? know_field(along, row, f) : (known_field){0};
            for (int at = first; at < end; at += W) {
                const NAME(varied_units) *here = &unit[(at - first) / W];
                NAME(loose) sum[5];
                UNROLLED
                for (int k = 0; k < 5; k++)
                    sum[k] = ZERO;
                UNROLLED
                for (int part = 0; part < PARTS; part++)
                    if (own[part] != 0) {
                        UNROLLED
                        for (int k = 0; k < 5; k++)
                            sum[k] += here->by[k][part] * own[part];
                    }
                if (along->beta)
                    NAME(derive)(&by, known, at, sum);
                NAME(put)(sum, many - at, along->size * F * n,
                          along->out + n * (row * F + f) + begin + at);
            }
        }
    }
}

/* The derivatives of a shape at `many` places from `begin` on, from changes that are in its `out`. */
static TARGET void NAME(derivatives)(const shapes *of, int64_t row, int64_t begin, int many, const known_places *known)
{
    const int64_t n = of->stations, F = of->F, each = of->size * F * n;
    for (int64_t f = 0; f < F; f++) {
        const known_field by = know_field(of, row, f);
        for (int at = 0; at < many; at += W) {
            const size_t size = sizeof(double) * (many - at < W ? many - at : W);
            double *to = of->out + n * (row * F + f) + begin + at;
            NAME(loose) change[5];
            for (int k = 0; k < 5; k++)
                change[k] = ZERO, memcpy(&change[k], to + each * k, size);
            NAME(derive)(&by, known, at, change);
            NAME(put)(change, many - at, each, to);
        }
    }
}

#undef W
#undef SUFFIX
