/* What one effect of a fault does to its signal; see navfmu/engine/effect.py. */
#ifndef NAVFMU_ACT_H
#define NAVFMU_ACT_H

#include "master.h"
#include "noise.h"

static inline double time_of(const Master *m, int64_t k) {
    return (double)k * m->numerator / m->denominator;
}

/* The number of the period in which communication point k lies, whatever the step. */
static inline int64_t period_of(const Effect *e, int64_t k) { return k * e->multiplier / e->divisor; }

/* The noise of communication point k: a new normal number each period. */
static inline void draw_normal(const Effect *e, double *memory, int64_t k) {
    int64_t j = period_of(e, k);
    if ((double)j == memory[0]) return;
    const uint64_t key[2] = {e->seed, e->stream};
    double z;
    standard_normals(key, (uint64_t)j, e->lane, &z, 1);
    memory[0] = (double)j;
    memory[1] = e->amount * z;
}

/* What it remembers of communication point k, at which v came to it. Twice the same k is as good as once. */
static inline void remember(const Effect *e, double *memory, const Moment *now, double v, int64_t k) {
    switch (e->kind) {
    case HOLD:
        if (!now->acts || k == 0) memory[0] = v;
        break;
    case NOISE:
        if (now->acts) draw_normal(e, memory, k);
        break;
    }
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
    }
}

/* What becomes of its signal as it leaves at communication point k. */
static inline void act(const Master *m, const Effect *e, double *memory, double *signal, int64_t k) {
    const Moment *now = &m->trigger[e->trigger].now;
    remember(e, memory, now, signal[e->slot], k);
    if (now->acts) change(m, e, memory, now, signal, k);
}

/* What becomes of its signal just before point k + 1, under the effect of point k. */
static inline void act_ahead(const Master *m, const Effect *e, const double *memory, double *signal, int64_t k) {
    const Moment *before = &m->trigger[e->trigger].before;
    if (before->acts) change(m, e, memory, before, signal, k + 1);
}

#endif
