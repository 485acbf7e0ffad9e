/* How a thread calculates with doubles. Ordinary is: rounded to the nearest, subnormal numbers kept, no trap. An FMU, or
   a library that it loads, may leave it another way, and whatever is calculated then has other bits. */
#ifndef NAVFMU_FLOATING_H
#define NAVFMU_FLOATING_H

#include <stdint.h>

/* In what a way of calculating is not the ordinary one; to be added. */
typedef enum { ROUNDING = 1, SUBNORMALS = 2, TRAPS = 4 } Stray;

#if defined(__x86_64__)

/* MXCSR without its flags; above it the x87 control word, which long double obeys, where there is a long double. */
#define ROUNDING_BITS 0x0F0000006000u
#define TRAP_BITS 0x003F00001F80u
#if defined(_WIN32)
#define CONTROLS 0xFFC0u
#define ORDINARY 0x1F80u
#else
#define CONTROLS 0x0F3F0000FFC0u
#define ORDINARY 0x033F00001F80u
#endif

static inline uint64_t floating(void) {
    uint32_t sse;
    uint16_t x87 = 0;
    __asm__ volatile("stmxcsr %0" : "=m"(sse));
#if !defined(_WIN32)
    __asm__ volatile("fnstcw %0" : "=m"(x87));
#endif
    return ((uint64_t)x87 << 32 | sse) & CONTROLS;
}

/* Whether doubles are calculated in another way. The x87 unit, which doubles do not use, is not asked: that takes longer
   than all the rest, and is done now and then. */
static inline int uncommon(void) {
    uint32_t sse;
    __asm__ volatile("stmxcsr %0" : "=m"(sse));
    return ((sse ^ ORDINARY) & 0xFFC0u) != 0;
}

static inline void set_floating(uint64_t to) {
    uint32_t sse = (uint32_t)to;
    __asm__ volatile("ldmxcsr %0" : : "m"(sse));
#if !defined(_WIN32)
    uint16_t x87 = (uint16_t)(to >> 32) | 0x40; /* a bit that is always set */
    __asm__ volatile("fldcw %0" : : "m"(x87));
#endif
}

#elif defined(__aarch64__)

#define ROUNDING_BITS 0x00C00000u
#define TRAP_BITS 0x00009F00u
#define CONTROLS 0x03C89F07u /* of FPCR */
#define ORDINARY 0u

static inline uint64_t floating(void) {
    uint64_t fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    return fpcr & CONTROLS;
}

static inline int uncommon(void) { return floating() != ORDINARY; }
static inline void set_floating(uint64_t to) { __asm__ volatile("msr fpcr, %0" : : "r"(to)); }

#else /* what C knows of it: rounding */

#include <fenv.h>

#define ROUNDING_BITS (~(uint64_t)0)
#define TRAP_BITS 0u
#define ORDINARY ((uint64_t)FE_TONEAREST)

static inline uint64_t floating(void) { return (uint64_t)fegetround(); }
static inline int uncommon(void) { return floating() != ORDINARY; }
static inline void set_floating(uint64_t to) { fesetround((int)to); }

#endif

/* In what a way differs from the ordinary one. */
static inline int32_t strayed(uint64_t way) {
    uint64_t other = way ^ ORDINARY;
    return (other & ROUNDING_BITS ? ROUNDING : 0) | (other & TRAP_BITS ? TRAPS : 0) |
           (other & ~(ROUNDING_BITS | TRAP_BITS) ? SUBNORMALS : 0);
}

#endif
