/* Counter-based noise: the same seed, stream and count give the same numbers, in whatever order they are asked for. */
#ifndef NAVFMU_NOISE_H
#define NAVFMU_NOISE_H

#include <stdint.h>

#ifndef NOISE_LINKAGE
#define NOISE_LINKAGE
#endif

/* Philox4x64-10 of Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3" (SC 2011). */
NOISE_LINKAGE void philox(const uint64_t counter[4], const uint64_t key[2], uint64_t out[4]);

/* Fill z with standard normal numbers of the sample k of a task (Box-Muller on the blocks 0, 1, ... of its counter). */
NOISE_LINKAGE void standard_normals(const uint64_t key[2], uint64_t k, uint64_t task, double *z, int count);

#endif
