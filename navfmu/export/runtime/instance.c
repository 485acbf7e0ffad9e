#include "instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "noise.h"

void instance_say(Instance *self, Severity severity, const char *format, ...) {
    char sentence[1024];
    va_list values;
    va_start(values, format);
    vsnprintf(sentence, sizeof sentence, format, values);
    va_end(values);
    self->report(self, severity, sentence);
}

int nearest_int(double value) {
    if (!(value > -2147483648.0)) return value != value ? 0 : -2147483647 - 1;
    if (value >= 2147483647.0) return 2147483647;
    return (int)(value < 0 ? value - 0.5 : value + 0.5);
}

/* ---- life ---- */

static size_t at_least_one(int count) {
    return (size_t)(count > 0 ? count : 1);
}

/* Both layouts are walked twice: once to add up sizes (base NULL), once to hand out pointers. */
static void *take(char *base, size_t *offset, size_t count, size_t size) {
    void *place = base ? base + *offset : NULL;
    *offset += (count * size + 15) / 16 * 16;
    return place;
}

static size_t lay_out_state(Instance *self, char *base) {
    size_t size = 0;
    self->state = take(base, &size, 1, sizeof(State));
    self->v = take(base, &size, at_least_one(model.variable_count), sizeof(double));
    self->slopes = take(base, &size, at_least_one(model.input_count), sizeof(double));
    self->counts = take(base, &size, at_least_one(model.clock_count), sizeof(int64_t));
    self->last = take(base, &size, at_least_one(model.task_count), sizeof(int64_t));
    return size;
}

static size_t lay_out(Instance *self, char *base) {
    size_t size = 0;
    char *state = take(base, &size, self->state_size, 1);
    self->before = take(base, &size, self->state_size, 1);
    self->tables = take(base, &size, at_least_one(model.table_count), sizeof(Table));
    self->cursors = take(base, &size, at_least_one(model.table_count), sizeof(int64_t));
    self->held = take(base, &size, at_least_one(model.input_count), sizeof(double));
    self->noise = take(base, &size, at_least_one(model.most_normals), sizeof(double));
    self->result = take(base, &size, at_least_one(model.most_targets), sizeof(double));
    self->rows = take(base, &size, at_least_one(model.row_values), sizeof(double));
    if (base) lay_out_state(self, state);
    return size;
}

int instance_create(Instance *self, const char *resources) {
    self->state_size = lay_out_state(self, NULL);
    self->memory = calloc(1, lay_out(self, NULL));
    if (!self->memory) {
        instance_say(self, ERROR, "There is not enough memory for another instance.");
        return 1;
    }
    lay_out(self, self->memory);
    for (int i = 0; i < model.table_count; i++) {
        char problem[900];
        if (table_load(&self->tables[i], &model.tables[i], resources, problem, sizeof problem)) {
            instance_say(self, ERROR, "%s", problem);
            return 1;
        }
    }
    instance_reset(self);
    return 0;
}

void instance_destroy(Instance *self) {
    if (!self->memory) return;
    for (int i = 0; i < model.table_count; i++) table_free(&self->tables[i]);
    free(self->memory);
    self->memory = NULL;
}

void instance_reset(Instance *self) {
    memset(self->state, 0, self->state_size);
    self->previewed = 0;
    self->state->phase = INSTANTIATED;
    self->state->stop = INFINITY;
    for (int i = 0; i < model.variable_count; i++) self->v[i] = model.variables[i].start;
}

/* ---- tasks ---- */

static void run(Instance *self, const Task *task, int64_t k, double time, double period) {
    if (task->normals) {
        uint64_t key[2] = {(uint64_t)nearest_int(self->v[model.seed]), (uint64_t)nearest_int(self->v[model.stream])};
        standard_normals(key, (uint64_t)k, task->stream, self->noise, task->normals);
    }
    const double clock[2] = {time, period};
    task->evaluate(self->v, self->noise, clock, self->rows, self->result);
    for (int i = 0; i < task->target_count; i++) self->v[task->targets[i]] = self->result[i];
}

static void look_up(Instance *self, double time) {
    double *out = self->rows;
    for (int i = 0; i < model.table_count; i++) {
        table_rows(&self->tables[i], time, &self->cursors[i], out);
        out += 2 * self->tables[i].columns;
    }
}

static void run_start_tasks(Instance *self) {
    look_up(self, self->state->start);
    for (int i = 0; i < model.task_count; i++) {
        if (model.tasks[i].kind == ON_START) run(self, &model.tasks[i], 0, self->state->start, 0.0);
    }
}

void instance_preview(Instance *self) {
    if (self->previewed) return;
    memcpy(self->before, self->state, self->state_size);
    run_start_tasks(self);
    self->previewed = 1;
}

void instance_undo_preview(Instance *self) {
    if (!self->previewed) return;
    memcpy(self->state, self->before, self->state_size);
    self->previewed = 0;
}

/* Run the task if the bundle's number has changed and its time has come. */
static void run_on_new(Instance *self, int i, double time, double tolerance) {
    const Task *task = &model.tasks[i];
    int64_t sequence = nearest_int(self->v[task->sequence]);
    int64_t jump = sequence - self->last[i];
    if (jump == 0 || !(self->v[task->validity] <= time + tolerance)) return;
    self->last[i] = sequence;
    if (jump > 1 && task->lost >= 0) {
        self->v[task->lost] += (double)(jump - 1);
        if (self->log_events) {
            instance_say(self, EVENT, "At %.9g s %lld samples of '%s' were lost: the communication step is longer than "
                         "their period.", time, (long long)(jump - 1), model.variables[task->sequence].name);
        }
    }
    run(self, task, sequence, time, self->v[model.clocks[task->clock]]);
}

