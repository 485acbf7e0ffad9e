/* FMI 2.0 for Co-Simulation, once for all models. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "instance.h"

#define CATEGORY_COUNT (sizeof categories / sizeof categories[0])

typedef struct {
    Instance core; /* first, so that a pointer to it is a pointer to the whole */
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name;
    int log; /* bits of the categories that are wanted */
    fmi2Status last_step;
} Slave;

/* A saved state: what it belongs to, and a copy of the block. */
typedef struct {
    char magic[8];
    char guid[40];
    uint64_t tables; /* what they hold, as a number */
    uint64_t size;   /* of the block that follows */
} Snapshot;

static const char snapshot_magic[8] = {'n', 'a', 'v', 'f', 'm', 'u', '0', '3'};

/* ---- reports ---- */

/* Hosts print the message with or without expanding it like printf, so each % is doubled and no arguments follow. */
static void send(Slave *slave, fmi2Status status, const char *category, const char *sentence) {
    char message[2048];
    size_t length = 0;
    if (!slave->logger) return;
    for (const char *c = sentence; *c && length + 3 < sizeof message; c++) {
        if (*c == '%') message[length++] = '%';
        message[length++] = *c;
    }
    message[length] = 0;
    slave->logger(slave->environment, slave->name ? slave->name : "", status, category, message);
}

static void report(Instance *self, Severity severity, const char *sentence) {
    Slave *slave = self->host;
    if (!(slave->log & categories[severity].bits)) return;
    send(slave, (fmi2Status)categories[severity].status, categories[severity].name, sentence);
}

SELDOM static Slave *not_allowed(Slave *slave, const char *function) {
    if (slave) instance_say(&slave->core, SAY_NOT_ALLOWED, function, phase_name(slave->core.state->phase));
    return NULL;
}

/* The slave, when the call is allowed now; else NULL after saying so. */
static inline Slave *allowed(fmi2Component component, const char *function, int phases) {
    Slave *slave = component;
    return slave && slave->core.state->phase & phases ? slave : not_allowed(slave, function);
}
#define ALLOWED(component, function) allowed(component, #function, IN_##function)

static fmi2Status refuse(Slave *slave, const char *sentence) {
    if (slave) instance_say(&slave->core, ERROR, "%s", sentence);
    return fmi2Error;
}

/* ---- inquiry and logging ---- */

const char *fmi2GetTypesPlatform(void) {
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void) {
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String names[]) {
    Slave *slave = c;
    if (!slave) return fmi2Error;
    int log = count ? 0 : LOG_ALL;
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < CATEGORY_COUNT && strcmp(names[i], categories[k].name) != 0) k++;
        if (k == CATEGORY_COUNT) {
            instance_say(&slave->core, ERROR, "There is no log category '%s'; expected " CATEGORY_NAMES ".", names[i]);
            return fmi2Error;
        }
        log |= categories[k].bits;
    }
    slave->log = on ? log | LOG_UNASKED : LOG_UNASKED; /* why a call was refused is told whatever is asked for */
    slave->core.log_events = slave->log & LOG_EVENTS;
    return fmi2OK;
}

/* ---- life ---- */

