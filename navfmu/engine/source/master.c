/* The run: initial values, steps, recording. */
#include "exchange.h"

static void drive(Master *m, int64_t k) {
    if (m->driven) leave(m, m->first_driven, m->driven, m->first_driven_effect, m->driven_effects, k);
}

static void record(Master *m, int64_t row) {
    double *to = m->rows + row * m->columns;
    for (int i = 0; i < m->columns; i++) to[i] = m->signal[m->column[i]];
    __atomic_store_n(&m->place->rows, row + 1, __ATOMIC_RELEASE); /* whoever counts the row finds it written */
}

/* No component is being called any more. */
static int outside(Master *m, int result) {
    m->place->component = -1;
    return result;
}

/* From initialisation mode to t = 0: values are propagated in the order of the components. */
API int initialise(Master *m) {
    m->place->k = 0;
    drive(m, 0);
    for (int i = 0; i < m->components; i++) {
        Component *c = at(m, i);
        if (read_into(m, c, m->signal)) return FAILED; /* start values, for cycles */
    }
    for (int i = 0; i < m->components; i++) {
        Component *c = at(m, m->order[i]);
        if (set_initial(m, c) || exit_initialization(m, c) || read_outputs(m, c, 0)) return FAILED;
    }
    record(m, 0);
    return outside(m, DONE);
}

/* Run to communication point `until`. Can be called again and again; memory is only touched, never allocated. */
API int advance(Master *m, int64_t until) {
    Place *place = m->place;
    int64_t row = place->k / m->record_every + 1, next = row * m->record_every;
    int (*step)(Master *) = m->algorithm ? gauss_seidel : jacobi;
    while (place->k < until) {
        if (*(volatile int32_t *)&m->interrupt) return outside(m, INTERRUPTED);
        if (step(m)) return FAILED;
        place->k++;
        drive(m, place->k);
        if (place->k == next) {
            record(m, row++);
            next += m->record_every;
        }
    }
    return outside(m, DONE);
}
