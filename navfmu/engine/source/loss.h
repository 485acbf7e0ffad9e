/* Steps that a component loses; see navfmu/engine/loss.py. */
#ifndef NAVFMU_LOSS_H
#define NAVFMU_LOSS_H

#include "exchange.h"

/* Whether the coming step of a component is lost. */
static RARELY int is_lost(Master *m, const Component *c) {
    int lost = 0;
    for (Loss *l = m->loss + c->first_loss; l < m->loss + c->first_loss + c->losses; l++) {
        if (!m->trigger[l->trigger].before.acts) continue;
        if (l->seen < 0) l->seen = 3 * m->place->k + 1;
        lost = 1;
    }
    return lost;
}

static inline int loses(Master *m, const Component *c) { return c->losses && is_lost(m, c); }

/* The step is lost: the outputs are what they were, under the faults of communication point k. */
static RARELY void stand_still(Master *m, Component *c, int64_t k) {
    m->behind[c - m->component]++;
    if (c->effects) disturb_again(m, c, k, -1);
}

#endif
