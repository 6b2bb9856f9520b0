/* The vector types of one instruction set, operation by operation, against plain C. Compiled once
 * for each set, and skipped where the machine lacks it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

extern "C" {
#include <cmocka.h>
}

#include "cpu/isa.h"
#include "cpu/simd/lanes.h"

static uint32_t random_bits(uint64_t *seed) {
  *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (uint32_t)(*seed >> 32);
}

/* Over many decades: as IEEE 754 rounds them. */
static void square_roots(void **state) {
  (void)state;
  pbf_real in[WIDTH], over_root[WIDTH], sqrts[WIDTH], roots[WIDTH];
  uint64_t seed = 1;
  for (int k = 0; k < 20000; ++k) {
    for (int l = 0; l < WIDTH; ++l)
      in[l] = (pbf_real)((1 + random_bits(&seed) / 4294967296.0) * pow(2, (int)(k % 100) - 60));
    lane_store(over_root, ops<lane>::over_root(ops<lane>::set(3), lane_load(in)));
    lane_store(sqrts, ops<lane>::sqrt(lane_load(in)));
    lane_store(roots, ops<lane>::root(lane_load(in)));
    for (int l = 0; l < WIDTH; ++l) {
      const pbf_real root = (pbf_real)sqrt((double)in[l]);
      assert_true(sqrts[l] == root);
      assert_true(roots[l] == root);
      assert_true(over_root[l] == 3 / root);
    }
  }
}

/* (1 + e)² - 1: the product is rounded before the sum, to 1 + 2 e; where it is FUSED e² is left. */
static void multiply_add(void **state) {
  (void)state;
  const pbf_real e = sizeof(pbf_real) == sizeof(float) ? (pbf_real)0x1p-12 : (pbf_real)0x1p-27;
  pbf_real sums[WIDTH];
  const lane a = ops<lane>::set(1 + e);
  lane_store(sums, ops<lane>::multiply_add(a, a, ops<lane>::set(-1)));
  for (int l = 0; l < WIDTH; ++l) assert_true(sums[l] == 2 * e + (FUSED ? e * e : 0));
}

static void arithmetic(void **state) {
  (void)state;
  pbf_real a[WIDTH], b[WIDTH], c[WIDTH], sums[WIDTH], max_ab[WIDTH], ramp_ab[WIDTH];
  for (int l = 0; l < WIDTH; ++l) {
    a[l] = (pbf_real)(l - 3);
    b[l] = (pbf_real)(5 - 2 * l);
    c[l] = (pbf_real)(l * l);
  }
  lane_store(sums, ops<lane>::multiply_add(lane_load(a), lane_load(b), lane_load(c)));
  lane_store(max_ab, ops<lane>::max(lane_load(a), lane_load(b)));
  lane_store(ramp_ab, ramp(lane_load(a), lane_load(b)));
  for (int l = 0; l < WIDTH; ++l) {
    assert_true(sums[l] == a[l] * b[l] + c[l]);
    assert_true(max_ab[l] == (a[l] > b[l] ? a[l] : b[l]));
    assert_true(ramp_ab[l] == (a[l] * b[l] > -1 ? a[l] * b[l] + 1 : 0));
  }
}

/* What is no number is below nothing, and nothing below it. */
static void comparisons(void **state) {
  (void)state;
  uint64_t seed = 4;
  for (int k = 0; k < 1000; ++k) {
    pbf_real x[WIDTH];
    int any = 0, all = 1;
    const uint32_t odd_one = random_bits(&seed) % WIDTH, kind = random_bits(&seed) % 3;
    for (uint32_t l = 0; l < WIDTH; ++l) {
      x[l] = (pbf_real)(k % 2);
      if (l == odd_one) x[l] = kind == 0 ? (pbf_real)NAN : (pbf_real)(kind - 1);
      any |= x[l] < 1;
      all &= x[l] < 1;
    }
    assert_int_equal(lane_any_below(lane_load(x), ops<lane>::set(1)) != 0, any);
    assert_int_equal(lane_all_below(lane_load(x), ops<lane>::set(1)) != 0, all);
    assert_int_equal(lane_all_below(ops<lane>::set(1), lane_load(x)) != 0, 0);
  }
}

