#include "instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "noise.h"

/* How many bytes the character of UTF-8 has that begins here, 0 if none does. */
static size_t character_bytes(const char *text) {
    const unsigned char *c = (const unsigned char *)text;
    if (c[0] < 0x80) return 1;
    const size_t count = c[0] >= 0xC2 && c[0] < 0xE0 ? 2 : (c[0] & 0xF0) == 0xE0 ? 3 : c[0] >= 0xF0 && c[0] < 0xF5 ? 4 : 0;
    for (size_t i = 1; i < count; i++) {
        if ((c[i] & 0xC0) != 0x80) return 0;
    }
    if (c[0] == 0xE0 && c[1] < 0xA0) return 0; /* could be shorter, */
    if (c[0] == 0xF0 && c[1] < 0x90) return 0;
    if (c[0] == 0xED && c[1] > 0x9F) return 0; /* half of a character of UTF-16, */
    if (c[0] == 0xF4 && c[1] > 0x8F) return 0; /* beyond the last character */
    return count;
}

/* A sentence is UTF-8 whatever it tells of, also where it ends because its place does. */
SELDOM static void instance_say(Instance *self, Severity severity, const char *format, ...) {
    char sentence[1024];
    va_list values;
    va_start(values, format);
    vsnprintf(sentence, sizeof sentence, format, values);
    va_end(values);
    for (char *c = sentence; *c;) {
        const size_t bytes = character_bytes(c);
        if (!bytes) *c = '?';
        c += bytes ? bytes : 1;
    }
    self->report(self, severity, sentence);
}

/* A value as it is printed: there is one NaN, without a sign. */
static double shown(double value) {
    return value == value ? value : (double)NAN;
}

static int nearest_int(double value) {
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
    self->clocks = take(base, &size, at_least_one(model.clock_count), sizeof(Clock));
    self->last = take(base, &size, at_least_one(model.task_count), sizeof(int64_t));
    self->remembered = take(base, &size, at_least_one(model.memory_count), sizeof(double));
    self->texts = take(base, &size, at_least_one(model.text_bytes), 1);
    return size;
}

static size_t lay_out(Instance *self, char *base) {
    size_t size = 0;
    char *state = take(base, &size, self->state_size, 1);
    self->before = take(base, &size, self->state_size, 1);
    self->tables = take(base, &size, at_least_one(model.table_count), sizeof(Table));
    self->others = take(base, &size, at_least_one(model.table_count), sizeof(Table));
    self->fixed = take(base, &size, at_least_one(model.fixed_count), sizeof(double));
    self->held = take(base, &size, at_least_one(model.input_count), sizeof(double));
    self->noise = take(base, &size, at_least_one(model.most_normals), sizeof(double));
    self->work = take(base, &size, at_least_one(model.work_count), sizeof(double));
    self->result = take(base, &size, at_least_one(model.most_targets), sizeof(double));
    if (base) lay_out_state(self, state);
    return size;
}

/* Read the table with this name, which is that of a file. Returns 0, or 1 after reporting why not. */
static int load_table(Instance *self, Table *table, int i, const char *name) {
    char problem[900];
    if (!table_is_within(name)) {
        instance_say(self, SAY_ELSEWHERE, name);
        return 1;
    }
    if (table_load(table, &model.tables[i], name, self->resources, problem, sizeof problem) == 0) return 0;
    instance_say(self, ERROR, "%s", problem);
    return 1;
}

/* Read the tables whose Strings, among these texts, name other files than before. They must hold what has this number
   if it is not 0. Returns 0; or 1 after reporting why not, then all tables are what they were. */
static int name_tables(Instance *self, const char *texts, uint64_t wanted, uint64_t *number) {
    int failed = 0;
    *number = 0;
    for (int i = 0; i < model.table_count; i++) {
        const int text = model.tables[i].text;
        if (text < 0) continue;
        const char *name = texts + model.texts[text].place;
        const int same = strcmp(name, self->tables[i].name) == 0;
        if (!failed && !same) failed = load_table(self, &self->others[i], i, name);
        if (!failed) *number = table_mix(*number, (same ? &self->tables[i] : &self->others[i])->number);
    }
    if (!failed && wanted && *number != wanted) {
        instance_say(self, SAY_OTHER_STATE, model.identifier);
        failed = 1;
    }
    for (int i = 0; i < model.table_count; i++) {
        if (!failed && self->others[i].values) {
            table_free(&self->tables[i]);
            self->tables[i] = self->others[i];
        } else {
            table_free(&self->others[i]);
        }
        memset(&self->others[i], 0, sizeof self->others[i]);
    }
    return failed;
}

