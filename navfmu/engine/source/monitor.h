/* What requirements ask at every communication point: navfmu/engine/monitor.py says what each number means. */
#ifndef NAVFMU_MONITOR_H
#define NAVFMU_MONITOR_H

#include "master.h"

static inline double program(const Master *m, int32_t first, int32_t count, double t) {
    return value_of(m->operation + first, count, m->signal, t, m->acting, m->faults);
}

/* A point outside of the bounds: it counts once more of them follow one another than are put up with. */
static inline void stray(Monitor *o, int64_t k) {
    o->row++;
    if (o->row > o->longest) o->longest = o->row;
    if (o->row <= o->tolerated) return;
    o->outside += o->row == o->tolerated + 1 ? o->row : 1;
    o->last_outside = k;
    if (o->row > o->tolerated + 1) return;
    o->episodes++;
    if (o->first_outside < 0) o->first_outside = k - o->tolerated;
}

static inline void observe(const Master *m, Monitor *o, int64_t k, double t) {
    if (k < o->begin || k > o->end) return;
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
        o->row = 0;
        o->last_inside = k;
        if (o->first_inside < 0) o->first_inside = k;
    } else {
        stray(o, k);
    }
}

static void observe_all(Master *m, int64_t k) {
    double t = (double)k * m->numerator / m->denominator;
    for (Monitor *o = m->monitor; o < m->monitor + m->monitors; o++) observe(m, o, k, t);
}

#endif
