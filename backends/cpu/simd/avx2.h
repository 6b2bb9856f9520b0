/* Part of lanes.h: AVX2 with FMA: 8 floats or 4 doubles. Quads are read with a load a lane: what
 * gathers take depends much on the processor, on AMD's of before Zen 4 and on those of Intel that
 * guard them against leaks several times as long. */
#include <immintrin.h>

#define LANES_QUADS

typedef pbf_real lane __attribute__((vector_size(32)));
enum { WIDTH = 32 / sizeof(pbf_real) };
typedef uint32_t u32_lanes __attribute__((vector_size(4 * WIDTH)));
enum { PARTS = 8 };
typedef struct window {
  const pbf_real *array;
  lane sentinel;
} window;

#if PBF_BITS == 32

namespace {
template <>
struct ops<lane> {
  static PBF_IN lane set(pbf_real a) { return (lane)_mm256_set1_ps(a); }
  static PBF_IN lane max(lane a, lane b) { return (lane)_mm256_max_ps((__m256)a, (__m256)b); }
  static PBF_IN lane multiply_add(lane a, lane b, lane c) {
    return FUSED ? (lane)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c) : a * b + c;
  }
  static PBF_IN lane sqrt(lane a) { return (lane)_mm256_sqrt_ps((__m256)a); }
  static PBF_IN lane root(lane a) { return sqrt(a); }
  static PBF_IN lane over_root(lane b, lane a) { return b / sqrt(a); }
};
}  // namespace

PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm256_loadu_ps(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm256_storeu_ps(p, (__m256)a); }
PBF_FN int lane_any_below(lane a, lane b) {
  return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ)) != 0;
}

PBF_FN u32_lanes u32_set(uint32_t a) { return (u32_lanes)_mm256_set1_epi32((int)a); }
PBF_FN u32_lanes u32_iota(void) { return (u32_lanes){0, 1, 2, 3, 4, 5, 6, 7}; }
PBF_FN u32_lanes u32_load(const uint32_t *p) {
  return (u32_lanes)_mm256_loadu_si256((const __m256i *)(const void *)p);
}
PBF_FN void u32_store(uint32_t *p, u32_lanes a) {
  _mm256_storeu_si256((__m256i *)(void *)p, (__m256i)a);
}
PBF_FN u32_lanes u32_shift_right(u32_lanes a, int count) {
  return (u32_lanes)_mm256_srli_epi32((__m256i)a, count);
}
PBF_FN u32_lanes u32_bit(u32_lanes s) {
  return (u32_lanes)_mm256_sllv_epi32(_mm256_set1_epi32(1), (__m256i)s);
}
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  return m | ((u32_lanes)_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ) & bit);
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) {
  return (u32_lanes)_mm256_cmpgt_epi32(_mm256_set1_epi32((int)limit), (__m256i)a);
}

PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) {
  return (u32_lanes)_mm256_slli_epi32((__m256i)a, count);
}
PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) {
  return (u32_lanes)_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p));
}

typedef struct lane_indices {
  __m256i index; /* -1: the sentinel, which lies before the first element */
  __m256 known;
} lane_indices;
PBF_FN lane_indices lane_indices_of(const uint32_t first[PARTS], u32_lanes s) {
  const u32_lanes slot_one = {1, 33, 65, 97, 129, 161, 193, 225}; /* of each part */
  const u32_lanes less =
      (u32_lanes)_mm256_loadu_si256((const __m256i *)(const void *)first) - slot_one;
  u32_lanes begin =
      (u32_lanes)_mm256_permutevar8x32_epi32((__m256i)less, (__m256i)u32_shift_right(s, 5));
  __m256i known = _mm256_cmpgt_epi32((__m256i)s, _mm256_setzero_si256());
  __m256i sentinel = _mm256_cmpeq_epi32((__m256i)s, _mm256_setzero_si256());
  return (lane_indices){(__m256i)((begin + s) | (u32_lanes)sentinel), _mm256_castsi256_ps(known)};
}
PBF_FN window window_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  (void)first;
  return (window){array, ops<lane>::set(sentinel)};
}
PBF_FN lane window_at(const window *t, lane_indices p) {
  return (lane)_mm256_mask_i32gather_ps((__m256)t->sentinel, t->array, p.index, p.known, 4);
}

