/* What one effect of a fault does to its signal; see navfmu/engine/effect.py. */
#ifndef NAVFMU_ACT_H
#define NAVFMU_ACT_H

#include <math.h>

#include "noise.h"
#include "program.h"

/* Done for every effect at every point, without a call; done often where there are faults, and not elsewhere; done now
   and then. The last two are kept out of the way of the rest. */
#if defined(__GNUC__)
#define AT_ONCE __attribute__((always_inline)) inline
#define ASIDE __attribute__((noinline))
#define RARELY __attribute__((noinline, cold))
#else
#define AT_ONCE inline
#define ASIDE
#define RARELY
#endif

/* The number of the period in which communication point k lies, whatever the step. */
static inline int64_t period_of(const Effect *e, int64_t k) { return k * e->multiplier / e->divisor; }

/* The first communication point behind k that lies in a later period. It is remembered, as divisions take long. */
static ASIDE double next_period(const Effect *e, int64_t k) {
    if (e->multiplier == 0) return INFINITY;
    int64_t end = (period_of(e, k) + 1) * e->divisor;
    return (double)(end / e->multiplier + (end % e->multiplier != 0));
}

/* Whether one of the periods begins at communication point k that are counted from the beginning of the window:
   memory[1] is where the last one began, memory[2] where the next one does. */
static inline int begins(const Effect *e, double *memory, const Moment *now, int64_t k) {
    if (k == now->since || (double)k >= memory[2]) {
        memory[1] = (double)k;
        memory[2] = (double)now->since + next_period(e, k - now->since);
    }
    return memory[1] == (double)k;
}

/* Whether the random number of communication point k is that of the point before; memory[0] is where the next period
   begins. */
static inline int drawn(const Effect *e, double *memory, int64_t k) {
    if ((double)k < memory[0]) return 1;
    memory[0] = next_period(e, k);
    return 0;
}

static ASIDE double draw_normal(const Effect *e, int64_t j) {
    const uint64_t key[2] = {e->seed, e->stream};
    double z;
    standard_normals(key, (uint64_t)j, e->lane, &z, 1);
    return z;
}

static ASIDE double draw_uniform(const Effect *e, int64_t j) {
    const uint64_t key[2] = {e->seed, e->stream}, counter[4] = {0, (uint64_t)j, e->lane, 0};
    uint64_t word[4];
    philox(counter, key, word);
    return ((double)(word[0] >> 11) + 0.5) * 0x1p-53;
}

/* DELAY remembers where its next jitter comes, how late the present one is, and behind that the last values in a ring,
   the length of which is a power of 2. */
static inline int64_t kept(const Effect *e) { return e->size - 2; }

static inline double late(const Effect *e, int64_t j) {
    double steps = ceil(e->amount + e->other * draw_uniform(e, j)), most = (double)(kept(e) - 1);
    return steps < most ? steps : most;
}

/* The value that came to a DELAY so many communication points before k. */
static inline double past(const Effect *e, const double *memory, int64_t k) {
    int64_t then = k - (int64_t)memory[1];
    return memory[2 + (then > 0 ? then & (kept(e) - 1) : 0)];
}

/* All at the same time. */
static ASIDE void swap(const Master *m, const Effect *e, double *signal) {
    const int32_t *to = m->reach + e->first_pair, *from = to + e->pairs;
    for (int i = 0; i < e->pairs; i++) m->turned[i] = signal[from[i]];
    for (int i = 0; i < e->pairs; i++) signal[to[i]] = m->turned[i];
}

/* What the connection makes of the value at its beginning; what is not scaled keeps its bits. */
static inline double taken(const Master *m, const Effect *e, const double *signal) {
    double v = signal[m->reach[e->first_pair + 1]];
    return e->amount != 1.0 || e->other != 0.0 ? e->amount * v + e->other : v;
}

/* What it remembers of a point k at which it does not act and v came to it. */
static inline void pass(const Effect *e, double *memory, double v, int64_t k) {
    switch (e->kind) {
    case HOLD: memory[0] = v; break;
    case SPIKE: memory[0] = 0.0; break;
    case DELAY: memory[2 + (k & (kept(e) - 1))] = v; break;
    }
}

/* What it makes of its signal as of communication point k, while it acts as it did at the point of `at`. Whether the
   value `leaves` at k, and it remembers what of that is needed later; twice the same k is as good as once. */
static AT_ONCE void change(const Master *m, const Effect *e, double *memory, const Moment *at, double *signal, int64_t k,
                           int leaves) {
    double *v = signal + e->slot;
    switch (e->kind) {
    case ADD: *v += e->amount; break;
    case RAMP: *v += e->amount * (time_of(m, k) - at->start); break;
    case SET: *v = e->amount; break;
    case HOLD:
        if (leaves && k == 0) memory[0] = *v;
        *v = memory[0];
        break;
    case NOISE:
        if (leaves && !drawn(e, memory, k)) memory[1] = e->amount * draw_normal(e, period_of(e, k));
        *v += memory[1];
        break;
    case SCALE: *v *= e->amount; break;
    case AFFINE: *v = *v * e->amount + e->other; break;
    case CLIP: *v = *v < e->amount ? e->amount : *v > e->other ? e->other : *v; break;
    case QUANTISE: *v = rint(*v / e->amount) * e->amount; break;
    case SPIKE:
        if (leaves) memory[0] = begins(e, memory, at, k);
        if (memory[0] != 0.0) *v += e->amount;
        break;
    case GARBAGE:
        if (leaves && !drawn(e, memory, k))
            memory[1] = e->amount + (e->other - e->amount) * draw_uniform(e, period_of(e, k));
        *v = memory[1];
        break;
    case DELAY:
        if (leaves) memory[2 + (k & (kept(e) - 1))] = *v;
        if (leaves && e->other != 0.0 && !drawn(e, memory, k)) memory[1] = late(e, period_of(e, k));
        if (memory[1] != 0.0) *v = past(e, memory, k);
        break;
    case SLOW:
        if (leaves && begins(e, memory, at, k)) memory[0] = *v;
        *v = memory[0];
        break;
    case SWAP: swap(m, e, signal); break;
    case TAKE: *v = taken(m, e, signal); break;
    }
}

/* What becomes of its signal as it leaves at communication point k. */
static AT_ONCE void act(const Master *m, const Effect *e, double *memory, double *signal, int64_t k) {
    const Moment *now = &m->trigger[e->trigger].now;
    if (m->acting[e->trigger]) change(m, e, memory, now, signal, k, 1);
    else pass(e, memory, signal[e->slot], k);
}

/* What becomes of its signal just before point k + 1, under the effect of point k. */
static AT_ONCE void act_ahead(const Master *m, const Effect *e, double *memory, double *signal, int64_t k) {
    const Moment *before = &m->trigger[e->trigger].before;
    if (m->acted[e->trigger]) change(m, e, memory, before, signal, k + 1, 0);
}

#endif
