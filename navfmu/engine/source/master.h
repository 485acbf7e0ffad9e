/* The compiled master: runs a plan (navfmu/engine/plan.py) over the function pointers of FMI 2.0 FMUs.
   All memory belongs to the caller; navfmu/engine/structures.py mirrors these structures, layout.c says where
   their fields lie. */
#ifndef NAVFMU_MASTER_H
#define NAVFMU_MASTER_H

#include <stdint.h>

#include "expression.h"
#include "fmi2FunctionTypes.h"

#if defined(_WIN32)
#define API __declspec(dllexport)
#else
#define API __attribute__((visibility("default")))
#endif

/* When a fault acts: at the communication points first <= k < end, and since when (s). */
typedef struct {
    int64_t first, end;
    double start;
} Window;

/* Whether a trigger acts at a communication point; if so, at which point, and when (s), the present window began. */
typedef struct {
    int32_t acts;
    int64_t since;
    double start;
} Moment;

typedef enum { LISTED, WHEN, DURING } TriggerKind;

#define FOREVER ((int64_t)1 << 62) /* a communication point that no run reaches */

/* Communication points first <= k < end at which a trigger acted; FOREVER: it still does. */
typedef struct {
    int64_t first, end;
} Span;

/* When effects act; see navfmu/engine/trigger.py. */
typedef struct {
    int32_t kind;
    int32_t window, last;         /* its next window, and behind its last one */
    int32_t first_operation, operations; /* WHEN, DURING: the condition */
    int32_t first_span, room, spans; /* when it acted: place and length in Master.span, and how many there are */
    int64_t needed, row;          /* points in a row at which the condition must hold, and has held */
    int64_t lasts;                /* WHEN: points at which it acts */
    Moment now, before;           /* at the point to which it was moved, and at the one before */
} Trigger;

/* What a fault does to one signal while its trigger acts; see navfmu/engine/effect.py. */
typedef enum {
    ADD, RAMP, SET, HOLD, NOISE, SCALE, AFFINE, CLIP, QUANTISE, SPIKE, GARBAGE, DELAY, SLOW, SWAP,
    TAKE
} EffectKind;

typedef struct {
    int32_t kind;
    int32_t slot;                 /* the signal it changes */
    int32_t trigger;
    int32_t foreseen;             /* whether somebody takes one of these as it is just before the next point */
    double amount, other;
    int32_t memory, size;         /* what it remembers: place and length in Master.memory */
    int32_t first_pair, pairs;    /* SWAP, TAKE: the signals that change, behind them those whose value they get */
    int64_t multiplier, divisor;  /* number of a period: k * multiplier / divisor */
    uint64_t seed, stream, lane;  /* random numbers: key, and task word of the counter */
    int32_t first_reach, reaches; /* the signals that can be different because of it */
    int32_t before;               /* these before it, now: place in Master.memory */
    int32_t first_echo, echoes;   /* later effects on them */
    int32_t followed;             /* whether something may be different because of it, which nobody has seen yet */
    int64_t seen;                 /* when a bit is different because of it: 3 k, at communication point k, 3 k + 1, in
                                     the step after it, 3 k + 2, in that step as it leaves at its end; -1: not yet */
} Effect;

/* Steps that a component loses while a trigger acts. */
typedef struct {
    int32_t component, trigger;
    int64_t seen;                 /* as that of an effect */
} Loss;

/* Who sees a signal: a component in this step, one in the next step, one that gets it as it is ahead; the recording; a
   monitor. */
typedef enum { NOW = 1, NEXT = 2, AHEAD = 4, RECORDED = 8, OBSERVED = 16 } Reader;

/* A later effect on the same signals, and where that is which it would remember without the earlier one. */
typedef struct {
    int32_t effect, memory;
} Echo;

/* From where a monitor counts its points: the beginning of the run; that of a fault; the end of a fault. */
typedef enum { START, ONSET, OVER } Origin;

/* What is asked at every communication point, and what was seen; see navfmu/engine/monitor.py. */
typedef struct {
    int32_t counts_from;          /* Origin */
    int32_t fault;                /* whose; -1: of all faults together */
    int32_t first_operation, operations; /* its value */
    int32_t first_when, whens;    /* asked while this is not 0; without any: always */
    double least, most;
    int64_t begin, end;           /* communication points, begin <= k - origin <= end */
    int64_t origin;               /* -1: it has not come */
    int64_t tolerated;            /* points in a row that may lie outside */
    int64_t points, not_finite;   /* at which it was asked; at which the value was no number */
    int64_t outside, episodes;    /* points in longer rows than tolerated; such rows */
    int64_t row, longest;         /* points outside in a row, now and at most */
    int64_t first_outside, last_outside, first_inside, last_inside, worst_at; /* -1: none */
    int64_t latest;               /* points from an origin to behind the last one outside, at most */
    int64_t latest_from;          /* which origin that was */
    int64_t back, settled;        /* the same of the present origin, -1 at a point outside; at most of those at whose last
                                     point it is inside, -1: there is none */
    double worst, excess;         /* the value furthest outside, and how far that is */
    double squares, greatest;     /* sum over the finite values; size */
} Monitor;

/* A move from initialisation mode to t = 0; see navfmu/engine/initial.py. LEAVE concerns all inputs and outputs. */
typedef enum { READ, GIVE, LEAVE } MoveKind;

typedef struct {
    int32_t kind, component;
    int32_t type;                 /* 0 Real, 1 Integer, 2 Boolean */
    fmi2ValueReference reference;
    int32_t slot;                 /* the signal that is read; input = factor * signal[slot] + offset */
    double factor, offset;
} Move;

