#include "noise.h"

#include <math.h>

static uint64_t multiply(uint64_t a, uint64_t b, uint64_t *high) {
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 Wide;
    Wide product = (Wide)a * b;
    *high = (uint64_t)(product >> 64);
    return (uint64_t)product;
#else
    uint64_t a0 = a & 0xFFFFFFFFu, a1 = a >> 32, b0 = b & 0xFFFFFFFFu, b1 = b >> 32;
    uint64_t middle = a1 * b0 + (a0 * b0 >> 32);
    uint64_t carry = (middle & 0xFFFFFFFFu) + a0 * b1;
    *high = a1 * b1 + (middle >> 32) + (carry >> 32);
    return a * b;
#endif
}

void philox(const uint64_t counter[4], const uint64_t key[2], uint64_t out[4]) {
    uint64_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
    uint64_t k0 = key[0], k1 = key[1];
    for (int round = 0; round < 10; round++) {
        uint64_t high0, high1;
        uint64_t low0 = multiply(0xD2E7470EE14C6C93u, c0, &high0);
        uint64_t low1 = multiply(0xCA5A826395121157u, c2, &high1);
        c0 = high1 ^ c1 ^ k0;
        c1 = low1;
        c2 = high0 ^ c3 ^ k1;
        c3 = low0;
        k0 += 0x9E3779B97F4A7C15u;
        k1 += 0xBB67AE8584CAA73Bu;
    }
    out[0] = c0, out[1] = c1, out[2] = c2, out[3] = c3;
}

/* A number in (0, 1], never 0. */
static double uniform(uint64_t n) {
    return ((double)(n >> 11) + 0.5) * 0x1p-53;
}

void standard_normals(const uint64_t key[2], uint64_t k, uint64_t task, double *z, int count) {
    for (int i = 0; i < count; i += 4) {
        uint64_t counter[4] = {(uint64_t)(i / 4), k, task, 0}, n[4];
        philox(counter, key, n);
        for (int pair = 0; pair < 2 && i + 2 * pair < count; pair++) {
            double radius = sqrt(-2.0 * log(uniform(n[2 * pair])));
            double angle = 6.283185307179586 * uniform(n[2 * pair + 1]);
            z[i + 2 * pair] = radius * cos(angle);
            if (i + 2 * pair + 1 < count) z[i + 2 * pair + 1] = radius * sin(angle);
        }
    }
}
