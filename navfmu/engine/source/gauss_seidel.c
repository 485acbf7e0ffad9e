/* Gauss-Seidel: one after the other, each component gets its inputs and makes the step to t_{k+1}. */
#include "loss.h"

int gauss_seidel(Master *m) {
    double t = time_of(m, m->place->k);
    for (int i = 0; i < m->components; i++) {
        Component *c = at(m, m->order[i]);
        if (loses(m, c)) {
            stand_still(m, c, m->place->k + 1);
            continue;
        }
        if (set_smooth(m, c) || set_held(m, c, 0)) return 1;
        if (make_step(m, c, t) || read_outputs(m, c, m->place->k + 1)) return 1;
    }
    return 0;
}
