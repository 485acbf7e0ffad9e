/* What happens to one component before t = 0. Each returns 0, or 1 when a call failed. */
#ifndef NAVFMU_INITIAL_H
#define NAVFMU_INITIAL_H

#include "exchange.h"

/* Set all inputs in initialisation mode. */
static int set_initial(Master *m, Component *c) {
    begin_smooth(m, c);
    if (c->smooth.count)
        TRY(SET_REAL, c->set_real(c->instance, c->smooth.references, (size_t)c->smooth.count, c->start));
    look(c);
    return set_held(m, c, 1);
}

static int exit_initialization(Master *m, Component *c) {
    TRY(EXIT_INITIALIZATION, c->exit_initialization(c->instance));
    return 0;
}

/* One output. */
static int read_one(Master *m, Component *c, const Move *v) {
    double *to = m->signal + v->slot;
    fmi2Integer integer;
    fmi2Boolean boolean;
    switch (v->type) {
    case 0: TRY(GET_REAL, c->get_real(c->instance, &v->reference, 1, to)); break;
    case 1:
        TRY(GET_INTEGER, c->get_integer(c->instance, &v->reference, 1, &integer));
        *to = integer;
        break;
    case 2:
        TRY(GET_BOOLEAN, c->get_boolean(c->instance, &v->reference, 1, &boolean));
        *to = boolean != 0;
        break;
    }
    look(c);
    m->signal[m->signals + v->slot] = *to;
    if (c->effects) disturb_again(m, c, 0, v->slot);
    return 0;
}

/* One input. */
static int give_one(Master *m, Component *c, const Move *v) {
    double value = m->signal[v->slot];
    if (v->factor != 1.0 || v->offset != 0.0) value = v->factor * value + v->offset;
    fmi2Integer integer = (fmi2Integer)(v->type == 1 ? value : 0.0);
    fmi2Boolean boolean = value != 0.0;
    switch (v->type) {
    case 0: TRY(SET_REAL, c->set_real(c->instance, &v->reference, 1, &value)); break;
    case 1: TRY(SET_INTEGER, c->set_integer(c->instance, &v->reference, 1, &integer)); break;
    case 2: TRY(SET_BOOLEAN, c->set_boolean(c->instance, &v->reference, 1, &boolean)); break;
    }
    return 0;
}

/* The end of initialisation, with all inputs and outputs. */
static int leave_initialization(Master *m, Component *c) {
    return set_initial(m, c) || exit_initialization(m, c) || read_outputs(m, c, 0);
}

static int make_move(Master *m, const Move *v) {
    Component *c = at(m, v->component);
    int failed = v->kind == READ ? read_one(m, c, v) : v->kind == GIVE ? give_one(m, c, v) : leave_initialization(m, c);
    look(c);
    return failed;
}

#endif
