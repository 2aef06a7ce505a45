/* Numbers in lanes: W of them in a register, and what is computed of them and of their series.

   Included without W for what all widths share, then once for each width W with its SUFFIX and TARGET; NAME(x) gives
   each function its own name. */

#ifndef VECTORS_H
#define VECTORS_H
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define EPS DBL_EPSILON
#define PI 3.14159265358979323846
#define FAR 1e6 /* angles beyond which sin and cos are left to libm */

static inline int64_t bits_of(double x)
{
    int64_t y;
    memcpy(&y, &x, sizeof y);
    return y;
}

static inline double number_of(int64_t x)
{
    double y;
    memcpy(&y, &x, sizeof y);
    return y;
}

static inline double larger(double x, double y) { return x > y || x != x ? x : y; } /* NaN where one of them is */
static inline double smaller(double x, double y) { return x < y || x != x ? x : y; }

/* The loops of the kernels have constant limits; unrolled, they mispredict no branch. */
#ifdef ROLLED /* quick to compile */
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("unroll")
#else
#define UNROLLED _Pragma("GCC unroll 21")
#endif
#define ALWAYS __attribute__((always_inline))
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(x) JOIN(x, SUFFIX)
#endif

#ifdef W
#undef vec
#undef ZERO
#undef vabs
#undef vmax
#undef vroot
#undef LANE
#undef PICK
#undef MASK
#undef BITS
#undef NUMBER

#if W == 1
typedef double NAME(vec), NAME(loose);
typedef int64_t NAME(mask);
#define LANE(x, i) (x)
#define PICK(m, x, y) ((m) ? (x) : (y))
#define MASK(x) (-(int64_t)(x))
#define BITS(x) bits_of(x)
#define NUMBER(x) number_of(x)
#else
typedef double NAME(vec) __attribute__((vector_size(8 * W), aligned(8 * W)));
typedef double NAME(loose) __attribute__((vector_size(8 * W), aligned(8)));
typedef int64_t NAME(mask) __attribute__((vector_size(8 * W), aligned(8)));
#define LANE(x, i) ((x)[i])
#define PICK(m, x, y) ((NAME(loose))(((NAME(mask))(x) & (m)) | ((NAME(mask))(y) & ~(m)))) /* x where m is set, else y */
#define MASK(x) (x)
#define BITS(x) ((NAME(mask))(x))
#define NUMBER(x) ((NAME(loose))(x))
#endif
#define vec NAME(vec)
#define ZERO ((vec){0})
#define vabs NAME(abs)
#define vmax NAME(max)
#define vroot NAME(root)

#if W > 1 || !defined(SCALARS) /* of one number at a time the functions may be there already */
/* sin and cos of x, |x| < FAR, to about one unit in the last place. */
static inline ALWAYS TARGET void NAME(near_sin_cos)(vec x, vec *sine, vec *cosine)
{
    /* pi/2 in three parts: the products of the first two with a whole number below 2^20 are exact */
    const double p1 = 0x1.921fb54400000p+0, p2 = 0x1.0b4611a600000p-34, p3 = 0x1.3198a2e037073p-69;
    const double nearest = 0x1.8p52;
    const vec shifted = x * (2 / PI) + nearest, k = shifted - nearest;
    const vec r = ((x - k * p1) - k * p2) - k * p3, q = r * r;
    vec s = ZERO - 1.0 / 121645100408832000.0, c = ZERO - 1.0 / 6402373705728000.0;
    s = s * q + 1.0 / 355687428096000.0, c = c * q + 1.0 / 20922789888000.0;
    s = s * q - 1.0 / 1307674368000.0, c = c * q - 1.0 / 87178291200.0;
    s = s * q + 1.0 / 6227020800.0, c = c * q + 1.0 / 479001600.0;
    s = s * q - 1.0 / 39916800.0, c = c * q - 1.0 / 3628800.0;
    s = s * q + 1.0 / 362880.0, c = c * q + 1.0 / 40320.0;
    s = s * q - 1.0 / 5040.0, c = c * q - 1.0 / 720.0;
    s = s * q + 1.0 / 120.0, c = c * q + 1.0 / 24.0;
    s = s * q - 1.0 / 6.0;
    s = r + r * q * s, c = 1.0 - (0.5 * q - q * q * c);
    const NAME(mask) turns = BITS(shifted), swap = MASK((turns & 1) != 0);
    const vec a = PICK(swap, c, s), b = PICK(swap, s, c);
    *sine = PICK(MASK((turns & 2) != 0), -a, a), *cosine = PICK(MASK(((turns + 1) & 2) != 0), -b, b);
}

