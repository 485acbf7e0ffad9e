/* For the caller of the loop, who calls FMUs, too: from now on this thread calculates in the ordinary way. */
#include "floating.h"

#include "master.h"

/* In what it did not; so after a call to an FMU, what that has changed. */
API int32_t make_ordinary(void) {
    uint64_t way = floating();
    if (way == ORDINARY) return 0;
    set_floating(ORDINARY);
    return strayed(way);
}

/* How it calculates now, for whom it is to be put back. */
API uint64_t floating_now(void) { return floating(); }

API void put_back(uint64_t way) { set_floating(way); }
