/* A test FMU: a first-order lag y' = (u - y) / tau in one explicit step, and windows on what its master does.
   Value references of each type start at 0; see probe.py. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef _WIN32
#include <unistd.h>
#endif

#include "fmi2Functions.h"

enum { U, Y, TAU, GAIN, START, FAIL_AT, SEEN, SLOPE, TIME, SAMPLE, VALIDITY, CURRENT, SETS, REALS };
enum { NUMBER, ECHO, FAIL_STATUS, FAIL_CALL, SEQUENCE, INTEGERS };
enum { FLAG, FLAG_ECHO, VALID, BOOLEANS };
enum { FAIL_STEP, FAIL_EXIT, FAIL_GET, FAIL_SET, WARN_STEP, FAIL_ENTER, FAIL_TERMINATE, FAIL_FREE };
enum { SEGFAULT = 10, ABORT, EXIT, HANG, READ, CLOSE, FORK, LEAVE, SHOUT, /* statuses that no FMU returns: the end of the process */
       COMPLAIN /* an error is logged and the call is well */ };

typedef struct {
    double r[REALS], du;
    int i[INTEGERS], b[BOOLEANS];
    char label[64];
    int warns_early, fatal_when_asked;
    const fmi2CallbackFunctions *callbacks;
} Probe;

static int fatal, after_fatal; /* a call has returned Fatal; calls since then, until there is a new instance */

__attribute__((visibility("default"))) int calls_after_fatal(void) { return after_fatal; }

static void die(int way) {
    if (way == SEGFAULT) *(volatile int *)8 = 1;
    if (way == ABORT) abort();
    if (way == EXIT) exit(0);
#ifndef _WIN32
    if (way == READ) {
        (void)getchar();
        return;
    }
    if (way == LEAVE) {
        if (chdir("/")) abort();
        return;
    }
    if (way == CLOSE)
        for (int file = 3; file < 256; file++) close(file);
    if (way == FORK) {
        if (fork() == 0) sleep(600);
        *(volatile int *)8 = 1;
    }
#endif
    for (volatile int forever = 1; forever;) {}
}

static fmi2Status shout(Probe *p, fmi2Status status) {
    char *text = malloc(200001);
    memset(text, 'x', 200000);
    memcpy(text, "red \x1b[31m,\nnew line,\x07 bell ", 27);
    text[200000] = '\0';
    p->callbacks->logger(p->callbacks->componentEnvironment, "probe", status, "logStatus", "%s", text);
    free(text);
    return status;
}

static fmi2Status trouble(Probe *p, int call, double t) {
    after_fatal += fatal;
    if (p->i[FAIL_CALL] != call || p->i[FAIL_STATUS] == 0 || t < p->r[FAIL_AT]) return fmi2OK;
    if (p->i[FAIL_STATUS] == COMPLAIN) {
        p->callbacks->logger(p->callbacks->componentEnvironment, "probe", fmi2Error, "logStatusError", "%s is unwell",
                             p->label);
        return fmi2OK;
    }
    if (p->i[FAIL_STATUS] == SHOUT) return shout(p, call == WARN_STEP ? fmi2Warning : fmi2Error);
    if (p->label[0]) /* or it says nothing */
        p->callbacks->logger(p->callbacks->componentEnvironment, "probe", p->i[FAIL_STATUS], "logStatusError",
                             "%s gave up at %g s after %d", p->label, t, 42);
    if (p->i[FAIL_STATUS] >= SEGFAULT) {
        die(p->i[FAIL_STATUS]);
        return fmi2OK;
    }
    fatal |= p->i[FAIL_STATUS] == fmi2Fatal;
    return p->i[FAIL_STATUS];
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)type, (void)resources, (void)visible, (void)logging;
    if (!strncmp(guid, "{dies}", 6)) die(atoi(guid + 6));
    if (strcmp(guid, "{probe}")) {
        callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "guid %s is not mine", guid);
        return NULL;
    }
    fatal = after_fatal = 0;
    Probe *p = callbacks->allocateMemory(1, sizeof *p);
    p->callbacks = callbacks;
    p->warns_early = !strncmp(name, "early", 5);
    p->fatal_when_asked = !strncmp(name, "asked", 5);
    p->r[TAU] = p->r[GAIN] = 1.0;
    p->r[FAIL_AT] = 1e9;
    strcpy(p->label, "probe");
    return p;
}