static int instance_create(Instance *self, const char *resources) {
    self->state_size = lay_out_state(self, NULL);
    self->memory = calloc(1, lay_out(self, NULL));
    if (!self->memory) {
        instance_say(self, ERROR, "There is not enough memory for another instance.");
        return 1;
    }
    lay_out(self, self->memory);
    self->resources = calloc(1, resources ? strlen(resources) + 1 : 1);
    if (!self->resources) {
        instance_say(self, ERROR, "There is not enough memory for another instance.");
        return 1;
    }
    if (resources) strcpy(self->resources, resources);
    for (int i = 0; i < model.table_count; i++) {
        if (load_table(self, &self->tables[i], i, "")) return 1;
        if (model.tables[i].text < 0) self->table_number = table_mix(self->table_number, self->tables[i].number);
    }
    instance_reset(self);
    return 0;
}

static void instance_destroy(Instance *self) {
    if (!self->memory) return;
    for (int i = 0; i < model.table_count; i++) table_free(&self->tables[i]);
    free(self->resources);
    free(self->memory);
    self->memory = NULL;
}

static void clear_slopes(Instance *self) {
    for (int i = 0; i < model.input_count; i++) self->slopes[i] = -0.0;
    self->state->slopes_set = 0;
}

static void instance_reset(Instance *self) {
    memset(self->state, 0, self->state_size);
    self->previewed = 0;
    self->state->phase = INSTANTIATED;
    self->state->stop = INFINITY;
    for (int i = 0; i < model.variable_count; i++) self->v[i] = model.variables[i].start;
    for (int i = 0; i < model.text_count; i++) strcpy(self->texts + model.texts[i].place, model.texts[i].start);
    for (int i = 0; i < model.memory_count; i++) self->remembered[i] = model.memory[i];
    clear_slopes(self);
}

/* ---- texts ---- */

static const Text *text_of(int index) {
    return &model.texts[(int)model.variables[index].start];
}

static const char *instance_text(const Instance *self, int index) {
    return self->texts + text_of(index)->place;
}

static int instance_can_hold(Instance *self, int index, const char *text) {
    const char *name = model.variables[index].name;
    const int longest = text_of(index)->longest;
    const char *c = text ? text : "";
    while (*c && character_bytes(c)) c += character_bytes(c);
    if (!text) instance_say(self, SAY_NO_TEXT, name);
    else if (*c) instance_say(self, SAY_NO_CHARACTER, name, (double)(c - text + 1));
    else if (c - text > longest) instance_say(self, SAY_TOO_LONG, name, (double)(c - text), longest);
    else return 1;
    return 0;
}

/* The rest of its place is 0, so that equal texts are equal bytes. */
static void instance_set_text(Instance *self, int index, const char *text) {
    const Text *place = text_of(index);
    strncpy(self->texts + place->place, text, (size_t)place->longest + 1);
}

/* ---- tasks ---- */

/* Integers hold whole numbers of 32 bits; anything else is refused, so that no fraction, infinity or NaN hides in one.
   Returns 0, or 1 after reporting. */
static int check_wholes(Instance *self, const Task *task) {
    for (int i = 0; i < task->whole_count; i++) {
        double *value = &self->result[task->wholes[i]];
        if (!(*value >= -2147483648.0 && *value <= 2147483647.0 && *value == (int)*value)) {
            instance_say(self, SAY_NOT_WHOLE, model.variables[task->targets[task->wholes[i]]].name, shown(*value));
            return 1;
        }
        *value += 0.0; /* there is no Integer -0 */
        const int index = task->targets[task->wholes[i]];
        const Variable *item = &model.variables[index];
        if (model.access[index] & ENUMERATION && !(*value >= item->min && *value <= item->max)) {
            instance_say(self, SAY_NO_ITEM, item->name, item->min, item->max, *value);
            return 1;
        }
    }
    return 0;
}

