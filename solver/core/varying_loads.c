/* Rods whose loads vary along them: weight, and friction of a rod that slides or turns. Taylor series with variations.

State, in units of A and rho: beta, beta_t, alpha, q = lam - mu, phi, mu, u = t - z, g = gamma + alpha, both from 0.
lam - mu, 1 - cos(beta) and t - z keep their digits in a slender rod, where beta, lam - mu and t - z are small.

    beta_tt = -H,  H = q cos + mu e (3 - 2 e) - (phi + 2 cos sin^2) sin,  e = 1 - cos(beta)
    alpha_t = sin,  u_t = e,  g_t = (A/C) mu + sin e
    phi_t = ws_c + k P cos,  lam_t = ws_s sin(alpha) + k P sin        k = sigma mu_f, along the rod
    mu_t = k a P,  phi_t = ws_c + k o P sin,  lam_t = ws_s sin(alpha) + k P (a - o) cos      a rod that turns in place
    P = o f,  f = sin (q + mu e - sin^3) + H (3 sin cos - mu) - 3 beta_t^2 cos(2 beta) - ws_s cos(alpha) + beta_t mu_t

with o = 1 outside and -1 inside. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#define ORDER 20
#define TERMS (ORDER + 1)
#define STATES 8
#define BENT 2   /* columns: changes by beta and beta_t, */
#define WIDE 6   /* columns: changes by the first six numbers of the state, */
#define GIVENS 9 /* and by the weight along, the weight across and the friction */
#define MOST_STEPS 1000000

enum { BETA, SPEED, ALPHA, Q, PHI, MU, SHORT, ROUND };
enum { RATIO, ALONG, ACROSS, FRICTION, TURNING, RADIUS, SIDE, PARAMETERS }; /* of a rod */

typedef double Series[TERMS];

typedef struct {
    Series y[STATES], s, e, c, sa, ea, ca, s2, sc, e2, w, g, H, se, v2, FY, lever, f, P, Pc, Ps;
    Series by_b, by_g, P_by[GIVENS]; /* derivatives of H and g_t by beta, and of P by the columns */
} Base;

