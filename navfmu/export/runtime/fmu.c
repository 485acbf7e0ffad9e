/* The whole FMU as one unit of compilation: the compiler sees the model's constants and drops what it does not use.
   Only the functions of FMI have names outside of it. Where several FMUs are linked into one program, each is compiled
   with FMI2_FUNCTION_PREFIX set to its model identifier and an underscore: -DFMI2_FUNCTION_PREFIX=imu_ */
#define NOISE_LINKAGE static

#include "model.c"

#include "noise.c"
#include "table.c"
#include "instance.c"
#include "fmi2.c"