static int run(Instance *self, const Task *task, int64_t k, double time) {
    if (task->normals) {
        uint64_t key[2] = {(uint64_t)nearest_int(self->v[model.seed]), (uint64_t)nearest_int(self->v[model.stream])};
        standard_normals(key, (uint64_t)k, task->stream, self->noise, task->normals);
    }
    task->evaluate(self->v, self->noise, &time, self->fixed, self->tables, self->work, self->result);
    if (check_wholes(self, task)) return 1;
    for (int i = 0; i < task->target_count; i++) self->v[task->targets[i]] = self->result[i];
    return 0;
}

static inline void instance_pass(Instance *self) {
    model.through(self->v, self->remembered, self->state->steps);
    self->state->passed = 1;
}

static int run_start_tasks(Instance *self) {
    uint64_t number;
    if (name_tables(self, self->texts, 0, &number)) return 1;
    for (int i = 0; i < model.task_count; i++) {
        if (model.tasks[i].kind == ON_START && run(self, &model.tasks[i], 0, self->state->start)) return 1;
    }
    if (model.through) instance_pass(self);
    return 0;
}

static int instance_preview(Instance *self) {
    if (self->previewed) return 0;
    memcpy(self->before, self->state, self->state_size);
    self->previewed = 1;
    if (run_start_tasks(self) == 0) return 0;
    instance_undo_preview(self);
    return 1;
}

SELDOM static void go_back(Instance *self) {
    memcpy(self->state, self->before, self->state_size);
    self->previewed = 0;
}

static inline void instance_undo_preview(Instance *self) {
    if (self->previewed) go_back(self);
}

/* Run the task if the bundle's number has changed and its time has come. */
static int run_on_new(Instance *self, int i, double time, double tolerance) {
    const Task *task = &model.tasks[i];
    int64_t sequence = nearest_int(self->v[task->sequence]);
    int64_t jump = sequence - self->last[i];
    if (jump == 0 || !(self->v[task->validity] <= time + tolerance)) return 0;
    self->last[i] = sequence;
    if (jump > 1 && task->lost >= 0) {
        self->v[task->lost] += (double)(jump - 1);
        if (self->log_events) {
            instance_say(self, SAY_LOST, time, (double)(jump - 1), model.variables[task->sequence].name);
        }
    }
    return run(self, task, sequence, time);
}

/* ---- time ---- */

/* A time is due when it is not later than another one by more than rounding: that of the period, and this, that of
   the host's times, which is large when the experiment does not start near 0 (seconds of a calendar). */
static double rounding_of(double start, double end) {
    return 4 * DBL_EPSILON * fmax(fabs(start), fabs(end));
}

static void set_due(Clock *clock) {
    clock->due = clock->origin + (double)(clock->ticks + 1 - clock->first) * clock->period;
}

/* There is no tick at the start itself: the first one comes at the offset, or where that is 0 one period later. */
static void start_clocks(Instance *self) {
    for (int c = 0; c < model.clock_count; c++) {
        const ClockInfo *info = &model.clocks[c];
        const double offset = info->offset < 0 ? 0.0 : self->v[info->offset];
        self->clocks[c] = (Clock){offset > 0 ? -1 : 0, 0, offset, self->v[info->period], 0.0};
        set_due(&self->clocks[c]);
    }
}

/* A period has changed: the next tick comes one new period after the last one, and at once if that has passed. */
SELDOM static void retime(Clock *clock, double period, double now) {
    if (clock->ticks >= clock->first) {
        const double last = clock->origin + (double)(clock->ticks - clock->first) * clock->period;
        const int late = last + period < now;
        clock->origin = late ? now : last;
        clock->first = clock->ticks + late;
    }
    clock->period = period;
    set_due(clock);
}

static inline void heed_periods(Instance *self) {
    for (int c = 0; c < model.clock_count; c++) {
        const double period = self->v[model.clocks[c].period];
        if (period != self->clocks[c].period) retime(&self->clocks[c], period, self->state->elapsed);
    }
}

SELDOM static void heed_host(State *s, double end) {
    const double clock = end - s->start, ahead = s->elapsed - clock;
    const double numbers = fmax(fabs(s->start), fabs(end)), adding = (double)(s->steps + 1) * fabs(clock);
    const double resolution = DBL_EPSILON * (numbers + adding);
    if (fabs(ahead) <= resolution) return;
    s->elapsed = s->base = clock + copysign(resolution, ahead);
    s->rest = s->alike = 0.0;
}

