/* Jacobi: all components get their inputs as of t_k, then all make the step to t_{k+1}. */
#include "loss.h"

int jacobi(Master *m) {
    double t = time_of(m, m->place->k);
    for (int i = 0; i < m->components; i++) {
        Component *c = at(m, i);
        if (loses(m, c)) continue;
        if (set_held(m, c, 0)) return 1;
        called(c);
    }
    for (int i = 0; i < m->components; i++) {
        Component *c = at(m, i);
        if (loses(m, c)) stand_still(m, c, m->place->k + 1);
        else if (make_step(m, c, t) || read_outputs(m, c, m->place->k + 1)) return 1;
    }
    return 0;
}
