/* Linear algebra: Gauss's elimination, and of a chain of stretches a band matrix with pivots and the inertia of a block
   tridiagonal one. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SIZE 8
#define HALF 4
#define WIDTH (SIZE + HALF - 1) /* of the band of a chain, on each side of the diagonal */
#define WIDE (3 * WIDTH + 1)

/* Row i of the matrix less a multiple of row k, from column `from` on. */
static void subtract(int columns, double *matrix, int i, int k, int from)
{
    const double factor = matrix[i * columns + from] / matrix[k * columns + from];
    for (int j = from; j < columns; j++)
        matrix[i * columns + j] -= factor * matrix[k * columns + j];
}

int rod_eliminated(int n, int columns, double *matrix)
{
    int sign = 1;
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(matrix[i * columns + k]) > fabs(matrix[best * columns + k]))
                best = i;
        const double pivot = matrix[best * columns + k];
        if (!(fabs(pivot) > 0) || !isfinite(pivot))
            return 0;
        for (int j = 0; best != k && j < columns; j++) {
            const double other = matrix[k * columns + j];
            matrix[k * columns + j] = matrix[best * columns + j], matrix[best * columns + j] = other;
        }
        sign *= (best != k ? -1 : 1) * (pivot > 0 ? 1 : -1);
        for (int i = k + 1; i < n; i++)
            subtract(columns, matrix, i, k, k);
    }
    for (int j = n; j < columns; j++)
        for (int k = n - 1; k >= 0; k--) {
            double value = matrix[k * columns + j];
            for (int i = k + 1; i < n; i++)
                value -= matrix[k * columns + i] * matrix[i * columns + j];
            matrix[k * columns + j] = value / matrix[k * columns + k];
        }
    return sign;
}

/* Solve band x = right in place by rows with partial pivoting. band: (n, 3 w + 1), row i holds the columns i - w ..
 * i + 2 w, of which the last w are room for pivoting. right: (n, m). Returns 0, or 1 where a pivot vanishes. */
static int solve_band(int64_t n, int64_t w, double *band, int64_t m, double *right)
{
    int64_t wide = 3 * w + 1;
    for (int64_t k = 0; k < n; k++) {
        int64_t last = k + w < n - 1 ? k + w : n - 1, best = k, right_end = k + 2 * w < n - 1 ? k + 2 * w : n - 1;
        double most = 0;
        for (int64_t i = k; i <= last; i++) {
            double size = fabs(band[i * wide + k - i + w]);
            if (size > most) { most = size; best = i; }
        }
        if (!(most > 0) || !isfinite(most)) return 1;
        double *pivot = band + k * wide + w; /* column k of row k; column j at pivot[j - k] */
        if (best != k) {
            double *other = band + best * wide + k - best + w;
            for (int64_t j = 0; j <= right_end - k; j++) { double kept = pivot[j]; pivot[j] = other[j]; other[j] = kept; }
            for (int64_t j = 0; j < m; j++) {
                double kept = right[k * m + j];
                right[k * m + j] = right[best * m + j];
                right[best * m + j] = kept;
            }
        }
        for (int64_t i = k + 1; i <= last; i++) {
            double *row = band + i * wide + k - i + w, factor = row[0] / pivot[0];
            if (factor == 0) continue;
            for (int64_t j = 1; j <= right_end - k; j++) row[j] -= factor * pivot[j];
            for (int64_t j = 0; j < m; j++) right[i * m + j] -= factor * right[k * m + j];
        }
    }
    for (int64_t k = n - 1; k >= 0; k--) {
        double *pivot = band + k * wide + w;
        int64_t right_end = k + 2 * w < n - 1 ? k + 2 * w : n - 1;
        for (int64_t j = 0; j < m; j++) {
            double sum = right[k * m + j];
            for (int64_t i = k + 1; i <= right_end; i++) sum -= pivot[i - k] * right[i * m + j];
            right[k * m + j] = sum / pivot[0];
        }
    }
    return 0;
}

/* Solve the scaled equations of a chain in place: four conditions at its start, n stretches, four at its end.
 *
 * transfer: (n, 8, 8), of the stretches. scale: (8,), of the states. start, end: (4, 8), the rows of the conditions.
 * stiffness: (n + 1, 2), of springs at the nodes that turn beta into beta_t and alpha into q; or NULL. right: (8 (n + 1),
 * m). Returns 0, 1 where the equations are singular, or -1 if there is no memory. */
