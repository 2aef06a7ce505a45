/* Stretches of rods whose loads vary, W at a time: one lane a stretch.

   Included once for each width W. Every lane does the same operations in the same order whatever W is and whatever its
   neighbours are, so results are equal to the bit for all widths. */

#include "vectors.h"

typedef struct {
    vec y[STATES][TERMS], s[TERMS], e[TERMS], c[TERMS], sa[TERMS], ca[TERMS], s2[TERMS], sc[TERMS], e2[TERMS];
    vec H[TERMS], se[TERMS], g[TERMS], by_b[TERMS];        /* derivatives of H by beta; that of se is g */
    vec d[STATES + 1][TERMS][2];                           /* two columns and the change of P */
    vec v2[TERMS], FY[TERMS], lever[TERMS], P[TERMS], Pc[TERMS], Ps[TERMS], FYb[TERMS], P_by[GIVENS][TERMS];
    vec rod[PARAMETERS], fine[STATES], at[STATES], t, length; /* fine: 1 over what a step may leave out */
    vec transfer[STATES][GIVENS], D[STATES][GIVENS];          /* of the step, and from the begin */
    vec growth[WIDE], spread[WIDE][WIDE], shift[WIDE], worst[2], lost; /* lost: what rounding took from t */
    int64_t stretch[W], station[W], last[W], step[W]; /* the stretch of each lane (-1: none), its stations, its steps */
} NAME(lanes);

/* `product` and `square` where the order is not known to the compiler. */
static TARGET vec NAME(sum)(const vec *x, const vec *y, int k) { return NAME(product)(x, y, k); }
static TARGET vec NAME(half)(const vec *x, int k) { return NAME(square)(x, k); }

/* Which way each rod moves against the wall: of the three, one is 1. */
typedef struct {
    vec sliding, turning, moving;
} NAME(way);

static inline ALWAYS TARGET NAME(way) NAME(ways)(const NAME(lanes) *x)
{
    const vec k = x->rod[WAY];
    const NAME(way) found = {1.0 - k * k, 0.5 * k * (k + 1.0), 0.5 * k * (k - 1.0)};
    return found;
}

/* The coefficients k of the contact force P, and of what it multiplies. */
static TARGET void NAME(pushed)(NAME(lanes) *x, int k)
{
    const vec *v = x->y[SPEED], *mu = x->y[MU], side = x->rod[SIDE];
    x->v2[k] = NAME(half)(v, k);
    x->FY[k] = x->y[Q][k] + NAME(sum)(mu, x->e, k) - NAME(sum)(x->s, x->s2, k);
    x->lever[k] = 3.0 * x->sc[k] - mu[k];
    vec plain = NAME(sum)(x->FY, x->s, k) + NAME(sum)(x->H, x->lever, k) - x->rod[ACROSS] * x->ca[k];
    plain += -3.0 * x->v2[k] + 6.0 * NAME(sum)(x->v2, x->s2, k);
    /* beta_t mu_t holds P itself */
    const vec much = NAME(ways)(x).turning * side * x->rod[FRICTION] * x->rod[RADIUS], divisor = 1.0 - much * v[0];
    for (int j = 1; j <= k; j++)
        plain += side * much * v[j] * x->P[k - j];
    x->P[k] = side * plain / divisor;
    x->Pc[k] = NAME(sum)(x->P, x->c, k);
    x->Ps[k] = NAME(sum)(x->P, x->s, k);
}

/* The term k of a product and of a square; fixed: whether the compiler knows k. */
static inline ALWAYS TARGET vec NAME(term)(const vec *x, const vec *y, int k, const int fixed)
{
    return fixed ? NAME(product)(x, y, k) : NAME(sum)(x, y, k);
}

static inline ALWAYS TARGET vec NAME(squared)(const vec *x, int k, const int fixed)
{
    return fixed ? NAME(square)(x, k) : NAME(half)(x, k);
}

/* The term k of the product of phi or mu and a series; without friction phi is a line and mu is constant. */
static inline ALWAYS TARGET vec NAME(by_load)(const NAME(lanes) *lanes, const int load, const vec *x, int k, const int rubbed)
{
    const vec *y = lanes->y[load];
    if (rubbed)
        return NAME(sum)(y, x, k);
    return load == PHI && k > 0 ? y[1] * x[k - 1] + y[0] * x[k] : y[0] * x[k];
}