SELDOM static void start_run(State *s, double h) {
    const double run = s->alike * s->step, sum = s->base + run, part = sum - s->base;
    s->rest += (s->base - (sum - part)) + (run - part);
    s->base = sum;
    s->step = h;
    s->alike = 0.0;
}

/* Move the clock to the end of a step. A host that adds up its time (t += h) is off by a rounding for each step, and
   what is due at the end of a step would seem to lie behind it. So equal steps are counted here, which rounds once
   however many they are, and what a run of them has come to is added to the runs before without rounding (Knuth's sum
   of two numbers). The host's own clock stays the judge: the sum may differ from it by no more than its resolution,
   which is that of its numbers and what adding up so many steps from 0 costs. */
static void move_clock(State *s, double h, double end) {
    const double before = s->elapsed, clock = end - s->start;
    if (h != s->step) start_run(s, h);
    s->alike += 1.0;
    s->steps++;
    s->elapsed = s->base + (s->rest + s->alike * h);
    if (!(fabs(s->elapsed - clock) <= 2 * DBL_EPSILON * clock)) heed_host(s, end); /* less than the resolution */
    if (s->elapsed < before) s->elapsed = before; /* it never runs backwards */
}

/* Inputs have moved along their derivatives for `since` seconds. Where there is none it is -0: it changes no value. */
static void move_inputs(Instance *self, double since, int first) {
    for (int i = 0; i < model.input_count; i++) {
        double *input = &self->v[model.inputs[i]];
        if (first) self->held[i] = *input;
        *input = self->held[i] + self->slopes[i] * since;
    }
}

/* One tick: all clocks that are due at its time, then all tasks in the order of their declaration. */
static int tick(Instance *self, double elapsed, double tolerance) {
    const double time = self->state->start + elapsed;
    uint64_t due = 0;
    for (int c = 0; c < model.clock_count; c++) {
        if (self->clocks[c].due <= elapsed + tolerance) {
            due |= (uint64_t)1 << c;
            self->clocks[c].ticks++;
            set_due(&self->clocks[c]);
        }
    }
    for (int i = 0; i < model.task_count; i++) {
        const Task *task = &model.tasks[i];
        if (task->kind == ON_NEW) {
            if (run_on_new(self, i, time, tolerance)) return 1;
        } else if (task->kind == ON_CLOCK && due >> task->clock & 1) {
            if (run(self, task, self->clocks[task->clock].ticks, time)) return 1;
        }
    }
    return 0;
}

/* All ticks up to and including the time `end`. */
static int advance(Instance *self, double h, double end) {
    const double start = self->state->start, origin = self->state->time - start, rounding = rounding_of(start, end);
    heed_periods(self);
    move_clock(self->state, h, end);
    int failed = 0, moved = 0;
    while (model.clock_count && !failed) {
        const Clock *first = self->clocks;
        for (const Clock *clock = first + 1; clock < self->clocks + model.clock_count; clock++) {
            if (clock->due < first->due) first = clock;
        }
        const double due = first->due;
        const double tolerance = 1e-9 * first->period + rounding;
        if (!(due <= self->state->elapsed + tolerance)) break;
        if (self->state->slopes_set) {
            move_inputs(self, fmax(due - origin, 0.0), !moved);
            moved = 1;
        }
        failed = tick(self, due, tolerance);
    }
    for (int i = 0; i < model.input_count && moved; i++) self->v[model.inputs[i]] = self->held[i];
    if (self->state->slopes_set) clear_slopes(self);
    if (!failed && end > self->state->time) self->state->time = end;
    return failed;
}

/* Whether a step from this time to that may be made now, which is so within rounding and a part of the step. */
SELDOM static int fits_in(Instance *self, double time, double h, double end) {
    const State *s = self->state;
    const double rounding = 8 * DBL_EPSILON * fmax(fabs(s->start), fabs(end));
    const double slack = 1e-9 * (1.0 + fabs(end - s->start));
    if (fabs(time - s->time) > fmin(slack, 0.5 * h) + rounding) {
        instance_say(self, SAY_OTHER_TIME, time, s->time);
    } else if (end > s->stop + slack + rounding) {
        instance_say(self, SAY_PAST_STOP, end, s->stop);
    } else {
        return 1;
    }
    return 0;
}

