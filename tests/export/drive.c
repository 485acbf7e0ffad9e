/* Calls one FMU, linked in, in every way a host might: in order, out of order, with nonsense. Run under sanitizers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmu.c"

static unsigned long long random_state = 1;
static size_t logged = 0;

static unsigned draw(unsigned below) {
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(random_state >> 33) % below;
}

static double draw_value(void) {
    static const double odd[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e308, -1e308, 1e-320, 2147483648.0};
    if (draw(4) == 0) return odd[draw(sizeof odd / sizeof odd[0])];
    return (draw(2000001) - 1e6) * 1e-5;
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment, (void)status;
    logged += strlen(name) + strlen(category) + strlen(message);
}

static void any_call(fmi2Component c, fmi2FMUstate *state, double *time) {
    enum { MOST = 8 };
    fmi2ValueReference vr[MOST];
    double real[MOST];
    int whole[MOST], order[MOST];
    static const char *const texts[] = {"", "TUL", "eight by", "a text that is longer than its place", NULL};
    fmi2String text[MOST];
    size_t count = draw(MOST + 1);
    for (size_t i = 0; i < MOST; i++) {
        vr[i] = draw(50) == 0 ? draw(0x7fffffff) * 2 : draw((unsigned)model.variable_count);
        real[i] = draw_value();
        text[i] = texts[draw(sizeof texts / sizeof texts[0])];
        whole[i] = draw(3) ? (int)draw(10) : (int)(draw(0xffffffffu));
        order[i] = draw(10) ? 1 : (int)draw(3);
    }
    switch (draw(23)) {
        case 0: case 1: fmi2SetReal(c, vr, count, real); break;
        case 2: fmi2SetInteger(c, vr, count, whole); break;
        case 3: fmi2SetBoolean(c, vr, count, whole); break;
        case 4: fmi2GetReal(c, vr, count, real); break;
        case 5: fmi2GetInteger(c, vr, count, whole); break;
        case 6: fmi2GetBoolean(c, vr, count, whole); break;
        case 7: fmi2SetRealInputDerivatives(c, vr, count, order, real); break;
        case 8: fmi2SetString(c, vr, count, text); break;
        case 9: fmi2GetFMUstate(c, state); break;
        case 10: if (*state) fmi2SetFMUstate(c, *state); break;
        case 11: fmi2FreeFMUstate(c, state); break;
        case 12: {
            size_t size = 0;
            if (!*state || fmi2SerializedFMUstateSize(c, *state, &size) != fmi2OK) break;
            char *bytes = malloc(size);
            fmi2FMUstate copy = NULL;
            fmi2SerializeFMUstate(c, *state, bytes, size);
            fmi2DeSerializeFMUstate(c, bytes, size - draw(2), &copy);
            fmi2FreeFMUstate(c, &copy);
            free(bytes);
            break;
        }
        case 13: fmi2SetDebugLogging(c, (int)draw(2), 0, NULL); break;
        case 14: if (draw(50) == 0) fmi2Reset(c); break;
        case 15: if (draw(100) == 0) fmi2Terminate(c); break;
        case 16: fmi2GetRealStatus(c, fmi2LastSuccessfulTime, time); break;
        case 17: fmi2DoStep(c, draw_value(), draw(2) ? -1.0 : NAN, 1); break;
        case 18:
            if (fmi2GetString(c, vr, count, text) != fmi2OK) break;
            for (size_t i = 0; i < count; i++) logged += strlen(text[i]);
            break;
        default: {
            double h = draw(1000) * 1e-3;
            if (fmi2DoStep(c, *time, h, 1) == fmi2OK) *time += h;
        }
    }
}

int main(int count, char **arguments) {
    fmi2CallbackFunctions functions = {logger, calloc, free, NULL, NULL};
    const char *resources = count > 1 ? arguments[1] : NULL;
    fmi2FreeInstance(NULL);
    if (fmi2Instantiate("wrong", fmi2CoSimulation, "{wrong}", resources, &functions, 0, 1)) return 1;
    if (model.table_count && fmi2Instantiate("bare", fmi2CoSimulation, model.guid, NULL, &functions, 0, 1)) return 2;
    for (int round = 0; round < 60; round++) {
        fmi2Component c = fmi2Instantiate("driven", fmi2CoSimulation, model.guid, resources, &functions, 0, round % 2);
        fmi2FMUstate state = NULL;
        double time = 0.0;
        if (!c) return 3;
        if (round % 3) { /* an orderly beginning */
            fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0);
            fmi2EnterInitializationMode(c);
            for (fmi2ValueReference i = 0; i < (unsigned)model.variable_count; i++) {
                double value;
                fmi2GetReal(c, &i, 1, &value);
            }
            if (fmi2ExitInitializationMode(c) != fmi2OK) return 4;
        }
        for (int i = 0; i < 400; i++) {
            if (round % 3 == 0 && i % 40 == 10) fmi2EnterInitializationMode(c);
            if (round % 3 == 0 && i % 40 == 30) fmi2ExitInitializationMode(c);
            any_call(c, &state, &time);
        }
        fmi2FreeFMUstate(c, &state);
        fmi2FreeInstance(c);
    }
    printf("clean %d\n", logged > 0);
    return 0;
}
