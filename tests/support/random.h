/* Numbers that look random and are the same in every run (Knuth's 64 bit generator). */
#ifndef PBF_TESTS_RANDOM_H
#define PBF_TESTS_RANDOM_H

#include <stdint.h>

/* The next number, even between two others. */
static inline double random_in(uint64_t *state, double low, double high) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(*state >> 11) / 9007199254740992.0;
}

#endif