/* A model with tables is the same build with other tables, which add a dot and a hash of their own to its GUID. */
static int fits_guid(fmi2String guid) {
    size_t length = strlen(model.guid);
    if (!guid || strncmp(guid, model.guid, length) != 0) return 0;
    return guid[length] == 0 || (guid[length] == '.' && model.table_count > 0);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    (void)visible;
    Slave *slave = calloc(1, sizeof *slave);
    if (!slave) return NULL;
    slave->core.host = slave;
    slave->core.report = report;
    slave->logger = functions ? functions->logger : NULL;
    slave->environment = functions ? functions->componentEnvironment : NULL;
    slave->log = logging ? LOG_ALL : LOG_UNASKED;
    slave->core.log_events = slave->log & LOG_EVENTS;
    if (name) slave->name = malloc(strlen(name) + 1);
    if (slave->name) strcpy(slave->name, name);

    if (!name || !*name) {
        refuse(slave, "The instance has no name.");
    } else if (type != fmi2CoSimulation) {
        refuse(slave, "This FMU is for co-simulation; it has no model exchange interface.");
    } else if (!fits_guid(guid)) {
        instance_say(&slave->core, ERROR, "The GUID '%s' was given, but this binary of '%s' belongs to '%s': the model "
                     "description is of another build.", guid ? guid : "", model.identifier, model.guid);
    } else if (instance_create(&slave->core, resources) == 0) {
        return slave;
    }
    fmi2FreeInstance(slave);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    Slave *slave = c;
    if (!slave) return;
    instance_destroy(&slave->core);
    free(slave->name);
    free(slave);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance;
    Slave *slave = ALLOWED(c, fmi2SetupExperiment);
    if (!slave) return fmi2Error;
    if (!stop_defined) stop = INFINITY;
    if (!isfinite(start) || !(stop >= start)) {
        instance_say(&slave->core, SAY_NO_INTERVAL, start == start ? start : NAN, stop == stop ? stop : NAN);
        return fmi2Error;
    }
    slave->core.state->start = slave->core.state->time = start;
    slave->core.state->stop = stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Slave *slave = ALLOWED(c, fmi2EnterInitializationMode);
    if (!slave) return fmi2Error;
    slave->core.state->phase = INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Slave *slave = ALLOWED(c, fmi2ExitInitializationMode);
    if (!slave) return fmi2Error;
    return instance_start(&slave->core) == 0 ? fmi2OK : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    Slave *slave = ALLOWED(c, fmi2Terminate);
    if (!slave) return fmi2Error;
    slave->core.state->phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    Slave *slave = c;
    if (!slave) return fmi2Error;
    instance_reset(&slave->core);
    slave->last_step = fmi2OK;
    return fmi2OK;
}

/* ---- values ---- */

static const char *type_name(int access) {
    return access & REAL ? "Real" : access & INTEGER ? "Integer" : access & BOOLEAN ? "Boolean" : "String";
}

SELDOM static fmi2Status refuse_get(Slave *slave, fmi2ValueReference reference, int type) {
    if (reference >= (unsigned)model.variable_count) {
        instance_say(&slave->core, SAY_NO_VARIABLE, reference, model.variable_count);
    } else {
        instance_say(&slave->core, SAY_OTHER_TYPE, model.variables[reference].name, reference,
                     type_name(model.access[reference]), type_name(type));
    }
    return fmi2Error;
}

SELDOM static fmi2Status refuse_set(Slave *slave, fmi2ValueReference reference, int type) {
    if (reference >= (unsigned)model.variable_count || !(model.access[reference] & type)) {
        return refuse_get(slave, reference, type);
    }
    instance_say(&slave->core, SAY_NOT_SETTABLE, model.variables[reference].name,
                 phase_name(slave->core.state->phase),
                 model.access[reference] & PHASES ? WHY_FIXED : WHY_CALCULATED);
    return fmi2Error;
}

/* Before values are read: in initialisation mode, what is calculated follows what was set so far; so do, between two
   steps, outputs that follow inputs directly. */
static inline int before_get(Slave *slave) {
    if (model.direct && slave->core.state->phase == STEPPING) instance_pass(&slave->core);
    if (!model.has_calculated || slave->core.state->phase != INITIALIZATION) return 0;
    return instance_preview(&slave->core);
}

static inline int has(fmi2ValueReference reference, int bits) {
    return reference < (unsigned)model.variable_count && (model.access[reference] & bits) == bits;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    Slave *slave = c;
    if (!slave || before_get(slave)) return fmi2Error;
    const double *v = slave->core.v;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], REAL)) return refuse_get(slave, vr[i], REAL);
        value[i] = v[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Integer value[]) {
    Slave *slave = c;
    if (!slave || before_get(slave)) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], INTEGER)) return refuse_get(slave, vr[i], INTEGER);
        value[i] = nearest_int(slave->core.v[vr[i]]);
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Boolean value[]) {
    Slave *slave = c;
    if (!slave || before_get(slave)) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], BOOLEAN)) return refuse_get(slave, vr[i], BOOLEAN);
        value[i] = slave->core.v[vr[i]] != 0 ? fmi2True : fmi2False;
    }
    return fmi2OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2String value[]) {
    Slave *slave = c;
    if (!slave || before_get(slave)) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], STRING)) return refuse_get(slave, vr[i], STRING);
        value[i] = instance_text(&slave->core, (int)vr[i]);
    }
    return fmi2OK;
}