/* The coefficient k of a product of two series. Four sums, which do not wait for each other. */
static inline double product(const double *x, const double *y, int k)
{
    double sum[4] = {0};
    int j = 0;
    y += k;
    for (; j + 3 <= k; j += 4)
        for (int i = 0; i < 4; i++) sum[i] += x[j + i] * y[-j - i];
    for (; j <= k; j++) sum[0] += x[j] * y[-j];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* The coefficients k of sin, 1 - cos and cos of an angle, whose rate is known up to k - 1. */
static void circle(const double *angle, const double *rate, double *s, double *e, double *c, int k)
{
    if (k == 0) {
        double half = sin(angle[0] / 2);
        s[0] = sin(angle[0]);
        e[0] = 2 * half * half;
        c[0] = 1 - e[0];
        return;
    }
    s[k] = product(rate, c, k - 1) / k;
    e[k] = product(rate, s, k - 1) / k;
    c[k] = -e[k];
}

static void pushed(Base *x, const double *rod, int k)
{
    const double *v = x->y[SPEED];
    x->v2[k] = product(v, v, k);
    x->FY[k] = x->y[Q][k] + product(x->y[MU], x->e, k) - product(x->s, x->s2, k);
    x->lever[k] = 3 * x->sc[k] - x->y[MU][k];
    double plain = product(x->FY, x->s, k) + product(x->H, x->lever, k) - rod[ACROSS] * x->ca[k];
    plain += -3 * x->v2[k] + 6 * product(x->v2, x->s2, k);
    double divisor = 1;
    if (rod[TURNING] != 0) { /* beta_t mu_t holds P itself */
        double much = rod[SIDE] * rod[FRICTION] * rod[RADIUS];
        divisor = 1 - much * v[0];
        for (int j = 1; j <= k; j++) plain += rod[SIDE] * much * v[j] * x->P[k - j];
    }
    x->P[k] = rod[SIDE] * plain / divisor;
}

/* The coefficients k of what the state's coefficients up to k give, and the state's coefficients k + 1. */
static void next_terms(Base *x, const double *rod, int k)
{
    circle(x->y[BETA], x->y[SPEED], x->s, x->e, x->c, k);
    if (rod[ACROSS] != 0) circle(x->y[ALPHA], x->s, x->sa, x->ea, x->ca, k);
    else x->sa[k] = x->ca[k] = 0;
    x->s2[k] = product(x->s, x->s, k);
    x->sc[k] = product(x->s, x->c, k);
    x->e2[k] = product(x->e, x->e, k);
    x->w[k] = x->y[PHI][k] + 2 * product(x->c, x->s2, k);
    x->g[k] = 3 * x->e[k] - 2 * x->e2[k];
    x->H[k] = product(x->y[Q], x->c, k) + product(x->y[MU], x->g, k) - product(x->w, x->s, k);
    x->se[k] = product(x->s, x->e, k);
    double along = k == 0 ? rod[ALONG] : 0, across = rod[ACROSS] * x->sa[k], twist = 0;
    if (rod[FRICTION] != 0) {
        pushed(x, rod, k);
        x->Pc[k] = product(x->P, x->c, k);
        x->Ps[k] = product(x->P, x->s, k);
        if (rod[TURNING] != 0) {
            twist = rod[FRICTION] * rod[RADIUS] * x->P[k];
            along += rod[FRICTION] * rod[SIDE] * x->Ps[k];
            across += rod[FRICTION] * (rod[RADIUS] - rod[SIDE]) * x->Pc[k];
        } else {
            along += rod[FRICTION] * x->Pc[k];
            across += rod[FRICTION] * x->Ps[k];
        }
    }
    double n = k + 1;
    x->y[BETA][k + 1] = x->y[SPEED][k] / n;
    x->y[SPEED][k + 1] = -x->H[k] / n;
    x->y[ALPHA][k + 1] = x->s[k] / n;
    x->y[Q][k + 1] = (across - twist) / n;
    x->y[PHI][k + 1] = along / n;
    x->y[MU][k + 1] = twist / n;
    x->y[SHORT][k + 1] = x->e[k] / n;
    x->y[ROUND][k + 1] = (rod[RATIO] * x->y[MU][k] + x->se[k]) / n;
}

static void jacobian(Base *x, int k)
{
    x->by_b[k] = -product(x->y[Q], x->s, k) + 3 * product(x->y[MU], x->s, k) - 4 * product(x->y[MU], x->se, k)
                 - product(x->y[PHI], x->c, k) - 6 * product(x->sc, x->sc, k) + 2 * product(x->s2, x->s2, k);
    x->by_g[k] = product(x->c, x->e, k) + x->s2[k];
}

/* The derivatives of P: of o f by the numbers of the state and by the weight across, of the rest by the friction. */
static void jacobian_of_push(Base *x, const double *rod, int k)
{
    Series FYb;
    for (int j = 0; j <= k; j++) FYb[j] = product(x->y[MU], x->s, j) - 3 * product(x->s2, x->c, j);
    double by[GIVENS] = {0};
    by[BETA] = product(FYb, x->s, k) + product(x->FY, x->c, k) + product(x->by_b, x->lever, k) + 3 * x->H[k]
               - 6 * product(x->H, x->s2, k) + 12 * product(x->v2, x->sc, k);
    by[SPEED] = -6 * x->y[SPEED][k] + 12 * product(x->y[SPEED], x->s2, k);
    by[ALPHA] = rod[ACROSS] * x->sa[k];
    by[Q] = x->s[k] + product(x->c, x->lever, k);
    by[PHI] = -product(x->s, x->lever, k);
    by[MU] = x->se[k] + product(x->g, x->lever, k) - x->H[k];
    by[WIDE + 1] = -x->ca[k];
    double much = rod[TURNING] != 0 ? rod[SIDE] * rod[FRICTION] * rod[RADIUS] : 0, divisor = 1 - much * x->y[SPEED][0];
    for (int i = 0; i < GIVENS; i++) {
        double n = rod[SIDE] * by[i];
        if (much != 0) {
            if (i == SPEED) n += much * x->P[k];
            if (i == WIDE + 2) n += rod[SIDE] * rod[RADIUS] * product(x->y[SPEED], x->P, k);
            for (int j = 1; j <= k; j++) n += much * x->y[SPEED][j] * x->P_by[i][k - j];
        }
        x->P_by[i][k] = n / divisor;
    }
}

typedef double Columns[TERMS][GIVENS];

#define ADD(sum, factor, series, row)                                                                                  \
    for (int j = 0; j <= k; j++)                                                                                       \
        for (int i = 0; i < n; i++) (sum)[i] += (factor) * (series)[j] * (row)[k - j][i]

/* The coefficients k + 1 of n columns. */
static inline __attribute__((always_inline)) void next_columns(const Base *x, const double *rod, Columns *d, int k, int n)
{
    double H[GIVENS] = {0}, across[GIVENS] = {0}, along[GIVENS] = {0}, twist[GIVENS] = {0}, bent[GIVENS] = {0};
    double turned[GIVENS] = {0}, lost[GIVENS] = {0};
    ADD(H, 1, x->by_b, d[BETA]);
    ADD(H, 1, x->c, d[Q]);
    if (rod[FRICTION] != 0 || n > WIDE) {
        ADD(H, 1, x->g, d[MU]);
        ADD(H, -1, x->s, d[PHI]);
    } else { /* the changes of phi and mu are constant */
        for (int i = 0; i < n; i++) H[i] += x->g[k] * d[MU][0][i] - x->s[k] * d[PHI][0][i];
    }
    ADD(turned, 1, x->c, d[BETA]);
    ADD(lost, 1, x->s, d[BETA]);
    ADD(bent, 1, x->by_g, d[BETA]);
    if (rod[ACROSS] != 0) ADD(across, rod[ACROSS], x->ca, d[ALPHA]);
    if (n > WIDE) {
        along[WIDE] += k == 0;
        across[WIDE + 1] += x->sa[k];
    }
    if (rod[FRICTION] != 0) {
        double dP[TERMS][GIVENS]; /* all orders up to k again: kept nowhere, as friction is rare */
        int turning = rod[TURNING] != 0;
        for (int m = 0; m <= k; m++) {
            for (int i = 0; i < n; i++) dP[m][i] = i < WIDE ? 0 : x->P_by[i][m];
            for (int row = 0; row < WIDE; row++)
                for (int j = 0; j <= m; j++)
                    for (int i = 0; i < n; i++) dP[m][i] += x->P_by[row][j] * d[row][m - j][i];
        }
        double by_s[GIVENS] = {0}, by_c[GIVENS] = {0};
        ADD(by_s, 1, x->s, dP);
        ADD(by_s, 1, x->Pc, d[BETA]);
        ADD(by_c, 1, x->c, dP);
        ADD(by_c, -1, x->Ps, d[BETA]);
        double a = rod[RADIUS], o = rod[SIDE], f = rod[FRICTION];
        for (int i = 0; i < n; i++) {
            along[i] += f * (turning ? o * by_s[i] : by_c[i]);
            across[i] += f * (turning ? (a - o) * by_c[i] : by_s[i]);
            twist[i] += turning ? f * a * dP[k][i] : 0;
        }
        if (n > WIDE) {
            along[WIDE + 2] += turning ? o * x->Ps[k] : x->Pc[k];
            across[WIDE + 2] += turning ? (a - o) * x->Pc[k] : x->Ps[k];
            twist[WIDE + 2] += turning ? a * x->P[k] : 0;
        }
    }
    double scale = 1.0 / (k + 1);
    for (int i = 0; i < n; i++) {
        d[BETA][k + 1][i] = scale * d[SPEED][k][i];
        d[SPEED][k + 1][i] = -scale * H[i];
        d[ALPHA][k + 1][i] = scale * turned[i];
        d[Q][k + 1][i] = scale * (across[i] - twist[i]);
        d[PHI][k + 1][i] = scale * along[i];
        d[MU][k + 1][i] = scale * twist[i];
        d[SHORT][k + 1][i] = scale * lost[i];
        d[ROUND][k + 1][i] = scale * (rod[RATIO] * d[MU][k][i] + bent[i]);
    }
}

/* The series of the state from y; the longest step at which the last terms are below `tol` of the scales. */
static double expanded(Base *x, const double *rod, const double *y, const double *scale, double tol)
{
    for (int i = 0; i < STATES; i++) x->y[i][0] = y[i];
    for (int k = 0; k < ORDER; k++) next_terms(x, rod, k);
    double worst = 0;
    for (int i = 0; i < SHORT; i++)
        for (int k = ORDER - 1; k <= ORDER; k++) {
            double size = fabs(x->y[i][k]) / (tol * scale[i]);
            if (!(size <= 0)) worst = fmax(worst, pow(size, 1.0 / k));
            if (size != size) return NAN;
        }
    return worst > 0 ? 1 / worst : INFINITY;
}

static void evaluated(const Series *y, double t, double *out)
{
    for (int i = 0; i < STATES; i++) {
        double sum = y[i][ORDER];
        for (int k = ORDER - 1; k >= 0; k--) sum = sum * t + y[i][k];
        out[i] = sum;
    }
}

static inline __attribute__((always_inline)) void carried(Base *x, const double *rod, double h, double *columns,
                                                          Columns *d, int n)
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < n; j++) d[i][0][j] = columns[i * n + j];
    for (int k = 0; k < ORDER; k++) next_columns(x, rod, d, k, n);
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < n; j++) {
            double sum = d[i][ORDER][j];
            for (int k = ORDER - 1; k >= 0; k--) sum = sum * h + d[i][k][j];
            columns[i * n + j] = sum;
        }
}