/* Row k of four: the quad of lane k's, and behind it that of lane k + 4's. Offsets go through
 * memory: to take them out of a register one by one is slower. */
PBF_FN void load_packed(const pbf_real *quads, lane_indices p, lane quad[4]) {
  _Alignas(32) int32_t halves[WIDTH];
  __m256 r[4];
  _mm256_store_si256((__m256i *)(void *)halves, _mm256_slli_epi32(p.index, 1));
  __asm__("" : "+m"(halves));
  for (int k = 0; k < 4; ++k)
    r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(quads + 2 * (int64_t)halves[k])),
                                _mm_load_ps(quads + 2 * (int64_t)halves[k + 4]), 1);
  const __m256 xy01 = _mm256_unpacklo_ps(r[0], r[1]), zw01 = _mm256_unpackhi_ps(r[0], r[1]);
  const __m256 xy23 = _mm256_unpacklo_ps(r[2], r[3]), zw23 = _mm256_unpackhi_ps(r[2], r[3]);
  quad[0] = (lane)_mm256_shuffle_ps(xy01, xy23, 0x44);
  quad[1] = (lane)_mm256_shuffle_ps(xy01, xy23, 0xee);
  quad[2] = (lane)_mm256_shuffle_ps(zw01, zw23, 0x44);
  quad[3] = (lane)_mm256_shuffle_ps(zw01, zw23, 0xee);
}

PBF_FN void store_packed(pbf_real *quads, const lane quad[4]) {
  const __m256 x = (__m256)quad[0], y = (__m256)quad[1], z = (__m256)quad[2], w = (__m256)quad[3];
  const __m256 xy02 = _mm256_unpacklo_ps(x, y), xy13 = _mm256_unpackhi_ps(x, y);
  const __m256 zw02 = _mm256_unpacklo_ps(z, w), zw13 = _mm256_unpackhi_ps(z, w);
  const __m256 r0 = _mm256_shuffle_ps(xy02, zw02, 0x44), r1 = _mm256_shuffle_ps(xy02, zw02, 0xee);
  const __m256 r2 = _mm256_shuffle_ps(xy13, zw13, 0x44), r3 = _mm256_shuffle_ps(xy13, zw13, 0xee);
  _mm256_storeu_ps(quads, _mm256_permute2f128_ps(r0, r1, 0x20));
  _mm256_storeu_ps(quads + 8, _mm256_permute2f128_ps(r2, r3, 0x20));
  _mm256_storeu_ps(quads + 16, _mm256_permute2f128_ps(r0, r1, 0x31));
  _mm256_storeu_ps(quads + 24, _mm256_permute2f128_ps(r2, r3, 0x31));
}

#else

namespace {
template <>
struct ops<lane> {
  static PBF_IN lane set(pbf_real a) { return (lane)_mm256_set1_pd(a); }
  static PBF_IN lane max(lane a, lane b) { return (lane)_mm256_max_pd((__m256d)a, (__m256d)b); }
  static PBF_IN lane multiply_add(lane a, lane b, lane c) { return a * b + c; }
  static PBF_IN lane sqrt(lane a) { return (lane)_mm256_sqrt_pd((__m256d)a); }
  static PBF_IN lane root(lane a) { return sqrt(a); }
  static PBF_IN lane over_root(lane b, lane a) { return b / sqrt(a); }
};
}  // namespace

PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm256_loadu_pd(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm256_storeu_pd(p, (__m256d)a); }
PBF_FN int lane_any_below(lane a, lane b) {
  return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ)) != 0;
}

PBF_FN u32_lanes u32_set(uint32_t a) { return (u32_lanes)_mm_set1_epi32((int)a); }
PBF_FN u32_lanes u32_iota(void) { return (u32_lanes){0, 1, 2, 3}; }
PBF_FN u32_lanes u32_load(const uint32_t *p) {
  return (u32_lanes)_mm_loadu_si128((const __m128i *)(const void *)p);
}
PBF_FN void u32_store(uint32_t *p, u32_lanes a) {
  _mm_storeu_si128((__m128i *)(void *)p, (__m128i)a);
}
PBF_FN u32_lanes u32_shift_right(u32_lanes a, int count) {
  return (u32_lanes)_mm_srli_epi32((__m128i)a, count);
}
PBF_FN u32_lanes u32_bit(u32_lanes s) {
  return (u32_lanes)_mm_sllv_epi32(_mm_set1_epi32(1), (__m128i)s);
}
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  __m256i less = _mm256_castpd_si256(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ));
  __m256i packed = _mm256_permutevar8x32_epi32(less, _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6));
  return m | ((u32_lanes)_mm256_castsi256_si128(packed) & bit);
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) {
  return (u32_lanes)_mm_cmpgt_epi32(_mm_set1_epi32((int)limit), (__m128i)a);
}

PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) {
  return (u32_lanes)_mm_slli_epi32((__m128i)a, count);
}
PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) {
  int32_t bytes;
  memcpy(&bytes, p, sizeof bytes);
  return (u32_lanes)_mm_cvtepu8_epi32(_mm_cvtsi32_si128(bytes));
}

typedef struct lane_indices {
  __m128i index;
  __m256d known;
} lane_indices;
PBF_FN lane_indices lane_indices_of(const uint32_t first[PARTS], u32_lanes s) {
  __m256i firsts = _mm256_loadu_si256((const __m256i *)(const void *)first);
  __m256i part = _mm256_castsi128_si256((__m128i)u32_shift_right(s, 5));
  u32_lanes begin = (u32_lanes)_mm256_castsi256_si128(_mm256_permutevar8x32_epi32(firsts, part));
  __m128i known = _mm_cmpgt_epi32((__m128i)s, _mm_setzero_si128());
  __m128i sentinel = _mm_cmpeq_epi32((__m128i)s, _mm_setzero_si128());
  u32_lanes index = begin + (s & u32_set(SLOTS - 1)) - u32_set(1);
  return (lane_indices){(__m128i)(index | (u32_lanes)sentinel),
                        _mm256_castsi256_pd(_mm256_cvtepi32_epi64(known))};
}
PBF_FN window window_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  (void)first;
  return (window){array, ops<lane>::set(sentinel)};
}
PBF_FN lane window_at(const window *t, lane_indices p) {
  return (lane)_mm256_mask_i32gather_pd((__m256d)t->sentinel, t->array, p.index, p.known, 8);
}

PBF_FN void lanes_transpose(const __m256d a[4], lane b[4]) {
  const __m256d xz01 = _mm256_unpacklo_pd(a[0], a[1]), yw01 = _mm256_unpackhi_pd(a[0], a[1]);
  const __m256d xz23 = _mm256_unpacklo_pd(a[2], a[3]), yw23 = _mm256_unpackhi_pd(a[2], a[3]);
  b[0] = (lane)_mm256_permute2f128_pd(xz01, xz23, 0x20);
  b[1] = (lane)_mm256_permute2f128_pd(yw01, yw23, 0x20);
  b[2] = (lane)_mm256_permute2f128_pd(xz01, xz23, 0x31);
  b[3] = (lane)_mm256_permute2f128_pd(yw01, yw23, 0x31);
}

PBF_FN void load_packed(const pbf_real *quads, lane_indices p, lane quad[4]) {
  _Alignas(16) int32_t halves[WIDTH];
  __m256d rows[4];
  _mm_store_si128((__m128i *)(void *)halves, _mm_slli_epi32(p.index, 1));
  __asm__("" : "+m"(halves));
  for (int k = 0; k < 4; ++k) rows[k] = _mm256_load_pd(quads + 2 * (int64_t)halves[k]);
  lanes_transpose(rows, quad);
}

PBF_FN void store_packed(pbf_real *quads, const lane quad[4]) {
  lane rows[4];
  const __m256d columns[4] = {(__m256d)quad[0], (__m256d)quad[1], (__m256d)quad[2],
                              (__m256d)quad[3]};
  lanes_transpose(columns, rows);
  for (int k = 0; k < 4; ++k) lane_store(quads + 4 * k, rows[k]);
}

#endif

PBF_FN uint32_t u32_max(u32_lanes a) {
  uint32_t largest = a[0];
  for (int k = 1; k < WIDTH; ++k) largest = a[k] > largest ? a[k] : largest;
  return largest;
}

PBF_FN uint32_t u32_any(u32_lanes a) {
  uint32_t any = a[0];
  for (int k = 1; k < WIDTH; ++k) any |= a[k];
  return any;
}
