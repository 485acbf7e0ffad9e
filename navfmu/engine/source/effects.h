/* What faults do to signals as they leave, and whether anybody sees it. */
#ifndef NAVFMU_EFFECTS_H
#define NAVFMU_EFFECTS_H

#include <string.h>

#include "act.h"

static inline uint64_t bits(double value) {
    uint64_t n;
    memcpy(&n, &value, sizeof n);
    return n;
}

/* The signals that an effect can reach, as they are before it. */
static inline void keep_before(Master *m, const Effect *e, const double *signal) {
    for (int i = 0; i < e->reaches; i++) m->memory[e->before + i] = signal[m->reach[e->first_reach + i]];
}

static void back_before(Master *m, const Effect *e) {
    for (int i = 0; i < e->reaches; i++) m->without[m->reach[e->first_reach + i]] = m->memory[e->before + i];
}

static void see(Master *m, Effect *e, int32_t slot, int64_t k) {
    int32_t readers = m->readers[slot];
    if (k == 0 && readers & (NOW | NEXT | AHEAD)) e->seen = 0;
    else if (readers & NOW) e->seen = 3 * k - 1;
    else if (readers & OBSERVED || (readers & RECORDED && k % m->record_every == 0)) e->seen = 3 * k;
    else if (readers & NEXT) e->seen = 3 * k + 1;
}

/* Would another value have left at point k without an effect of which nothing has been seen so far? It is followed from
   where it acts to where it acts no more and all that others remember is what they would remember without it. */
static RARELY void search(Master *m, Effect *e, int64_t k, int32_t only) {
    int followed = k > 0 && e->followed;
    e->followed = m->trigger[e->trigger].now.acts;
    back_before(m, e);
    for (const Echo *o = m->echo + e->first_echo; o < m->echo + e->first_echo + e->echoes; o++) {
        const Effect *other = m->effect + o->effect;
        const double *with = m->memory + other->memory;
        double *memory = m->memory + o->memory;
        size_t size = sizeof(double) * (size_t)other->size;
        if (!followed) memcpy(memory, with, size);
        act(m, other, memory, m->without, k);
        e->followed |= memcmp(memory, with, size) != 0;
    }
    for (int i = 0; i < e->reaches; i++) {
        int32_t slot = m->reach[e->first_reach + i];
        int differs = bits(m->without[slot]) != bits(m->signal[slot]);
        if (e->seen < 0 && differs && (only < 0 || slot == only)) see(m, e, slot, k);
    }
}

/* An effect that is alone with its signal and has changed nothing. */
static inline int same(const Master *m, const Effect *e) {
    return !e->echoes && e->reaches == 1 && bits(m->memory[e->before]) == bits(m->signal[e->slot]);
}

/* Effects act on the values that leave at communication point k, which are still the true ones, and those that nobody
   has seen are searched. `only`: values of k = 0 come about one by one, and this signal goes to others before the rest
   is known; -1: all are. Nothing else of the rest can be compared. Returns whether there is one. */
static RARELY int leave_searched(Master *m, int first_effect, int effects, int64_t k, int32_t only) {
    double *value = m->signal;
    Effect *first = m->effect + first_effect, *end = first + effects;
    int unseen = 0;
    for (Effect *e = first; e < end; e++) {
        if (e->seen < 0) {
            unseen = 1;
            keep_before(m, e, value);
        }
        act(m, e, m->memory + e->memory, value, k);
    }
    for (Effect *e = first; unseen && e < end; e++) {
        if (e->seen >= 0) continue;
        int acts = m->trigger[e->trigger].now.acts;
        if (same(m, e)) e->followed = acts;
        else if (acts || e->followed) search(m, e, k, only);
    }
    return unseen;
}

/* At t = 0 nothing lies ahead yet: what leaves is what every input gets. */
static inline void no_step_yet(Master *m, const Component *c) {
    for (int i = 0; i < c->exposures; i++) m->signal[2 * m->signals + c->exposed[i]] = m->signal[c->exposed[i]];
}

/* The same question as in `search`, for the values just before point k + 1. */
static RARELY void search_ahead(Master *m, Effect *e, int64_t k) {
    back_before(m, e);
    for (const Echo *o = m->echo + e->first_echo; o < m->echo + e->first_echo + e->echoes; o++)
        act_ahead(m, m->effect + o->effect, m->memory + o->memory, m->without, k);
    for (int i = 0; i < e->reaches; i++) {
        int32_t slot = m->reach[e->first_reach + i];
        if (m->readers[slot] & AHEAD && bits(m->without[slot]) != bits(m->signal[2 * m->signals + slot]))
            e->seen = 3 * k + 1;
    }
}

/* Effects of point k act on the values just before point k + 1, which are still the true ones. */
static RARELY void look_ahead_searched(Master *m, const Component *c, int64_t k) {
    double *ahead = m->signal + 2 * m->signals;
    Effect *first = m->effect + c->first_effect, *end = first + c->effects;
    int unseen = 0;
    for (Effect *e = first; e < end; e++) {
        if (!e->foreseen) continue;
        if (e->seen < 0) {
            unseen = 1;
            keep_before(m, e, ahead);
        }
        act_ahead(m, e, m->memory + e->memory, ahead, k);
    }
    for (Effect *e = first; unseen && e < end; e++)
        if (e->foreseen && e->seen < 0 && e->followed) search_ahead(m, e, k);
}

#endif
