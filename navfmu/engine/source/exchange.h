/* What happens to one component: inputs set, a step made, outputs read. Each returns 0, or 1 when a call failed. */
#ifndef NAVFMU_EXCHANGE_H
#define NAVFMU_EXCHANGE_H

#include <math.h>

#include "effects.h"
#include "floating.h"

static RARELY int failed(Master *m, Component *c, fmi2Status status) {
    if (status == fmi2Warning) {
        c->warnings++;
        return 0;
    }
    m->status = status;
    return 1;
}

/* Once it has strayed it may do so again. */
static RARELY void straighten(Component *c) {
    c->look = 1;
    c->strayed |= strayed(floating());
    set_floating(ORDINARY);
}

/* It has been called: how it left this thread to calculate is not how others do. */
static inline void called(Component *c) {
    if (uncommon()) straighten(c);
}

static RARELY void look(Component *c) {
    if (floating() != ORDINARY) straighten(c);
    c->look = c->strayed != 0;
}

/* The last call to it for now: the register is read, too, when that is due. */
static inline void called_last(Component *c) {
    if (uncommon() | c->look) look(c);
}

/* The component that is called from now on. */
static inline Component *at(Master *m, int32_t number) {
    m->place->component = number;
    return &m->component[number];
}

#define TRY(which, expression)                                                      \
    do {                                                                            \
        m->place->call = which;                                                     \
        fmi2Status status_ = (expression);                                          \
        if (status_ != fmi2OK && failed(m, c, status_)) return 1;                   \
    } while (0)

/* Signals as a group of Real inputs sees them; what is not scaled keeps its bits. Returns 0 if no bit has changed. */
static inline uint64_t gather(const Inputs *in, const int32_t *source, const double *signal, double *restrict value) {
    uint64_t changed = 0;
    const int count = in->count;
    for (int i = 0; i < count; i++) {
        double now = signal[source[i]];
        if (in->scaled && (in->factor[i] != 1.0 || in->offset[i] != 0.0)) now = in->factor[i] * now + in->offset[i];
        changed |= bits(now) ^ bits(value[i]);
        value[i] = now;
    }
    return changed;
}

/* Set the inputs that are held over the step, each group only if a bit of it has changed. */
static inline int set_held(Master *m, Component *c, int always) {
    const double *signal = m->signal;
    if (c->real.count) {
        uint64_t changed = gather(&c->real, c->real.source, signal, c->real_value);
        if (changed || always)
            TRY(SET_REAL, c->set_real(c->instance, c->real.references, (size_t)c->real.count, c->real_value));
    }
    if (c->integer.count) {
        int changed = always;
        for (int i = 0; i < c->integer.count; i++) {
            fmi2Integer value = (fmi2Integer)signal[c->integer.source[i]];
            changed |= value != c->integer_value[i];
            c->integer_value[i] = value;
        }
        if (changed)
            TRY(SET_INTEGER,
                c->set_integer(c->instance, c->integer.references, (size_t)c->integer.count, c->integer_value));
    }
    if (c->boolean.count) {
        int changed = always;
        for (int i = 0; i < c->boolean.count; i++) {
            fmi2Boolean value = signal[c->boolean.source[i]] != 0.0;
            changed |= value != c->boolean_value[i];
            c->boolean_value[i] = value;
        }
        if (changed)
            TRY(SET_BOOLEAN,
                c->set_boolean(c->instance, c->boolean.references, (size_t)c->boolean.count, c->boolean_value));
    }
    return 0;
}

/* The value of each smooth input now, where the next step starts. */
static inline void begin_smooth(Master *m, Component *c) {
    gather(&c->smooth, c->smooth.source, m->signal, c->start);
}

/* How long the coming step of a component is: it makes up for those that it has lost. */
static inline double length(const Master *m, const Component *c) {
    return m->step * (double)(m->behind[c - m->component] + 1);
}

/* Set the smooth inputs: their value at the beginning of the step and the slope to its end. */
static inline int set_smooth(Master *m, Component *c) {
    if (!c->smooth.count) return 0;
    gather(&c->smooth, c->ahead, m->signal, c->slope);
    const double h = length(m, c);
    for (int i = 0; i < c->smooth.count; i++) c->slope[i] = (c->slope[i] - c->start[i]) / h;
    size_t count = (size_t)c->smooth.count;
    TRY(SET_REAL, c->set_real(c->instance, c->smooth.references, count, c->start));
    TRY(SET_DERIVATIVES, c->set_derivatives(c->instance, c->smooth.references, count, c->first_order, c->slope));
    called(c);
    begin_smooth(m, c);
    return 0;
}

