/* AVX2 with FMA: 8 floats or 4 doubles, tables read by gathers. */
#include <immintrin.h>

typedef pbf_real lane __attribute__((vector_size(32)));
enum { WIDTH = 32 / sizeof(pbf_real) };
typedef uint32_t slots __attribute__((vector_size(4 * WIDTH)));
typedef struct table {
  const pbf_real *slot;
  lane far;
} table;

#if PBF_BITS == 32

PBF_FN lane lane_set(pbf_real a) { return (lane)_mm256_set1_ps(a); }
PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm256_loadu_ps(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm256_storeu_ps(p, (__m256)a); }
PBF_FN lane lane_max(lane a, lane b) { return (lane)_mm256_max_ps((__m256)a, (__m256)b); }
PBF_FN lane lane_fma(lane a, lane b, lane c) {
  return (lane)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}
PBF_FN lane lane_sqrt(lane a) { return (lane)_mm256_sqrt_ps((__m256)a); }
/* An estimate of 12 bits and one Newton step: 2e-7. */
PBF_FN lane lane_rsqrt(lane a) {
  lane y = (lane)_mm256_rsqrt_ps((__m256)a);
  return y * lane_fma(a * y, y * lane_set(-0.5f), lane_set(1.5f));
}

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
/* The exponent of the mask as a float; what follows a set bit is dropped so that nothing rounds up.
 */
PBF_FN slots slots_leading(slots m) {
  slots leading = m & ~slots_shift_right(m, 1);
  __m256 value = _mm256_cvtepi32_ps((__m256i)leading);
  return slots_set(127 + 31) - slots_shift_right((slots)_mm256_castps_si256(value), 23);
}
PBF_FN slots slots_mark(slots m, lane a, lane b, uint32_t bit) {
  return m | ((slots)_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ) & slots_set(bit));
}
PBF_FN slots slots_below(slots a, uint32_t limit) {
  return (slots)_mm256_cmpgt_epi32(_mm256_set1_epi32((int)limit), (__m256i)a);
}

PBF_FN table table_of(const pbf_real *slot, pbf_real far) { return (table){slot, lane_set(far)}; }
PBF_FN lane table_at(const table *t, slots s) {
  __m256 known = _mm256_castsi256_ps((__m256i)slots_below(s, SLOTS));
  return (lane)_mm256_mask_i32gather_ps((__m256)t->far, t->slot, (__m256i)s, known, 4);
}

#else

PBF_FN lane lane_set(pbf_real a) { return (lane)_mm256_set1_pd(a); }
PBF_FN lane lane_load(const pbf_real *p) { return (lane)_mm256_loadu_pd(p); }
PBF_FN void lane_store(pbf_real *p, lane a) { _mm256_storeu_pd(p, (__m256d)a); }
PBF_FN lane lane_max(lane a, lane b) { return (lane)_mm256_max_pd((__m256d)a, (__m256d)b); }
PBF_FN lane lane_fma(lane a, lane b, lane c) {
  return (lane)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
PBF_FN lane lane_sqrt(lane a) { return (lane)_mm256_sqrt_pd((__m256d)a); }
PBF_FN lane lane_rsqrt(lane a) { return lane_set(1) / lane_sqrt(a); }

PBF_FN slots slots_set(uint32_t a) { return (slots)_mm_set1_epi32((int)a); }
PBF_FN slots slots_iota(void) { return (slots){0, 1, 2, 3}; }
PBF_FN slots slots_load(const uint32_t *p) {
  return (slots)_mm_loadu_si128((const __m128i *)(const void *)p);
}
PBF_FN void slots_store(uint32_t *p, slots a) {
  _mm_storeu_si128((__m128i *)(void *)p, (__m128i)a);
}
PBF_FN slots slots_shift_right(slots a, int count) {
  return (slots)_mm_srli_epi32((__m128i)a, count);
}
PBF_FN slots slots_bit(slots s) {
  return (slots)_mm_srlv_epi32(_mm_set1_epi32(INT32_MIN), (__m128i)s);
}
PBF_FN slots slots_leading(slots m) {
  slots leading = m & ~slots_shift_right(m, 1);
  __m128 value = _mm_cvtepi32_ps((__m128i)leading);
  return slots_set(127 + 31) - slots_shift_right((slots)_mm_castps_si128(value), 23);
}
PBF_FN slots slots_mark(slots m, lane a, lane b, uint32_t bit) {
  __m256i less = _mm256_castpd_si256(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ));
  __m256i packed = _mm256_permutevar8x32_epi32(less, _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6));
  return m | ((slots)_mm256_castsi256_si128(packed) & slots_set(bit));
}
PBF_FN slots slots_below(slots a, uint32_t limit) {
  return (slots)_mm_cmpgt_epi32(_mm_set1_epi32((int)limit), (__m128i)a);
}

PBF_FN table table_of(const pbf_real *slot, pbf_real far) { return (table){slot, lane_set(far)}; }
PBF_FN lane table_at(const table *t, slots s) {
  __m256d known = _mm256_castsi256_pd(_mm256_cvtepi32_epi64((__m128i)slots_below(s, SLOTS)));
  return (lane)_mm256_mask_i32gather_pd((__m256d)t->far, t->slot, (__m128i)s, known, 8);
}

#endif

PBF_FN uint32_t slots_max(slots a) {
  uint32_t most = a[0];
  for (int k = 1; k < WIDTH; ++k) most = a[k] > most ? a[k] : most;
  return most;
}
