/* Part of lanes.h: AVX2 with FMA: 8 floats or 4 doubles. Quads are read with a load a lane: what
 * gathers take depends much on the processor, on AMD's of before Zen 4 and on those of Intel that
 * guard them against leaks several times as long. */
#include <immintrin.h>

#define LANES_QUADS

typedef pbf_real lane __attribute__((vector_size(32)));
enum { WIDTH = 32 / sizeof(pbf_real) };
typedef uint32_t u32_lanes __attribute__((vector_size(4 * WIDTH)));
enum { PARTS = 8 };

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
PBF_FN int lane_all_below(lane a, lane b) {
  return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ)) == 0xff;
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

/* Row k of four: the quad of lane k's, and behind it that of lane k + 4's. */
PBF_FN void load_packed(const pbf_real *quads, const int32_t *places, const uint8_t *slots,
                        lane quad[4]) {
  __m256 r[4];
  for (int k = 0; k < 4; ++k)
    r[k] = _mm256_insertf128_ps(
        _mm256_castps128_ps256(_mm_load_ps(quads + 2 * (int64_t)places[slots[k]])),
        _mm_load_ps(quads + 2 * (int64_t)places[slots[k + 4]]), 1);
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

#ifndef __OPTIMIZE_SIZE__
/* The slots of a byte's bits, a byte each, the first one lowest. */
struct byte_slots {
  uint64_t of[256];
};
constexpr byte_slots slots_of_bytes() {
  byte_slots all = {};
  for (uint32_t bits = 0; bits < 256; ++bits)
    for (uint32_t slot = 0, count = 0; slot < 8; ++slot)
      if (bits >> slot & 1) all.of[bits] |= (uint64_t)slot << 8 * count++;
  return all;
}
static constexpr byte_slots SLOTS_OF_BYTES = slots_of_bytes();

/* Rows of a lane's slots to rounds of all lanes' slots, eight rounds at a time. */
PBF_FN void transpose_slots(const uint8_t *rows, uint32_t stride, uint32_t rounds, uint8_t *list) {
  for (uint32_t r = 0; r < rounds; r += 8) {
    __m128i row[WIDTH], two[4], four[4], eight[4];
    for (int l = 0; l < WIDTH; ++l)
      row[l] = _mm_loadl_epi64((const __m128i *)(const void *)(rows + l * stride + r));
    for (int k = 0; k < 4; ++k) two[k] = _mm_unpacklo_epi8(row[2 * k], row[2 * k + 1]);
    for (int k = 0; k < 2; ++k) {
      four[2 * k] = _mm_unpacklo_epi16(two[2 * k], two[2 * k + 1]);
      four[2 * k + 1] = _mm_unpackhi_epi16(two[2 * k], two[2 * k + 1]);
    }
    for (int k = 0; k < 2; ++k) {
      eight[2 * k] = _mm_unpacklo_epi32(four[k], four[k + 2]);
      eight[2 * k + 1] = _mm_unpackhi_epi32(four[k], four[k + 2]);
    }
    for (uint32_t k = 0; k < 4 && r + 2 * k < rounds; ++k)
      _mm_storeu_si128((__m128i *)(void *)(list + (r + 2 * k) * WIDTH), eight[k]);
  }
}

/* Lists the slots of all bits, eight at a time out of a table: a loop over bits would be
 * mispredicted in each lane. */
#define LANES_LIST_BY_BYTES
static inline void u32_list(const u32_lanes masks[PARTS], uint32_t parts, uint32_t rounds,
                            uint8_t *list) {
  enum { STRIDE = PARTS * 32 + 64 };
  _Alignas(32) uint32_t bits[PARTS][WIDTH];
  uint8_t rows[WIDTH * STRIDE];
  for (uint32_t part = 0; part < parts; ++part) u32_store(bits[part], masks[part]);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    uint8_t *next = rows + l * STRIDE;
    const uint8_t *const end = next + rounds;
    uint64_t first = 0;
    for (uint32_t part = 0; part < parts; ++part)
      for (uint32_t k = 0; k < 4; ++k, first += UINT64_C(0x0808080808080808)) {
        const uint32_t some = bits[part][l] >> 8 * k & 255;
        const uint64_t slots = SLOTS_OF_BYTES.of[some] + first;
        memcpy(next, &slots, sizeof slots);
        next += __builtin_popcount(some);
      }
    for (; next < end; next += 32)
      _mm256_storeu_si256((__m256i *)(void *)next, _mm256_setzero_si256());
  }
  transpose_slots(rows, STRIDE, rounds, list);
}
#endif

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
PBF_FN int lane_all_below(lane a, lane b) {
  return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ)) == 0xf;
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

PBF_FN void lanes_transpose(const __m256d a[4], lane b[4]) {
  const __m256d xz01 = _mm256_unpacklo_pd(a[0], a[1]), yw01 = _mm256_unpackhi_pd(a[0], a[1]);
  const __m256d xz23 = _mm256_unpacklo_pd(a[2], a[3]), yw23 = _mm256_unpackhi_pd(a[2], a[3]);
  b[0] = (lane)_mm256_permute2f128_pd(xz01, xz23, 0x20);
  b[1] = (lane)_mm256_permute2f128_pd(yw01, yw23, 0x20);
  b[2] = (lane)_mm256_permute2f128_pd(xz01, xz23, 0x31);
  b[3] = (lane)_mm256_permute2f128_pd(yw01, yw23, 0x31);
}

PBF_FN void load_packed(const pbf_real *quads, const int32_t *places, const uint8_t *slots,
                        lane quad[4]) {
  __m256d rows[4];
  for (int k = 0; k < 4; ++k) rows[k] = _mm256_load_pd(quads + 2 * (int64_t)places[slots[k]]);
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
