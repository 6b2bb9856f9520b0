/* Part of lanes.h: vectors of 128 bits in the compiler's own extension: SSE2, NEON on AArch64, or
 * WebAssembly's SIMD128.
 * What the extension lacks and compilers make poorly of loops, roots, is the processor's own. */
#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

typedef pbf_real lane __attribute__((vector_size(16)));
enum { WIDTH = 16 / sizeof(pbf_real) };
typedef uint32_t u32_lanes __attribute__((vector_size(4 * WIDTH)));
enum { PARTS = 8 };

#if PBF_BITS == 32
typedef int32_t lane_mask __attribute__((vector_size(16)));
PBF_FN u32_lanes u32_of_mask(lane_mask m) { return (u32_lanes)m; }
#else
typedef int64_t lane_mask __attribute__((vector_size(16)));
PBF_FN u32_lanes u32_of_mask(lane_mask m) { return (u32_lanes){(uint32_t)m[0], (uint32_t)m[1]}; }
#endif

PBF_FN lane lane_load(const pbf_real *p) {
  lane a;
  memcpy(&a, p, sizeof a);
  return a;
}
PBF_FN void lane_store(pbf_real *p, lane a) { memcpy(p, &a, sizeof a); }

PBF_FN lane roots_of(lane a) {
#if defined(__SSE2__) && PBF_BITS == 32
  return (lane)_mm_sqrt_ps((__m128)a);
#elif defined(__SSE2__)
  return (lane)_mm_sqrt_pd((__m128d)a);
#elif defined(__aarch64__) && PBF_BITS == 32
  return (lane)vsqrtq_f32((float32x4_t)a);
#elif defined(__aarch64__)
  return (lane)vsqrtq_f64((float64x2_t)a);
#elif defined(__wasm_simd128__) && PBF_BITS == 32
  return (lane)wasm_f32x4_sqrt((v128_t)a);
#elif defined(__wasm_simd128__)
  return (lane)wasm_f64x2_sqrt((v128_t)a);
#else
  for (int k = 0; k < WIDTH; ++k) a[k] = pbf_real_sqrt(a[k]);
  return a;
#endif
}

/* a b + c, rounded once where the lanes are FUSED. */
PBF_FN lane product_plus(lane a, lane b, lane c) {
#if defined(__aarch64__) && PBF_BITS == 32
  if (FUSED) return (lane)vfmaq_f32((float32x4_t)c, (float32x4_t)a, (float32x4_t)b);
#endif
  return a * b + c;
}

/* a > b ? a : b */
PBF_FN lane larger_of(lane a, lane b) {
#if defined(__wasm_simd128__) && PBF_BITS == 32
  return (lane)wasm_f32x4_pmax((v128_t)b, (v128_t)a);
#elif defined(__wasm_simd128__)
  return (lane)wasm_f64x2_pmax((v128_t)b, (v128_t)a);
#else
  const lane_mask m = a > b;
  return (lane)(((lane_mask)a & m) | ((lane_mask)b & ~m));
#endif
}

namespace {
template <>
struct ops<lane> {
#if PBF_BITS == 32
  static PBF_IN lane set(pbf_real a) { return (lane){a, a, a, a}; }
#else
  static PBF_IN lane set(pbf_real a) { return (lane){a, a}; }
#endif
  static PBF_IN lane max(lane a, lane b) { return larger_of(a, b); }
  static PBF_IN lane multiply_add(lane a, lane b, lane c) { return product_plus(a, b, c); }
  static PBF_IN lane sqrt(lane a) { return roots_of(a); }
  static PBF_IN lane root(lane a) { return sqrt(a); }
  static PBF_IN lane over_root(lane b, lane a) { return b / sqrt(a); }
};
}  // namespace

PBF_FN int lane_any_below(lane a, lane b) {
  const lane_mask below = a < b;
  uint64_t halves[2];
  memcpy(halves, &below, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}
PBF_FN int lane_all_below(lane a, lane b) {
  const lane_mask below = a < b;
  uint64_t halves[2];
  memcpy(halves, &below, sizeof halves);
  return (halves[0] & halves[1]) == UINT64_MAX;
}

#if PBF_BITS == 32
PBF_FN u32_lanes u32_set(uint32_t a) { return (u32_lanes){a, a, a, a}; }
PBF_FN u32_lanes u32_iota(void) { return (u32_lanes){0, 1, 2, 3}; }
#else
PBF_FN u32_lanes u32_set(uint32_t a) { return (u32_lanes){a, a}; }
PBF_FN u32_lanes u32_iota(void) { return (u32_lanes){0, 1}; }
#endif

PBF_FN u32_lanes u32_load(const uint32_t *p) {
  u32_lanes a;
  memcpy(&a, p, sizeof a);
  return a;
}
PBF_FN void u32_store(uint32_t *p, u32_lanes a) { memcpy(p, &a, sizeof a); }
PBF_FN u32_lanes u32_shift_right(u32_lanes a, int count) { return a >> u32_set((uint32_t)count); }
PBF_FN u32_lanes u32_bit(u32_lanes s) {
  for (int k = 0; k < WIDTH; ++k) s[k] = s[k] < SLOTS ? 1u << s[k] : 0;
  return s;
}
PBF_FN uint32_t u32_max(u32_lanes a) {
  uint32_t largest = a[0];
  for (int k = 1; k < WIDTH; ++k) largest = a[k] > largest ? a[k] : largest;
  return largest;
}
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  return m | (u32_of_mask(a < b) & bit);
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) { return (u32_lanes)(a < u32_set(limit)); }