/* The bits in which the access of any of these variables differs from those. */
static inline int difference(const fmi2ValueReference vr[], size_t count, int bits) {
    int all = 0;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= (unsigned)model.variable_count) return ~0;
        all |= model.access[vr[i]] ^ bits;
    }
    return all;
}

/* Whether all variables may be set now to these values, doubles or ints; says so when not. Parameters that change while
   the instance runs must lie in their range at once; before, all parameters are checked when initialisation ends. */
SELDOM static int may_be(Slave *slave, const fmi2ValueReference vr[], size_t count, int type, const double *reals,
                         const int *ints) {
    const int phase = (int)slave->core.state->phase;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], type | phase)) return refuse_set(slave, vr[i], type) == fmi2OK;
        if (phase != STEPPING || !(model.access[vr[i]] & TUNABLE)) continue;
        if (!instance_accepts(&slave->core, (int)vr[i], reals ? reals[i] : ints[i])) return 0;
    }
    return 1;
}

/* The same, quickly: nearly always all may be set, whatever the value. */
static inline int settable(Slave *slave, const fmi2ValueReference vr[], size_t count, int type, const double *reals,
                           const int *ints) {
    const int bits = type | (int)slave->core.state->phase;
    return !(difference(vr, count, bits) & (bits | TUNABLE)) || may_be(slave, vr, count, type, reals, ints);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[]) {
    Slave *slave = ALLOWED(c, fmi2SetReal);
    if (!slave || !settable(slave, vr, count, REAL, value, NULL)) return fmi2Error;
    instance_undo_preview(&slave->core);
    for (size_t i = 0; i < count; i++) slave->core.v[vr[i]] = value[i];
    return fmi2OK;
}

static inline fmi2Status set_ints(Slave *slave, const fmi2ValueReference vr[], size_t count, const int value[],
                                  int type) {
    if (!slave || !settable(slave, vr, count, type, NULL, value)) return fmi2Error;
    instance_undo_preview(&slave->core);
    for (size_t i = 0; i < count; i++) slave->core.v[vr[i]] = type == BOOLEAN ? value[i] != fmi2False : value[i];
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Integer value[]) {
    return set_ints(ALLOWED(c, fmi2SetInteger), vr, count, value, INTEGER);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Boolean value[]) {
    return set_ints(ALLOWED(c, fmi2SetBoolean), vr, count, value, BOOLEAN);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2String value[]) {
    Slave *slave = ALLOWED(c, fmi2SetString);
    if (!slave) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (!has(vr[i], STRING | (int)slave->core.state->phase)) return refuse_set(slave, vr[i], STRING);
        if (!instance_can_hold(&slave->core, (int)vr[i], value[i])) return fmi2Error;
    }
    instance_undo_preview(&slave->core);
    for (size_t i = 0; i < count; i++) instance_set_text(&slave->core, (int)vr[i], value[i]);
    return fmi2OK;
}

SELDOM static fmi2Status refuse_slope(Slave *slave, fmi2ValueReference reference, int order) {
    if (!has(reference, REAL)) return refuse_get(slave, reference, REAL);
    instance_say(&slave->core, SAY_NO_SLOPE, order, model.variables[reference].name);
    return fmi2Error;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    Slave *slave = ALLOWED(c, fmi2SetRealInputDerivatives);
    if (!slave) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= (unsigned)model.variable_count || model.input_slot[vr[i]] < 0 || order[i] != 1) {
            return refuse_slope(slave, vr[i], order[i]);
        }
    }
    instance_undo_preview(&slave->core);
    for (size_t i = 0; i < count; i++) slave->core.slopes[model.input_slot[vr[i]]] = value[i] == 0 ? -0.0 : value[i];
    if (count) slave->core.state->slopes_set = 1;
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                        const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)count, (void)order, (void)value;
    return refuse(c, "This FMU has no derivatives of outputs (maxOutputDerivativeOrder is 0).");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknown_count,
                                        const fmi2ValueReference known[], size_t known_count, const fmi2Real dv_known[],
                                        fmi2Real dv_unknown[]) {
    (void)unknown, (void)unknown_count, (void)known, (void)known_count, (void)dv_known, (void)dv_unknown;
    return refuse(c, "This FMU has no directional derivatives (providesDirectionalDerivative is false).");
}