static int instance_step(Instance *self, double time, double h) {
    const double end = time + h;
    if (!(h > 0) || !isfinite(end)) {
        instance_say(self, SAY_NO_STEP, shown(h), shown(time));
        return 1;
    }
    const int plain = fabs(time - self->state->time) <= 1e-9 * h && end <= self->state->stop;
    if (!plain && !fits_in(self, time, h, end)) return 1;
    if (model.step > 0 && fabs(h - model.step) > 1e-6 * model.step) {
        instance_say(self, SAY_OTHER_STEP, h, time, model.step);
        return 1;
    }
    if (model.direct && !self->state->passed) instance_pass(self); /* nobody has asked at this point */
    self->state->passed = 0;
    if (advance(self, h, end) == 0) {
        if (model.through && !model.direct) instance_pass(self);
        return 0;
    }
    self->state->phase = FAILED;
    return 1;
}

/* ---- parameters ---- */

static int in_range(Instance *self, int index, double value) {
    const Variable *variable = &model.variables[index];
    if (value >= variable->min && value <= variable->max) return 1;
    const char *space = *variable->unit ? " " : "", *unit = variable->unit;
    value = shown(value);
    if (isfinite(variable->min) && isfinite(variable->max)) {
        instance_say(self, SAY_BETWEEN, variable->name, value, space, unit, variable->min, variable->max, space, unit);
    } else if (isfinite(variable->min)) {
        instance_say(self, SAY_AT_LEAST, variable->name, value, space, unit, variable->min, space, unit);
    } else if (isfinite(variable->max)) {
        instance_say(self, SAY_AT_MOST, variable->name, value, space, unit, variable->max, space, unit);
    } else {
        instance_say(self, SAY_NO_NUMBER, variable->name);
    }
    return 0;
}

static int is_period(Instance *self, int index, double value) {
    if (isfinite(value) && value > 0) return 1;
    instance_say(self, SAY_NO_PERIOD, model.variables[index].name, shown(value));
    return 0;
}

static int instance_accepts(Instance *self, int index, double value) {
    int good = in_range(self, index, value);
    for (int c = 0; c < model.clock_count && good; c++) {
        if (model.clocks[c].period == index) return is_period(self, index, value);
    }
    return good;
}

static int clocks_hold(Instance *self) {
    int good = 1;
    for (int c = 0; c < model.clock_count; c++) {
        const ClockInfo *info = &model.clocks[c];
        if (!is_period(self, info->period, self->v[info->period])) good = 0;
        if (info->offset < 0 || (isfinite(self->v[info->offset]) && self->v[info->offset] >= 0)) continue;
        instance_say(self, SAY_NO_OFFSET, model.variables[info->offset].name, shown(self->v[info->offset]));
        good = 0;
    }
    return good;
}

static void report_check(Instance *self, const Check *check) {
    char sentence[1024];
    size_t length = 0;
    const int *value = check->values;
    for (const char *c = check->message; *c && length + 32 < sizeof sentence; c++) {
        if (c[0] == '{' && c[1] == '}') {
            length += (size_t)snprintf(sentence + length, 32, "%.9g", shown(self->v[*value++]));
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
        if (model.variables[i].is_parameter && !in_range(self, i, self->v[i])) good = 0;
    }
    if (good) good = clocks_hold(self);
    for (int i = 0; i < model.check_count && good; i++) {
        model.checks[i].holds(self->v, self->noise, &self->state->start, self->fixed, self->tables, self->work,
                              self->result);
        if (self->result[0] == 0 || isnan(self->result[0])) {
            report_check(self, &model.checks[i]);
            good = 0;
        }
    }
    return good;
}

static void fix(Instance *self) {
    self->previewed = 0;
    model.fix(self->v, self->tables, self->work, self->fixed);
}

static int instance_take(Instance *self, const State *state) {
    const char *texts = (const char *)state + (self->texts - (const char *)self->state);
    uint64_t number;
    if (state->named && name_tables(self, texts, state->named, &number)) return 1;
    memcpy(self->state, state, self->state_size);
    fix(self);
    return 0;
}

static int instance_start(Instance *self) {
    uint64_t number;
    instance_undo_preview(self);
    if (name_tables(self, self->texts, 0, &number) || !parameters_hold(self) || instance_preview(self)) return 1;
    fix(self); /* what was calculated stays */
    self->state->named = number;
    start_clocks(self);
    self->state->time = self->state->start;
    self->state->phase = STEPPING;
    return 0;
}