/* A step was discarded: because the FMU wants to end the run? Then the step may have been made all the same. */
static RARELY int discarded(Master *m, Component *c) {
    fmi2Boolean terminated = fmi2False;
    fmi2Real last;
    m->status = fmi2Discard;
    m->last = NAN;
    fmi2Status answer = fmi2Error;
    m->place->call = GET_BOOLEAN_STATUS;
    if (c->get_boolean_status) answer = c->get_boolean_status(c->instance, fmi2Terminated, &terminated);
    if (answer == fmi2Fatal) return failed(m, c, answer);
    if (answer > fmi2Warning) terminated = fmi2False;
    answer = fmi2Error;
    m->place->call = GET_REAL_STATUS;
    if (c->get_real_status) answer = c->get_real_status(c->instance, fmi2LastSuccessfulTime, &last);
    if (answer == fmi2Fatal) return failed(m, c, answer);
    called(c);
    if (answer <= fmi2Warning) m->last = last;
    m->place->call = DO_STEP;
    if (!terminated) return 1;
    m->status = fmi2OK;
    m->ended = (int32_t)(c - m->component);
    m->interrupt = 1;
    return !(m->last > time_of(m, m->place->k + 1) - 1e-9 * m->step);
}

static inline int make_step(Master *m, Component *c, double t) {
    int64_t *behind = m->behind + (c - m->component);
    const double from = *behind ? time_of(m, m->place->k - *behind) : t, h = length(m, c);
    m->place->call = DO_STEP;
    fmi2Status status = c->do_step(c->instance, from, h, c->never_back);
    *behind = 0;
    if (status == fmi2OK) return 0;
    return status == fmi2Discard ? discarded(m, c) : failed(m, c, status);
}

static inline int read_signals(Master *m, Component *c) {
    double *to = m->signal + c->first_signal;
    if (c->reals) TRY(GET_REAL, c->get_real(c->instance, c->real_reference, (size_t)c->reals, to));
    to += c->reals;
    if (c->integers) {
        TRY(GET_INTEGER, c->get_integer(c->instance, c->integer_reference, (size_t)c->integers, c->whole));
        for (int i = 0; i < c->integers; i++) to[i] = c->whole[i];
    }
    to += c->integers;
    if (c->booleans) {
        TRY(GET_BOOLEAN, c->get_boolean(c->instance, c->boolean_reference, (size_t)c->booleans, c->whole));
        for (int i = 0; i < c->booleans; i++) to[i] = c->whole[i] != 0;
    }
    return 0;
}

/* The faults of communication point k act on true values: on all of them (-1) or `only` one. */
static RARELY void disturb_searched(Master *m, Component *c, int64_t k, int32_t only) {
    if (k > 0 && c->foreseen) look_ahead_searched(m, c, k - 1);
    c->searched = leave_searched(m, c->first_effect, c->effects, k, only) || k == 0;
    if (k == 0) no_step_yet(m, c);
}

/* They act on the outputs that were read. Values go one by one: a copy in wider pieces would have to wait for what an
   FMU has just written in narrow ones. */
static ASIDE void disturb(Master *m, Component *c, int64_t k) {
    double *leaving = m->signal, *truth = leaving + m->signals, *ahead = truth + m->signals;
    if (c->copied)
        for (const int32_t *s = c->exposed, *end = s + c->exposures; s < end; s++) truth[*s] = ahead[*s] = leaving[*s];
    if (c->searched) {
        disturb_searched(m, c, k, -1);
        return;
    }
    const Effect *first = m->effect + c->first_effect, *last = first + c->effects;
    for (const Effect *e = first; e < last; e++) {
        double *memory = m->memory + e->memory;
        if (e->foreseen) act_ahead(m, e, memory, ahead, k - 1);
        act(m, e, memory, leaving, k);
    }
}

/* They act on the true values that are known from before. */
static RARELY void disturb_again(Master *m, Component *c, int64_t k, int32_t only) {
    double *leaving = m->signal, *truth = leaving + m->signals, *ahead = truth + m->signals;
    for (const int32_t *s = c->exposed, *end = s + c->exposures; s < end; s++) leaving[*s] = ahead[*s] = truth[*s];
    disturb_searched(m, c, k, only);
}

/* Outputs at communication point k, with the faults of that point. */
static inline int read_outputs(Master *m, Component *c, int64_t k) {
    if (read_signals(m, c)) return 1;
    called_last(c);
    if (c->effects) disturb(m, c, k);
    return 0;
}

#endif
