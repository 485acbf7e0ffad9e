/* What faults do to signals as they leave. */
#ifndef NAVFMU_EFFECTS_H
#define NAVFMU_EFFECTS_H

#include <string.h>

#include "master.h"
#include "noise.h"

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

/* Values that leave at communication point k, from the true ones. */
static inline void leave(Master *m, int first_signal, int signals, int first_effect, int effects, int64_t k) {
    double *value = m->signal;
    memcpy(value + first_signal, value + m->signals + first_signal, sizeof(double) * (size_t)signals);
    for (Effect *e = m->effect + first_effect; e < m->effect + first_effect + effects; e++) {
        double *v = value + e->slot;
        int active = k >= e->first && k < e->end;
        if (e->kind == HOLD && (!active || k == 0)) e->memory = *v;
        if (!active) continue;
        switch (e->kind) {
        case ADD: *v += e->amount; break;
        case RAMP: *v += e->amount * (time_of(m, k) - e->start); break;
        case SET: *v = e->amount; break;
        case HOLD: *v = e->memory; break;
        case NOISE: *v += noise_at(e, k); break;
        }
    }
}

/* At t = 0 nothing lies ahead yet: what leaves is what every input gets. */
static inline void no_step_yet(Master *m, const Component *c) {
    memcpy(m->signal + 2 * m->signals + c->first_signal, m->signal + c->first_signal,
           sizeof(double) * (size_t)(c->reals + c->integers + c->booleans));
}

/* Values just before communication point k + 1, where the effects of point k still act on the true values. */
static inline void look_ahead(Master *m, const Component *c, int64_t k) {
    double *ahead = m->signal + 2 * m->signals;
    memcpy(ahead + c->first_signal, m->signal + m->signals + c->first_signal,
           sizeof(double) * (size_t)(c->reals + c->integers + c->booleans));
    for (const Effect *e = m->effect + c->first_effect; e < m->effect + c->first_effect + c->effects; e++) {
        double *v = ahead + e->slot;
        if (k < e->first || k >= e->end) continue;
        switch (e->kind) {
        case ADD: *v += e->amount; break;
        case RAMP: *v += e->amount * (time_of(m, k + 1) - e->start); break;
        case SET: *v = e->amount; break;
        case HOLD: *v = e->memory; break;
        case NOISE: *v += e->memory; break;
        }
    }
}

#endif