/* March `count` stretches.
 *
 * rod, scale: PARAMETERS and STATES numbers of each; alike: those of the first hold for all. begin, end: (count, STATES). columns: (count, STATES, n), the derivatives of the end by the begin's first
 * six numbers (n = 6), and by the weight along, across and the friction (n = 9); n = 0: none. growth: (count, 6), the
 * largest size of d beta by these at the ends of steps. Stations first[i] .. first[i + 1] of stretch i, rising, fill
 * out (stations, STATES). steps: (count). Returns how many stretches were lost; their `end` is NaN. */
int64_t rod_loaded(int64_t count, const double *rod, const double *scale, int64_t alike, double tol, double shorter,
                   const double *begin, const double *length, int n, double *end, double *columns, double *growth,
                   const int64_t *first, const double *stations, double *out, int64_t *steps)
{
    int64_t lost = 0;
    for (int64_t at = 0; at < count; at++) {
        const double *mine = rod + (alike ? 0 : at * PARAMETERS), *sizes = scale + (alike ? 0 : at * STATES);
        double y[STATES], t = 0, whole = length[at], local[STATES * GIVENS], *D = n ? local : 0;
        Base x;
        Columns d[STATES];
        memcpy(y, begin + at * STATES, sizeof y);
        if (D) {
            memset(local, 0, sizeof local);
            for (int i = 0; i < n && i < WIDE; i++) D[i * n + i] = 1;
        }
        if (growth)
            for (int i = 0; i < WIDE; i++) growth[at * WIDE + i] = i == BETA;
        int64_t station = first ? first[at] : 0, last = first ? first[at + 1] : 0, number = 0;
        int fails = 0;
        while (number++ < MOST_STEPS) {
            double h = shorter * expanded(&x, mine, y, sizes, tol);
            if (!(h > 0)) { fails = 1; break; }
            double left = whole - t;
            int final = h >= left;
            if (final) h = left;
            for (; station < last && (final || stations[station] <= t + h); station++)
                evaluated(x.y, stations[station] - t, out + station * STATES);
            if (D) {
                for (int k = 0; k < ORDER; k++) jacobian(&x, k);
                if (mine[FRICTION] != 0)
                    for (int k = 0; k < ORDER; k++) jacobian_of_push(&x, mine, k);
                if (n == BENT) carried(&x, mine, h, D, d, BENT);
                else if (n == WIDE) carried(&x, mine, h, D, d, WIDE);
                else carried(&x, mine, h, D, d, GIVENS);
            }
            evaluated(x.y, h, y);
            t += h;
            if (growth && D)
                for (int i = 0; i < n && i < WIDE; i++) growth[at * WIDE + i] = fmax(growth[at * WIDE + i], fabs(D[i]));
            if (final) break;
            if (t + h * 1e-3 <= t) { fails = 1; break; }
        }
        if (number > MOST_STEPS) fails = 1;
        lost += fails;
        if (fails) {
            for (int i = 0; i < STATES; i++) y[i] = NAN;
            for (; station < last; station++)
                for (int i = 0; i < STATES; i++) out[station * STATES + i] = NAN;
        }
        memcpy(end + at * STATES, y, sizeof y);
        if (D) memcpy(columns + at * STATES * n, D, sizeof(double) * STATES * n);
        if (steps) steps[at] = number;
    }
    return lost;
}
