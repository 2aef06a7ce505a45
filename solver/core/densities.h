/* The densities whose integrals and extremes are the observables, in units of A and rho, at the nodes of one piece of a
   rod, and their derivatives. */

#ifndef ROD_DENSITIES_H
#define ROD_DENSITIES_H

#include "measured.h"
#include "orbit_parts.h"

enum { AT = 24, LONGEST = 64 }; /* nodes of a piece; most coefficients of its series */

/* The loads at the nodes of a piece. steepness: a bound of the change of beta_t for a unit change of beta. weight: across
   the rod, outward. divisor: what friction divides the contact force by. far_lam, far_mu: at the far end of the rod, where
   the given loads act. sign: of the push. */
typedef struct {
    double lam[AT], mu[AT], phi[AT], weight[AT], divisor[AT], steepness[AT], far_lam, far_mu, sign;
} rod_loads;

/* beta, |beta_t|, sin and cos of beta. */
typedef struct {
    double beta[AT], speed[AT], s[AT], c[AT];
} node_angles;

/* values. size: sum of the sizes of the terms of a value, whose rounding is that many EPS. spread: the largest change of a
   value for a unit change of beta and the change of beta_t that comes with it. */
typedef struct {
    double values[AT], size[AT], spread[AT];
} density;

/* The derivatives of the values with respect to beta, |beta_t|, lam, mu and phi. Where no one reads them, the compiler
   leaves them out. */
typedef struct {
    double beta[AT], speed[AT], lam[AT], mu[AT], phi[AT];
} density_slopes;

/* Loads that are the same along a rod. */
INLINE void steady_loads(double lam, double mu, double phi, double sign, rod_loads *out)
{
    for (int i = 0; i < AT; i++)
        out->lam[i] = lam, out->mu[i] = mu, out->phi[i] = phi, out->weight[i] = 0, out->divisor[i] = 1,
        out->steepness[i] = steepness_of(lam, mu, phi);
    out->far_lam = lam, out->far_mu = mu, out->sign = sign;
}

/* The first n polynomials of Chebyshev at x. */
INLINE void polynomials_at(int n, const double *restrict x, double *restrict out)
{
    for (int i = 0; i < AT; i++)
        out[i] = 1, out[AT + i] = x[i];
    for (int k = 2; k < n; k++)
        for (int i = 0; i < AT; i++)
            out[k * AT + i] = 2 * x[i] * out[(k - 1) * AT + i] - out[(k - 2) * AT + i];
}

/* sin and cos of beta. */
INLINE void directions_of(node_angles *restrict a)
{
    sin_cos_of(AT, a->beta, a->s, a->c);
}

/* Loads from series (5, n) of lam, mu, phi, the weight across the rod and the divisor of the contact force. */
INLINE void loads_at(int width, int n, const double *restrict series, const double *restrict polynomials, rod_loads *restrict l)
{
    double *values[5] = {l->lam, l->mu, l->phi, l->weight, l->divisor};
    for (int k = 0; k < 5; k++)
        product(width, n, AT, series + k * n, polynomials, values[k]);
    for (int i = 0; i < AT; i++)
        l->steepness[i] = steepness_of(l->lam[i], l->mu[i], l->phi[i]);
}

/* The angles from the series of beta and |beta_t| (2, n) and the polynomials at the nodes. */
INLINE void angles_at(int width, int n, const double *restrict series, const double *restrict polynomials, node_angles *restrict a)
{
    product_of_two(width, n, AT, series, series + n, polynomials, a->beta, a->speed);
    directions_of(a);
}

INLINE void angle_density(const node_angles *restrict a, const rod_loads *l, density *restrict out,
                          density_slopes *restrict by)
{
    for (int i = 0; i < AT; i++) {
        out->values[i] = a->beta[i], out->size[i] = fabs(a->beta[i]), out->spread[i] = 1;
        by->beta[i] = 1;
    }
}

/* sin or cos of beta; other: its derivative. */
INLINE void direction(const double *restrict values, const double *restrict other, double sign, density *restrict out,
                      density_slopes *restrict by)
{
    for (int i = 0; i < AT; i++) {
        out->values[i] = values[i], out->size[i] = fabs(values[i]), out->spread[i] = fabs(other[i]);
        by->beta[i] = sign * other[i];
    }
}

INLINE void across_density(const node_angles *restrict a, const rod_loads *l, density *restrict out,
                           density_slopes *restrict by)
{
    direction(a->s, a->c, 1, out, by);
}

INLINE void along_density(const node_angles *restrict a, const rod_loads *l, density *restrict out,
                          density_slopes *restrict by)
{
    direction(a->c, a->s, -1, out, by);
}

/* No derivative where the rod is straight. */
INLINE void curvature_density(const node_angles *restrict a, const rod_loads *l, density *restrict out,
                      density_slopes *restrict by)
{
    double more[AT];
    for (int i = 0; i < AT; i++) {
        const double v = fabs(a->speed[i]), s2 = a->s[i] * a->s[i];
        out->values[i] = sqrt(v * v + s2 * s2), more[i] = larger(v, s2);
    }
    if (!(largest_size(AT, more) < 1e150 && smallest_size(AT, more) > 1e-140))
        for (int i = 0; i < AT; i++)
            out->values[i] = hypot(a->speed[i], a->s[i] * a->s[i]);
    for (int i = 0; i < AT; i++) {
        const double v = fabs(a->speed[i]), s = a->s[i], kappa = out->values[i];
        const double share = kappa > 0 ? v / kappa : 1.0;
        out->size[i] = v + s * s;
        out->spread[i] = share * l->steepness[i] + 2 * fabs(s * a->c[i]);
        by->beta[i] = 2 * s * a->c[i] * (s * s / kappa), by->speed[i] = v / kappa;
    }
}