/* The coefficients k of what the states up to k give, and the coefficients k + 1 of the states. */
static inline ALWAYS TARGET void NAME(terms)(NAME(lanes) *x, const int k, const int rubbed)
{
    vec(*y)[TERMS] = x->y;
    const vec zero = ZERO, *rod = x->rod, *v = y[SPEED], *q = y[Q], *s = x->s, *c = x->c, *e = x->e;
    const double share = 1.0 / (k + 1.0);
    const int fixed = !rubbed;
    x->e2[k] = NAME(squared)(e, k, fixed);
    x->s2[k] = 2.0 * e[k] - x->e2[k];
    x->se[k] = NAME(term)(s, e, k, fixed);
    x->sc[k] = s[k] - x->se[k];
    x->g[k] = 3.0 * e[k] - 2.0 * x->e2[k];
    vec along = k == 0 ? rod[ALONG] : zero, across = rod[ACROSS] * x->sa[k], twist = zero;
    x->H[k] = NAME(term)(c, q, k, fixed) + NAME(by_load)(x, MU, x->g, k, rubbed) -
              NAME(by_load)(x, PHI, s, k, rubbed) - 2.0 * NAME(term)(x->sc, x->s2, k, fixed);
    if (rubbed) {
        NAME(pushed)(x, k);
        const NAME(way) is = NAME(ways)(x);
        const vec f = rod[FRICTION];
        twist = is.turning * f * rod[RADIUS] * x->P[k];
        along += f * (is.sliding * x->Pc[k] + is.moving * x->P[k] + is.turning * rod[SIDE] * x->Ps[k]);
        across += f * (is.sliding * x->Ps[k] + is.turning * (rod[RADIUS] - rod[SIDE]) * x->Pc[k]);
    }
    y[BETA][k + 1] = v[k] * share;
    y[SPEED][k + 1] = x->H[k] * -share;
    y[ALPHA][k + 1] = s[k] * share;
    y[Q][k + 1] = (across - twist) * share;
    y[PHI][k + 1] = along * share;
    y[MU][k + 1] = twist * share;
    y[SHORT][k + 1] = e[k] * share;
    y[ROUND][k + 1] = (rod[RATIO] * y[MU][k] + x->se[k]) * share;
    x->s[k + 1] = NAME(term)(c, v, k, fixed) * share;
    x->e[k + 1] = NAME(term)(s, v, k, fixed) * share;
    x->c[k + 1] = -e[k + 1];
    x->sa[k + 1] = NAME(term)(s, x->ca, k, fixed) * share;
    x->ca[k + 1] = NAME(term)(s, x->sa, k, fixed) * -share;
}

/* Fills the table with the series about the states where the lanes are. */
static inline ALWAYS TARGET void NAME(expand)(NAME(lanes) *x, const int rubbed)
{
    vec sine, cosine;
    for (int i = 0; i < STATES; i++)
        x->y[i][0] = x->at[i];
    NAME(sin_cos)(x->at[BETA] / 2.0, &sine, &cosine);
    x->s[0] = 2.0 * sine * cosine, x->e[0] = 2.0 * sine * sine, x->c[0] = 1.0 - x->e[0];
    NAME(sin_cos)(x->at[ALPHA], &x->sa[0], &x->ca[0]);
    if (rubbed)
        for (int k = 0; k < ORDER; k++)
            NAME(terms)(x, k, 1);
    else
        UNROLLED
        for (int k = 0; k < ORDER; k++)
            NAME(terms)(x, k, 0);
}

/* The largest coefficient of order k, in what a step may leave out. */
static inline TARGET vec NAME(size)(const NAME(lanes) *x, int k)
{
    vec size = ZERO;
    for (int i = 0; i < SHORT; i++)
        size = vmax(vabs(x->y[i][k]) * x->fine[i], size);
    return size;
}

/* The distance at which the last four terms of the series are small enough: some may vanish by chance. */
static inline TARGET vec NAME(reach)(const NAME(lanes) *x)
{
    vec least = ZERO + 1000.0;
    double wide = 1; /* each term may be USUAL times the next */
    for (int k = ORDER; k > ORDER - 4; k--) {
        const vec size = NAME(size)(x, k) / wide, power = NAME(log_2)(size) / -(double)k;
        least = PICK(MASK(size > 0) & MASK(power < least), power, least);
        wide *= USUAL;
    }
    return NAME(exp_2)(least);
}