static void masks(void **state) {
  (void)state;
  uint64_t seed = 2;
  for (int k = 0; k < 1000; ++k) {
    uint32_t in[WIDTH], count[WIDTH], marked[WIDTH], bit[WIDTH], below[WIDTH], any = 0, most = 0;
    pbf_real x[WIDTH];
    for (int l = 0; l < WIDTH; ++l) {
      in[l] = random_bits(&seed) & random_bits(&seed) & 0x7fffffffu;
      x[l] = (pbf_real)(random_bits(&seed) % 3);
      any |= in[l];
      most = (in[l] & 63) > most ? in[l] & 63 : most;
    }
    u32_lanes m = u32_load(in);
    u32_store(count, u32_popcount(m));
    u32_store(marked, u32_mark(m, lane_load(x), ops<lane>::set(1), u32_set(0x10)));
    u32_store(bit, u32_bit(m & u32_set(63)));
    u32_store(below, u32_below(m & u32_set(63), 20));
    assert_int_equal(u32_any(m), any);
    assert_int_equal(u32_max(m & u32_set(63)), most);
    for (int l = 0; l < WIDTH; ++l) {
      assert_int_equal(count[l], __builtin_popcount(in[l]));
      assert_int_equal(marked[l], in[l] | (x[l] < 1 ? 0x10 : 0));
      assert_int_equal(bit[l], (in[l] & 63) < 32 ? slot_bit(in[l] & 63) : 0);
      assert_int_equal(below[l], (in[l] & 63) < 20 ? UINT32_MAX : 0);
    }
    u32_store(in, u32_shift_left(m, 3) & u32_shift_right(m, 2));
  }
}

/* A list has the slots of every mask, each once, in order, and 0 where a lane has fewer. */
static void lists(void **state) {
  (void)state;
  enum { MOST = PARTS * (SLOTS - 1) };
  static uint8_t list[MOST * WIDTH];
  uint64_t seed = 3;
  for (int k = 0; k < 500; ++k) {
    uint32_t in[PARTS][WIDTH], rounds = 0;
    u32_lanes m[PARTS];
    for (int l = 0; l < WIDTH; ++l) {
      uint32_t bits = 0;
      for (int part = 0; part < PARTS; ++part) {
        in[part][l] = random_bits(&seed) & (k % 2 ? random_bits(&seed) : ~0u) & ~slot_bit(0);
        if (k % 7 == 0 && part) in[part][l] = 0;
        bits += (uint32_t)__builtin_popcount(in[part][l]);
      }
      rounds = bits > rounds ? bits : rounds;
    }
    for (int part = 0; part < PARTS; ++part) m[part] = u32_load(in[part]);
    list_set_bits(m, k % 7 ? PARTS : 1, rounds, list);
    for (uint32_t l = 0; l < WIDTH; ++l) {
      uint32_t seen[PARTS] = {0}, listed = 0, last = 0;
      for (uint32_t r = 0; r < rounds; ++r) {
        uint32_t slot = list[r * WIDTH + l];
        if (!slot) continue;
        assert_true(slot < PARTS * SLOTS);
        assert_true(slot > last);
        last = slot;
        seen[slot / SLOTS] |= slot_bit(slot % SLOTS);
        ++listed;
      }
      for (int part = 0; part < PARTS; ++part) {
        assert_int_equal(seen[part], in[part][l]);
        listed -= (uint32_t)__builtin_popcount(in[part][l]);
      }
      assert_int_equal(listed, 0);
    }
  }
}