/* ---- stepping ---- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_return) {
    (void)no_return;
    Slave *slave = ALLOWED(c, fmi2DoStep);
    if (!slave) return fmi2Error;
    return slave->last_step = instance_step(&slave->core, time, h) == 0 ? fmi2OK : fmi2Error;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    return refuse(c, "There is no step to cancel: this FMU does not run asynchronously.");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    Slave *slave = c;
    if (!slave || kind != fmi2DoStepStatus) return refuse(c, "Expected the status kind fmi2DoStepStatus.");
    *value = slave->last_step;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Slave *slave = c;
    if (!slave || kind != fmi2LastSuccessfulTime) return refuse(c, "Expected the status kind fmi2LastSuccessfulTime.");
    *value = slave->core.state->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return refuse(c, "There is no status of type Integer.");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    Slave *slave = c;
    if (!slave || kind != fmi2Terminated) return refuse(c, "Expected the status kind fmi2Terminated.");
    *value = fmi2False; /* this FMU never asks for the end of the simulation */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    Slave *slave = c;
    if (!slave || kind != fmi2PendingStatus) return refuse(c, "Expected the status kind fmi2PendingStatus.");
    *value = "";
    return fmi2OK;
}

/* ---- saved states ---- */

static size_t snapshot_size(const Slave *slave) {
    return sizeof(Snapshot) + slave->core.state_size;
}

/* The head of a state of this instance: what tells it from one of another build, and of one with other tables. */
static Snapshot head_of(const Slave *slave) {
    Snapshot head = {{0}, {0}, slave->core.table_number, slave->core.state_size};
    memcpy(head.magic, snapshot_magic, sizeof head.magic);
    strncpy(head.guid, model.guid, sizeof head.guid - 1);
    return head;
}

/* Whether the bytes are a state of this very build with these tables; says so when not. */
static int belongs(Slave *slave, const void *bytes, size_t size) {
    const Snapshot head = head_of(slave);
    if (bytes && size == snapshot_size(slave) && memcmp(bytes, &head, sizeof head) == 0) return 1;
    instance_say(&slave->core, SAY_OTHER_STATE, model.identifier);
    return 0;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    Slave *slave = c;
    if (!slave || !state) return fmi2Error;
    Snapshot *snapshot = *state;
    if (snapshot && !belongs(slave, snapshot, snapshot_size(slave))) return fmi2Error;
    if (!snapshot) {
        snapshot = calloc(1, snapshot_size(slave));
        if (!snapshot) return refuse(slave, "There is not enough memory for a saved state.");
        *snapshot = head_of(slave);
        *state = snapshot;
    }
    instance_undo_preview(&slave->core);
    memcpy(snapshot + 1, slave->core.state, slave->core.state_size);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    Slave *slave = c;
    if (!slave) return fmi2Error;
    if (!belongs(slave, state, snapshot_size(slave))) return fmi2Error;
    if (instance_take(&slave->core, (const State *)((const Snapshot *)state + 1))) return fmi2Error;
    slave->last_step = fmi2OK;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (!c) return fmi2Error;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    Slave *slave = c;
    if (!slave || !belongs(slave, state, snapshot_size(slave))) return fmi2Error;
    *size = snapshot_size(slave);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    Slave *slave = c;
    if (!slave || !belongs(slave, state, snapshot_size(slave))) return fmi2Error;
    if (size < snapshot_size(slave)) return refuse(slave, "The buffer is too small for the saved state.");
    memcpy(bytes, state, snapshot_size(slave));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    Slave *slave = c;
    if (!slave || !state || !belongs(slave, bytes, size)) return fmi2Error;
    Snapshot *snapshot = malloc(size);
    if (!snapshot) return refuse(slave, "There is not enough memory for a saved state.");
    memcpy(snapshot, bytes, size);
    *state = snapshot;
    return fmi2OK;
}
