/* What an FMU may call: messages are kept, one for each instance; memory comes from the C library. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "master.h"

enum { ROOM = 2048 };

/* Characters of a text in UTF-8. */
static int64_t characters(const char *text) {
    int64_t count = 0;
    for (; *text; text++) count += (*text & 0xC0) != 0x80;
    return count;
}

/* Cut off the last character, which may be there in part only. */
static void drop_last(char *text) {
    size_t length = strlen(text);
    while (length && (text[--length] & 0xC0) == 0x80) {}
    text[length] = '\0';
}

/* Put a sentence behind the others, or, when there is no room, in their place; whether it is behind them. */
static int append(char *text, size_t size, const char *sentence) {
    size_t length = strlen(text), more = strlen(sentence);
    if (length + more + 2 > size) length = 0;
    snprintf(text + length, size - length, length ? " %s" : "%s", sentence);
    return length > 0;
}

/* Write a message, and return how many of its characters there is no room for. */
static int64_t write_message(char *sentence, const char *message, va_list arguments, va_list again) {
    int length = vsnprintf(sentence, ROOM, message, arguments);
    if (length < ROOM) return 0;
    drop_last(sentence);
    char *whole = malloc((size_t)length + 1);
    if (!whole) return length - (int64_t)strlen(sentence);
    vsnprintf(whole, (size_t)length + 1, message, again);
    int64_t more = characters(whole) - characters(sentence);
    free(whole);
    return more;
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)instance;
    (void)category;
    Log *log = environment;
    if (!log || !message || status == fmi2OK || status == fmi2Pending) return;
    char sentence[ROOM];
    va_list arguments, again;
    va_start(arguments, message);
    va_start(again, message);
    int64_t more = write_message(sentence, message, arguments, again);
    va_end(again);
    va_end(arguments);
    if (status == fmi2Warning) {
        memcpy(log->warning, sentence, sizeof sentence);
        log->warning_more = more;
        log->warnings++;
    } else {
        int behind = append(log->error, sizeof log->error, sentence);
        log->error_more = more + (behind ? log->error_more : 0);
        log->errors++;
    }
}

/* The callbacks of one instance; `log` must stay where it is as long as the instance lives. */
API void prepare_callbacks(fmi2CallbackFunctions *callbacks, Log *log) {
    fmi2CallbackFunctions filled = {log_message, calloc, free, NULL, log};
    *callbacks = filled;
}
