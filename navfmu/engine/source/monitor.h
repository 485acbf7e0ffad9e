/* What requirements ask at every communication point: navfmu/engine/monitor.py says what each number means. */
#ifndef NAVFMU_MONITOR_H
#define NAVFMU_MONITOR_H

#include "program.h"

/* The first point at which any of the faults acted, -1: none has. */
static inline int64_t onset(const Master *m, const Trigger *first, const Trigger *end) {
    int64_t found = -1;
    for (const Trigger *t = first; t < end; t++)
        if (t->spans && (found < 0 || m->span[t->first_span].first < found)) found = m->span[t->first_span].first;
    return found;
}

/* The first point since which none of the faults has acted any more, -1: one does, or none has. */
static inline int64_t over(const Master *m, const Trigger *first, const Trigger *end) {
    int64_t found = -1;
    for (const Trigger *t = first; t < end; t++) {
        if (t->now.acts) return -1;
        if (t->spans && m->span[t->first_span + t->spans - 1].end > found)
            found = m->span[t->first_span + t->spans - 1].end;
    }
    return found;
}

static inline int64_t origin(const Master *m, const Monitor *o) {
    if (o->counts_from == START) return 0;
    if (o->fault < -1) return -1; /* of a fault that the run does not have */
    const Trigger *first = m->trigger + (o->fault < 0 ? 0 : o->fault), *end = o->fault < 0 ? first + m->faults : first + 1;
    return o->counts_from == ONSET ? onset(m, first, end) : over(m, first, end);
}

/* A point outside of the bounds: it counts once more of them follow one another than are put up with. */
static inline void stray(Monitor *o, int64_t k) {
    o->row++;
    o->back = -1;
    if (k - o->origin >= o->latest) {
        o->latest = k - o->origin + 1;
        o->latest_from = o->origin;
    }
    if (o->row > o->longest) o->longest = o->row;
    if (o->row <= o->tolerated) return;
    o->outside += o->row == o->tolerated + 1 ? o->row : 1;
    o->last_outside = k;
    if (o->row > o->tolerated + 1) return;
    o->episodes++;
    if (o->first_outside < 0) o->first_outside = k - o->tolerated;
}

/* A point inside; what it takes from its origin to there is as long as it took to the last point outside. */
static inline void inside(Monitor *o, int64_t k) {
    o->row = 0;
    o->back = o->last_outside < o->origin ? 0 : o->last_outside - o->origin + 1;
    o->last_inside = k;
    if (o->first_inside < 0) o->first_inside = k;
}

/* Nothing is counted at this point: what was counted from the last origin is settled. */
static inline void settle(Monitor *o) {
    if (o->back > o->settled) o->settled = o->back;
    o->back = -1;
    o->row = 0;
}

static inline void observe(const Master *m, Monitor *o, int64_t k, double t) {
    int64_t from = origin(m, o);
    if (from < 0) settle(o);
    if (from < 0 || k - from < o->begin || k - from > o->end) return;
    o->origin = from;
    if (o->whens && program(m, o->first_when, o->whens, t) == 0.0) {
        o->row = 0;
        return;
    }
    double value = program(m, o->first_operation, o->operations, t);
    double above = value - o->most, below = o->least - value;
    double excess = isnan(value) ? INFINITY : above > below ? above : below;
    o->points++;
    if (isfinite(value)) {
        o->squares += value * value;
        if (fabs(value) > o->greatest) o->greatest = fabs(value);
    } else {
        o->not_finite++;
    }
    if (o->worst_at < 0 || excess > o->excess) {
        o->excess = excess;
        o->worst = value;
        o->worst_at = k;
    }
    if (value >= o->least && value <= o->most) {
        inside(o, k);
    } else {
        stray(o, k);
    }
}

static void observe_all(Master *m, int64_t k) {
    double t = time_of(m, k);
    for (Monitor *o = m->monitor; o < m->monitor + m->monitors; o++) observe(m, o, k, t);
}

#endif
