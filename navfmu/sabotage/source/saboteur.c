/* A saboteur: what faults do to values on their way through it. The effects are those of the compiled master, by its own
   functions (act.h, trigger.h); the tables are those of its plan (tables.h, written by navfmu/sabotage/tables.py). */
#define NOISE_LINKAGE static
#include "noise.c"

#include <string.h>

#include "act.h"
#include "trigger.h"

#include "tables.h"

void THROUGH(double *v, double *memory, int64_t k);

void THROUGH(double *v, double *memory, int64_t k) {
    Trigger trigger[TRIGGERS];
    Span span[TRIGGERS];
    int32_t acting[TRIGGERS], acted[TRIGGERS];
    double signal[SIGNALS], turned[SIGNALS];
    Master m = {
        .trigger = trigger,
        .triggers = TRIGGERS,
        .acting = acting,
        .acted = acted,
        .window = windows,
        .span = span,
        .reach = reach,
        .turned = turned,
        .signal = signal,
        .signals = SIGNALS,
        .numerator = NUMERATOR,
        .denominator = DENOMINATOR,
    };
    memcpy(trigger, triggers, sizeof trigger);
    move_triggers(&m, k);
    for (int i = 0; i < SIGNALS; i++) signal[i] = entry[i] < 0 ? otherwise[i] : v[entry[i]];
    for (int i = 0; i < EFFECTS; i++) {
        Effect e = effects[i];
        if (SEED >= 0) e.seed = (uint64_t)(int64_t)v[SEED];
        act(&m, &e, memory + e.memory, signal, k);
    }
    for (int i = 0; i < OUTPUTS; i++) v[leaves[i].reference] = signal[leaves[i].signal];
}
