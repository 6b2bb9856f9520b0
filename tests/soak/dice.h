/* Numbers that look random, from a seed and the number of what they are for: leaving out one call
 * of a run changes none of those that the others draw. */
#ifndef PBF_TESTS_SOAK_DICE_H
#define PBF_TESTS_SOAK_DICE_H

#include <stddef.h>
#include <stdint.h>

typedef struct dice {
  uint64_t state;
} dice;

/* Steele, Lea & Flood 2014, SplitMix64. */
static inline uint64_t dice_next(dice *d) {
  uint64_t z = (d->state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static inline dice dice_of(uint64_t seed, uint64_t part, uint64_t number) {
  dice d = {seed};
  d.state = dice_next(&d) + part;
  d.state = dice_next(&d) + number;
  return d;
}

/* 0 … end - 1. */
static inline uint32_t dice_below(dice *d, uint32_t end) { return (uint32_t)(dice_next(d) % end); }

/* One of so many times. */
static inline int dice_one_in(dice *d, uint32_t times) { return dice_below(d, times) == 0; }

static inline double dice_in(dice *d, double low, double high) {
  return low + (high - low) * (double)(dice_next(d) >> 11) / 9007199254740992.0;
}

static inline void dice_bytes(dice *d, void *bytes, size_t count) {
  for (size_t i = 0; i < count; ++i) ((unsigned char *)bytes)[i] = (unsigned char)dice_next(d);
}

#endif
