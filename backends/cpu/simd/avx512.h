/* Part of lanes.h: AVX-512 (F, CD, BW, DQ, VL): 16 floats or 8 doubles. A window of floats is two
 * registers, and looking up in it is one permutation; a gather costs ten times that. */
#include <immintrin.h>

typedef pbf_real lane __attribute__((vector_size(64)));
enum { WIDTH = 64 / sizeof(pbf_real) };
typedef uint32_t u32_lanes __attribute__((vector_size(4 * WIDTH)));

#if PBF_BITS == 32

enum { PARTS = 2 };
typedef struct window {
  __m512 low[PARTS], high[PARTS];
} window;
typedef struct lane_indices {
  __m512i slot;
  __mmask16 second;
} lane_indices;

namespace {
template <>
struct ops<lane> {
  static PBF_IN lane set(pbf_real a) { return (lane)_mm512_set1_ps(a); }
  static PBF_IN lane max(lane a, lane b) { return (lane)_mm512_max_ps((__m512)a, (__m512)b); }
  static PBF_IN lane multiply_add(lane a, lane b, lane c) {
    return FUSED ? (lane)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c) : a * b + c;
  }
  static PBF_IN lane sqrt(lane a) { return (lane)_mm512_sqrt_ps((__m512)a); }
  static PBF_IN lane root(lane a) { return sqrt(a); }
  static PBF_IN lane over_root(lane b, lane a) { return b / sqrt(a); }
};
}  // namespace

PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm512_loadu_ps(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm512_storeu_ps(p, (__m512)a); }
PBF_FN int lane_any_below(lane a, lane b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ) != 0;
}
PBF_FN int lane_all_below(lane a, lane b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ) == 0xffff;
}

PBF_FN u32_lanes u32_set(uint32_t a) { return (u32_lanes)_mm512_set1_epi32((int)a); }
PBF_FN u32_lanes u32_iota(void) {
  return (u32_lanes){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
PBF_FN u32_lanes u32_load(const uint32_t *p) { return (u32_lanes)_mm512_loadu_si512(p); }
PBF_FN void u32_store(uint32_t *p, u32_lanes a) { _mm512_storeu_si512(p, (__m512i)a); }
PBF_FN u32_lanes u32_shift_right(u32_lanes a, int count) {
  return (u32_lanes)_mm512_srli_epi32((__m512i)a, (unsigned int)count);
}
PBF_FN u32_lanes u32_bit(u32_lanes s) {
  return (u32_lanes)_mm512_srlv_epi32(_mm512_set1_epi32(INT32_MIN), (__m512i)s);
}
PBF_FN uint32_t u32_max(u32_lanes a) { return _mm512_reduce_max_epu32((__m512i)a); }
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  __mmask16 less = _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
  return (u32_lanes)_mm512_mask_or_epi32((__m512i)m, less, (__m512i)m, (__m512i)bit);
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) {
  __mmask16 below = _mm512_cmplt_epu32_mask((__m512i)a, _mm512_set1_epi32((int)limit));
  return (u32_lanes)_mm512_maskz_set1_epi32(below, -1);
}

PBF_FN uint32_t u32_any(u32_lanes a) { return (uint32_t)_mm512_reduce_or_epi32((__m512i)a); }
PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) {
  return (u32_lanes)_mm512_slli_epi32((__m512i)a, (unsigned int)count);
}
PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) {
  return (u32_lanes)_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)(const void *)p));
}

PBF_FN lane_indices lane_indices_of(const uint32_t first[PARTS], u32_lanes s) {
  (void)first;
  return (lane_indices){(__m512i)s, _mm512_test_epi32_mask((__m512i)s, _mm512_set1_epi32(SLOTS))};
}
PBF_FN window window_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  window t;
  for (int part = 0; part < PARTS; ++part) {
    t.low[part] = _mm512_loadu_ps(array + first[part] - 1);
    t.high[part] = _mm512_loadu_ps(array + first[part] - 1 + WIDTH);
  }
  t.low[0] = _mm512_mask_mov_ps(t.low[0], 1, _mm512_set1_ps(sentinel));
  return t;
}
/* The permutation looks at the slot's low five bits. */
PBF_FN lane window_at(const window *t, lane_indices p) {
  __m512 first = _mm512_permutex2var_ps(t->low[0], p.slot, t->high[0]);
  __m512 second = _mm512_permutex2var_ps(t->low[1], p.slot, t->high[1]);
  return (lane)_mm512_mask_mov_ps(first, p.second, second);
}