/* Inputs of one type that are set by one call: input i = factor[i] * signal[source[i]] + offset[i]. */
typedef struct {
    int32_t count;
    int32_t scaled;               /* 0: all are plain copies */
    const fmi2ValueReference *references;
    const int32_t *source;
    const double *factor, *offset;
} Inputs;

typedef struct {
    fmi2Component instance;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2SetRealInputDerivativesTYPE *set_derivatives;
    fmi2GetRealTYPE *get_real;
    fmi2GetIntegerTYPE *get_integer;
    fmi2GetBooleanTYPE *get_boolean;
    fmi2DoStepTYPE *do_step;
    fmi2ExitInitializationModeTYPE *exit_initialization;
    fmi2GetBooleanStatusTYPE *get_boolean_status; /* NULL where an FMU lacks it; so the next */
    fmi2GetRealStatusTYPE *get_real_status;
    fmi2Boolean never_back;       /* no snapshot is held: no state before this communication point will be set */

    Inputs smooth, real, integer, boolean;
    const int32_t *ahead;         /* smooth: signal at the end of the step, with the fault at its beginning */
    const fmi2Integer *first_order; /* smooth: 1, 1, ... */
    double *start, *slope;        /* smooth: value at the beginning of the step, derivative */
    double *real_value;           /* last set */
    fmi2Integer *integer_value;
    fmi2Boolean *boolean_value;

    int32_t reals, integers, booleans; /* outputs, whose signals lie in this order from first_signal on */
    int32_t first_signal;
    const fmi2ValueReference *real_reference, *integer_reference, *boolean_reference;
    int32_t *whole;               /* room for the Integer and Boolean outputs */

    int32_t first_effect, effects;
    int32_t exposures;            /* signals that effects change or look at */
    const int32_t *exposed;
    int32_t foreseen;             /* whether somebody takes one of these as it is just before the next point */
    int32_t copied;               /* or needs the true value of one besides the one that leaves */
    int32_t searched;             /* whether it may be that nothing has been seen of one of its effects */
    int32_t first_loss, losses;
    int64_t warnings;             /* calls that returned fmi2Warning */
    int32_t strayed;              /* what it has changed of how this thread calculates; see floating.h */
    int32_t look;                 /* whether the register is to be read for this after the next step */
} Component;

/* Calls to an FMU: those of the loop first, then those that the caller of the loop makes. */
typedef enum {
    SET_REAL, SET_INTEGER, SET_BOOLEAN, SET_DERIVATIVES, GET_REAL, GET_INTEGER, GET_BOOLEAN, DO_STEP,
    EXIT_INITIALIZATION, GET_BOOLEAN_STATUS, GET_REAL_STATUS, LOAD, INSTANTIATE, SETUP_EXPERIMENT,
    ENTER_INITIALIZATION, SET_STRING, GET_STATE, SET_STATE, FREE_STATE, TERMINATE, FREE_INSTANCE
} Call;

/* How far a run is and which call it is in, written before each call: what is left when an FMU ends the process. */
typedef struct {
    int64_t k;                    /* communication points reached; may be read while running */
    int64_t rows;                 /* recorded so far; 0 until initialisation is complete */
    int32_t component;            /* whose function has been called, -1: nobody's */
    int32_t call;                 /* which function */
} Place;

/* What an instance has said; its componentEnvironment. */
typedef struct {
    char error[2048];             /* all errors one after the other: the first often tells more than the last */
    char warning[2048];           /* the last warning */
    int64_t errors, warnings;
    int64_t error_more, warning_more; /* characters that had no room */
} Log;

typedef struct {
    Place *place;
    Component *component;         /* in the order of the system description */
    const int32_t *order;         /* in which they step in Gauss-Seidel */
    const Move *move;             /* how the values of t = 0 come about */
    Trigger *trigger;
    int32_t *acting, *acted;      /* whether each trigger acts at the point to which it was moved, and the one before */
    const Window *window;
    Span *span;
    Effect *effect;
    const Echo *echo;
    Loss *loss;
    int64_t *behind;              /* for each component, how many steps it has lost and not made up for */
    const int32_t *reach;         /* signals, as effects name them */
    const int32_t *readers;       /* who sees each signal: a sum of Reader */
    double *memory;               /* of effects and echoes */
    double *without;              /* room: signals as they would be without an effect */
    double *turned;               /* room: values that change places */
    Monitor *monitor;
    const Operation *operation;   /* of all programs */
    double *signal;               /* the values that left; then the true ones, then those ahead, where faults can change them */
    int32_t components, moves, signals, monitors, triggers;
    int32_t faults;               /* the first triggers are theirs */
    int32_t first_driven, driven; /* driven signals are the last ones */
    int32_t first_driven_effect, driven_effects;
    int32_t algorithm;            /* 0 Jacobi, 1 Gauss-Seidel */

    int32_t columns;
    const int32_t *column;        /* recorded signals */
    double *rows;                 /* room for every recorded communication point */
    int64_t record_every;
    int64_t calm;                 /* the point before which no trigger needs to be moved */

    double step, numerator, denominator; /* t_k = k * numerator / denominator */
    int32_t interrupt;            /* set to 1 from another thread to stop at the next communication point */
    int32_t status;               /* what the call at `place` returned when it failed; fmi2OK: it ended the run */
    int32_t ended;                /* the component that has ended the run (fmi2Terminated), -1: none */
    int32_t turn;                 /* the component at which a step was left that is not complete, -1: none */
    double last;                  /* s, how far a step that was discarded got, as the FMU says; else NaN */
} Master;

/* Return values of initialise and advance; after FAILED `place` says which call it was. */
enum { DONE, FAILED, INTERRUPTED };

int jacobi(Master *m);
int gauss_seidel(Master *m);

#endif