PBF_FN uint32_t u32_any(u32_lanes a) {
  uint32_t any = a[0];
  for (int k = 1; k < WIDTH; ++k) any |= a[k];
  return any;
}
PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) { return a << u32_set((uint32_t)count); }

/* Lanes are named where the code is compiled: clang leaves some loops over them as they are, and
 * what is indexed by a variable is then kept in memory. */
namespace {
template <int... k>
struct lane_numbers {};
#if PBF_BITS == 32
typedef lane_numbers<0, 1, 2, 3> each_lane;
#else
typedef lane_numbers<0, 1> each_lane;
#endif

template <int... k>
PBF_FN u32_lanes bytes_in_lanes(const uint8_t *p, lane_numbers<k...>) {
  return (u32_lanes){p[k]...};
}
}  // namespace

PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) { return bytes_in_lanes(p, each_lane()); }

#define LANES_QUADS
namespace {
/* Lane k is number from[k] of a's and, from WIDTH on, of b's. */
template <int... from>
PBF_FN lane lanes_pick(lane a, lane b) {
#ifdef __clang__
  return __builtin_shufflevector(a, b, from...);
#else
  return __builtin_shuffle(a, b, (lane_mask){from...});
#endif
}
}  // namespace

#if PBF_BITS == 32
PBF_FN void lanes_transpose(const lane a[4], lane b[4]) {
  const lane low01 = lanes_pick<0, 4, 1, 5>(a[0], a[1]), low23 = lanes_pick<0, 4, 1, 5>(a[2], a[3]);
  const lane high01 = lanes_pick<2, 6, 3, 7>(a[0], a[1]);
  const lane high23 = lanes_pick<2, 6, 3, 7>(a[2], a[3]);
  b[0] = lanes_pick<0, 1, 4, 5>(low01, low23);
  b[1] = lanes_pick<2, 3, 6, 7>(low01, low23);
  b[2] = lanes_pick<0, 1, 4, 5>(high01, high23);
  b[3] = lanes_pick<2, 3, 6, 7>(high01, high23);
}
PBF_FN void load_packed(const pbf_real *quads, const int32_t *places, const uint8_t *slots,
                        lane quad[4]) {
  const lane rows[4] = {
      lane_load(quads + 2 * (int64_t)places[slots[0]]),
      lane_load(quads + 2 * (int64_t)places[slots[1]]),
      lane_load(quads + 2 * (int64_t)places[slots[2]]),
      lane_load(quads + 2 * (int64_t)places[slots[3]]),
  };
  lanes_transpose(rows, quad);
}
PBF_FN void store_packed(pbf_real *quads, const lane quad[4]) {
  lane rows[4];
  lanes_transpose(quad, rows);
  for (int k = 0; k < 4; ++k) lane_store(quads + 4 * k, rows[k]);
}
#else
PBF_FN void load_packed(const pbf_real *quads, const int32_t *places, const uint8_t *slots,
                        lane quad[4]) {
  const pbf_real *const quad_a = quads + 2 * (int64_t)places[slots[0]];
  const pbf_real *const quad_b = quads + 2 * (int64_t)places[slots[1]];
  for (int half = 0; half < 2; ++half) {
    const lane a = lane_load(quad_a + 2 * half), b = lane_load(quad_b + 2 * half);
    quad[2 * half] = lanes_pick<0, 2>(a, b);
    quad[2 * half + 1] = lanes_pick<1, 3>(a, b);
  }
}
PBF_FN void store_packed(pbf_real *quads, const lane quad[4]) {
  for (int half = 0; half < 2; ++half) {
    const lane a = quad[2 * half], b = quad[2 * half + 1];
    lane_store(quads + 2 * half, lanes_pick<0, 2>(a, b));
    lane_store(quads + 4 + 2 * half, lanes_pick<1, 3>(a, b));
  }
}
#endif