int rod_solve_chain(int64_t n, const double *transfer, const double *scale, const double *start, const double *end,
                    const double *stiffness, int64_t m, double *right)
{
    double *band = calloc((size_t)(SIZE * (n + 1)) * WIDE, sizeof *band);
    if (!band) return -1;
    for (int i = 0; i < HALF; i++)
        for (int j = 0; j < SIZE; j++) {
            int64_t far = SIZE * n + HALF + i;
            band[i * WIDE + WIDTH + j - i] = start[SIZE * i + j] * scale[j];
            band[far * WIDE + WIDTH - HALF + j - i] = end[SIZE * i + j] * scale[j];
        }
    for (int64_t k = 0; k < n; k++)
        for (int i = 0; i < SIZE; i++) {
            double *row = band + (SIZE * k + HALF + i) * WIDE + WIDTH - HALF - i; /* from the begin of the stretch on */
            for (int j = 0; j < SIZE; j++) row[j] = -transfer[SIZE * SIZE * k + SIZE * i + j] * scale[j] / scale[i];
            row[SIZE + i] = 1;
            if (!stiffness || k == n - 1) continue;
            if (i == 1) row[SIZE] = -stiffness[2 * (k + 1)] * scale[0] / scale[1];
            if (i == 3) row[SIZE + 2] = -stiffness[2 * (k + 1) + 1] * scale[2] / scale[3];
        }
    int failed = solve_band(SIZE * (n + 1), WIDTH, band, m, right);
    free(band);
    return failed;
}

#define FRONT 12

/* Eliminate the first `inner` of `size` variables of a symmetric matrix by the pivots of Bunch and Parlett; returns the
 * number of negative ones. What is left lies in the last rows and columns. */
static int eliminate(double a[FRONT][FRONT], int inner, int size)
{
    int order[FRONT], negative = 0;
    for (int i = 0; i < size; i++) order[i] = i;
    for (int done = 0; done < inner;) {
        int p = done, q = done, r = done;
        double diagonal = -1, off = -1;
        for (int i = done; i < inner; i++) {
            double d = fabs(a[order[i]][order[i]]);
            if (d > diagonal) { diagonal = d; p = i; }
            for (int j = done; j < i; j++)
                if (fabs(a[order[i]][order[j]]) > off) { off = fabs(a[order[i]][order[j]]); q = j; r = i; }
        }
        if (diagonal >= 0.6403882032022076 * off) {
            int k = order[p];
            order[p] = order[done];
            order[done++] = k;
            double pivot = a[k][k];
            negative += pivot < 0;
            if (pivot == 0) continue;
            for (int i = done; i < size; i++) {
                double factor = a[order[i]][k] / pivot;
                for (int j = done; j < size; j++) a[order[i]][order[j]] -= factor * a[k][order[j]];
            }
        } else {
            int k = order[q], l = order[r];
            order[r] = order[done + 1]; /* q < r: the larger place first, so that neither is overwritten */
            order[done + 1] = l;
            if (q == done + 1) q = r; /* k was there */
            order[q] = order[done];
            order[done] = k;
            done += 2;
            double x = a[k][k], y = a[l][l], z = a[k][l], det = x * y - z * z;
            negative += det < 0 ? 1 : x < 0 ? 2 : 0;
            for (int i = done; i < size; i++) {
                double u = a[order[i]][k], v = a[order[i]][l], f = (y * u - z * v) / det, g = (x * v - z * u) / det;
                for (int j = done; j < size; j++) a[order[i]][order[j]] -= f * a[k][order[j]] + g * a[l][order[j]];
            }
        }
    }
    return negative;
}

/* The second derivatives of the generating function of a stretch by q at its begin and p at its end, scaled by `unit`
 * of the four q and the four p: W_qq, W_qp and W_pp. transfer: (8, 8), of the state, whose canonical numbers are q =
 * (beta, alpha, z, gamma) and p = (beta_t, lam, phi, mu). */