static void look_ups(void **state) {
  (void)state;
#ifndef LANES_QUADS
  static pbf_real array[1024];
  uint32_t first[PARTS];
  for (int i = 0; i < 1024; ++i) array[i] = (pbf_real)(i + 1);
  for (uint32_t part = 0; part < PARTS; ++part) first[part] = 20 + 53 * part;
  const window t = window_of(array, first, -7);
  for (uint32_t begin = 0; begin < PARTS * SLOTS; ++begin) {
    uint8_t bytes[64] = {0};
    pbf_real found[WIDTH];
    for (uint32_t l = 0; l < WIDTH; ++l) {
      bytes[l] = (uint8_t)((begin + 37 * l) % (PARTS * SLOTS));
      if (bytes[l] % SLOTS == 0) bytes[l] = 0;
    }
    lane_store(found, window_at(&t, lane_indices_of(first, u32_of_bytes(bytes))));
    for (uint32_t l = 0; l < WIDTH; ++l) {
      uint32_t index = first[bytes[l] / SLOTS] + bytes[l] % SLOTS - 1;
      assert_true(found[l] == (bytes[l] ? array[index] : -7));
    }
  }
#endif
}

/* The quad before the first is the sentinel's. */
static void quads(void **state) {
  (void)state;
#ifdef LANES_QUADS
  alignas(64) static pbf_real array[4 * 1040];
  pbf_real *of_first = array + 4 * 16;
  uint32_t first[PARTS];
  int32_t places[PARTS * SLOTS];
  for (uint32_t part = 0; part < PARTS; ++part) first[part] = 20 + 53 * part;
  for (uint32_t slot = 0; slot < PARTS * SLOTS; ++slot)
    places[slot] = 2 * (int32_t)(first[slot / SLOTS] + slot % SLOTS - 1);
  places[0] = -2;
  for (int i = 0; i + WIDTH <= 1024; i += WIDTH) {
    lane quad[4];
    pbf_real in[4][WIDTH];
    for (int c = 0; c < 4; ++c)
      for (int l = 0; l < WIDTH; ++l) in[c][l] = (pbf_real)(4 * (i + l) + c);
    for (int c = 0; c < 4; ++c) quad[c] = lane_load(in[c]);
    store_packed(of_first + 4 * i, quad);
  }
  for (int k = 0; k < 4 * 1024; ++k) assert_true(of_first[k] == k);
  for (int c = 0; c < 4; ++c) of_first[c - 4] = (pbf_real)(-7 - c);
  for (uint32_t begin = 0; begin < PARTS * SLOTS; ++begin) {
    uint8_t bytes[64] = {0};
    lane quad[4];
    for (uint32_t l = 0; l < WIDTH; ++l) {
      bytes[l] = (uint8_t)((begin + 37 * l) % (PARTS * SLOTS));
      if (bytes[l] % SLOTS == 0) bytes[l] = 0;
    }
    load_packed(of_first, places, bytes, quad);
    for (int c = 0; c < 4; ++c) {
      pbf_real found[WIDTH];
      lane_store(found, quad[c]);
      for (uint32_t l = 0; l < WIDTH; ++l) {
        uint32_t index = first[bytes[l] / SLOTS] + bytes[l] % SLOTS - 1;
        assert_true(found[l] == (bytes[l] ? (pbf_real)(4 * index) + c : -7 - c));
      }
    }
  }
#endif
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(square_roots), cmocka_unit_test(multiply_add), cmocka_unit_test(arithmetic),
      cmocka_unit_test(masks),        cmocka_unit_test(lists),        cmocka_unit_test(look_ups),
      cmocka_unit_test(quads),        cmocka_unit_test(comparisons),
  };
  cpu_isa best;
  char reason[128];
  if (!cpu_isa_best(&best, reason, sizeof reason) || best < PBF_TEST_ISA) {
    printf("skipped: this processor lacks the instructions under test, %s\n",
           cpu_isa_name(PBF_TEST_ISA));
    return 77;
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
