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

/* r = a b. Each element is a sum from 0.0 on, from the first product to the last; several are made at a time. */
static inline void product(int rows, int inner, int columns, const double *restrict a, int down, int right,
                           const double *restrict b, int below, int beside, double *restrict r) {
    if (columns == 1 && down != 1) {
        int i = 0;
        for (; i + 4 <= rows; i += 4) {
            const double *x = a + i * down;
            double s[4] = {0.0, 0.0, 0.0, 0.0};
            for (int k = 0; k < inner; k++) {
                for (int n = 0; n < 4; n++) s[n] += x[n * down + k * right] * b[k * below];
            }
            for (int n = 0; n < 4; n++) r[i + n] = s[n];
        }
        for (; i < rows; i++) {
            double s = 0.0;
            for (int k = 0; k < inner; k++) s += a[i * down + k * right] * b[k * below];
            r[i] = s;
        }
        return;
    }
    if (columns == 1) {
        for (int i = 0; i < rows; i++) r[i] = 0.0;
        for (int k = 0; k < inner; k++) {
            for (int i = 0; i < rows; i++) r[i] += a[i + k * right] * b[k * below];
        }
        return;
    }
    for (int i = 0; i < rows; i++) {
        for (int j = 0; j < columns; j++) r[i * columns + j] = 0.0;
        for (int k = 0; k < inner; k++) {
            const double x = a[i * down + k * right];
            for (int j = 0; j < columns; j++) r[i * columns + j] += x * b[k * below + j * beside];
        }
    }
}

#endif
