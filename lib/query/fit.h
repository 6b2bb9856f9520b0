/* The straight line that fits the values of particles around a point best. */
#ifndef PBF_LIB_QUERY_FIT_H
#define PBF_LIB_QUERY_FIT_H

#include <stdint.h>

enum { PBF_FIT_VALUES = 4 };

/* Weighted means: of the ways from the point, of their products, of the values and of those times
 * the ways. */
typedef struct pbf_fit {
  double weight, way[3], ways[3][3], value[PBF_FIT_VALUES], slope[PBF_FIT_VALUES][3];
} pbf_fit;

static inline void pbf_fit_add(pbf_fit *m, double w, const double r[3],
                               const double values[PBF_FIT_VALUES], uint32_t dimension) {
  m->weight += w;
  for (uint32_t k = 0; k < dimension; ++k) {
    m->way[k] += w * r[k];
    for (uint32_t l = 0; l <= k; ++l) m->ways[k][l] += w * r[k] * r[l];
  }
  for (uint32_t v = 0; v < PBF_FIT_VALUES; ++v) {
    m->value[v] += w * values[v];
    for (uint32_t k = 0; k < dimension; ++k) m->slope[v][k] += w * values[v] * r[k];
  }
}

/* Sums become means, and products those about the means. */
void pbf_fit_centre(pbf_fit *m, uint32_t dimension);

/* L D Lᵀ of the symmetric m->ways, in its place; a D of 0 stands for one that is too small. */
void pbf_fit_decompose(pbf_fit *m, double min_spread, uint32_t dimension);

/* The slope of a value, in the place of its products with the ways. */
void pbf_fit_solve(const pbf_fit *m, double b[3], uint32_t dimension);

#endif