/* The term k of the derivative of H by beta. */
static inline ALWAYS TARGET vec NAME(slope)(const NAME(lanes) *x, int k, const int rubbed)
{
    const int fixed = !rubbed;
    return 3.0 * NAME(by_load)(x, MU, x->s, k, rubbed) - 4.0 * NAME(by_load)(x, MU, x->se, k, rubbed) -
           NAME(term)(x->y[Q], x->s, k, fixed) - NAME(by_load)(x, PHI, x->c, k, rubbed) -
           6.0 * NAME(squared)(x->sc, k, fixed) + 2.0 * NAME(squared)(x->s2, k, fixed);
}

/* The derivative of H by beta, up to the order `deep`, without friction. */
static inline ALWAYS TARGET void NAME(derive)(NAME(lanes) *x, int deep)
{
    UNROLLED
    for (int k = 0; k < ORDER; k++) {
        if (k >= deep)
            break;
        x->by_b[k] = NAME(slope)(x, k, 0);
    }
}

/* The derivatives of H and P, up to the order `deep`, with friction. */
static TARGET void NAME(derive_rubbed)(NAME(lanes) *x, int deep)
{
    const vec *mu = x->y[MU], *v = x->y[SPEED], side = x->rod[SIDE];
    for (int k = 0; k < deep; k++)
        x->by_b[k] = NAME(slope)(x, k, 1);
    const vec much = NAME(ways)(x).turning * side * x->rod[FRICTION] * x->rod[RADIUS], divisor = 1.0 - much * v[0];
    for (int k = 0; k < deep; k++) {
        vec by[GIVENS] = {ZERO};
        x->FYb[k] = NAME(sum)(mu, x->s, k) - 3.0 * NAME(sum)(x->s2, x->c, k);
        by[BETA] = NAME(sum)(x->FYb, x->s, k) + NAME(sum)(x->FY, x->c, k) +
                   NAME(sum)(x->by_b, x->lever, k) + 3.0 * x->H[k] - 6.0 * NAME(sum)(x->H, x->s2, k) +
                   12.0 * NAME(sum)(x->v2, x->sc, k);
        by[SPEED] = -6.0 * v[k] + 12.0 * NAME(sum)(v, x->s2, k);
        by[ALPHA] = x->rod[ACROSS] * x->sa[k];
        by[Q] = x->s[k] + NAME(sum)(x->c, x->lever, k);
        by[PHI] = -NAME(sum)(x->s, x->lever, k);
        by[MU] = x->se[k] + NAME(sum)(x->g, x->lever, k) - x->H[k];
        by[WIDE + 1] = -x->ca[k];
        for (int i = 0; i < GIVENS; i++) {
            vec n = side * by[i];
            if (i == SPEED)
                n += much * x->P[k];
            if (i == WIDE + 2)
                n += NAME(ways)(x).turning * side * x->rod[RADIUS] * NAME(sum)(v, x->P, k);
            for (int j = 1; j <= k; j++)
                n += much * v[j] * x->P_by[i][k - j];
            x->P_by[i][k] = n / divisor;
        }
    }
}

