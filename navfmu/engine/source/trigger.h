/* When faults act; see navfmu/engine/trigger.py. */
#ifndef NAVFMU_TRIGGER_H
#define NAVFMU_TRIGGER_H

#include "program.h"

/* Whether point k lies in a window of its list; those that have ended are left behind. */
static inline Moment listed(const Master *m, Trigger *t, int64_t k) {
    while (t->window < t->last && m->window[t->window].end <= k) t->window++;
    const Window *w = m->window + t->window;
    if (t->window == t->last || k < w->first) return (Moment){0};
    return (Moment){1, w->first, w->start};
}

/* Since point k, if that was later than the window began. */
static inline void not_before(const Master *m, Moment *now, int64_t k) {
    if (k > now->since) *now = (Moment){1, k, time_of(m, k)};
}

static inline Moment moment_of(const Master *m, Trigger *t, int64_t k) {
    Moment now = listed(m, t, k);
    if (t->kind == LISTED) return now;
    if (now.acts && t->row < t->needed) now = (Moment){0};
    if (t->kind == DURING) {
        if (now.acts) not_before(m, &now, k - (t->row - t->needed));
    } else if (t->spans || now.acts) { /* WHEN: it has begun, or does so now */
        int64_t onset = t->spans ? m->span[t->first_span].first : k;
        now = k - onset < t->lasts ? (Moment){1, onset, time_of(m, onset)} : (Moment){0};
    }
    return now;
}

/* It begins to act at point k, in a new span or in the last one, or does so no more. */
static inline void keep(const Master *m, Trigger *t, int64_t k) {
    if (t->now.acts && t->spans < t->room) m->span[t->first_span + t->spans++].first = k;
    m->span[t->first_span + t->spans - 1].end = t->now.acts ? FOREVER : k;
}

/* Before which point it needs not be moved, as nothing that it says of point k and the one before can change. */
static inline int64_t stays(const Master *m, const Trigger *t, int64_t k) {
    if (t->operations || t->now.acts != t->before.acts || t->now.since != t->before.since) return k + 1;
    if (t->window == t->last) return FOREVER;
    return t->now.acts ? m->window[t->window].end : m->window[t->window].first;
}

/* From point k - 1, whose values have all left, to point k: the one place where it is decided what acts there. */
static inline void move_triggers(Master *m, int64_t k) {
    if (k < m->calm) return;
    m->calm = FOREVER;
    Trigger *end = m->trigger + m->triggers;
    for (Trigger *t = m->trigger; k && t < end; t++) /* all are asked before one of them moves */
        if (t->operations)
            t->row = program(m, t->first_operation, t->operations, time_of(m, k - 1)) != 0.0 ? t->row + 1 : 0;
    for (Trigger *t = m->trigger; t < end; t++) {
        t->before = t->now;
        t->now = moment_of(m, t, k);
        if (t->now.acts != t->before.acts) keep(m, t, k);
        m->acting[t - m->trigger] = t->now.acts;
        m->acted[t - m->trigger] = t->before.acts;
        int64_t until = stays(m, t, k);
        if (until < m->calm) m->calm = until;
    }
}

#endif