/* The same of any numbers; beyond FAR, or of what is no number, by libm. */
static inline TARGET void NAME(sin_cos)(vec x, vec *sine, vec *cosine)
{
    NAME(near_sin_cos)(x, sine, cosine);
    for (int i = 0; i < W; i++)
        if (!(fabs(LANE(x, i)) < FAR))
            LANE(*sine, i) = sin(LANE(x, i)), LANE(*cosine, i) = cos(LANE(x, i));
}

/* The term of order k of the product of two series, and of a square. The newest coefficients, those of order k, are
   added last, and there are two partial sums, so that little waits for something else. */
static inline ALWAYS TARGET vec NAME(product)(const vec *x, const vec *y, int k)
{
    if (k == 0)
        return x[0] * y[0];
    vec even = ZERO, odd = ZERO;
    UNROLLED
    for (int i = 1; i < k; i += 2)
        even += x[i] * y[k - i];
    UNROLLED
    for (int i = 2; i < k; i += 2)
        odd += x[i] * y[k - i];
    return even + odd + (x[0] * y[k] + x[k] * y[0]);
}

static inline ALWAYS TARGET vec NAME(square)(const vec *x, int k)
{
    if (k == 0)
        return x[0] * x[0];
    vec even = ZERO, odd = ZERO;
    UNROLLED
    for (int i = 1; 2 * i < k; i += 2)
        even += x[i] * x[k - i];
    UNROLLED
    for (int i = 2; 2 * i < k; i += 2)
        odd += x[i] * x[k - i];
    const vec half = even + odd + x[0] * x[k], twice = half + half;
    return k % 2 ? twice : twice + x[k / 2] * x[k / 2];
}

static inline TARGET vec NAME(value)(const vec *row, int n, vec x)
{
    vec total = row[n];
    for (int k = n - 1; k >= 0; k--)
        total = total * x + row[k];
    return total;
}

static inline TARGET vec NAME(value_and_rate)(const vec *row, int n, vec x, vec *rate)
{
    vec total = row[n], slope = ZERO;
    for (int k = n - 1; k >= 0; k--) {
        slope = slope * x + total;
        total = total * x + row[k];
    }
    *rate = slope;
    return total;
}

static inline TARGET vec NAME(abs)(vec x)
{
    return NUMBER(BITS(x) & 0x7fffffffffffffff);
}

static inline TARGET vec NAME(max)(vec x, vec y)
{
    return PICK(MASK(x > y), x, y);
}

static inline TARGET vec NAME(root)(vec x)
{
#if W > 1 && defined(__clang__)
    return __builtin_elementwise_sqrt(x);
#else
    vec y;
    for (int i = 0; i < W; i++)
        LANE(y, i) = sqrt(LANE(x, i));
    return y;
#endif
}

/* The binary logarithm of a positive number to five digits, as a length of step needs it. */
static inline TARGET vec NAME(log_2)(vec x)
{
    const NAME(mask) bits = BITS(x);
    const vec power = NUMBER((bits >> 52) | 0x4330000000000000) - (0x1p52 + 1023.0);
    const vec m = NUMBER((bits & 0x000fffffffffffff) | 0x3ff0000000000000), y = (m - 1.0) / (m + 1.0), q = y * y;
    return power + y * (2.8853900817779268 + q * (0.96179669392597560 + q * (0.57707801635558535 + q * 0.43)));
}

/* Two to the power x to five digits; 0 below 2^-1000. */
static inline TARGET vec NAME(exp_2)(vec x)
{
    const double nearest = 0x1.8p52;
    const vec low = PICK(MASK(x > -1000.0), x, ZERO - 1000.0), y = PICK(MASK(low < 1000.0), low, ZERO + 1000.0);
    const vec shifted = y + nearest, r = y - (shifted - nearest);
    const vec part = 1.0 + r * (0.69314718 + r * (0.24022651 + r * (0.05550411 + r * (0.00961813 + r * 0.0013333558))));
    const vec scale = NUMBER(((BITS(shifted) + 1023) & 0x7ff) << 52);
    return PICK(MASK(x > -1000.0), part * scale, ZERO);
}
#if W == 1
#define SCALARS
#endif
#endif
#endif
