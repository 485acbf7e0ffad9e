/* What faults do to signals as they leave. */
#ifndef NAVFMU_EFFECTS_H
#define NAVFMU_EFFECTS_H

#include <string.h>

#include "master.h"
#include "noise.h"

/* Kept out of the way of the calls that succeed and of components without faults. */
#if defined(__GNUC__)
#define RARELY __attribute__((noinline, cold))
#else
#define RARELY
#endif

static inline uint64_t bits(double value) {
    uint64_t n;
    memcpy(&n, &value, sizeof n);
    return n;
}

static inline double time_of(const Master *m, int64_t k) {
    return (double)k * m->numerator / m->denominator;
}

/* The noise of an effect at communication point k: a new normal number each period, whatever the step. */
static inline double noise_at(Effect *e, int64_t k) {
    int64_t j = k * e->multiplier / e->divisor;
    if (j != e->drawn) {
        const uint64_t key[2] = {e->seed, e->stream};
        double z;
        standard_normals(key, (uint64_t)j, e->lane, &z, 1);
        e->memory = e->amount * z;
        e->drawn = j;
    }
    return e->memory;
}

/* What an effect makes of a value that leaves at communication point k. */
static inline void act(const Master *m, Effect *e, double *v, int64_t k) {
    int active = k >= e->first && k < e->end;
    if (e->kind == HOLD && (!active || k == 0)) e->memory = *v;
    if (!active) return;
    switch (e->kind) {
    case ADD: *v += e->amount; break;
    case RAMP: *v += e->amount * (time_of(m, k) - e->start); break;
    case SET: *v = e->amount; break;
    case HOLD: *v = e->memory; break;
    case NOISE: *v += noise_at(e, k); break;
    }
}

/* Would another value have left at point k without an effect of which nothing has been seen so far? */
static RARELY void search(Master *m, Effect *e, int64_t k) {
    double without = e->before;
    for (Echo *o = m->echo + e->first_echo; o < m->echo + e->first_echo + e->echoes; o++) {
        Effect other = m->effect[o->effect];
        if (k > e->first) {
            other.memory = o->memory;
            other.drawn = o->drawn;
        }
        act(m, &other, &without, k);
        o->memory = other.memory;
        o->drawn = other.drawn;
    }
    if (bits(without) == bits(m->signal[e->slot])) return;
    if (k == 0 && e->readers & (NOW | NEXT | AHEAD)) e->seen = 0;
    else if (e->readers & NOW) e->seen = 3 * k - 1;
    else if (e->readers & OBSERVED || (e->readers & RECORDED && k % m->record_every == 0)) e->seen = 3 * k;
    else if (e->readers & NEXT) e->seen = 3 * k + 1;
}

/* Values that leave at communication point k, from the true ones. `only`: those of k = 0 come about one by one, and this
   signal goes to others before the rest is known; -1: all are. Nothing else of the rest can be compared. */
static inline void leave(Master *m, int first_signal, int signals, int first_effect, int effects, int64_t k,
                         int32_t only) {
    double *value = m->signal;
    Effect *first = m->effect + first_effect, *end = first + effects;
    memcpy(value + first_signal, value + m->signals + first_signal, sizeof(double) * (size_t)signals);
    for (Effect *e = first; e < end; e++) {
        e->before = value[e->slot];
        act(m, e, value + e->slot, k);
    }
    for (Effect *e = first; e < end; e++)
        if (e->seen < 0 && k >= e->first && k < e->until && (only < 0 || e->slot == only)) search(m, e, k);
}

/* At t = 0 nothing lies ahead yet: what leaves is what every input gets. */
static inline void no_step_yet(Master *m, const Component *c) {
    memcpy(m->signal + 2 * m->signals + c->first_signal, m->signal + c->first_signal,
           sizeof(double) * (size_t)(c->reals + c->integers + c->booleans));
}

/* What an effect of point k makes of a value just before point k + 1. */
static inline void act_ahead(const Master *m, const Effect *e, double *v, int64_t k) {
    if (k < e->first || k >= e->end) return;
    switch (e->kind) {
    case ADD: *v += e->amount; break;
    case RAMP: *v += e->amount * (time_of(m, k + 1) - e->start); break;
    case SET: *v = e->amount; break;
    case HOLD: *v = e->memory; break;
    case NOISE: *v += e->memory; break;
    }
}

/* The same question as in `search`, for the value just before point k + 1. */
static RARELY void search_ahead(Master *m, Effect *e, int64_t k) {
    double without = e->before;
    for (const Echo *o = m->echo + e->first_echo; o < m->echo + e->first_echo + e->echoes; o++) {
        Effect other = m->effect[o->effect];
        other.memory = o->memory;
        act_ahead(m, &other, &without, k);
    }
    if (bits(without) != bits(m->signal[2 * m->signals + e->slot])) e->seen = 3 * k + 1;
}

/* Values just before communication point k + 1, where the effects of point k still act on the true values. */
static inline void look_ahead(Master *m, const Component *c, int64_t k) {
    double *ahead = m->signal + 2 * m->signals;
    Effect *first = m->effect + c->first_effect, *end = first + c->effects;
    memcpy(ahead + c->first_signal, m->signal + m->signals + c->first_signal,
           sizeof(double) * (size_t)(c->reals + c->integers + c->booleans));
    for (Effect *e = first; e < end; e++) {
        e->before = ahead[e->slot];
        act_ahead(m, e, ahead + e->slot, k);
    }
    for (Effect *e = first; e < end; e++)
        if (e->seen < 0 && k >= e->first && k < e->until && e->readers & AHEAD) search_ahead(m, e, k);
}

#endif
