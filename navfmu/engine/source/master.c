/* The run: initial values, steps, recording. */
#include "exchange.h"

static void drive(Master *m, int64_t k) {
    if (m->driven) leave(m, m->first_driven, m->driven, m->first_driven_effect, m->driven_effects, k);
}

static void record(Master *m, int64_t row) {
    double *to = m->rows + row * m->columns;
    for (int i = 0; i < m->columns; i++) to[i] = m->signal[m->column[i]];
}

/* From initialisation mode to t = 0: values are propagated in the order of the components. */
API int initialise(Master *m) {
    m->k = 0;
    drive(m, 0);
    for (int i = 0; i < m->components; i++) {
        Component *c = &m->component[i];
        if (read_into(m, c, m->signal)) return FAILED; /* start values, for cycles */
    }
    for (int i = 0; i < m->components; i++) {
        Component *c = &m->component[m->order[i]];
        if (set_initial(m, c) || exit_initialization(m, c) || read_outputs(m, c, 0)) return FAILED;
    }
    record(m, 0);
    return DONE;
}

/* Run to communication point `until`. Can be called again and again; memory is only touched, never allocated. */
API int advance(Master *m, int64_t until) {
    int64_t row = m->k / m->record_every + 1, next = row * m->record_every;
    int (*step)(Master *) = m->algorithm ? gauss_seidel : jacobi;
    while (m->k < until) {
        if (*(volatile int32_t *)&m->interrupt) return INTERRUPTED;
        if (step(m)) return FAILED;
        m->k++;
        drive(m, m->k);
        if (m->k == next) {
            record(m, row++);
            next += m->record_every;
        }
    }
    return DONE;
}

/* Sizes of the structures, so that the caller can see that it means the same ones. */
API void layout(int32_t size[3]) {
    size[0] = (int32_t)sizeof(Master);
    size[1] = (int32_t)sizeof(Component);
    size[2] = (int32_t)sizeof(Effect);
}
