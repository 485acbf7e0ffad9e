/* What one effect of a fault does to its signal; see navfmu/engine/effect.py. */
#ifndef NAVFMU_ACT_H
#define NAVFMU_ACT_H

#include <math.h>

#include "noise.h"
#include "program.h"

/* The number of the period in which communication point k lies, whatever the step. */
static inline int64_t period_of(const Effect *e, int64_t k) { return k * e->multiplier / e->divisor; }

/* Whether one of the periods begins at communication point k that are counted from the beginning of the window. */
static inline int begins(const Effect *e, const Moment *now, int64_t k) {
    int64_t n = k - now->since;
    return n == 0 || period_of(e, n) != period_of(e, n - 1);
}

/* Random numbers of communication point k are new each period; memory[0] is the number of the last one. */
static inline int drawn(double *memory, int64_t j) {
    if ((double)j == memory[0]) return 1;
    memory[0] = (double)j;
    return 0;
}

static inline double draw_normal(const Effect *e, int64_t j) {
    const uint64_t key[2] = {e->seed, e->stream};
    double z;
    standard_normals(key, (uint64_t)j, e->lane, &z, 1);
    return z;
}

static inline double draw_uniform(const Effect *e, int64_t j) {
    const uint64_t key[2] = {e->seed, e->stream}, counter[4] = {0, (uint64_t)j, e->lane, 0};
    uint64_t word[4];
    philox(counter, key, word);
    return ((double)(word[0] >> 11) + 0.5) * 0x1p-53;
}

/* DELAY remembers the number of its jitter, how late the present one is, and behind that the last values in a ring,
   the length of which is a power of 2. */
static inline int64_t kept(const Effect *e) { return e->size - 2; }

static inline double late(const Effect *e, int64_t j) {
    double steps = ceil(e->amount + e->other * draw_uniform(e, j)), most = (double)(kept(e) - 1);
    return steps < most ? steps : most;
}

/* What it remembers of communication point k, at which v came to it. Twice the same k is as good as once. */
static inline void remember(const Effect *e, double *memory, const Moment *now, double v, int64_t k) {
    switch (e->kind) {
    case HOLD:
        if (!now->acts || k == 0) memory[0] = v;
        break;
    case NOISE:
        if (now->acts && !drawn(memory, period_of(e, k))) memory[1] = e->amount * draw_normal(e, period_of(e, k));
        break;
    case GARBAGE:
        if (now->acts && !drawn(memory, period_of(e, k)))
            memory[1] = e->amount + (e->other - e->amount) * draw_uniform(e, period_of(e, k));
        break;
    case SPIKE: memory[0] = now->acts && begins(e, now, k); break;
    case SLOW:
        if (now->acts && begins(e, now, k)) memory[0] = v;
        break;
    case DELAY:
        memory[2 + (k & (kept(e) - 1))] = v;
        if (now->acts && e->other != 0.0 && !drawn(memory, period_of(e, k))) memory[1] = late(e, period_of(e, k));
        break;
    }
}

/* The value that came to a DELAY so many communication points before k. */
static inline double past(const Effect *e, const double *memory, int64_t k) {
    int64_t then = k - (int64_t)memory[1];
    return memory[2 + (then > 0 ? then & (kept(e) - 1) : 0)];
}

/* All at the same time. */
static inline void swap(const Master *m, const Effect *e, double *signal) {
    const int32_t *to = m->reach + e->first_pair, *from = to + e->pairs;
    for (int i = 0; i < e->pairs; i++) m->turned[i] = signal[from[i]];
    for (int i = 0; i < e->pairs; i++) signal[to[i]] = m->turned[i];
}

/* What the connection makes of the value at its beginning; what is not scaled keeps its bits. */
static inline double taken(const Master *m, const Effect *e, const double *signal) {
    double v = signal[m->reach[e->first_pair + 1]];
    return e->amount != 1.0 || e->other != 0.0 ? e->amount * v + e->other : v;
}

/* What it makes of its signal as of communication point k, while it acts as it did at the point of `at`. */
static inline void change(const Master *m, const Effect *e, const double *memory, const Moment *at, double *signal,
                          int64_t k) {
    double *v = signal + e->slot;
    switch (e->kind) {
    case ADD: *v += e->amount; break;
    case RAMP: *v += e->amount * (time_of(m, k) - at->start); break;
    case SET: *v = e->amount; break;
    case HOLD: *v = memory[0]; break;
    case NOISE: *v += memory[1]; break;
    case SCALE: *v *= e->amount; break;
    case AFFINE: *v = *v * e->amount + e->other; break;
    case CLIP: *v = *v < e->amount ? e->amount : *v > e->other ? e->other : *v; break;
    case QUANTISE: *v = rint(*v / e->amount) * e->amount; break;
    case SPIKE:
        if (memory[0] != 0.0) *v += e->amount;
        break;
    case GARBAGE: *v = memory[1]; break;
    case DELAY:
        if (memory[1] != 0.0) *v = past(e, memory, k);
        break;
    case SLOW: *v = memory[0]; break;
    case SWAP: swap(m, e, signal); break;
    case TAKE: *v = taken(m, e, signal); break;
    }
}

/* What becomes of its signal as it leaves at communication point k. */
static inline void act(const Master *m, const Effect *e, double *memory, double *signal, int64_t k) {
    const Moment *now = &m->trigger[e->trigger].now;
    if (e->size) remember(e, memory, now, signal[e->slot], k);
    if (now->acts) change(m, e, memory, now, signal, k);
}

/* What becomes of its signal just before point k + 1, under the effect of point k. */
static inline void act_ahead(const Master *m, const Effect *e, const double *memory, double *signal, int64_t k) {
    const Moment *before = &m->trigger[e->trigger].before;
    if (before->acts) change(m, e, memory, before, signal, k + 1);
}

#endif
