/* What an FMU may call: messages are kept, one for each instance; memory comes from the C library. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "master.h"

/* Put a sentence behind the others; when there is no room, in their place. */
static void append(char *text, size_t size, const char *sentence) {
    size_t length = strlen(text), more = strlen(sentence);
    if (length + more + 2 > size) length = 0;
    snprintf(text + length, size - length, length ? " %s" : "%s", sentence);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)instance;
    (void)category;
    Log *log = environment;
    if (!log || !message || status == fmi2OK || status == fmi2Pending) return;
    char sentence[2048];
    va_list arguments;
    va_start(arguments, message);
    vsnprintf(sentence, sizeof sentence, message, arguments);
    va_end(arguments);
    if (status == fmi2Warning) {
        memcpy(log->warning, sentence, sizeof sentence);
        log->warnings++;
    } else {
        append(log->error, sizeof log->error, sentence);
        log->errors++;
    }
}

/* The callbacks of one instance; `log` must stay where it is as long as the instance lives. */
API void prepare_callbacks(fmi2CallbackFunctions *callbacks, Log *log) {
    fmi2CallbackFunctions filled = {log_message, calloc, free, NULL, log};
    *callbacks = filled;
}
