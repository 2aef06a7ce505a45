/* Linear algebra of a chain of stretches: a band matrix with pivots, and the inertia of a block tridiagonal one. */
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Solve band x = right in place by rows with partial pivoting. band: (n, 3 w + 1), row i holds the columns i - w ..
 * i + 2 w, of which the last w are room for pivoting. right: (n, m). Returns 0, or 1 where a pivot vanishes. */
int rod_solve_band(int64_t n, int64_t w, double *band, int64_t m, double *right)
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

/* The number of negative eigenvalues of the Hessian over q_0, (p_1, q_1), ..., (p_(n-1), q_(n-1)), p_n, each q and p
 * of four numbers. qq, qp, pp: (n, 4, 4), the second derivatives of the generating functions of the stretches. unit:
 * (4,), the coupling of p_i and q_i. spring: (n + 1, 4), added to the diagonal of q_i. free, held: (4,), which numbers
 * of q_0 and p_n are variables. */
int64_t rod_negatives(int64_t n, const double *qq, const double *qp, const double *pp, const double *unit,
                      const double *spring, const int64_t *free, const int64_t *held)
{
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
        memset(a, 0, sizeof a);
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                a[i][j] = left[i][j] - pp[16 * (s - 1) + 4 * i + j];
                a[4 + i][4 + j] = -qq[16 * s + 4 * i + j];
                a[4 + i][8 + j] = a[8 + j][4 + i] = -qp[16 * s + 4 * i + j];
            }
            a[i][4 + i] = a[4 + i][i] = unit[i];
            a[4 + i][4 + i] += spring[4 * s + i];
        }
        negative += eliminate(a, 8, 12);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) left[i][j] = a[8 + i][8 + j];
    }
    memset(a, 0, sizeof a);
    count = 0;
    for (int i = 0; i < 4; i++)
        if (held[i]) kept[count++] = i;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            a[i][j] = left[kept[i]][kept[j]] - pp[16 * (n - 1) + 4 * kept[i] + kept[j]];
    return negative + eliminate(a, count, count);
}