/* The columns first and, where m is 2, first + 1 of the transfer of a step of length h. */
static inline ALWAYS TARGET void NAME(columns)(NAME(lanes) *x, int first, const int m, int deep, const int rubbed,
                                               const int whole, vec h)
{
    vec(*d)[TERMS][2] = x->d;
    const vec zero = ZERO, *rod = x->rod;
    const int given = first >= WIDE;
    for (int i = 0; i < m; i++)
        for (int row = 0; row < STATES; row++)
            d[row][0][i] = zero + (double)(row == first + i && !given);
    for (int k = 0; k < deep; k++) {
        vec H[2] = {ZERO}, pulled[2] = {ZERO}, turned[2] = {ZERO}, lost[2] = {ZERO}, bent[2] = {ZERO}, across[2] = {ZERO};
        vec along[2] = {ZERO}, twist[2] = {ZERO};
        for (int j = k; j >= 0; j--)
            for (int i = 0; i < m; i++) {
                const vec change = d[BETA][k - j][i];
                H[i] += x->by_b[j] * change;
                pulled[i] += x->c[j] * d[Q][k - j][i];
                turned[i] += x->c[j] * change;
                across[i] += x->ca[j] * d[ALPHA][k - j][i];
                if (whole) {
                    lost[i] += x->s[j] * change;
                    bent[i] += x->g[j] * change;
                }
            }
        for (int i = 0; i < m; i++) {
            H[i] += pulled[i], across[i] *= rod[ACROSS];
            if (!rubbed && !given) { /* the changes of phi and mu are constant */
                H[i] += x->g[k] * d[MU][0][i] - x->s[k] * d[PHI][0][i];
                continue;
            }
            for (int j = k; j >= 0; j--)
                H[i] += x->g[j] * d[MU][k - j][i] - x->s[j] * d[PHI][k - j][i];
            if (first + i == WIDE && k == 0)
                along[i] += 1.0;
            if (first + i == WIDE + 1)
                across[i] += x->sa[k];
            if (!rubbed)
                continue;
            vec by_s = zero, by_c = zero, change = given ? x->P_by[first + i][k] : zero;
            for (int row = 0; row < WIDE; row++)
                for (int j = k; j >= 0; j--)
                    change += x->P_by[row][j] * d[row][k - j][i];
            d[STATES][k][i] = change;
            for (int j = k; j >= 0; j--) {
                by_s += x->s[j] * d[STATES][k - j][i] + x->Pc[j] * d[BETA][k - j][i];
                by_c += x->c[j] * d[STATES][k - j][i] - x->Ps[j] * d[BETA][k - j][i];
            }
            const NAME(way) is = NAME(ways)(x);
            const vec f = rod[FRICTION], lift = rod[RADIUS] - rod[SIDE];
            along[i] += f * (is.turning * rod[SIDE] * by_s + is.sliding * by_c + is.moving * change);
            across[i] += f * (is.turning * lift * by_c + is.sliding * by_s);
            twist[i] += is.turning * f * rod[RADIUS] * change;
            if (first + i == WIDE + 2) {
                along[i] += is.turning * rod[SIDE] * x->Ps[k] + is.sliding * x->Pc[k] + is.moving * x->P[k];
                across[i] += is.turning * lift * x->Pc[k] + is.sliding * x->Ps[k];
                twist[i] += is.turning * rod[RADIUS] * x->P[k];
            }
        }
        const double share = 1.0 / (k + 1.0);
        for (int i = 0; i < m; i++) {
            d[BETA][k + 1][i] = share * d[SPEED][k][i];
            d[SPEED][k + 1][i] = -share * H[i];
            d[ALPHA][k + 1][i] = share * turned[i];
            d[Q][k + 1][i] = share * (across[i] - twist[i]);
            d[PHI][k + 1][i] = share * along[i];
            d[MU][k + 1][i] = share * twist[i];
            d[SHORT][k + 1][i] = share * lost[i];
            d[ROUND][k + 1][i] = share * (rod[RATIO] * d[MU][k][i] + bent[i]);
        }
    }
    for (int i = 0; i < m; i++)
        for (int row = 0; row < (whole ? STATES : rubbed ? WIDE : PHI); row++) {
            vec sum = d[row][deep][i];
            for (int k = deep - 1; k >= 0; k--)
                sum = sum * h + d[row][k][i];
            x->transfer[row][first + i] = sum;
        }
}

/* The same with friction, of which fewer rods are marched, compiled once. */
static TARGET void NAME(columns_rubbed)(NAME(lanes) *x, int first, int m, int deep, int whole, vec h)
{
    NAME(columns)(x, first, m, deep, 1, whole, h);
}

/* Applies the transfer of a step, of which the first `inner` numbers change, to n columns. */
static inline ALWAYS TARGET void NAME(carry)(NAME(lanes) *x, int n, const int inner, const int rows)
{
    for (int i = 0; i < n; i++) {
        vec sum[STATES];
        for (int row = 0; row < rows; row++) {
            sum[row] = row >= SHORT ? x->D[row][i] : i >= WIDE ? x->transfer[row][i] : ZERO;
            if (row >= SHORT && i >= WIDE)
                sum[row] += x->transfer[row][i];
            for (int k = 0; k < inner; k++)
                sum[row] += x->transfer[row][k] * x->D[k][i];
        }
        for (int row = 0; row < rows; row++)
            x->D[row][i] = sum[row];
    }
    for (int i = 0; i < n && i < WIDE; i++)
        x->growth[i] = vmax(x->growth[i], vabs(x->D[BETA][i]));
}

/* What the series of the state leave out at the distance h: their last four terms with a geometric rest, whose ratio is
   that of the last eight. */
