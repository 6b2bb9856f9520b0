/* Lanes: the vector types of one instruction set, behind the names that the pair loops use.
 *
 *   lane    WIDTH reals, with + - * and sqrt, rsqrt, max, fma
 *   slots   WIDTH unsigned 32-bit integers, with & | ~ + -
 *   table   31 neighbouring elements of an array, numbered as slots 1 … 31, to be looked up by
 *           each lane at an index of its own; slot 0 (and every slot above 31) is `far`
 *
 * A mask has one bit a slot, slot s being bit 31 - s, so that the leading bit is the lowest slot.
 */
#ifndef PBF_CPU_LANES_H
#define PBF_CPU_LANES_H

#include <stdint.h>
#include <string.h>

#include "physics/real.h"

enum { SLOTS = 32 };

#if defined(PBF_LANES_AVX512)
#include "cpu/lanes_avx512.h"
#elif defined(PBF_LANES_AVX2)
#include "cpu/lanes_avx2.h"
#elif defined(PBF_LANES_SSE2)
#include "cpu/lanes_128.h"
#else
#include "cpu/lanes_scalar.h"
#endif

#define PBF_LANE lane
#define PBF_LANE_(operation) lane_##operation
#define PBF_PAIR(term) lanes_##term
#include "physics/pair.h"

/* Set bits of each lane. */
PBF_FN slots slots_popcount(slots m) {
  m = m - (slots_shift_right(m, 1) & slots_set(0x55555555u));
  m = (m & slots_set(0x33333333u)) + (slots_shift_right(m, 2) & slots_set(0x33333333u));
  m = (m + slots_shift_right(m, 4)) & slots_set(0x0f0f0f0fu);
  m = m + slots_shift_right(m, 8);
  return (m + slots_shift_right(m, 16)) & slots_set(63);
}

/* Takes the leading bit out of each lane's mask; gives its slot, or 32 and more for an empty one.
 */
PBF_FN slots slots_take(slots *m) {
  slots leading = slots_leading(*m);
  *m = *m & ~slots_bit(leading);
  return leading;
}

#endif