/* A time is due when it is not later than another one by more than rounding: that of the period, and that of the
   host's times, which is large when the experiment does not start near 0 (seconds of a calendar). */
static double tolerance_of(double period, double start, double end) {
    return 1e-9 * period + 4 * DBL_EPSILON * fmax(fabs(start), fabs(end));
}

static double due_time(const Instance *self, int clock) {
    return (double)(self->counts[clock] + 1) * self->v[model.clocks[clock]];
}

/* One tick: all clocks that are due at its time, then all tasks in the order of their declaration. */
static void tick(Instance *self, double elapsed, double tolerance, double origin) {
    const double time = self->state->start + elapsed;
    if (self->state->slopes_set) {
        for (int i = 0; i < model.input_count; i++) {
            self->v[model.inputs[i]] = self->held[i] + self->slopes[i] * (time - origin);
        }
    }
    look_up(self, time);
    uint64_t due = 0;
    for (int c = 0; c < model.clock_count; c++) {
        if (due_time(self, c) <= elapsed + tolerance) {
            due |= (uint64_t)1 << c;
            self->counts[c]++;
        }
    }
    for (int i = 0; i < model.task_count; i++) {
        const Task *task = &model.tasks[i];
        if (task->kind == ON_NEW) {
            run_on_new(self, i, time, tolerance);
        } else if (task->kind == ON_CLOCK && due >> task->clock & 1) {
            run(self, task, self->counts[task->clock], time, self->v[model.clocks[task->clock]]);
        }
    }
}

void instance_advance(Instance *self, double end) {
    const double origin = self->state->time, elapsed_end = end - self->state->start;
    if (self->state->slopes_set) {
        for (int i = 0; i < model.input_count; i++) self->held[i] = self->v[model.inputs[i]];
    }
    while (model.clock_count) {
        int first = 0;
        for (int c = 1; c < model.clock_count; c++) {
            if (due_time(self, c) < due_time(self, first)) first = c;
        }
        const double due = due_time(self, first);
        const double tolerance = tolerance_of(self->v[model.clocks[first]], self->state->start, end);
        if (!(due <= elapsed_end + tolerance)) break;
        tick(self, due, tolerance, origin);
    }
    if (self->state->slopes_set) {
        for (int i = 0; i < model.input_count; i++) {
            self->v[model.inputs[i]] = self->held[i];
            self->slopes[i] = 0.0;
        }
        self->state->slopes_set = 0;
    }
    self->state->time = end;
}

/* ---- parameters ---- */

int instance_in_range(Instance *self, int index, double value) {
    const Variable *variable = &model.variables[index];
    if (value >= variable->min && value <= variable->max) return 1;
    const char *space = *variable->unit ? " " : "", *unit = variable->unit;
    if (isfinite(variable->min) && isfinite(variable->max)) {
        instance_say(self, ERROR, "Parameter '%s' is %.9g%s%s; expected a value from %.9g to %.9g%s%s.", variable->name,
                     value, space, unit, variable->min, variable->max, space, unit);
    } else if (isfinite(variable->min) || isfinite(variable->max)) {
        instance_say(self, ERROR, "Parameter '%s' is %.9g%s%s; expected a value of at %s %.9g%s%s.", variable->name, value,
                     space, unit, isfinite(variable->min) ? "least" : "most",
                     isfinite(variable->min) ? variable->min : variable->max, space, unit);
    } else {
        instance_say(self, ERROR, "Parameter '%s' is not a number.", variable->name);
    }
    return 0;
}

static void report_check(Instance *self, const Check *check) {
    char sentence[1024];
    size_t length = 0;
    const int *value = check->values;
    for (const char *c = check->message; *c && length + 32 < sizeof sentence; c++) {
        if (c[0] == '{' && c[1] == '}') {
            length += (size_t)snprintf(sentence + length, 32, "%.6g", self->v[*value++]);
            c++;
        } else {
            sentence[length++] = *c;
        }
    }
    sentence[length] = 0;
    instance_say(self, ERROR, "%s", sentence);
}

static int parameters_hold(Instance *self) {
    int good = 1;
    for (int i = 0; i < model.variable_count; i++) {
        if (model.variables[i].is_parameter && !instance_in_range(self, i, self->v[i])) good = 0;
    }
    for (int c = 0; c < model.clock_count && good; c++) {
        double period = self->v[model.clocks[c]];
        if (isfinite(period) && period > 0) continue;
        instance_say(self, ERROR, "Parameter '%s' is %.9g s; expected a period longer than 0 s.",
                     model.variables[model.clocks[c]].name, period);
        good = 0;
    }
    for (int i = 0; i < model.check_count && good; i++) {
        const double clock[2] = {0.0, 0.0};
        model.checks[i].holds(self->v, self->noise, clock, self->rows, self->result);
        if (self->result[0] == 0 || isnan(self->result[0])) {
            report_check(self, &model.checks[i]);
            good = 0;
        }
    }
    return good;
}

int instance_start(Instance *self) {
    instance_undo_preview(self);
    if (!parameters_hold(self)) return 1;
    self->state->time = self->state->start;
    run_start_tasks(self);
    self->state->phase = STEPPING;
    return 0;
}
