/* One running component: its state, its clocks and its tasks. Knows nothing of FMI beyond a way to report. */
#ifndef NAVFMU_INSTANCE_H
#define NAVFMU_INSTANCE_H

#include <stddef.h>
#include <stdint.h>

#include "model.h"
#include "table.h"

/* For what is done seldom: keeps it out of the way of what is done at every step. */
#ifdef __GNUC__
#define SELDOM __attribute__((noinline, cold))
#else
#define SELDOM
#endif

/* The head of the state block. The block is plain data without pointers: head, v, slopes, clocks, last, remembered,
   texts; saving, restoring and resetting are copies of it. */
typedef struct {
    double time;          /* communication point */
    double start, stop;   /* of the experiment; stop is INFINITY when it was not given */
    double elapsed;       /* since the start: the sum of all steps, */
    double base, rest;    /* of those before the last run of equal ones and what is too small to show in it, */
    double step, alike;   /* and of that run: their size and number */
    int64_t steps;        /* done */
    int64_t phase;
    int64_t passed;     /* outputs that follow inputs directly have left at this communication point */
    int64_t slopes_set; /* some input has a derivative for the coming step */
    uint64_t named;     /* what the tables that Strings name held when initialisation ended, as a number */
} State;

/* A clock: tick k comes at origin + (k - first) * period since the start. */
typedef struct {
    int64_t ticks;  /* number of the last tick that was made, */
    int64_t first;  /* of the one whose time is */
    double origin;
    double period;  /* that holds from there on */
    double due;     /* when the next tick comes, in seconds since the start */
} Clock;

typedef struct Instance Instance;
typedef void Report(Instance *self, Severity severity, const char *sentence);

struct Instance {
    void *host; /* what the FMI front end needs to report */
    Report *report;
    int log_events;

    State *state; /* the block; the pointers below lie in it */
    size_t state_size;
    double *v;
    double *slopes;   /* du/dt of each continuous input, for the coming step; -0 for none */
    Clock *clocks;
    int64_t *last;    /* sequence number last seen, for each task */
    double *remembered; /* by what passes through */
    char *texts;      /* of Strings, each in a place of its own with a 0 behind it */

    State *before;    /* copy of the block while outputs are shown in initialisation mode, */
    int previewed;    /* which `before` undoes */

    Table *tables;    /* constant after instantiation but for those that Strings name */
    Table *others;    /* while these are read */
    char *resources;
    uint64_t table_number; /* what those hold that are constant, as a number */
    double *fixed;    /* follows from values that stand since initialisation: not part of the state */

    /* buffers of one task's run */
    double *held, *noise, *work, *result;
    void *memory;
};

/* Returns 0, or 1 after reporting why not. `self` is zeroed memory of the front end with host and report set. */
static int instance_create(Instance *self, const char *resources);
static void instance_destroy(Instance *self);
static void instance_reset(Instance *self);

/* In initialisation mode: calculate what depends on what was set so far, and take that back.
   Returns 0, or 1 after reporting why not. */
static int instance_preview(Instance *self);
static inline void instance_undo_preview(Instance *self);

/* Check the parameters and run the start tasks. Returns 0, or 1 after reporting why not; then nothing has changed. */
static int instance_start(Instance *self);

/* Take a block that holds another state, and bring along what lies outside of it. Returns 0, or 1 after reporting that
   this cannot be done, as it has other tables; then nothing has changed. */
static int instance_take(Instance *self, const State *state);

/* Calculate what passes through, from what was set last. */
static inline void instance_pass(Instance *self);

/* Do all that is due in a step of h from the host's time. Returns 0, or 1 after reporting why it cannot be done. */
static int instance_step(Instance *self, double time, double h);

/* Whether a parameter may have the value, as far as one parameter tells; reports when not. */
static int instance_accepts(Instance *self, int index, double value);

/* The text of a String, which changes only before initialisation has ended. Setting reports why not, and returns 0. */
static const char *instance_text(const Instance *self, int index);
static int instance_can_hold(Instance *self, int index, const char *text);
static void instance_set_text(Instance *self, int index, const char *text);

/* The nearest int, also for values that no int can hold. */
static int nearest_int(double value);

static void instance_say(Instance *self, Severity severity, const char *format, ...);

#endif
