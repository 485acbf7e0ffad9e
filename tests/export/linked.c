/* One of several FMUs in a program: it is run, and its outputs are printed. */
#include <math.h>
#include <stdio.h>

#include "fmi2Functions.h"

int RUN(const char *guid, const char *resources);

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment, (void)status, (void)category;
    fprintf(stderr, "%s: %s\n", name, message);
}

int RUN(const char *guid, const char *resources) {
    static const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, NULL};
    static const fmi2ValueReference references[] = {REFERENCES};
    enum { COUNT = sizeof references / sizeof references[0] };
    double values[COUNT];
    fmi2Component c = fmi2Instantiate("linked", fmi2CoSimulation, guid, resources, &functions, fmi2False, fmi2True);
    if (!c || fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) || fmi2EnterInitializationMode(c) ||
        fmi2ExitInitializationMode(c)) {
        return 1;
    }
    for (int k = 0; k < 20; k++) {
        if (fmi2DoStep(c, 0.1 * k, 0.1, fmi2True)) return 1;
    }
    if (fmi2GetReal(c, references, COUNT, values)) return 1;
    for (int i = 0; i < COUNT; i++) printf("%a\n", values[i]);
    fmi2FreeInstance(c);
    return 0;
}
