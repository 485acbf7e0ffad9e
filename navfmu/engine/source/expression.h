/* What an expression makes of the signals: navfmu/expressions/program.py has the same operations. */
#ifndef NAVFMU_EXPRESSION_H
#define NAVFMU_EXPRESSION_H

#include <math.h>
#include <stdint.h>

typedef enum {
    CONSTANT, LOAD_SIGNAL, TIME, ACTIVE, NEGATE, ABS, SQUARE, SQRT, NOT, /* these push a value or change the top one */
    PLUS, MINUS, MULTIPLY, DIVIDE, MINIMUM, MAXIMUM, LESS, AT_MOST, GREATER, AT_LEAST, EQUAL, DIFFERENT, AND, OR
} OperationKind;

typedef struct {
    int32_t kind;
    int32_t place;                /* LOAD_SIGNAL: in the signals; ACTIVE: of the fault, -1: any */
    double number;                /* CONSTANT */
} Operation;

enum { DEEPEST = 64 };            /* values on the stack at a time; no program takes more */

/* The value of `count` operations at the time t (s); `active` has whether each fault acts. */
static inline double value_of(const Operation *o, int count, const double *signal, double t, const int32_t *active,
                              int faults) {
    double stack[DEEPEST], *top = stack - 1;
    for (const Operation *end = o + count; o < end; o++) {
        double right;
        switch (o->kind) {
        case CONSTANT: *++top = o->number; continue;
        case LOAD_SIGNAL: *++top = signal[o->place]; continue;
        case TIME: *++top = t; continue;
        case ACTIVE: {
            int acts = o->place >= 0 && active[o->place];
            for (int i = 0; o->place < 0 && i < faults; i++) acts |= active[i];
            *++top = acts;
            continue;
        }
        case NEGATE: *top = -*top; continue;
        case ABS: *top = fabs(*top); continue;
        case SQUARE: *top = *top * *top; continue;
        case SQRT: *top = sqrt(*top); continue;
        case NOT: *top = *top == 0.0; continue;
        default: break;
        }
        right = *top--;
        switch (o->kind) {
        case PLUS: *top += right; break;
        case MINUS: *top -= right; break;
        case MULTIPLY: *top *= right; break;
        case DIVIDE: *top /= right; break;
        case MINIMUM: *top = isnan(*top) || isnan(right) ? *top + right : right < *top ? right : *top; break;
        case MAXIMUM: *top = isnan(*top) || isnan(right) ? *top + right : right > *top ? right : *top; break;
        case LESS: *top = *top < right; break;
        case AT_MOST: *top = *top <= right; break;
        case GREATER: *top = *top > right; break;
        case AT_LEAST: *top = *top >= right; break;
        case EQUAL: *top = *top == right; break;
        case DIFFERENT: *top = *top != right; break;
        case AND: *top = *top != 0.0 && right != 0.0; break;
        case OR: *top = *top != 0.0 || right != 0.0; break;
        }
    }
    return *top;
}

#endif
