/* The whole FMU as one unit of compilation: the compiler sees the model's constants and drops what it does not use. */
#include "model.c"

#include "noise.c"
#include "table.c"
#include "instance.c"
#include "fmi2.c"