static void generate(const double *transfer, const double *unit, double *qq, double *qp, double *pp)
{
    double rows[SIZE][SIZE], M[SIZE][SIZE], D[HALF][2 * HALF];
    for (int j = 0; j < SIZE; j++) {
        const double *x = transfer + j; /* of beta, beta_t, alpha, q, phi, mu, short, round */
        rows[0][j] = x[0], rows[1][j] = x[16], rows[2][j] = -x[48], rows[3][j] = x[56] - x[16];
        rows[4][j] = x[8], rows[5][j] = x[24] + x[40], rows[6][j] = x[32], rows[7][j] = x[40];
    }
    for (int i = 0; i < SIZE; i++) {
        const double *x = rows[i];
        M[i][0] = x[0], M[i][1] = x[2] + x[7], M[i][2] = -x[6], M[i][3] = x[7];
        M[i][4] = x[1], M[i][5] = x[3], M[i][6] = x[4], M[i][7] = x[5] - x[3];
    }
    for (int i = 0; i < HALF; i++)
        for (int j = 0; j < HALF; j++) D[i][j] = M[HALF + i][HALF + j], D[i][HALF + j] = i == j;
    rod_eliminated(HALF, 2 * HALF, &D[0][0]); /* the inverse of D */
    double left[HALF][HALF], right[HALF][HALF];
    for (int i = 0; i < HALF; i++)
        for (int j = 0; j < HALF; j++) {
            left[i][j] = right[i][j] = 0;
            for (int k = 0; k < HALF; k++) {
                left[i][j] -= D[i][HALF + k] * M[HALF + k][j];
                right[i][j] += M[i][HALF + k] * D[k][HALF + j];
            }
        }
    for (int i = 0; i < HALF; i++)
        for (int j = 0; j < HALF; j++) {
            qp[HALF * i + j] = D[i][HALF + j] * unit[i] * unit[HALF + j];
            qq[HALF * i + j] = (left[i][j] + left[j][i]) / 2 * unit[i] * unit[j];
            pp[HALF * i + j] = (right[i][j] + right[j][i]) / 2 * unit[HALF + i] * unit[HALF + j];
        }
}

/* The number of negative eigenvalues of the Hessian of the action over q_0, (p_1, q_1), ..., (p_(n-1), q_(n-1)), p_n,
 * each q and p of four numbers. transfer: (n, 8, 8), of the stretches. unit: (8,), the scales of q and p. spring: (n + 1,
 * 4), added to the diagonal of q_i. free, held: (4,), which numbers of q_0 and p_n are variables. */
int64_t rod_negatives(int64_t n, const double *transfer, const double *unit, const double *spring, const int64_t *free,
                      const int64_t *held)
{
    double qq[16], qp[16], pp[16], before[16];
    generate(transfer, unit, qq, qp, before);
    double a[FRONT][FRONT], left[4][4] = {{0}};
    int64_t negative = 0;
    int count = 0, kept[4];
    memset(a, 0, sizeof a);
    for (int i = 0; i < 4; i++)
        if (free[i]) kept[count++] = i;
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) a[i][j] = -qq[4 * kept[i] + kept[j]];
        a[i][i] += spring[kept[i]];
        for (int j = 0; j < 4; j++) a[i][count + j] = a[count + j][i] = -qp[4 * kept[i] + j];
    }
    negative += eliminate(a, count, count + 4);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) left[i][j] = a[count + i][count + j];
    for (int64_t s = 1; s < n; s++) {
        generate(transfer + SIZE * SIZE * s, unit, qq, qp, pp);
        memset(a, 0, sizeof a);
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                a[i][j] = left[i][j] - before[4 * i + j];
                a[4 + i][4 + j] = -qq[4 * i + j];
                a[4 + i][8 + j] = a[8 + j][4 + i] = -qp[4 * i + j];
            }
            a[i][4 + i] = a[4 + i][i] = unit[i] * unit[4 + i];
            a[4 + i][4 + i] += spring[4 * s + i];
        }
        negative += eliminate(a, 8, 12);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) left[i][j] = a[8 + i][8 + j];
        memcpy(before, pp, sizeof before);
    }
    memset(a, 0, sizeof a);
    count = 0;
    for (int i = 0; i < 4; i++)
        if (held[i]) kept[count++] = i;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[i][j] = left[kept[i]][kept[j]] - before[4 * kept[i] + kept[j]];
    return negative + eliminate(a, count, count);
}