INLINE void bending_density(const node_angles *restrict a, const rod_loads *l, density *restrict out,
                    density_slopes *restrict by)
{
    for (int i = 0; i < AT; i++) {
        const double v = a->speed[i], s = a->s[i], s2 = s * s;
        const double moved = 2 * s2 * (s * a->c[i]);
        out->values[i] = out->size[i] = (v * v + s2 * s2) / 2;
        out->spread[i] = fabs(v) * l->steepness[i] + fabs(moved);
        by->beta[i] = moved, by->speed[i] = v;
    }
}

/* With weight, the work of FZ at the far end less that of the weight along the axis is that of the local FZ. */
INLINE void potential_density(const node_angles *restrict a, const rod_loads *l, density *restrict out, density_slopes *restrict by)
{
    const double lam = l->far_lam, mu = l->far_mu;
    for (int i = 0; i < AT; i++) {
        const double phi = l->phi[i], weight = l->weight[i], v = a->speed[i], s = a->s[i], c = a->c[i], s2 = s * s;
        const double bent = (v * v + s2 * s2) / 2, twisted = mu * s * c, pulled = phi * c, turned = lam * s;
        const double moved = 2 * s2 * s * c + mu * (c - s) * (c + s) + phi * s - lam * c;
        out->values[i] = bent + twisted - pulled - turned - weight;
        out->size[i] = bent + fabs(twisted) + fabs(pulled) + fabs(turned) + fabs(weight);
        out->spread[i] = fabs(v) * l->steepness[i] + fabs(moved);
        by->beta[i] = moved, by->speed[i] = v, by->lam[i] = -s, by->mu[i] = s * c, by->phi[i] = -c;
    }
}

/* The push: the contact force, positive where the cylinder pushes; eq. (34), corrected. */
INLINE void outward_density(const node_angles *restrict a, const rod_loads *l, density *restrict out, density_slopes *restrict by)
{
    for (int i = 0; i < AT; i++) {
        const double lam = l->lam[i], mu = l->mu[i], phi = l->phi[i], weight = l->weight[i];
        const double v = a->speed[i], s = a->s[i], c = a->c[i], absolute = fabs(c);
        const double v2 = v * v, s2 = s * s, s3 = s * s * s, cos2 = (c - s) * (c + s);
        const double across = lam - mu * c - s3, lever = 3 * s * c - mu;
        const double even = (lam - (c < 0 ? -mu : mu)) * c, twist = mu * (s2 * (1 + 2 * absolute) / (1 + absolute));
        const double rest = (phi + 2 * c * s2) * s, H = even + twist - rest;
        const double size = fabs(s) * (fabs(lam) + fabs(mu * c) + fabs(s3)) + 3 * v2 * fabs(cos2) + fabs(weight);
        const double rate = slope_rate_by(lam, mu, phi, s, c);
        const double moved = c * across + s * (mu * s - 3 * s * s * c) + rate * lever + 3 * H * cos2;
        const double by_beta = moved + 12 * v2 * s * c, by_speed = -6 * (v * cos2), share = l->sign / l->divisor[i];
        out->values[i] = (s * across + H * lever - 3 * v2 * cos2 - weight) / l->divisor[i] * l->sign;
        out->size[i] = size + (fabs(even) + fabs(twist) + fabs(rest)) * (3 * fabs(s * c) + fabs(mu));
        out->spread[i] = fabs(by_beta) + fabs(by_speed) * l->steepness[i];
        by->beta[i] = share * by_beta, by->speed[i] = share * by_speed;
        by->lam[i] = share * (s + c * lever), by->mu[i] = share * (-s * c - cos2 * lever - H);
        by->phi[i] = share * (-s * lever);
    }
}

/* The internal force along the tangent. */
INLINE void tension_density(const node_angles *restrict a, const rod_loads *l, density *restrict out, density_slopes *restrict by)
{
    for (int i = 0; i < AT; i++) {
        const double lam = l->lam[i], mu = l->mu[i], phi = l->phi[i];
        const double s = a->s[i], c = a->c[i], s3 = s * s * s, across = lam - mu * c - s3;
        const double moved = -phi * s + c * across + s * (mu * s - 3 * s * s * c);
        out->values[i] = phi * c + across * s;
        out->size[i] = fabs(phi * c) + fabs(s) * (fabs(lam) + fabs(mu * c) + fabs(s3));
        out->spread[i] = fabs(moved);
        by->beta[i] = moved, by->lam[i] = s, by->mu[i] = -s * c, by->phi[i] = c;
    }
}

/* by: zero before, for a density does not write what is zero. */
INLINE void density_of(int kind, const node_angles *a, const rod_loads *l, density *out, density_slopes *by)
{
    switch (kind) {
#define DENSITY_CASE(id, name)                                                                                         \
    case id: name##_density(a, l, out, by); break;
        DENSITY_ROWS(DENSITY_CASE)
    }
}

#endif
