/* A test FMU that takes FMI at its word where others do not: x' = u in one explicit step.
   - With noSetFMUStatePriorToCurrentPoint false each step starts from the state that was last certain.
   - `direct` is gain * u + bias, in initialisation mode, too; `fixed` is what the parameter `bias` says.
   - fmi2SetupExperiment begins anew: what was set before is forgotten, as FMUs made with 20-sim do.
   - At `ends_at` + `spread` * `seed` it wants no more: fmi2DoStep is discarded. `stubborn`: it does not say that this
     is an end. A step longer than `longest`, or one with more than `most` at u, is an end before it has begun.
   Value references of each type start at 0; see stepper.py. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { U, X, DIRECT, FIXED, GAIN, BIAS, ENDS_AT, SPREAD, LONGEST, MOST, REALS };
enum { NUMBER, DOUBLE, SEED, INTEGERS };
enum { FLAG, NOT, STUBBORN, BOOLEANS };

typedef struct {
    double r[REALS], certain, time;
    int i[INTEGERS], b[BOOLEANS], ended;
    const fmi2CallbackFunctions *callbacks;
} Stepper;

static void begin(Stepper *s) {
    const fmi2CallbackFunctions *callbacks = s->callbacks;
    memset(s, 0, sizeof *s);
    s->callbacks = callbacks;
    s->r[GAIN] = 1.0;
    s->r[ENDS_AT] = s->r[LONGEST] = s->r[MOST] = 1e9;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Stepper *s = callbacks->allocateMemory(1, sizeof *s);
    s->callbacks = callbacks;
    begin(s);
    return s;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e, fmi2Real f) {
    (void)a, (void)b, (void)d, (void)e, (void)f;
    begin(c);
    return fmi2OK;
}
void fmi2FreeInstance(fmi2Component c) {
    if (c) ((Stepper *)c)->callbacks->freeMemory(c);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean never_back) {
    Stepper *s = c;
    int refused = h > s->r[LONGEST] || s->r[U] > s->r[MOST];
    double last = refused ? t : s->r[ENDS_AT] + s->r[SPREAD] * s->i[SEED], end = fmin(t + h, last);
    if (never_back) s->certain = s->r[X];
    s->r[X] = s->certain + s->r[U] * (end - t);
    s->time = end;
    s->ended = end >= last - 1e-9;
    return s->ended ? fmi2Discard : fmi2OK;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    Stepper *s = c;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = s->ended && !s->b[STUBBORN];
    return fmi2OK;
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Stepper *s = c;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = s->time;
    return fmi2OK;
}

static void calculate(Stepper *s) {
    s->r[DIRECT] = s->r[GAIN] * s->r[U] + s->r[BIAS];
    s->r[FIXED] = s->r[BIAS];
    s->i[DOUBLE] = 2 * s->i[NUMBER];
    s->b[NOT] = !s->b[FLAG];
}
#define ACCESS(type, ctype, field)                                                                              \
    fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, ctype value[]) {         \
        Stepper *s = c;                                                                                         \
        calculate(s);                                                                                           \
        for (size_t k = 0; k < n; k++) value[k] = s->field[vr[k]];                                              \
        return fmi2OK;                                                                                          \
    }                                                                                                           \
    fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, const ctype value[]) {   \
        Stepper *s = c;                                                                                         \
        for (size_t k = 0; k < n; k++) s->field[vr[k]] = value[k];                                              \
        return fmi2OK;                                                                                          \
    }
ACCESS(Real, fmi2Real, r)
ACCESS(Integer, fmi2Integer, i)
ACCESS(Boolean, fmi2Boolean, b)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    *state = malloc(sizeof(Stepper));
    memcpy(*state, c, sizeof(Stepper));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Stepper));
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* The rest of the interface. */
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
#define GRANTED(name, ...) \
    fmi2Status name(__VA_ARGS__) { return fmi2OK; }
#define REFUSED(name, ...) \
    fmi2Status name(__VA_ARGS__) { return fmi2Error; }
GRANTED(fmi2SetDebugLogging, fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
GRANTED(fmi2EnterInitializationMode, fmi2Component c)
GRANTED(fmi2ExitInitializationMode, fmi2Component c)
GRANTED(fmi2Terminate, fmi2Component c)
GRANTED(fmi2Reset, fmi2Component c)
GRANTED(fmi2SetString, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
REFUSED(fmi2GetString, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
REFUSED(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer o[],
        const fmi2Real value[])
REFUSED(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n)
REFUSED(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
REFUSED(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
REFUSED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
REFUSED(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer o[],
        fmi2Real value[])
REFUSED(fmi2CancelStep, fmi2Component c)
REFUSED(fmi2GetStatus, fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
REFUSED(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
REFUSED(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind s, fmi2String *value)
