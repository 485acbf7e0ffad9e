/* Programs of a plan on its signals. */
#ifndef NAVFMU_PROGRAM_H
#define NAVFMU_PROGRAM_H

#include "master.h"

/* The time of communication point k (s). */
static inline double time_of(const Master *m, int64_t k) { return (double)k * m->numerator / m->denominator; }

/* The value of some operations at the time t (s). */
static inline double program(const Master *m, int32_t first, int32_t count, double t) {
    return value_of(m->operation + first, count, m->signal, t, m->acting, m->faults);
}

#endif
