/* What the exporter is measured against: the filters as one writes them by hand in C, in loops over arrays.

   N states, of which the first M are driven by all; the rest are multiplied by a factor each. Every function reads its
   arguments one after the other from v and writes its results one after the other to r. The arithmetic is that of the
   functions in Python; what is known to be zero, or twice the same, is left out. */
#include <math.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Call a function again and again. */
EXPORT void repeat(void (*function)(const double *, double *), const double *v, double *r, long count) {
    for (long i = 0; i < count; i++)
        function(v, r);
}

#define UPPER (N * (N + 1) / 2)

/* P = Phi P Phi' + C_d on packed upper triangles: v is P, rows (M, N), factor (N - M), noise (N). */
EXPORT void ekf_predict(const double *restrict v, double *restrict r) {
    const double *upper = v, *rows = upper + UPPER, *factor = rows + M * N, *noise = factor + N - M;
    static double p[N][N], moved[M][N];
    for (int i = 0, place = 0; i < N; i++)
        for (int j = i; j < N; j++)
            p[i][j] = p[j][i] = upper[place++];
    for (int i = 0; i < M; i++) {
        for (int j = 0; j < N; j++)
            moved[i][j] = 0.0;
        for (int k = 0; k < N; k++)
            for (int j = 0; j < N; j++)
                moved[i][j] += rows[i * N + k] * p[k][j];
    }
    int place = 0;
    for (int i = 0; i < M; i++) {
        for (int j = i; j < M; j++) {
            double sum = 0.0;
            for (int k = 0; k < N; k++)
                sum += moved[i][k] * rows[j * N + k];
            r[place++] = sum + (i == j ? noise[i] : 0.0);
        }
        for (int j = M; j < N; j++)
            r[place++] = moved[i][j] * factor[j - M];
    }
    for (int i = M; i < N; i++)
        for (int j = i; j < N; j++)
            r[place++] = p[i][j] * factor[i - M] * factor[j - M] + (i == j ? noise[i] : 0.0);
}

/* One scalar measurement: v is correction (N), P, row (N), variance, residual; r is correction, P. */
EXPORT void ekf_update(const double *restrict v, double *restrict r) {
    const double *correction = v, *upper = correction + N, *row = upper + UPPER;
    const double variance = row[N], residual = row[N + 1];
    double cross[N] = {0.0}, spread = variance, innovation = residual;
    for (int i = 0, place = 0; i < N; i++) {
        cross[i] += upper[place++] * row[i];
        for (int j = i + 1; j < N; j++, place++) {
            cross[i] += upper[place] * row[j];
            cross[j] += upper[place] * row[i];
        }
    }
    for (int i = 0; i < N; i++) {
        spread += row[i] * cross[i];
        innovation -= row[i] * correction[i];
    }
    const double inverse = 1.0 / spread;
    for (int i = 0, place = 0; i < N; i++) {
        const double gain = inverse * cross[i];
        r[i] = correction[i] + innovation * gain;
        for (int j = i; j < N; j++, place++)
            r[N + place] = upper[place] - gain * cross[j];
    }
}

/* Thornton's propagation: v is the columns of U with D, rows (M, N), factor (N - M), noise (N); r is the columns. */
EXPORT void ud_predict(const double *restrict v, double *restrict r) {
    const double *rows = v + UPPER, *factor = rows + M * N, *noise = factor + N - M;
    static double w[N][2 * N];
    double weights[2 * N], weighted[2 * N];
    memset(w, 0, sizeof w);
    for (int j = 0; j < N; j++) {
        const double *u = v + j * (j + 1) / 2;
        for (int i = 0; i < M; i++) {
            double sum = 0.0;
            for (int k = 0; k < j; k++)
                sum += rows[i * N + k] * u[k];
            w[i][j] = sum + rows[i * N + j];
        }
        for (int i = M; i < j; i++)
            w[i][j] = factor[i - M] * u[i];
        if (j >= M)
            w[j][j] = factor[j - M];
        w[j][N + j] = 1.0;
        weights[j] = u[j];
        weights[N + j] = noise[j];
    }
    for (int j = N - 1; j >= 0; j--) {
        double *u = r + j * (j + 1) / 2, square = 0.0;
        for (int k = 0; k < 2 * N; k++) {
            weighted[k] = weights[k] * w[j][k];
            square += w[j][k] * weighted[k];
        }
        const double inverse = 1.0 / (square > 0.0 ? square : 1.0);
        u[j] = square;
        for (int i = 0; i < j; i++) {
            double share = 0.0;
            for (int k = 0; k < 2 * N; k++)
                share += w[i][k] * weighted[k];
            share *= inverse;
            u[i] = share;
            for (int k = 0; k < 2 * N; k++)
                w[i][k] -= share * w[j][k];
        }
    }
}

/* Bierman's scalar measurement: v is correction (N), columns, row (N), variance, residual; r is correction, columns. */
EXPORT void ud_update(const double *restrict v, double *restrict r) {
    const double *correction = v, *row = v + N + UPPER, variance = row[N], residual = row[N + 1];
    double gathered[N], alpha = variance, innovation = residual;
    for (int j = 0; j < N; j++) {
        const double *u = v + N + j * (j + 1) / 2;
        double *after = r + N + j * (j + 1) / 2, f = row[j];
        for (int i = 0; i < j; i++)
            f += row[i] * u[i];
        const double v_j = u[j] * f, before = alpha, share = f / before;
        alpha += f * v_j;
        for (int i = 0; i < j; i++) {
            after[i] = u[i] - share * gathered[i];
            gathered[i] += u[i] * v_j;
        }
        after[j] = u[j] * before / alpha;
        gathered[j] = v_j;
        innovation -= row[j] * correction[j];
    }
    for (int i = 0; i < N; i++)
        r[i] = correction[i] + innovation / alpha * gathered[i];
}

