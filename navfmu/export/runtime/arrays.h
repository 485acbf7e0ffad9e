/* What generated code does with whole arrays. Sizes and strides are constants there, so all of it is compiled in place. */
#ifndef NAVFMU_ARRAYS_H
#define NAVFMU_ARRAYS_H

/* The sum of n numbers that lie a step apart, in the order in which NumPy adds what lies side by side. */
static inline double sum(const double *x, int n, int step) {
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

/* Some rows and columns of a product, so few that their sums stay in registers. */
#define PRODUCT_BLOCK(ROWS, COLUMNS)                                                                              \
    {                                                                                                             \
        double s[ROWS][COLUMNS] = {{0.0}};                                                                        \
        for (int k = 0; k < inner; k++) {                                                                         \
            for (int m = 0; m < ROWS; m++) {                                                                      \
                const double x = a[(i + m) * down + k * right];                                                   \
                for (int n = 0; n < COLUMNS; n++) s[m][n] += x * b[k * below + (j + n) * beside];                 \
            }                                                                                                     \
        }                                                                                                         \
        for (int m = 0; m < ROWS; m++) {                                                                          \
            for (int n = 0; n < COLUMNS; n++) r[(i + m) * columns + j + n] = s[m][n];                             \
        }                                                                                                         \
    }

/* r = a b. Each element is a sum from 0.0 on, from the first product to the last; several are made at a time. */
static inline void product(int rows, int inner, int columns, const double *restrict a, int down, int right,
                           const double *restrict b, int below, int beside, double *restrict r) {
    int j = 0;
    for (; j + 8 <= columns; j += 8) {
        for (int i = 0; i < rows; i++) PRODUCT_BLOCK(1, 8)
    }
    for (; j + 4 <= columns; j += 4) {
        int i = 0;
        for (; i + 2 <= rows; i += 2) PRODUCT_BLOCK(2, 4)
        for (; i < rows; i++) PRODUCT_BLOCK(1, 4)
    }
    for (; j < columns; j++) {
        int i = 0;
        for (; i + 8 <= rows; i += 8) PRODUCT_BLOCK(8, 1)
        for (; i + 4 <= rows; i += 4) PRODUCT_BLOCK(4, 1)
        for (; i < rows; i++) PRODUCT_BLOCK(1, 1)
    }
}
#undef PRODUCT_BLOCK

#endif
