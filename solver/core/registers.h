/* Sums in registers of MANY numbers, where the compiler does not keep them of itself: included for every width of registers. */

#define NUMBERS_OF(many) JOIN(abreast_, many)
#define ABREAST NUMBERS_OF(MANY)
#define ABREAST_AT(at) (*(ABREAST *)(at))

typedef double ABREAST __attribute__((vector_size(8 * MANY), aligned(8), may_alias));

/* out (rows, m) = values (rows, n) @ linear (n, m). rows, registers: constants, of sums at once. m is at least MANY; the last
   registers of a row overlap, so that no number is left over. paired, a constant: a column of even number takes values[i] +
   values[m - 1 - i] in place of values[i], one of odd number their difference: so the series of a function from its values at m
   nodes that lie evenly about 0, where polynomials of even and of odd order are even and odd, is a sum over n = m/2. */
INLINE void JOIN(products_, MANY)(int rows, int registers, int paired, int n, int m, const double *const *values,
                                  const double *linear, double *const *out)
{
    const int last = m - MANY;
    ABREAST parity;
    for (int k = 0; k < MANY; k++)
        parity[k] = k % 2 ? -1 : 1;
    for (int j = 0; j < m; j += registers * MANY) {
        ABREAST sum[4][8] = {{{0}}};
        int at[8];
        UNROLLED
        for (int k = 0; k < registers; k++)
            at[k] = j + k * MANY < last ? j + k * MANY : last;
        for (int i = 0; i < n; i++) {
            double *row = (double *)linear + i * m;
            UNROLLED
            for (int r = 0; r < rows; r++) {
                const ABREAST none = {0};
                ABREAST x = values[r][i] - none;
                if (paired)
                    x += values[r][m - 1 - i] * parity;
                UNROLLED
                for (int k = 0; k < registers; k++)
                    sum[r][k] += x * ABREAST_AT(row + at[k]);
            }
        }
        UNROLLED
        for (int r = 0; r < rows; r++) {
            UNROLLED
            for (int k = 0; k < registers; k++)
                ABREAST_AT(out[r] + at[k]) = sum[r][k];
        }
    }
}

/* The values of two series of n + 1 coefficients at n places, `registers` at once; the arrays hold whole ones. */
INLINE void JOIN(two_series_, MANY)(int registers, int n, const double *first, const double *second, const double *x,
                                    double *to_first, double *to_second)
{
    for (int i = 0; i < n; i += registers * MANY) {
        ABREAST place[4], b1[4] = {{0}}, b2[4] = {{0}}, c1[4] = {{0}}, c2[4] = {{0}};
        UNROLLED
        for (int j = 0; j < registers; j++)
            place[j] = ABREAST_AT((double *)x + i + MANY * j);
        for (int k = n; k > 0; k--) {
            UNROLLED
            for (int j = 0; j < registers; j++) {
                const ABREAST twice = 2 * place[j];
                const ABREAST b0 = twice * b1[j] - b2[j] + first[k], c0 = twice * c1[j] - c2[j] + second[k];
                b2[j] = b1[j], b1[j] = b0, c2[j] = c1[j], c1[j] = c0;
            }
        }
        UNROLLED
        for (int j = 0; j < registers; j++) {
            ABREAST_AT(to_first + i + MANY * j) = place[j] * b1[j] - b2[j] + first[0];
            ABREAST_AT(to_second + i + MANY * j) = place[j] * c1[j] - c2[j] + second[0];
        }
    }
}

#undef ABREAST_AT
#undef ABREAST
#undef NUMBERS_OF
#undef MANY
