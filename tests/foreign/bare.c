/* stepper.c as an FMU whose library has no function of what it cannot do: FMI 2.0 asks for all of them. */
#include "fmi2Functions.h"

#undef fmi2GetFMUstate
#undef fmi2SetFMUstate
#undef fmi2FreeFMUstate
#undef fmi2SetRealInputDerivatives
#define fmi2GetFMUstate no_state_to_get
#define fmi2SetFMUstate no_state_to_set
#define fmi2FreeFMUstate no_state_to_free
#define fmi2SetRealInputDerivatives no_slope_to_set
#include "stepper.c"
