/* What the runtime must know about one model. The generated model.c defines `model`; all else here is generic. */
#ifndef NAVFMU_MODEL_H
#define NAVFMU_MODEL_H

#include <stdint.h>

#include "life.h"

/* Every variable of any type is one double in the vector v; its value reference is its index there.
   These are the types; further bits of a variable's access are the phases (life.h) in which it may be set. */
enum {
    REAL = 1,
    INTEGER = 2,
    BOOLEAN = 4,
    TUNABLE = 256,     /* its range is checked when it is set */
    ENUMERATION = 512, /* and when a task assigns it */
    STRING = 1024,     /* its number says which of the texts it is */
    TYPES = REAL | INTEGER | BOOLEAN | STRING
};

typedef struct {
    const char *name;
    const char *unit; /* "" for none */
    double start;
    double min, max;  /* -INFINITY, INFINITY where there is no bound */
    int is_parameter;
} Variable;

typedef struct Table Table; /* table.h */

/* Calculates r from all variables, fresh random numbers, the time, what Fix has calculated, and what is found in tables;
   work is memory for what is on the way to it. Neither overlaps anything else. */
typedef void Evaluate(const double *v, const double *noise, const double *time, const double *fixed, Table *tables,
                      double *work, double *r);

/* Calculates from the variables what stands once initialisation has ended. */
typedef void Fix(const double *v, Table *tables, double *work, double *fixed);

/* Calculates, from the inputs in v, the outputs as they leave at communication point k, and what is remembered for later
   points. The last call at a point counts. */
typedef void Through(double *v, double *memory, int64_t k);

typedef enum { ON_START, ON_CLOCK, ON_NEW } TaskKind;

/* One piece of behaviour: evaluate, then v[targets[i]] = r[i]. */
typedef struct {
    const char *name;
    TaskKind kind;
    Evaluate *evaluate;
    int normals;      /* fresh standard normal numbers that it takes */
    uint64_t stream;  /* third word of their counter, distinct for each task */
    int clock;        /* ON_CLOCK: which of model.clocks drives it; ON_NEW: whose period it is told */
    int sequence;     /* ON_NEW: index in v of the bundle's sequence number, */
    int validity;     /* of its time of validity, */
    int lost;         /* and of the count of lost samples (or -1) */
    int target_count;
    const int *targets;
    int whole_count;  /* those of its results that are Integers, */
    const int *wholes;
} Task;

/* A requirement on parameters: it sets r[0] to what is not 0, else the message with each "{}" replaced by a value. */
typedef struct {
    Evaluate *holds;
    const char *message;
    const int *values; /* indices in v, in order of the "{}" */
} Check;

/* Columns of numbers in a file of NumPy's format in resources/: rows of a table, or two axes and surfaces over them. */
typedef struct {
    const char *file;
    const char *header;        /* of the file; the bytes 1 and 2 stand for sizes */
    int grid;
    int columns;
    const char *const *labels;
    int key_count;
    const int *keys;           /* the columns that increase */
    int text;                  /* which of the texts names another file to read instead, or -1 */
} TableInfo;

/* The text of a String. */
typedef struct {
    const char *start;
    int longest; /* bytes, without the 0 behind them */
    int place;   /* among the bytes of all texts */
} Text;

/* When tasks run: at offset + k * period since the start. */
typedef struct {
    int period, offset; /* indices in v of times in s; offset is -1 where there is none */
} ClockInfo;

typedef struct {
    const char *identifier;
    const char *guid;
    int variable_count;
    const unsigned short *access; /* of each variable: the bits above */
    const Variable *variables;
    int task_count;
    const Task *tasks;
    int check_count;
    const Check *checks;
    int text_count, text_bytes;
    const Text *texts;
    int clock_count;
    const ClockInfo *clocks;
    int table_count;
    const TableInfo *tables;
    int input_count;             /* continuous Real inputs: those that may have a derivative */
    const int *inputs;
    const int *input_slot;       /* for each variable: its place among them, or -1 */
    int seed, stream;            /* index in v of the parameters that key the noise, or -1 */
    int work_count;              /* how many numbers the functions need to work in */
    int fixed_count;             /* how many numbers fix calculates */
    Fix *fix;
    Through *through;            /* or NULL */
    int direct;                  /* its outputs follow inputs that are set at the same communication point */
    int memory_count;            /* numbers that it remembers, */
    const double *memory;        /* as they are before the start */
    double step;                 /* the only communication step that it knows (s); 0: any will do */
    int has_calculated;          /* some variable is calculated in initialisation mode */
    int most_normals, most_targets; /* sizes of what the functions read and write */
} Model;

static const Model model; /* defined in model.c */

#endif
