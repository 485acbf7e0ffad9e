/* What an FMU may call: messages are kept, one for each instance; memory comes from the C library. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "master.h"

/* The last error and the last warning of an instance; its componentEnvironment. */
typedef struct {
    char error[2048];
    char warning[2048];
    int64_t errors, warnings;
} Log;

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)instance;
    (void)category;
    Log *log = environment;
    if (!log || !message || status == fmi2OK || status == fmi2Pending) return;
    va_list arguments;
    va_start(arguments, message);
    if (status == fmi2Warning) {
        vsnprintf(log->warning, sizeof log->warning, message, arguments);
        log->warnings++;
    } else {
        vsnprintf(log->error, sizeof log->error, message, arguments);
        log->errors++;
    }
    va_end(arguments);
}

/* The callbacks of one instance; `log` must stay where it is as long as the instance lives. */
API void prepare_callbacks(fmi2CallbackFunctions *callbacks, Log *log) {
    fmi2CallbackFunctions filled = {log_message, calloc, free, NULL, log};
    *callbacks = filled;
}