static inline ALWAYS TARGET void NAME(left_out)(const NAME(lanes) *x, vec h, vec *out, const int inner)
{
    const vec most = ZERO + 0.8;
    vec last = ZERO, earlier = ZERO + 1e-300, power = ZERO + 1.0, ratio, low;
    for (int k = ORDER - 3; k <= ORDER; k++) {
        last = vmax(NAME(size)(x, k) * power, last), earlier = vmax(NAME(size)(x, k - 4) * power, earlier);
        power *= h;
    }
    ratio = vroot(vroot(last / earlier)) * h;
    ratio = PICK(MASK(ratio < most), ratio, most);
    low = h * h;
    low *= low, low *= low, low *= low, low *= h; /* h to the power ORDER - 3 */
    const vec rest = low * ratio / (1.0 - ratio), cube = ratio * ratio * ratio;
    for (int i = 0; i < inner; i++) {
        vec most_left = ZERO, factor = cube, grown = ZERO + 1.0;
        for (int k = ORDER - 3; k <= ORDER; k++) {
            most_left = vmax(vabs(x->y[i][k]) * grown * factor, most_left);
            grown *= h, factor = k < ORDER - 1 ? factor / ratio : ZERO + 1.0;
        }
        out[i] = rest * most_left;
    }
}

/* The errors of the first `inner` numbers after a step of length h, and what the rounded loads shift them by. Their
   covariance is spread * spread^T, where spread is lower triangular: of a product of covariances, rounding would lose
   the small errors next to the large ones, and these can shrink before the small ones grow. */
static inline ALWAYS TARGET void NAME(spread)(NAME(lanes) *x, const int inner, vec h)
{
    const vec *at = x->at, bent = vabs(x->s[0]) + h * vabs(at[SPEED]);
    const vec pull = vabs(at[Q]) + (vabs(at[MU]) + vabs(at[PHI]) + 2.0 * bent) * bent;
    const vec fresh[WIDE] = {EPS * (vabs(at[BETA]) + h * vabs(at[SPEED])), EPS * (vabs(at[SPEED]) + h * pull),
                             EPS * (vabs(at[ALPHA]) + h * bent), EPS * (vabs(at[Q]) + h * vabs(x->rod[ACROSS])),
                             EPS * vabs(at[PHI]), EPS * vabs(at[MU])};
    vec rows[WIDE][2 * WIDE], shift[WIDE], out[WIDE];
    NAME(left_out)(x, h, out, inner);
    for (int i = 0; i < inner; i++) {
        shift[i] = ZERO;
        for (int k = 0; k < inner; k++)
            shift[i] += x->transfer[i][k] * x->shift[k];
        for (int j = 0; j < inner; j++) {
            rows[i][j] = ZERO, rows[i][inner + j] = i == j ? out[i] + fresh[i] : ZERO;
            for (int k = j; k < inner; k++)
                rows[i][j] += x->transfer[i][k] * x->spread[k][j];
        }
    }
    for (int i = 0; i < inner; i++) { /* Gram and Schmidt */
        vec size = ZERO;
        x->shift[i] = shift[i];
        for (int k = 0; k < 2 * inner; k++)
            size += rows[i][k] * rows[i][k];
        x->spread[i][i] = size = vroot(size);
        size = 1.0 / (size + 1e-300);
        for (int k = 0; k < 2 * inner; k++)
            rows[i][k] *= size;
        for (int j = i + 1; j < inner; j++) {
            vec share = ZERO;
            for (int k = 0; k < 2 * inner; k++)
                share += rows[j][k] * rows[i][k];
            x->spread[j][i] = share;
            for (int k = 0; k < 2 * inner; k++)
                rows[j][k] -= share * rows[i][k];
        }
    }
    x->shift[SPEED] += EPS * h * pull;
    x->shift[Q] += EPS * h * vabs(x->rod[ACROSS]);
    for (int i = 0; i < 2; i++) {
        const int row = i ? ALPHA : BETA;
        vec square = ZERO;
        for (int k = 0; k <= row; k++)
            square += x->spread[row][k] * x->spread[row][k];
        x->worst[i] = vmax(x->worst[i], vroot(square) + vabs(x->shift[row]));
    }
}

