/* A round: what one seed stands for. */
#ifndef PBF_TESTS_SOAK_ROUND_H
#define PBF_TESTS_SOAK_ROUND_H

#include <stdint.h>

enum { EVERY_ACTOR = -1 };

/* Runs it in this process, which it ends: with status 0, or as `found` does. */
_Noreturn void round_run(uint64_t seed, int only_actor);

#endif
