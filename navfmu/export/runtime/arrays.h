/* What generated code does with whole arrays. Sizes and strides are constants there, so all of it is compiled in place. */
#ifndef NAVFMU_ARRAYS_H
#define NAVFMU_ARRAYS_H

#include <math.h>

/* Not compiled in place: it is long, and called often. */
#ifdef __GNUC__
#define CALLED __attribute__((noinline, unused))
#else
#define CALLED
#endif

/* The sum of n numbers that lie a step apart, in the order in which NumPy adds what lies side by side. */
CALLED static double sum(const double *x, int n, int step) {
    if (n < 8) {
        double total = x[0];
        for (int i = 1; i < n; i++) total += x[i * step];
        return total;
    }
    if (n <= 128) {
        double s[8];
        int i = 8;
        for (int k = 0; k < 8; k++) s[k] = x[k * step];
        for (; i + 8 <= n; i += 8) {
            for (int k = 0; k < 8; k++) s[k] += x[(i + k) * step];
        }
        double total = ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
        for (; i < n; i++) total += x[i * step];
        return total;
    }
    int half = n / 2 - n / 2 % 8;
    return sum(x, half, step) + sum(x + half * step, n - half, step);
}

/* ROWS rows of a matrix times a vector: sums go on side by side, so that none waits for itself. */
#define ROWS_SIDE_BY_SIDE(ROWS)                                                                       \
    for (; i + ROWS <= rows; i += ROWS) {                                                             \
        double s[ROWS] = {0.0};                                                                       \
        for (int k = 0; k < inner; k++) {                                                             \
            for (int m = 0; m < ROWS; m++) s[m] += a[(i + m) * down + k * right] * b[k * below];      \
        }                                                                                             \
        for (int m = 0; m < ROWS; m++) r[i + m] = s[m];                                               \
    }

/* r = a b. Each element is a sum from 0.0 on, from the first product to the last. */
static inline void product(int rows, int inner, int columns, const double *restrict a, int down, int right,
                           const double *restrict b, int below, int beside, double *restrict r) {
    int i = 0;
    if (columns == 1) {
        ROWS_SIDE_BY_SIDE(8)
        ROWS_SIDE_BY_SIDE(4)
        ROWS_SIDE_BY_SIDE(2)
        ROWS_SIDE_BY_SIDE(1)
        return;
    }
    for (; i < rows; i++) {
        for (int j = 0; j < columns; j++) r[i * columns + j] = 0.0;
        for (int k = 0; k < inner; k++) {
            const double x = a[i * down + k * right];
            for (int j = 0; j < columns; j++) r[i * columns + j] += x * b[k * below + j * beside];
        }
    }
}
#undef ROWS_SIDE_BY_SIDE

/* Eliminates below the diagonal of lu (n, n), with the largest pivot of each column, and does the same to b (n, columns).
   Returns the sign of the exchange of rows. */
static inline double eliminate(int n, int columns, double *restrict lu, double *restrict b) {
    double sign = 1.0;
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            if (fabs(lu[i * n + k]) > fabs(lu[pivot * n + k])) pivot = i;
        }
        if (pivot != k) {
            sign = -sign;
            for (int j = k; j < n; j++) {
                const double x = lu[k * n + j];
                lu[k * n + j] = lu[pivot * n + j];
                lu[pivot * n + j] = x;
            }
            for (int j = 0; j < columns; j++) {
                const double x = b[k * columns + j];
                b[k * columns + j] = b[pivot * columns + j];
                b[pivot * columns + j] = x;
            }
        }
        for (int i = k + 1; i < n; i++) {
            const double factor = lu[i * n + k] / lu[k * n + k];
            for (int j = k + 1; j < n; j++) lu[i * n + j] -= factor * lu[k * n + j];
            for (int j = 0; j < columns; j++) b[i * columns + j] -= factor * b[k * columns + j];
        }
    }
    return sign;
}

/* r begins with x of a x = b, with a (n, n), b and x (n, columns); n n numbers behind it are for calculating. */
static inline void solve(int n, int columns, const double *restrict a, const double *restrict b, double *restrict r) {
    double *lu = r + n * columns;
    for (int i = 0; i < n * n; i++) lu[i] = a[i];
    for (int i = 0; i < n * columns; i++) r[i] = b[i];
    eliminate(n, columns, lu, r);
    for (int i = n - 1; i >= 0; i--) {
        for (int j = 0; j < columns; j++) {
            double x = r[i * columns + j];
            for (int k = i + 1; k < n; k++) x -= lu[i * n + k] * r[k * columns + j];
            r[i * columns + j] = x / lu[i * n + i];
        }
    }
}

/* r begins with the determinant of a (n, n); n n numbers behind it are for calculating. */
static inline void determinant(int n, const double *restrict a, double *restrict r) {
    double *lu = r + 1;
    for (int i = 0; i < n * n; i++) lu[i] = a[i];
    double product = eliminate(n, 0, lu, 0);
    for (int i = 0; i < n; i++) product *= lu[i * n + i];
    r[0] = product;
}

/* r = L of a = L L', all (n, n), of which the lower triangle is read. */
static inline void cholesky(int n, const double *restrict a, double *restrict r) {
    for (int j = 0; j < n; j++) {
        double square = a[j * n + j];
        for (int k = 0; k < j; k++) square -= r[j * n + k] * r[j * n + k];
        const double root = sqrt(square);
        for (int i = 0; i < j; i++) r[i * n + j] = 0.0;
        r[j * n + j] = root;
        for (int i = j + 1; i < n; i++) {
            double x = a[i * n + j];
            for (int k = 0; k < j; k++) x -= r[i * n + k] * r[j * n + k];
            r[i * n + j] = x / root;
        }
    }
}

#endif