static inline ALWAYS TARGET void NAME(vary)(NAME(lanes) *x, const marches *all, vec h, const int rubbed)
{
    const int n = all->columns, judged = all->errors != 0, inner = rubbed ? WIDE : PHI;
    const int deep = judged ? SHALLOW : all->deep;
    if (rubbed) {
        NAME(derive_rubbed)(x, deep);
        for (int i = 0; i < (judged ? inner : n); i += 2)
            NAME(columns_rubbed)(x, i, i + 1 < n || judged ? 2 : 1, deep, !judged, h);
    } else {
        NAME(derive)(x, deep);
        if (judged)
            for (int i = 0; i < PHI; i += 2)
                NAME(columns)(x, i, 2, SHALLOW, 0, 0, h);
        else
            for (int i = 0; i < n; i += 2)
                NAME(columns)(x, i, 2, deep, 0, 1, h);
    }
    if (judged) {
        NAME(spread)(x, inner, h);
        NAME(carry)(x, n, inner, inner);
    } else
        NAME(carry)(x, n, WIDE, STATES);
}

/* Writes the states at the stations of each lane that lie in its step; without friction all but phi and mu. */
static inline TARGET void NAME(read)(NAME(lanes) *x, const marches *all, vec h, const int *final, const int rubbed)
{
    vec y[STATES] = {ZERO};
    const vec ends = x->t + h;
    for (;;) {
        vec t = ZERO;
        int busy[W], any = 0;
        for (int i = 0; i < W; i++) {
            const int64_t k = x->station[i];
            busy[i] = k < x->last[i] && (final[i] || all->stations[k] <= LANE(ends, i));
            any |= busy[i];
            if (busy[i])
                LANE(t, i) = (all->stations[k] - LANE(x->t, i)) - LANE(x->lost, i);
        }
        if (!any)
            return;
        y[BETA] = NAME(value)(x->y[BETA], ORDER, t), y[SPEED] = NAME(value)(x->y[SPEED], ORDER, t);
        y[ALPHA] = NAME(value)(x->y[ALPHA], ORDER, t), y[Q] = NAME(value)(x->y[Q], ORDER, t);
        y[SHORT] = NAME(value)(x->y[SHORT], ORDER, t), y[ROUND] = NAME(value)(x->y[ROUND], ORDER, t);
        if (rubbed)
            y[PHI] = NAME(value)(x->y[PHI], ORDER, t), y[MU] = NAME(value)(x->y[MU], ORDER, t);
        double values[STATES][W];
        memcpy(values, y, sizeof values);
        for (int i = 0; i < W; i++)
            if (busy[i]) {
                const int64_t at = all->stride * x->station[i]++;
                for (int k = 0; k < STATES; k++)
                    if (rubbed || (k != PHI && k != MU))
                        all->out[k][at] = values[k][i];
            }
    }
}

/* The lane takes stretch i; where i < 0 it stays where it is. */
static TARGET void NAME(take)(NAME(lanes) *x, int lane, int64_t i, const marches *all)
{
    const int64_t rod = i < 0 || all->alike ? 0 : i;
    x->stretch[lane] = i, x->step[lane] = 0;
    for (int k = 0; k < PARAMETERS; k++)
        LANE(x->rod[k], lane) = i < 0 ? 0 : all->rod[rod * PARAMETERS + k];
    for (int k = 0; k < STATES; k++) {
        LANE(x->fine[k], lane) = i < 0 ? 1 : 1 / all->goal[rod * STATES + k];
        LANE(x->at[k], lane) = i < 0 ? 0 : all->begin[i * STATES + k];
        for (int j = 0; j < GIVENS; j++)
            LANE(x->D[k][j], lane) = k == j && j < WIDE;
    }
    for (int k = 0; k < WIDE; k++) {
        LANE(x->growth[k], lane) = k == BETA, LANE(x->shift[k], lane) = 0;
        for (int j = 0; j < WIDE; j++)
            LANE(x->spread[k][j], lane) = 0;
    }
    LANE(x->worst[0], lane) = LANE(x->worst[1], lane) = LANE(x->t, lane) = LANE(x->lost, lane) = 0;
    LANE(x->length, lane) = i < 0 ? 0 : all->length[i];
    x->station[lane] = i < 0 || !all->first ? 0 : all->first[i];
    x->last[lane] = i < 0 || !all->first ? 0 : all->first[i + 1];
}

