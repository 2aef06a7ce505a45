/* The densities whose integrals and extremes are the observables, at the nodes of one piece of a rod: each function does
   what the one of the same name does in solver/observe/densities.py. */

#ifndef ROD_DENSITIES_H
#define ROD_DENSITIES_H

#include "orbit_parts.h"

enum { AT = 24, LONGEST = 64 }; /* nodes of a piece; most coefficients of its series */
enum { ANGLE, CURVATURE, BENDING, POTENTIAL, OUTWARD, TENSION, ACROSS, ALONG, DENSITIES };

typedef struct {
    double lam, mu, phi, sign, steepness; /* sign: of the push; steepness: `densities.rate` */
} rod_loads;

/* beta, |beta_t|, sin and cos of beta. */
typedef struct {
    double beta[AT], speed[AT], s[AT], c[AT];
} node_angles;

/* `densities.Density` */
typedef struct {
    double values[AT], size[AT], spread[AT];
} density;

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
    double far = 0;
    for (int i = 0; i < AT; i++)
        far = larger(far, fabs(a->beta[i]));
    if (far < FAR)
        sin_cos_of(AT, a->beta, a->s, a->c);
    else
        for (int i = 0; i < AT; i++)
            a->s[i] = sin(a->beta[i]), a->c[i] = cos(a->beta[i]);
}

/* The angles from the series of beta and |beta_t| (2, n) and the polynomials at the nodes. */
INLINE void angles_at(int n, const double *restrict series, const double *restrict polynomials, node_angles *restrict a)
{
    product(n, AT, series, polynomials, a->beta);
    product(n, AT, series + n, polynomials, a->speed);
    directions_of(a);
}

INLINE void angle(const node_angles *restrict a, density *restrict out)
{
    for (int i = 0; i < AT; i++)
        out->values[i] = a->beta[i], out->size[i] = fabs(a->beta[i]), out->spread[i] = 1;
}

INLINE void direction(const double *restrict values, const double *restrict other, density *restrict out)
{
    for (int i = 0; i < AT; i++)
        out->values[i] = values[i], out->size[i] = fabs(values[i]), out->spread[i] = fabs(other[i]);
}

INLINE void curvature(const node_angles *restrict a, const rod_loads *l, density *restrict out)
{
    double most = 0, least = INFINITY;
    for (int i = 0; i < AT; i++) {
        const double v = fabs(a->speed[i]), s2 = a->s[i] * a->s[i], more = larger(v, s2);
        out->values[i] = sqrt(v * v + s2 * s2);
        most = larger(most, more), least = smaller(least, more);
    }
    if (!(most < 1e150 && least > 1e-140))
        for (int i = 0; i < AT; i++)
            out->values[i] = hypot(a->speed[i], a->s[i] * a->s[i]);
    for (int i = 0; i < AT; i++) {
        const double v = fabs(a->speed[i]), s = a->s[i], kappa = out->values[i];
        const double share = kappa > 0 ? v / kappa : 1.0;
        out->size[i] = v + s * s;
        out->spread[i] = share * l->steepness + 2 * fabs(s * a->c[i]);
    }
}

INLINE void bending(const node_angles *restrict a, const rod_loads *l, density *restrict out)
{
    for (int i = 0; i < AT; i++) {
        const double v = a->speed[i], s = a->s[i], s2 = s * s;
        out->values[i] = out->size[i] = (v * v + s2 * s2) / 2;
        out->spread[i] = fabs(v) * l->steepness + 2 * s2 * fabs(s * a->c[i]);
    }
}

INLINE void energy(const node_angles *restrict a, const rod_loads *l, density *restrict out)
{
    const double lam = l->lam, mu = l->mu, phi = l->phi;
    for (int i = 0; i < AT; i++) {
        const double v = a->speed[i], s = a->s[i], c = a->c[i], s2 = s * s;
        const double bent = (v * v + s2 * s2) / 2, twisted = mu * s * c, pulled = phi * c, turned = lam * s;
        const double moved = 2 * s2 * s * c + mu * (c - s) * (c + s) + phi * s - lam * c;
        out->values[i] = bent + twisted - pulled - turned;
        out->size[i] = bent + fabs(twisted) + fabs(pulled) + fabs(turned);
        out->spread[i] = fabs(v) * l->steepness + fabs(moved);
    }
}

/* The push: the contact force, positive where the cylinder pushes. */
INLINE void outward(const node_angles *restrict a, const rod_loads *l, density *restrict out)
{
    const double lam = l->lam, mu = l->mu, phi = l->phi, steepness = l->steepness;
    for (int i = 0; i < AT; i++) {
        const double v = a->speed[i], s = a->s[i], c = a->c[i], absolute = fabs(c);
        const double v2 = v * v, s2 = s * s, s3 = s * s * s, cos2 = (c - s) * (c + s);
        const double across = lam - mu * c - s3, lever = 3 * s * c - mu;
        const double even = (lam - (c < 0 ? -mu : mu)) * c, twist = mu * (s2 * (1 + 2 * absolute) / (1 + absolute));
        const double rest = (phi + 2 * c * s2) * s, H = even + twist - rest;
        const double size = fabs(s) * (fabs(lam) + fabs(mu * c) + fabs(s3)) + 3 * v2 * fabs(cos2);
        const double rate = -lam * s + 4 * mu * s * c - phi * c - 2 * s * s * (3 * c * c - s * s);
        const double moved = c * across + s * (mu * s - 3 * s * s * c) + rate * lever + 3 * H * cos2;
        out->values[i] = (s * across + H * lever - 3 * v2 * cos2) * l->sign;
        out->size[i] = size + (fabs(even) + fabs(twist) + fabs(rest)) * (3 * fabs(s * c) + fabs(mu));
        out->spread[i] = fabs(moved + 12 * v2 * s * c) + 6 * fabs(v * cos2) * steepness;
    }
}

INLINE void tension(const node_angles *restrict a, const rod_loads *l, density *restrict out)
{
    const double lam = l->lam, mu = l->mu, phi = l->phi;
    for (int i = 0; i < AT; i++) {
        const double s = a->s[i], c = a->c[i], s3 = s * s * s, across = lam - mu * c - s3;
        out->values[i] = phi * c + across * s;
        out->size[i] = fabs(phi * c) + fabs(s) * (fabs(lam) + fabs(mu * c) + fabs(s3));
        out->spread[i] = fabs(-phi * s + c * across + s * (mu * s - 3 * s * s * c));
    }
}

INLINE void density_of(int kind, const node_angles *a, const rod_loads *l, density *out)
{
    switch (kind) {
    case ANGLE: angle(a, out); break;
    case CURVATURE: curvature(a, l, out); break;
    case BENDING: bending(a, l, out); break;
    case POTENTIAL: energy(a, l, out); break;
    case OUTWARD: outward(a, l, out); break;
    case TENSION: tension(a, l, out); break;
    case ACROSS: direction(a->s, a->c, out); break;
    default: direction(a->c, a->s, out);
    }
}

#endif