void fmi2FreeInstance(fmi2Component c) {
    if (!c) return;
    (void)trouble(c, FAIL_FREE, ((Probe *)c)->r[TIME]);
    ((Probe *)c)->callbacks->freeMemory(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real d, fmi2Boolean e, fmi2Real f) {
    (void)a, (void)b, (void)d, (void)e, (void)f;
    return ((Probe *)c)->warns_early ? fmi2Warning : fmi2OK; /* nothing has been set yet */
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Probe *p = c;
    p->r[Y] = p->r[START];
    return trouble(p, FAIL_ENTER, 0.0);
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Probe *p = c;
    p->r[SEEN] = p->r[U];
    p->r[CURRENT] = p->r[U] + 100.0;
    p->i[ECHO] = p->i[NUMBER];
    p->b[FLAG_ECHO] = p->b[FLAG];
    return trouble(p, FAIL_EXIT, 0.0);
}
fmi2Status fmi2Terminate(fmi2Component c) { return trouble(c, FAIL_TERMINATE, ((Probe *)c)->r[TIME]); }
fmi2Status fmi2Reset(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean never_back) {
    (void)never_back;
    Probe *p = c;
    fmi2Status status = trouble(p, FAIL_STEP, t + h);
    if (status != fmi2OK) return status;
    double u = p->r[U], du = p->du;
    p->r[Y] += h * (p->r[GAIN] * (u + 0.5 * du * h) - p->r[Y]) / p->r[TAU];
    p->r[SEEN] = u + du * h;
    p->r[SLOPE] = du;
    p->r[TIME] = t + h;
    p->r[SAMPLE] = 10.0 * (t + h);
    p->r[VALIDITY] = t + h;
    p->i[SEQUENCE]++;
    p->b[VALID] = 1;
    p->i[ECHO] = p->i[NUMBER];
    p->b[FLAG_ECHO] = p->b[FLAG];
    p->du = 0.0; /* a derivative is for the coming step only */
    return trouble(p, WARN_STEP, t + h);
}

#define GET(type, ctype, field)                                                                                \
    fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, ctype value[]) {         \
        Probe *p = c;                                                                                           \
        for (size_t k = 0; k < n; k++) value[k] = p->field[vr[k]];                                              \
        return trouble(p, FAIL_GET, p->r[TIME]);                                                                \
    }
#define SET(type, ctype, field)                                                                                \
    fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, const ctype value[]) {   \
        Probe *p = c;                                                                                           \
        for (size_t k = 0; k < n; k++) p->field[vr[k]] = value[k];                                              \
        p->r[SETS] += 1.0;                                                                                      \
        return trouble(p, FAIL_SET, p->r[TIME]);                                                                \
    }
GET(Real, fmi2Real, r)
GET(Integer, fmi2Integer, i)
GET(Boolean, fmi2Boolean, b)
SET(Real, fmi2Real, r)
SET(Integer, fmi2Integer, i)
SET(Boolean, fmi2Boolean, b)

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)vr;
    if (n) strncpy(((Probe *)c)->label, value[0], 63);
    return fmi2OK;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) {
        if (vr[k] != U || order[k] != 1) return fmi2Error;
        ((Probe *)c)->du = value[k];
    }
    return fmi2OK;
}
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    *state = malloc(sizeof(Probe));
    memcpy(*state, c, sizeof(Probe));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Probe));
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    after_fatal += fatal;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* The rest of the interface, which FMPy wants to find. */
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    (void)kind, (void)value;
    if (!((Probe *)c)->fatal_when_asked) return fmi2Error;
    fatal = 1;
    return fmi2Fatal;
}
#define REFUSED(name, ...) \
    fmi2Status name(__VA_ARGS__) { return fmi2Error; }
REFUSED(fmi2GetString, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
REFUSED(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n)
REFUSED(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
REFUSED(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
REFUSED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
REFUSED(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer o[],
        fmi2Real value[])
REFUSED(fmi2CancelStep, fmi2Component c)
REFUSED(fmi2GetStatus, fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
REFUSED(fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
REFUSED(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
REFUSED(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind s, fmi2String *value)
