/* Where the fields of the structures lie, so that a caller in another language can see that it means the same ones. */
#include <stddef.h>

#include "floating.h"
#include "master.h"

typedef struct {
    const char *structure, *field; /* "" for the structure itself */
    int32_t offset, size;          /* bytes; of an enumeration: value and 0 */
} Field;

#define WHOLE(structure) {#structure, "", 0, sizeof(structure)}
#define FIELD(structure, field) {#structure, #field, offsetof(structure, field), sizeof(((structure *)0)->field)}
#define VALUE(enumeration, value) {#enumeration, #value, value, 0}

static const Field FIELDS[] = {
    WHOLE(Window), FIELD(Window, first), FIELD(Window, end), FIELD(Window, start),

    WHOLE(Moment), FIELD(Moment, acts), FIELD(Moment, since), FIELD(Moment, start),

    WHOLE(Trigger), FIELD(Trigger, kind), FIELD(Trigger, window), FIELD(Trigger, last),
    FIELD(Trigger, first_operation), FIELD(Trigger, operations), FIELD(Trigger, first_span), FIELD(Trigger, room),
    FIELD(Trigger, spans), FIELD(Trigger, needed), FIELD(Trigger, row), FIELD(Trigger, lasts), FIELD(Trigger, now),
    FIELD(Trigger, before),

    WHOLE(Span), FIELD(Span, first), FIELD(Span, end),

    WHOLE(Effect), FIELD(Effect, kind), FIELD(Effect, slot), FIELD(Effect, trigger), FIELD(Effect, foreseen),
    FIELD(Effect, amount), FIELD(Effect, other), FIELD(Effect, memory), FIELD(Effect, size),
    FIELD(Effect, first_pair), FIELD(Effect, pairs), FIELD(Effect, multiplier), FIELD(Effect, divisor),
    FIELD(Effect, seed), FIELD(Effect, stream), FIELD(Effect, lane), FIELD(Effect, first_reach),
    FIELD(Effect, reaches), FIELD(Effect, before), FIELD(Effect, first_echo), FIELD(Effect, echoes),
    FIELD(Effect, followed), FIELD(Effect, seen),

    WHOLE(Echo), FIELD(Echo, effect), FIELD(Echo, memory),

    WHOLE(Loss), FIELD(Loss, component), FIELD(Loss, trigger), FIELD(Loss, seen),

    WHOLE(Monitor), FIELD(Monitor, counts_from), FIELD(Monitor, fault), FIELD(Monitor, first_operation), FIELD(Monitor, operations), FIELD(Monitor, first_when),
    FIELD(Monitor, whens), FIELD(Monitor, least), FIELD(Monitor, most), FIELD(Monitor, begin), FIELD(Monitor, end),
    FIELD(Monitor, origin), FIELD(Monitor, tolerated), FIELD(Monitor, points), FIELD(Monitor, not_finite), FIELD(Monitor, outside),
    FIELD(Monitor, episodes), FIELD(Monitor, row), FIELD(Monitor, longest), FIELD(Monitor, first_outside),
    FIELD(Monitor, last_outside), FIELD(Monitor, first_inside), FIELD(Monitor, last_inside), FIELD(Monitor,
    worst_at), FIELD(Monitor, latest), FIELD(Monitor, latest_from), FIELD(Monitor, back), FIELD(Monitor, settled),
    FIELD(Monitor, worst), FIELD(Monitor, excess), FIELD(Monitor, squares), FIELD(Monitor, greatest),

    WHOLE(Operation), FIELD(Operation, kind), FIELD(Operation, place), FIELD(Operation, number),

    WHOLE(Move), FIELD(Move, kind), FIELD(Move, component), FIELD(Move, type), FIELD(Move, reference),
    FIELD(Move, slot), FIELD(Move, factor), FIELD(Move, offset),

    WHOLE(Inputs), FIELD(Inputs, count), FIELD(Inputs, scaled), FIELD(Inputs, references), FIELD(Inputs, source),
    FIELD(Inputs, factor), FIELD(Inputs, offset),

    WHOLE(Component), FIELD(Component, instance), FIELD(Component, set_real), FIELD(Component, set_integer),
    FIELD(Component, set_boolean), FIELD(Component, set_derivatives), FIELD(Component, get_real),
    FIELD(Component, get_integer), FIELD(Component, get_boolean), FIELD(Component, do_step),
    FIELD(Component, exit_initialization), FIELD(Component, get_boolean_status), FIELD(Component, get_real_status),
    FIELD(Component, never_back), FIELD(Component, smooth),
    FIELD(Component, real), FIELD(Component, integer), FIELD(Component, boolean), FIELD(Component, ahead),
    FIELD(Component, first_order), FIELD(Component, start), FIELD(Component, slope), FIELD(Component, real_value),
    FIELD(Component, integer_value), FIELD(Component, boolean_value), FIELD(Component, reals),
    FIELD(Component, integers), FIELD(Component, booleans), FIELD(Component, first_signal),
    FIELD(Component, real_reference), FIELD(Component, integer_reference), FIELD(Component, boolean_reference),
    FIELD(Component, whole), FIELD(Component, first_effect), FIELD(Component, effects), FIELD(Component, exposures),
    FIELD(Component, exposed), FIELD(Component, foreseen), FIELD(Component, copied), FIELD(Component, searched),
    FIELD(Component, first_loss), FIELD(Component, losses), FIELD(Component, warnings),
    FIELD(Component, strayed), FIELD(Component, look),

    WHOLE(Place), FIELD(Place, k), FIELD(Place, rows), FIELD(Place, component), FIELD(Place, call),

    WHOLE(Log), FIELD(Log, error), FIELD(Log, warning), FIELD(Log, errors), FIELD(Log, warnings),
    FIELD(Log, error_more), FIELD(Log, warning_more),

    WHOLE(Master), FIELD(Master, place), FIELD(Master, component), FIELD(Master, order), FIELD(Master, move),
    FIELD(Master, trigger), FIELD(Master, acting), FIELD(Master, acted), FIELD(Master, window), FIELD(Master, span), FIELD(Master, effect), FIELD(Master, echo), FIELD(Master, loss),
    FIELD(Master, behind), FIELD(Master, reach),
    FIELD(Master, readers), FIELD(Master, memory), FIELD(Master, without), FIELD(Master, turned), FIELD(Master, monitor),
    FIELD(Master, operation), FIELD(Master, signal),
    FIELD(Master, components), FIELD(Master, moves), FIELD(Master, signals), FIELD(Master, monitors),
    FIELD(Master, triggers), FIELD(Master, faults),
    FIELD(Master, first_driven),
    FIELD(Master, driven), FIELD(Master, first_driven_effect), FIELD(Master, driven_effects),
    FIELD(Master, algorithm), FIELD(Master, columns), FIELD(Master, column), FIELD(Master, rows),
    FIELD(Master, record_every), FIELD(Master, calm), FIELD(Master, step), FIELD(Master, numerator), FIELD(Master, denominator),
    FIELD(Master, interrupt), FIELD(Master, status), FIELD(Master, ended), FIELD(Master, turn), FIELD(Master, last),

    VALUE(TriggerKind, LISTED), VALUE(TriggerKind, WHEN), VALUE(TriggerKind, DURING),

    VALUE(Origin, START), VALUE(Origin, ONSET), VALUE(Origin, OVER),

    VALUE(EffectKind, ADD), VALUE(EffectKind, RAMP), VALUE(EffectKind, SET), VALUE(EffectKind, HOLD),
    VALUE(EffectKind, NOISE), VALUE(EffectKind, SCALE), VALUE(EffectKind, AFFINE), VALUE(EffectKind, CLIP),
    VALUE(EffectKind, QUANTISE), VALUE(EffectKind, SPIKE), VALUE(EffectKind, GARBAGE), VALUE(EffectKind, DELAY),
    VALUE(EffectKind, SLOW), VALUE(EffectKind, SWAP), VALUE(EffectKind, TAKE),

    VALUE(Reader, NOW), VALUE(Reader, NEXT), VALUE(Reader, AHEAD), VALUE(Reader, RECORDED), VALUE(Reader, OBSERVED),

    VALUE(OperationKind, CONSTANT), VALUE(OperationKind, LOAD_SIGNAL), VALUE(OperationKind, TIME),
    VALUE(OperationKind, ACTIVE), VALUE(OperationKind, NEGATE), VALUE(OperationKind, ABS), VALUE(OperationKind,
    SQUARE), VALUE(OperationKind, SQRT), VALUE(OperationKind, NOT), VALUE(OperationKind, PLUS), VALUE(OperationKind,
    MINUS), VALUE(OperationKind, MULTIPLY), VALUE(OperationKind, DIVIDE), VALUE(OperationKind, MINIMUM),
    VALUE(OperationKind, MAXIMUM), VALUE(OperationKind, LESS), VALUE(OperationKind, AT_MOST), VALUE(OperationKind,
    GREATER), VALUE(OperationKind, AT_LEAST), VALUE(OperationKind, EQUAL), VALUE(OperationKind, DIFFERENT),
    VALUE(OperationKind, AND), VALUE(OperationKind, OR),

    VALUE(MoveKind, READ), VALUE(MoveKind, GIVE), VALUE(MoveKind, LEAVE),

    VALUE(Stray, ROUNDING), VALUE(Stray, SUBNORMALS), VALUE(Stray, TRAPS),

    VALUE(Call, SET_REAL), VALUE(Call, SET_INTEGER), VALUE(Call, SET_BOOLEAN), VALUE(Call, SET_DERIVATIVES),
    VALUE(Call, GET_REAL), VALUE(Call, GET_INTEGER), VALUE(Call, GET_BOOLEAN), VALUE(Call, DO_STEP),
    VALUE(Call, EXIT_INITIALIZATION), VALUE(Call, GET_BOOLEAN_STATUS), VALUE(Call, GET_REAL_STATUS), VALUE(Call, LOAD), VALUE(Call, INSTANTIATE), VALUE(Call, SETUP_EXPERIMENT),
    VALUE(Call, ENTER_INITIALIZATION), VALUE(Call, SET_STRING), VALUE(Call, GET_STATE), VALUE(Call, SET_STATE),
    VALUE(Call, FREE_STATE), VALUE(Call, TERMINATE), VALUE(Call, FREE_INSTANCE),
};

/* The table and the number of its rows. */
API const Field *layout(int32_t *rows) {
    *rows = (int32_t)(sizeof FIELDS / sizeof *FIELDS);
    return FIELDS;
}