/* What an array of 32 has at these places. */
#define LANES_LOOK_UP
PBF_FN lane lanes_look_up(const pbf_real *array, const int places[WIDTH]) {
  return (lane)_mm512_permutex2var_ps(_mm512_loadu_ps(array), _mm512_loadu_si512(places),
                                      _mm512_loadu_ps(array + WIDTH));
}

/* The leading bit of the first mask, and once that is empty of the second; then 64, that is 0. */
#define LANES_LIST_BY_MASKS
PBF_FN void u32_list(const u32_lanes masks[PARTS], uint32_t, uint32_t rounds, uint8_t *list) {
  const __m512i top = _mm512_set1_epi32(INT32_MIN);
  __m512i a = (__m512i)masks[0], b = (__m512i)masks[1];
  for (uint32_t r = 0; r < rounds; ++r, list += WIDTH) {
    __m512i in_a = _mm512_lzcnt_epi32(a), in_b = _mm512_lzcnt_epi32(b);
    __mmask16 from_b = _mm512_testn_epi32_mask(a, a);
    __m512i slot = _mm512_mask_add_epi32(in_a, from_b, in_a, in_b);
    a = _mm512_andnot_si512(_mm512_srlv_epi32(top, in_a), a);
    b = _mm512_mask_andnot_epi32(b, from_b, _mm512_srlv_epi32(top, in_b), b);
    slot = _mm512_and_si512(slot, _mm512_set1_epi32(PARTS * SLOTS - 1));
    _mm_storeu_si128((__m128i *)(void *)list, _mm512_cvtepi32_epi8(slot));
  }
}

#else

enum { PARTS = 8 };
typedef struct window {
  const pbf_real *array;
  lane sentinel;
} window;
typedef struct lane_indices {
  __m256i index;
  __mmask8 known;
} lane_indices;

namespace {
template <>
struct ops<lane> {
  static PBF_IN lane set(pbf_real a) { return (lane)_mm512_set1_pd(a); }
  static PBF_IN lane max(lane a, lane b) { return (lane)_mm512_max_pd((__m512d)a, (__m512d)b); }
  static PBF_IN lane multiply_add(lane a, lane b, lane c) { return a * b + c; }
  static PBF_IN lane sqrt(lane a) { return (lane)_mm512_sqrt_pd((__m512d)a); }
  static PBF_IN lane root(lane a) { return sqrt(a); }
  static PBF_IN lane over_root(lane b, lane a) { return b / sqrt(a); }
};
}  // namespace

PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm512_loadu_pd(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm512_storeu_pd(p, (__m512d)a); }
PBF_FN int lane_any_below(lane a, lane b) {
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ) != 0;
}
PBF_FN int lane_all_below(lane a, lane b) {
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ) == 0xff;
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
PBF_FN uint32_t u32_max(u32_lanes a) {
  uint32_t largest = a[0];
  for (int k = 1; k < WIDTH; ++k) largest = a[k] > largest ? a[k] : largest;
  return largest;
}
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  __mmask8 less = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
  return (u32_lanes)_mm256_mask_or_epi32((__m256i)m, less, (__m256i)m, (__m256i)bit);
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) {
  __mmask8 below = _mm256_cmplt_epu32_mask((__m256i)a, _mm256_set1_epi32((int)limit));
  return (u32_lanes)_mm256_maskz_set1_epi32(below, -1);
}

PBF_FN uint32_t u32_any(u32_lanes a) {
  uint32_t any = a[0];
  for (int k = 1; k < WIDTH; ++k) any |= a[k];
  return any;
}
PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) {
  return (u32_lanes)_mm256_slli_epi32((__m256i)a, count);
}
PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) {
  return (u32_lanes)_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p));
}

PBF_FN lane_indices lane_indices_of(const uint32_t first[PARTS], u32_lanes s) {
  __m256i firsts = _mm256_loadu_si256((const __m256i *)(const void *)first);
  u32_lanes begin = (u32_lanes)_mm256_permutevar8x32_epi32(firsts, (__m256i)u32_shift_right(s, 5));
  return (lane_indices){(__m256i)(begin + (s & u32_set(SLOTS - 1)) - u32_set(1)),
                        _mm256_test_epi32_mask((__m256i)s, (__m256i)s)};
}
PBF_FN window window_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  (void)first;
  return (window){array, ops<lane>::set(sentinel)};
}
PBF_FN lane window_at(const window *t, lane_indices p) {
  return (lane)_mm512_mask_i32gather_pd((__m512d)t->sentinel, p.known, p.index, t->array, 8);
}

#endif
