/* Lanes: the vector types of one instruction set, behind the names that the pair loops use.
 *
 *   lane    WIDTH reals, with + - *, ops<lane>, load, store, any_below, all_below
 *   slots   WIDTH unsigned 32-bit integers, with & | ~ + -
 *   table   PARTS windows of an array, to be looked up by each lane at a slot of its own
 *
 * A window is 31 consecutive elements: slots 1 … 31 of part 0, 33 … 63 of part 1, and so on. Slot 0
 * is the sentinel: a value given with the table. Where LANES_QUADS is defined there are, instead of
 * tables,
 *
 *   quads   four reals a particle, side by side, the sentinel's before them: a load a lane gets all
 *           four. `places` has where the quad of each slot is, in halves of a quad
 *
 * Which slots of a window a lane wants is a mask: slot s is bit s % 32, the lowest of which a
 * processor finds and clears fastest in a word, or with LANES_LIST_BY_MASKS bit 31 - s % 32, the
 * highest of which it finds in all lanes of a vector. With LANES_LIST_BY_MASKS or
 * LANES_LIST_BY_BYTES the set has a u32_list of its own.
 */
#ifndef PBF_CPU_SIMD_LANES_H
#define PBF_CPU_SIMD_LANES_H

#include <stdint.h>
#include <string.h>

#include "physics/lane_vector.h"

enum { SLOTS = 32 };

/* Whether code that is small comes before code that is fast. */
#ifdef __OPTIMIZE_SIZE__
enum { BUILT_FOR_SIZE = 1 };
#else
enum { BUILT_FOR_SIZE = 0 };
#endif

/* Whether ops<lane>::multiply_add rounds once, as pbf_desc.determinism may allow; in float32. */
#ifdef PBF_LANES_FUSED
enum { FUSED = 1 };
#else
enum { FUSED = 0 };
#endif

#if defined(PBF_LANES_AVX512)
#include "cpu/simd/avx512.h"
#elif defined(PBF_LANES_AVX2)
#include "cpu/simd/avx2.h"
#elif defined(PBF_LANES_SSE2) || defined(PBF_LANES_NEON) || defined(PBF_LANES_SIMD128)
#include "cpu/simd/128.h"
#else
#include "cpu/simd/scalar.h"
#endif

/* Slots of one window, 0 … 31: the bit of one, in all lanes that of the slot behind, the first of a
 * mask, and masks of a window that begins `count` slots later. */
#ifdef LANES_LIST_BY_MASKS
PBF_FN uint32_t slot_bit(uint32_t slot) { return 0x80000000u >> slot; }
PBF_FN u32_lanes next_slot_bit(u32_lanes bit) { return u32_shift_right(bit, 1); }
PBF_FN uint32_t first_slot(uint32_t mask) { return (uint32_t)__builtin_clz(mask); }
PBF_FN u32_lanes slots_from(u32_lanes m, int count) { return u32_shift_left(m, count); }
#else
PBF_FN uint32_t slot_bit(uint32_t slot) { return 1u << slot; }
PBF_FN u32_lanes next_slot_bit(u32_lanes bit) { return bit + bit; }
PBF_FN uint32_t first_slot(uint32_t mask) { return (uint32_t)__builtin_ctz(mask); }
PBF_FN u32_lanes slots_from(u32_lanes m, int count) { return u32_shift_right(m, count); }
#endif

/* Set bits of each lane. */
PBF_FN u32_lanes u32_popcount(u32_lanes m) {
  m = m - (u32_shift_right(m, 1) & u32_set(0x55555555u));
  m = (m & u32_set(0x33333333u)) + (u32_shift_right(m, 2) & u32_set(0x33333333u));
  m = (m + u32_shift_right(m, 4)) & u32_set(0x0f0f0f0fu);
  m = m + u32_shift_right(m, 8);
  return (m + u32_shift_right(m, 16)) & u32_set(63);
}

/* Lists the slots in the masks of some windows: byte r * WIDTH + l is lane l's r-th one, or 0. */
#if defined(LANES_LIST_BY_MASKS) || defined(LANES_LIST_BY_BYTES)
PBF_FN void list_set_bits(const u32_lanes masks[PARTS], uint32_t parts, uint32_t rounds,
                          uint8_t *list) {
  u32_list(masks, parts, rounds, list);
}
#else
/* Unpacks the bits of two windows, the first slot first, into every WIDTH-th byte; returns where
 * the next ones begin. A loop of as many rounds as a lane has neighbours is mispredicted in each
 * lane: so some at once, be there as many or not, which leaves behind the end what is no neighbour.
 */
enum { BITS_AT_ONCE = 8 };

PBF_FN uint8_t *list_bits(uint64_t m, uint32_t part, uint8_t *next) {
  uint8_t *end = next + (uint32_t)__builtin_popcountll(m) * WIDTH;
  do {
    for (int k = 0; k < BITS_AT_ONCE; ++k, next += WIDTH) {
      const uint64_t some = m | UINT64_C(0x8000000000000000);
      *next = (uint8_t)(part * SLOTS + (uint32_t)__builtin_ctzll(some));
      m &= m - 1;
    }
  } while (m);
  return end;
}

/* Built for size: one at a time. */
PBF_FN uint8_t *list_each_bit(uint64_t m, uint32_t part, uint8_t *next) {
  for (; m; m &= m - 1, next += WIDTH)
    *next = (uint8_t)(part * SLOTS + (uint32_t)__builtin_ctzll(m));
  return next;
}

static inline void list_set_bits(const u32_lanes masks[PARTS], uint32_t parts, uint32_t rounds,
                                 uint8_t *list) {
  uint32_t bits[PARTS][WIDTH];
  uint8_t space[(PARTS * (SLOTS - 1) + BITS_AT_ONCE) * WIDTH];
  for (int part = 0; part < PARTS; ++part) u32_store(bits[part], masks[part]);
  memset(space, 0, (size_t)rounds * WIDTH);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    uint8_t *next = space + l;
    for (uint32_t part = 0; part < parts; part += 2) {
      uint64_t m = (uint64_t)bits[part + 1][l] << 32 | bits[part][l];
      next = BUILT_FOR_SIZE ? list_each_bit(m, part, next) : list_bits(m, part, next);
    }
    for (int k = 0; k < BITS_AT_ONCE && !BUILT_FOR_SIZE; ++k) next[k * WIDTH] = 0;
  }
  memcpy(list, space, (size_t)rounds * WIDTH);
}
#endif

#endif
