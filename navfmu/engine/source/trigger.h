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

/* That it acts at point k belongs to a new span, or to the last one. */
static inline void keep(const Master *m, Trigger *t, int64_t k) {
    if (!t->before.acts && t->spans < t->room) m->span[t->first_span + t->spans++].first = k;
    m->span[t->first_span + t->spans - 1].end = k + 1;
}

/* From point k - 1, whose values have all left, to point k: the one place where it is decided what acts there. */
static inline void move_triggers(Master *m, int64_t k) {
    Trigger *end = m->trigger + m->triggers;
    for (Trigger *t = m->trigger; k && t < end; t++) /* all are asked before one of them moves */
        if (t->operations)
            t->row = program(m, t->first_operation, t->operations, time_of(m, k - 1)) != 0.0 ? t->row + 1 : 0;
    for (Trigger *t = m->trigger; t < end; t++) {
        t->before = t->now;
        t->now = moment_of(m, t, k);
        if (t->now.acts) keep(m, t, k);
        m->acting[t - m->trigger] = t->now.acts;
    }
}

#endif
