/* The smallest possible host of an FMI 2.0 co-simulation FMU, for Linux and Windows: loads the library, sets inputs,
   makes steps and prints outputs as hexadecimal floating-point numbers, so that nothing is lost in printing.

   driver LIBRARY GUID RESOURCES STEP STEPS EVERY [i REFERENCE VALUE]... [o REFERENCE]...
   i sets a Real before initialisation; k an Integer, b a Boolean; o prints a Real after each EVERY steps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) (void *)LoadLibraryA(path)
#define FIND(library, name) (void *)GetProcAddress((HMODULE)(library), name)
#define WHY() "LoadLibrary failed"
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#define WHY() dlerror()
#endif
#include "fmi2Functions.h"

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
    (void)environment;
    fprintf(stderr, "%s, %s, status %d: %s\n", instance, category, status, message);
}

static void *library;

static void *function(const char *name) {
    void *found = FIND(library, name);
    if (!found) {
        fprintf(stderr, "%s is missing\n", name);
        exit(3);
    }
    return found;
}

static void must(fmi2Status status, const char *call) {
    if (status == fmi2OK) return;
    fprintf(stderr, "%s returned %d\n", call, status);
    exit(4);
}

int main(int count, char **arguments) {
    if (count < 7) return 2;
    library = OPEN(arguments[1]);
    if (!library) {
        fprintf(stderr, "%s: %s\n", arguments[1], WHY());
        return 3;
    }
    fmi2InstantiateTYPE *instantiate = function("fmi2Instantiate");
    fmi2SetupExperimentTYPE *setup = function("fmi2SetupExperiment");
    fmi2EnterInitializationModeTYPE *enter = function("fmi2EnterInitializationMode");
    fmi2ExitInitializationModeTYPE *leave = function("fmi2ExitInitializationMode");
    fmi2DoStepTYPE *do_step = function("fmi2DoStep");
    fmi2SetRealTYPE *set_real = function("fmi2SetReal");
    fmi2SetIntegerTYPE *set_integer = function("fmi2SetInteger");
    fmi2SetBooleanTYPE *set_boolean = function("fmi2SetBoolean");
    fmi2GetRealTYPE *get_real = function("fmi2GetReal");
    fmi2TerminateTYPE *terminate = function("fmi2Terminate");
    fmi2FreeInstanceTYPE *release = function("fmi2FreeInstance");

    fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2Component it = instantiate("it", fmi2CoSimulation, arguments[2], arguments[3], &callbacks, fmi2False, fmi2False);
    if (!it) return 4;
    double step = strtod(arguments[4], NULL);
    int steps = atoi(arguments[5]), every = atoi(arguments[6]);
    must(setup(it, fmi2False, 0.0, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    for (int i = 7; i + 2 < count; i++) {
        fmi2ValueReference reference = (fmi2ValueReference)atol(arguments[i + 1]);
        fmi2Real real = strtod(arguments[i + 2], NULL);
        fmi2Integer integer = (fmi2Integer)real;
        if (!strcmp(arguments[i], "i")) must(set_real(it, &reference, 1, &real), "fmi2SetReal");
        if (!strcmp(arguments[i], "k")) must(set_integer(it, &reference, 1, &integer), "fmi2SetInteger");
        if (!strcmp(arguments[i], "b")) must(set_boolean(it, &reference, 1, &integer), "fmi2SetBoolean");
    }
    must(enter(it), "fmi2EnterInitializationMode");
    must(leave(it), "fmi2ExitInitializationMode");
    for (int k = 1; k <= steps; k++) {
        must(do_step(it, (k - 1) * step, step, fmi2True), "fmi2DoStep");
        if (k % every) continue;
        for (int i = 7; i + 1 < count; i++) {
            if (strcmp(arguments[i], "o")) continue;
            fmi2ValueReference reference = (fmi2ValueReference)atol(arguments[i + 1]);
            fmi2Real value;
            must(get_real(it, &reference, 1, &value), "fmi2GetReal");
            printf("%a ", value);
        }
        printf("\n");
    }
    must(terminate(it), "fmi2Terminate");
    release(it);
    return 0;
}