/* Writes what is known of the stretch of a lane at its end; NaN where it is lost. */
static TARGET void NAME(finish)(NAME(lanes) *x, int lane, int lost, const marches *all)
{
    const int64_t i = x->stretch[lane], n = all->columns;
    if (all->first && LANE(x->rod[FRICTION], lane) == 0)
        for (int64_t j = all->first[i]; j < x->last[lane]; j++) {
            all->out[PHI][all->stride * j] = all->begin[i * STATES + PHI] + LANE(x->rod[ALONG], lane) * all->stations[j];
            all->out[MU][all->stride * j] = all->begin[i * STATES + MU];
        }
    for (int k = 0; k < STATES; k++) {
        all->end[i * STATES + k] = lost ? NAN : LANE(x->at[k], lane);
        for (int64_t j = lost ? x->station[lane] : x->last[lane]; j < x->last[lane]; j++)
            all->out[k][all->stride * j] = NAN;
        for (int j = 0; j < n; j++)
            all->derived[(i * STATES + k) * n + j] = lost ? NAN : LANE(x->D[k][j], lane);
    }
    for (int k = 0; k < WIDE && n > 0; k++)
        all->growth[i * WIDE + k] = lost ? NAN : LANE(x->growth[k], lane);
    for (int k = 0; k < 2 && all->errors; k++)
        all->errors[2 * i + k] = lost ? NAN : LANE(x->worst[k], lane);
    all->steps[i] = x->step[lane];
}

/* One step of every lane. Returns through `over` which lanes have come to their end, or are lost. */
static inline ALWAYS TARGET void NAME(advance)(NAME(lanes) *x, const marches *all, int *over, int *lost, const int rubbed)
{
    NAME(expand)(x, rubbed);
    const vec left = (x->length - x->t) - x->lost, steps = all->shorter * NAME(reach)(x);
    const NAME(mask) ends = MASK(steps >= left);
    const vec h = PICK(ends, left, steps);
    int final[W];
    for (int i = 0; i < W; i++)
        final[i] = LANE(steps, i) >= LANE(left, i);
    if (all->first)
        NAME(read)(x, all, h, final, rubbed);
    if (all->columns > 0)
        NAME(vary)(x, all, h, rubbed);
    vec sum = ZERO;
    for (int k = 0; k < STATES; k++) {
        x->at[k] = NAME(value)(x->y[k], k == PHI && !rubbed ? 1 : k == MU && !rubbed ? 0 : ORDER, h);
        sum += x->at[k];
    }
    for (int i = 0; i < W; i++) {
        const double t = LANE(x->t, i);
        x->step[i]++;
        lost[i] = !(fabs(LANE(sum, i)) < INFINITY) || (!final[i] && (t + LANE(h, i) * 1e-3 <= t || x->step[i] > rod_tuning.most_steps));
        over[i] = final[i] || lost[i];
    }
    const vec t = x->t + h, back = t - x->t;
    x->lost += (x->t - (t - back)) + (h - back), x->t = t;
}

/* March the stretches, W at a time: a lane whose stretch is done takes the next. Returns -1 if there is no memory, else
   how many were lost. */
static TARGET int64_t NAME(run)(const marches *all)
{
    char *memory = malloc(sizeof(NAME(lanes)) + 63); /* aligned by hand: Windows has no aligned_alloc */
    if (!memory)
        return -1;
    NAME(lanes) *x = (NAME(lanes) *)(((uintptr_t)memory + 63) & ~(uintptr_t)63);
    memset(x, 0, sizeof *x);
    int64_t next = all->from, count = 0;
    int busy = 0, over[W], lost[W];
    for (int i = 0; i < W; i++) {
        NAME(take)(x, i, next < all->to ? next : -1, all);
        busy += next++ < all->to;
    }
    while (busy) {
        int rubbed = all->columns > WIDE;
        for (int i = 0; i < W; i++)
            rubbed |= LANE(x->rod[FRICTION], i) != 0;
        if (rubbed)
            NAME(advance)(x, all, over, lost, 1);
        else
            NAME(advance)(x, all, over, lost, 0);
        for (int i = 0; i < W; i++) {
            if (x->stretch[i] < 0 || !over[i])
                continue;
            NAME(finish)(x, i, lost[i], all);
            count += lost[i];
            busy -= next >= all->to;
            NAME(take)(x, i, next < all->to ? next++ : -1, all);
        }
    }
    free(memory);
    return count;
}

#undef W
#undef SUFFIX
