#include "sums.h"

#include <math.h>
#include <string.h>

#include "compiler.h"
#include "fit.h"
#include "near.h"

/* ---- The kernel ------------------------------------------------------------------------------ */

/* Wendland's C2 without its norm: (1 - q)⁴ (4 q + 1). */
static double kernel(double q) {
  const double u = (1 - q) * (1 - q);
  return u * u * (4 * q + 1);
}

/* Its derivative by q over q. */
static double kernel_slope(double q) { return -20 * (1 - q) * (1 - q) * (1 - q); }

/* ---- Density --------------------------------------------------------------------------------- */

static void add_density(const pbf_near *n, double *sum) {
  double kernels[PBF_NEAR];
  for (uint32_t j = 0; j < n->count; ++j) kernels[j] = kernel(sqrt(n->squares[j]));
  for (uint32_t j = 0; j < n->count; ++j) *sum += kernels[j]; /* NOLINT */
}

static void add_slope(const pbf_near *n, uint32_t dimension, double slope[3]) {
  for (uint32_t j = 0; j < n->count; ++j) {
    const double s = kernel_slope(sqrt(n->squares[j]));
    for (uint32_t k = 0; k < dimension; ++k) slope[k] -= s * n->ways[j][k]; /* NOLINT */
  }
}

double pbf_query_density(pbf_query_place *place, const double *point, double *gradient) {
  const pbf_query_index *index = place->index;
  double sum = 0, slope[3] = {0, 0, 0}, images[PBF_QUERY_IMAGES][3];
  pbf_near n;
  for (uint32_t i = pbf_query_images(index, point, images); i-- > 0;) {
    pbf_query_go(place, images[i]);
    for (uint32_t run = 0; run < place->count; ++run) {
      for (uint32_t begin = place->runs[run].begin; begin < place->runs[run].end;) {
        pbf_near_find(index, images[i], 1 / index->radius, &place->runs[run], &begin, &n);
        add_density(&n, &sum);
        if (gradient) add_slope(&n, index->dimension, slope);
      }
    }
  }
  for (uint32_t k = 0; k < index->dimension && gradient; ++k)
    gradient[k] = index->scale / index->radius * slope[k];
  return index->scale * sum;
}

/* ---- Fields ---------------------------------------------------------------------------------- */

static inline void read_values(const pbf_query_index *index, uint32_t particle, uint32_t fields,
                               double values[PBF_FIT_VALUES]) {
  const uint32_t n = index->dimension, precision = index->precision;
  for (uint32_t k = 0; k < n && fields & PBF_QUERY_VELOCITIES; ++k)
    values[k] = pbf_query_number(index->velocities, (uint64_t)particle * n + k, precision);
  if (fields & PBF_QUERY_PRESSURES)
    values[3] = pbf_query_number(index->pressures, particle, precision);
}

static PBF_ALWAYS_INLINE void collect(const pbf_query_index *index, const pbf_near *n,
                                      uint32_t fields, uint32_t dimension, pbf_fit *m) {
  double values[PBF_FIT_VALUES] = {0};
  for (uint32_t j = 0; j < n->count; ++j) {
    read_values(index, n->particles[j], fields, values);                        /* NOLINT */
    pbf_fit_add(m, kernel(sqrt(n->squares[j])), n->ways[j], values, dimension); /* NOLINT */
  }
}

static void collect_all(const pbf_query_place *place, const double *point, uint32_t fields,
                        pbf_fit *m) {
  pbf_near n;
  for (uint32_t run = 0; run < place->count; ++run) {
    for (uint32_t begin = place->runs[run].begin; begin < place->runs[run].end;) {
      pbf_near_find(place->index, point, 1 / place->index->radius, &place->runs[run], &begin, &n);
      if (place->index->dimension == 3)
        collect(place->index, &n, fields, 3, m);
      else
        collect(place->index, &n, fields, 2, m);
    }
  }
}

/* The square of 0.22 spacings in the radius that three of them are: half a spacing above a surface
 * particles spread by 0.28 across it. Along what they spread less, a slope would be noise. */
static const double min_spread = 0.0055;

void pbf_query_fields(pbf_query_place *place, const double *point, uint32_t fields,
                      double values[PBF_FIT_VALUES]) {
  const uint32_t n = place->index->dimension;
  double images[PBF_QUERY_IMAGES][3];
  pbf_fit m = {0};
  memset(values, 0, PBF_FIT_VALUES * sizeof *values);
  for (uint32_t i = pbf_query_images(place->index, point, images); i-- > 0;) {
    pbf_query_go(place, images[i]);
    collect_all(place, images[i], fields, &m);
  }
  if (!(m.weight > 0)) return;
  pbf_fit_centre(&m, n);
  pbf_fit_decompose(&m, min_spread, n);
  for (uint32_t v = 0; v < PBF_FIT_VALUES; ++v) {
    pbf_fit_solve(&m, m.slope[v], n);
    values[v] = m.value[v];
    for (uint32_t k = 0; k < n; ++k) values[v] -= m.slope[v][k] * m.way[k];
  }
}
