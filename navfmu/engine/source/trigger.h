/* When faults act; see navfmu/engine/trigger.py. */
#ifndef NAVFMU_TRIGGER_H
#define NAVFMU_TRIGGER_H

#include "master.h"

/* Whether point k lies in a window of its list; those that have ended are left behind. */
static inline void follow_list(const Master *m, Trigger *t, int64_t k) {
    while (t->window < t->last && m->window[t->window].end <= k) t->window++;
    const Window *w = m->window + t->window;
    t->now.acts = t->window < t->last && w->first <= k;
    if (!t->now.acts) return;
    t->now.since = w->first;
    t->now.start = w->start;
}

/* From point k - 1, whose values have all left, to point k: the one place where it is decided what acts there. */
static inline void move_triggers(Master *m, int64_t k) {
    for (Trigger *t = m->trigger; t < m->trigger + m->triggers; t++) {
        t->before = t->now;
        switch (t->kind) {
        case LISTED: follow_list(m, t, k); break;
        }
        m->acting[t - m->trigger] = t->now.acts;
    }
}

#endif
