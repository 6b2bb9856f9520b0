/* AVX-512 (F, CD, BW, DQ, VL): 16 floats or 8 doubles. A table of floats is two registers, and
 * looking up in it is one permutation; gathers cost ten times that. */
#include <immintrin.h>

typedef pbf_real lane __attribute__((vector_size(64)));
enum { WIDTH = 64 / sizeof(pbf_real) };
typedef uint32_t slots __attribute__((vector_size(4 * WIDTH)));

#if PBF_BITS == 32

typedef struct table {
  __m512 low, high;
} table;

PBF_FN lane lane_set(pbf_real a) { return (lane)_mm512_set1_ps(a); }
PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm512_loadu_ps(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm512_storeu_ps(p, (__m512)a); }
PBF_FN lane lane_max(lane a, lane b) { return (lane)_mm512_max_ps((__m512)a, (__m512)b); }
PBF_FN lane lane_fma(lane a, lane b, lane c) {
  return (lane)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
PBF_FN lane lane_sqrt(lane a) { return (lane)_mm512_sqrt_ps((__m512)a); }
/* An estimate of 14 bits and one Newton step: within an ulp or two. */
PBF_FN lane lane_rsqrt(lane a) {
  lane y = (lane)_mm512_rsqrt14_ps((__m512)a);
  return y * lane_fma(a * y, y * lane_set(-0.5f), lane_set(1.5f));
}

PBF_FN slots slots_set(uint32_t a) { return (slots)_mm512_set1_epi32((int)a); }
PBF_FN slots slots_iota(void) {
  return (slots){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
PBF_FN slots slots_load(const uint32_t *p) { return (slots)_mm512_loadu_si512(p); }
PBF_FN void slots_store(uint32_t *p, slots a) { _mm512_storeu_si512(p, (__m512i)a); }
PBF_FN slots slots_shift_right(slots a, int count) {
  return (slots)_mm512_srli_epi32((__m512i)a, (unsigned int)count);
}
PBF_FN slots slots_bit(slots s) {
  return (slots)_mm512_srlv_epi32(_mm512_set1_epi32(INT32_MIN), (__m512i)s);
}
PBF_FN slots slots_leading(slots m) { return (slots)_mm512_lzcnt_epi32((__m512i)m); }
PBF_FN uint32_t slots_max(slots a) { return _mm512_reduce_max_epu32((__m512i)a); }
PBF_FN slots slots_mark(slots m, lane a, lane b, uint32_t bit) {
  __mmask16 less = _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
  return (slots)_mm512_mask_or_epi32((__m512i)m, less, (__m512i)m, _mm512_set1_epi32((int)bit));
}
PBF_FN slots slots_below(slots a, uint32_t limit) {
  __mmask16 below = _mm512_cmplt_epu32_mask((__m512i)a, _mm512_set1_epi32((int)limit));
  return (slots)_mm512_maskz_set1_epi32(below, -1);
}

PBF_FN table table_of(const pbf_real *slot, pbf_real far) {
  table t = {_mm512_loadu_ps(slot), _mm512_loadu_ps(slot + WIDTH)};
  t.low = _mm512_mask_mov_ps(t.low, 1, _mm512_set1_ps(far));
  return t;
}
/* Slot 32, of an empty mask, wraps to slot 0. */
PBF_FN lane table_at(const table *t, slots s) {
  return (lane)_mm512_permutex2var_ps(t->low, (__m512i)s, t->high);
}

#else

typedef struct table {
  const pbf_real *slot;
  lane far;
} table;

PBF_FN lane lane_set(pbf_real a) { return (lane)_mm512_set1_pd(a); }
PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm512_loadu_pd(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm512_storeu_pd(p, (__m512d)a); }
PBF_FN lane lane_max(lane a, lane b) { return (lane)_mm512_max_pd((__m512d)a, (__m512d)b); }
PBF_FN lane lane_fma(lane a, lane b, lane c) {
  return (lane)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
PBF_FN lane lane_sqrt(lane a) { return (lane)_mm512_sqrt_pd((__m512d)a); }
PBF_FN lane lane_rsqrt(lane a) { return lane_set(1) / lane_sqrt(a); }

PBF_FN slots slots_set(uint32_t a) { return (slots)_mm256_set1_epi32((int)a); }
PBF_FN slots slots_iota(void) { return (slots){0, 1, 2, 3, 4, 5, 6, 7}; }
PBF_FN slots slots_load(const uint32_t *p) {
  return (slots)_mm256_loadu_si256((const __m256i *)(const void *)p);
}
PBF_FN void slots_store(uint32_t *p, slots a) {
  _mm256_storeu_si256((__m256i *)(void *)p, (__m256i)a);
}
PBF_FN slots slots_shift_right(slots a, int count) {
  return (slots)_mm256_srli_epi32((__m256i)a, count);
}
PBF_FN slots slots_bit(slots s) {
  return (slots)_mm256_srlv_epi32(_mm256_set1_epi32(INT32_MIN), (__m256i)s);
}
PBF_FN slots slots_leading(slots m) { return (slots)_mm256_lzcnt_epi32((__m256i)m); }
PBF_FN uint32_t slots_max(slots a) {
  uint32_t most = a[0];
  for (int k = 1; k < WIDTH; ++k) most = a[k] > most ? a[k] : most;
  return most;
}
PBF_FN slots slots_mark(slots m, lane a, lane b, uint32_t bit) {
  __mmask8 less = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
  return (slots)_mm256_mask_or_epi32((__m256i)m, less, (__m256i)m, _mm256_set1_epi32((int)bit));
}
PBF_FN slots slots_below(slots a, uint32_t limit) {
  __mmask8 below = _mm256_cmplt_epu32_mask((__m256i)a, _mm256_set1_epi32((int)limit));
  return (slots)_mm256_maskz_set1_epi32(below, -1);
}

PBF_FN table table_of(const pbf_real *slot, pbf_real far) { return (table){slot, lane_set(far)}; }
PBF_FN lane table_at(const table *t, slots s) {
  __mmask8 known = _mm256_cmplt_epu32_mask((__m256i)s, _mm256_set1_epi32(SLOTS));
  return (lane)_mm512_mask_i32gather_pd((__m512d)t->far, known, (__m256i)s, t->slot, 8);
}

#endif
