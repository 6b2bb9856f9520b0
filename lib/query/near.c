#include "near.h"

#include "compiler.h"

static PBF_ALWAYS_INLINE void find_as(const pbf_query_index *index, const double *point,
                                      double inv_radius, uint32_t begin, uint32_t end,
                                      uint32_t dimension, uint32_t precision, pbf_near *n) {
  n->count = 0;
  for (uint32_t i = begin; i < end; ++i) {
    double square = 0;
    for (uint32_t k = 0; k < dimension; ++k) {
      const double at = pbf_query_number(index->points, (uint64_t)i * dimension + k, precision);
      const double r = (at - point[k]) * inv_radius;
      n->ways[n->count][k] = r;
      square += r * r;
    }
    n->squares[n->count] = square;
    n->particles[n->count] = i;
    n->count += square < 1;
  }
}

void pbf_near_find(const pbf_query_index *index, const double *point, double inv_radius,
                   const pbf_query_run *run, uint32_t *begin, pbf_near *n) {
  const uint32_t from = *begin, end = run->end - from > PBF_NEAR ? from + PBF_NEAR : run->end;
  *begin = end;
  if (index->dimension == 3 && index->precision == PBF_FLOAT32)
    find_as(index, point, inv_radius, from, end, 3, PBF_FLOAT32, n);
  else if (index->dimension == 3)
    find_as(index, point, inv_radius, from, end, 3, PBF_FLOAT64, n);
  else if (index->precision == PBF_FLOAT32)
    find_as(index, point, inv_radius, from, end, 2, PBF_FLOAT32, n);
  else
    find_as(index, point, inv_radius, from, end, 2, PBF_FLOAT64, n);
}
