/* The run: initial values, steps, recording. */
#include "initial.h"
#include "monitor.h"
#include "trigger.h"

static void drive(Master *m, int64_t k) {
    if (!m->driven) return;
    memcpy(m->signal + m->first_driven, m->signal + m->signals + m->first_driven, sizeof(double) * (size_t)m->driven);
    leave_searched(m, m->first_driven_effect, m->driven_effects, k, -1);
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

static int begin(Master *m) {
    m->place->k = 0;
    move_triggers(m, 0);
    drive(m, 0);
    for (const Move *v = m->move; v < m->move + m->moves; v++)
        if (make_move(m, v)) return FAILED;
    record(m, 0);
    observe_all(m, 0);
    return outside(m, DONE);
}

/* From time to time, counted in steps, so that the same is seen in every run. */
static void look_again(Master *m) {
    for (int i = 0; i < m->components; i++) m->component[i].look = 1;
}

static int go_on(Master *m, int64_t until) {
    Place *place = m->place;
    int64_t row = place->k / m->record_every + 1, next = row * m->record_every;
    int (*step)(Master *) = m->algorithm ? gauss_seidel : jacobi;
    while (place->k < until) {
        if (*(volatile int32_t *)&m->interrupt) return outside(m, INTERRUPTED);
        if (!(place->k & 63)) look_again(m);
        move_triggers(m, place->k + 1);
        if (step(m)) {
            m->turn = place->component;
            return m->status == fmi2OK ? outside(m, INTERRUPTED) : FAILED;
        }
        place->k++;
        drive(m, place->k);
        if (place->k == next) {
            record(m, row++);
            next += m->record_every;
        }
        observe_all(m, place->k);
    }
    return outside(m, DONE);
}

/* From initialisation mode to t = 0. */
API int initialise(Master *m) {
    uint64_t before = floating();
    set_floating(ORDINARY);
    int result = begin(m);
    set_floating(before);
    return result;
}

/* Run to communication point `until`. Can be called again and again; memory is only touched, never allocated. */
API int advance(Master *m, int64_t until) {
    uint64_t before = floating();
    set_floating(ORDINARY);
    int result = go_on(m, until);
    set_floating(before);
    return result;
}
