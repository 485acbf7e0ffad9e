/* A test FMU with two habits of solvers: it integrates y' = u as closely as the tolerance says that it was given (error
   per second, 1 when none was given), and it begins each step at the last point to which nobody will go back. */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { U, Y, TOLERANCE, REALS };

typedef struct {
    double r[REALS], kept;
    fmi2CallbackFunctions callbacks;
} Solver;

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Solver *s = calloc(1, sizeof *s);
    s->callbacks = *callbacks;
    s->r[U] = s->r[TOLERANCE] = 1.0;
    return s;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean ends, fmi2Real stop) {
    (void)start, (void)ends, (void)stop;
    if (defined) ((Solver *)c)->r[TOLERANCE] = tolerance;
    return fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean never_back) {
    (void)t;
    Solver *s = c;
    s->r[Y] = s->kept + h * (s->r[U] + s->r[TOLERANCE]);
    if (never_back) s->kept = s->r[Y];
    return fmi2OK;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) value[k] = ((Solver *)c)->r[vr[k]];
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) ((Solver *)c)->r[vr[k]] = value[k];
    return fmi2OK;
}
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    *state = malloc(sizeof(Solver));
    memcpy(*state, c, sizeof(Solver));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Solver));
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* The rest of the interface, which FMPy wants to find. */
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
#define ANSWER(status, name, ...) \
    fmi2Status name(__VA_ARGS__) { return status; }
ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component c)
ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component c)
ANSWER(fmi2OK, fmi2Terminate, fmi2Component c)
ANSWER(fmi2OK, fmi2Reset, fmi2Component c)
ANSWER(fmi2OK, fmi2SetDebugLogging, fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
#define ACCESS(type)                                                                                                   \
    ANSWER(fmi2Error, fmi2Get##type, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##type value[])     \
    ANSWER(fmi2Error, fmi2Set##type, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2##type value[])
ACCESS(Integer)
ACCESS(Boolean)
ACCESS(String)
ANSWER(fmi2Error, fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
       const fmi2Integer order[], const fmi2Real value[])
ANSWER(fmi2Error, fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
       const fmi2Integer order[], fmi2Real value[])
ANSWER(fmi2Error, fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n)
ANSWER(fmi2Error, fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
ANSWER(fmi2Error, fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
ANSWER(fmi2Error, fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
       const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
ANSWER(fmi2Error, fmi2CancelStep, fmi2Component c)
ANSWER(fmi2Error, fmi2GetStatus, fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
ANSWER(fmi2Error, fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
ANSWER(fmi2Error, fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
ANSWER(fmi2Error, fmi2GetBooleanStatus, fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
ANSWER(fmi2Error, fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind s, fmi2String *value)
