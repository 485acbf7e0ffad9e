/* A test FMU that changes how its thread calculates, and leaves it so. Its instance name says in which call and what:
   "step_rounding", "instantiate_subnormals", "get_traps", "free_rounding"; other names change nothing. One that has
   "ends" in it discards steps that begin after 0.65 s, as an end of the run.
   Outputs, value references 0..2: `sum` of 0.1 each step, `tiny` subnormal, `nothing` 0 / 0. STRAY_LOAD: at loading. */
#include <fenv.h>
#include <stdio.h>
#include <string.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "fmi2Functions.h"

typedef struct {
    double sum, tiny, nothing, time;
    char name[64];
    const fmi2CallbackFunctions *callbacks;
} Stray;

static void flush_subnormals(void) {
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040);
#elif defined(__aarch64__)
    uint64_t fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    __asm__ volatile("msr fpcr, %0" : : "r"(fpcr | 0x01000000));
#endif
}
static void trap(void) {
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() & ~0x1F80u); /* whatever is not exact ends the process */
#endif
}
static void change(const char *name, const char *call) {
    if (strncmp(name, call, strlen(call)) != 0) return;
    if (strstr(name, "rounding")) fesetround(FE_UPWARD);
    if (strstr(name, "subnormals")) flush_subnormals();
    if (strstr(name, "traps")) trap();
}

#ifdef STRAY_LOAD
__attribute__((constructor)) static void load(void) {
    fesetround(FE_UPWARD);
    flush_subnormals();
}
#endif

static void calculate(Stray *s) {
    volatile double small = 1e-300, smaller = 1e-10, zero = 0.0, tenth = 0.1;
    s->sum += tenth;
    s->tiny = small * smaller;
    s->nothing = zero / zero;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Stray *s = callbacks->allocateMemory(1, sizeof *s);
    snprintf(s->name, sizeof s->name, "%s", name);
    s->callbacks = callbacks;
    change(name, "instantiate");
    return s;
}
void fmi2FreeInstance(fmi2Component c) {
    Stray *s = c;
    change(s->name, "free");
    s->callbacks->freeMemory(s);
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean never_back) {
    Stray *s = c;
    fmi2Status status = strstr(s->name, "ends") && t > 0.65 ? fmi2Discard : fmi2OK;
    (void)never_back;
    s->time = t + h;
    calculate(s);
    change(s->name, "step");
    return status;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Stray *s = c;
    for (size_t k = 0; k < n; k++) value[k] = vr[k] == 0 ? s->sum : vr[k] == 1 ? s->tiny : s->nothing;
    change(s->name, "get");
    return fmi2OK;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    (void)c;
    *value = kind == fmi2Terminated;
    return fmi2OK;
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Stray *s = c;
    (void)kind;
    *value = s->time;
    change(s->name, "status");
    return fmi2OK;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    change(((Stray *)c)->name, "exit");
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    change(((Stray *)c)->name, "enter");
    return fmi2OK;
}
fmi2Status fmi2Terminate(fmi2Component c) {
    change(((Stray *)c)->name, "terminate");
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
GRANTED(fmi2SetupExperiment, fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e, fmi2Real f)
GRANTED(fmi2Reset, fmi2Component c)
GRANTED(fmi2SetReal, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
GRANTED(fmi2SetInteger, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[])
GRANTED(fmi2SetBoolean, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[])
GRANTED(fmi2SetString, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
REFUSED(fmi2GetInteger, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[])
REFUSED(fmi2GetBoolean, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[])
REFUSED(fmi2GetString, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
REFUSED(fmi2GetFMUstate, fmi2Component c, fmi2FMUstate *state)
REFUSED(fmi2SetFMUstate, fmi2Component c, fmi2FMUstate state)
REFUSED(fmi2FreeFMUstate, fmi2Component c, fmi2FMUstate *state)
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
