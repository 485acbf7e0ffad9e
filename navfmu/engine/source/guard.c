/* Who ended the process: an FMU that calls exit or crashes takes everything with it and leaves no word of its own. */
#define _POSIX_C_SOURCE 200809L /* sigaction */
#include "master.h"

#if defined(_WIN32)

API void watch(const Place *place, const char *const *component, const char *const *call, double step) {
    (void)place, (void)component, (void)call, (void)step;
}

#else

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define FAILED_COMMAND 2 /* exit code of whatever an FMU ends from inside */

/* The run whose FMUs this thread is calling. */
static _Thread_local struct {
    const Place *place;
    const char *const *component, *const *call;
    double step; /* s */
} run;

static const int SIGNALS[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
#define COUNT (sizeof SIGNALS / sizeof *SIGNALS)
static struct sigaction before[COUNT];

static int inside(void) { return run.place && run.place->component >= 0; }

static void say(const char *what) {
    static int told; /* once is enough, when several threads end in one FMU */
    if (!inside() || __atomic_exchange_n(&told, 1, __ATOMIC_SEQ_CST)) return;
    const Place *place = run.place;
    char text[512];
    int length = snprintf(text, sizeof text, "navfmu: component '%s' in %s at t = %.9g s: the FMU %s\n",
                          run.component[place->component], run.call[place->call], (double)place->k * run.step, what);
    if (length > (int)sizeof text - 1) length = (int)sizeof text - 1;
    if (write(STDERR_FILENO, text, (size_t)length) < 0) return;
}

static void at_exit(void) {
    if (!inside()) return;
    say("ended the process");
    _exit(FAILED_COMMAND);
}

/* Say it, then let whoever handled the signal before do so: as a rule the process ends. */
static void on_signal(int number) {
    say(number == SIGABRT ? "aborted" : number == SIGFPE ? "crashed (SIGFPE)" : "crashed (a wrong access to memory)");
    for (size_t i = 0; i < COUNT; i++)
        if (SIGNALS[i] == number) sigaction(number, &before[i], NULL);
    raise(number);
}

/* From now on this thread calls the FMUs of a run (or, with NULL, of none any more). */
API void watch(const Place *place, const char *const *component, const char *const *call, double step) {
    static int prepared;
    static _Thread_local int registered; /* once a thread: two may call exit at once, and each takes one of the list */
    run.component = component, run.call = call, run.step = step;
    run.place = place;
    if (!place) return;
    if (!registered) registered = !atexit(at_exit);
    if (__atomic_exchange_n(&prepared, 1, __ATOMIC_SEQ_CST)) return;
    struct sigaction action = {.sa_handler = on_signal};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < COUNT; i++) sigaction(SIGNALS[i], &action, &before[i]);
}

#endif