#if N == 15
#define MOTION 15 /* period, force (3), C_nb (3, 3), two factors */

/* Phi times the matrix a, by columns of its transpose: t is Phi a. */
static void move(double a[N][N], const double *motion, double t[N][N]) {
    const double period = motion[0], *f = motion + 1, *c = motion + 4;
    for (int j = 0; j < N; j++) {
        const double force[3] = {f[1] * a[8][j] - f[2] * a[7][j], f[2] * a[6][j] - f[0] * a[8][j],
                                 f[0] * a[7][j] - f[1] * a[6][j]};
        for (int i = 0; i < 3; i++) {
            double drift = 0.0, push = 0.0;
            for (int k = 0; k < 3; k++) {
                drift += c[3 * i + k] * a[9 + k][j];
                push += c[3 * i + k] * a[12 + k][j];
            }
            t[i][j] = a[i][j] + period * a[3 + i][j];
            t[3 + i][j] = a[3 + i][j] + period * (force[i] + push);
            t[6 + i][j] = a[6 + i][j] - period * drift;
            t[9 + i][j] = motion[13] * a[9 + i][j];
            t[12 + i][j] = motion[14] * a[12 + i][j];
        }
    }
}

static void predict(const double *upper, const double *noise, const double *motion, double *r) {
    static double p[N][N], phi_p[N][N], transposed[N][N], phi_p_phi[N][N];
    for (int i = 0, place = 0; i < N; i++)
        for (int j = i; j < N; j++)
            p[i][j] = p[j][i] = upper[place++];
    move(p, motion, phi_p);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            transposed[i][j] = phi_p[j][i];
    move(transposed, motion, phi_p_phi);
    for (int i = 0, place = 0; i < N; i++) {
        for (int j = i; j < N; j++)
            r[place++] = phi_p_phi[i][j];
        r[place - (N - i)] += noise[i];
    }
}

/* The error states of an inertial navigator: v is P, noise (N), motion; r is P. */
EXPORT void inertial_predict(const double *restrict v, double *restrict r) {
    predict(v, v + UPPER, v + UPPER + N, r);
}

#define COUNT 4
/* Four filters: v is corrections (4, N), Ps, noises (4, N), row (N), variances (4), residual, motion; r is corrections,
   Ps. */
EXPORT void bank(const double *restrict v, double *restrict r) {
    const double *uppers = v + COUNT * N, *noises = uppers + COUNT * UPPER, *row = noises + COUNT * N;
    const double *variances = row + N, *motion = variances + COUNT + 1;
    double given[N + UPPER + N + 2], after[N + UPPER];
    for (int i = 0; i < COUNT; i++) {
        memcpy(given, v + i * N, N * sizeof *v);
        predict(uppers + i * UPPER, noises + i * N, motion, given + N);
        memcpy(given + N + UPPER, row, N * sizeof *row);
        given[N + UPPER + N] = variances[i];
        given[N + UPPER + N + 1] = variances[COUNT];
        ekf_update(given, after);
        memcpy(r + i * N, after, N * sizeof *r);
        memcpy(r + COUNT * N + i * UPPER, after + N, UPPER * sizeof *r);
    }
}
#endif

#define SATELLITES 24
/* Weighted least squares: v is where to start (4), positions (24, 3), ranges (24), weights (24); r is where it is. */
EXPORT void satellites(const double *restrict v, double *restrict r) {
    const double *positions = v + 4, *ranges = positions + 3 * SATELLITES, *weights = ranges + SATELLITES;
    memcpy(r, v, 4 * sizeof *r);
    for (int iteration = 0; iteration < 4; iteration++) {
        double a[4][4] = {{0.0}}, x[4] = {0.0};
        for (int s = 0; s < SATELLITES; s++) {
            double h[4], square = 0.0;
            for (int k = 0; k < 3; k++) {
                h[k] = r[k] - positions[3 * s + k];
                square += h[k] * h[k];
            }
            const double distance = sqrt(square), residual = ranges[s] - distance - r[3];
            for (int k = 0; k < 3; k++)
                h[k] /= distance;
            h[3] = 1.0;
            for (int i = 0; i < 4; i++) {
                x[i] += weights[s] * h[i] * residual;
                for (int j = 0; j <= i; j++)
                    a[i][j] += weights[s] * h[i] * h[j];
            }
        }
        for (int j = 0; j < 4; j++) { /* L below the diagonal of a, D on it */
            for (int k = 0; k < j; k++)
                a[j][j] -= a[j][k] * a[j][k] * a[k][k];
            for (int i = j + 1; i < 4; i++) {
                for (int k = 0; k < j; k++)
                    a[i][j] -= a[i][k] * a[j][k] * a[k][k];
                a[i][j] /= a[j][j];
            }
            for (int k = 0; k < j; k++)
                x[j] -= a[j][k] * x[k];
        }
        for (int i = 3; i >= 0; i--) {
            x[i] /= a[i][i];
            for (int k = i + 1; k < 4; k++)
                x[i] -= a[k][i] * x[k];
        }
        for (int i = 0; i < 4; i++)
            r[i] += x[i];
    }
}
