#include "sums.h"

#include <math.h>
#include <string.h>

/* ---- The kernel ------------------------------------------------------------------------------ */

/* Wendland's C2 without its norm: (1 - q)⁴ (4 q + 1). */
static double kernel(double q) {
  const double u = (1 - q) * (1 - q);
  return u * u * (4 * q + 1);
}

/* Its derivative by q over q. */
static double kernel_slope(double q) { return -20 * (1 - q) * (1 - q) * (1 - q); }

/* ---- Particles within the radius ------------------------------------------------------------- */

/* Of a part of a run. That they are found first and summed up then keeps branches that go one way
 * as often as the other out of both. */
enum { PART = 64 };

typedef struct near {
  uint32_t count, particles[PART];
  double squares[PART], ways[PART][3]; /* from the point, in units of the radius */
} near;

static inline __attribute__((always_inline)) void find(const pbf_query_index *index,
                                                       const double *point, uint32_t begin,
                                                       uint32_t end, uint32_t dimension,
                                                       uint32_t precision, near *n) {
  const double inv_radius = 1 / index->radius;
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

/* Those of a run from *begin on, which goes to where the next ones begin. */
static void find_part(const pbf_query_index *index, const double *point, const pbf_query_run *run,
                      uint32_t *begin, near *n) {
  const uint32_t from = *begin, end = run->end - from > PART ? from + PART : run->end;
  *begin = end;
  if (index->dimension == 3 && index->precision == PBF_FLOAT32)
    find(index, point, from, end, 3, PBF_FLOAT32, n);
  else if (index->dimension == 3)
    find(index, point, from, end, 3, PBF_FLOAT64, n);
  else if (index->precision == PBF_FLOAT32)
    find(index, point, from, end, 2, PBF_FLOAT32, n);
  else
    find(index, point, from, end, 2, PBF_FLOAT64, n);
}

/* ---- Density --------------------------------------------------------------------------------- */

static void add_density(const near *n, double *sum) {
  double kernels[PART];
  for (uint32_t j = 0; j < n->count; ++j) kernels[j] = kernel(sqrt(n->squares[j]));
  for (uint32_t j = 0; j < n->count; ++j) *sum += kernels[j]; /* NOLINT */
}

static void add_slope(const near *n, uint32_t dimension, double slope[3]) {
  for (uint32_t j = 0; j < n->count; ++j) {
    const double s = kernel_slope(sqrt(n->squares[j]));
    for (uint32_t k = 0; k < dimension; ++k) slope[k] -= s * n->ways[j][k]; /* NOLINT */
  }
}

double pbf_query_density(pbf_query_place *place, const double *point, double *gradient) {
  const pbf_query_index *index = place->index;
  double sum = 0, slope[3] = {0, 0, 0}, images[PBF_QUERY_IMAGES][3];
  near n;
  for (uint32_t i = pbf_query_images(index, point, images); i-- > 0;) {
    pbf_query_go(place, images[i]);
    for (uint32_t run = 0; run < place->count; ++run) {
      for (uint32_t begin = place->runs[run].begin; begin < place->runs[run].end;) {
        find_part(index, images[i], &place->runs[run], &begin, &n);
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

enum { VALUES = 4 };

/* Weighted means: of the ways from the point, of their products, of the values and of those times
 * the ways. */
typedef struct moments {
  double weight, way[3], ways[3][3], value[VALUES], slope[VALUES][3];
} moments;

static inline void read_values(const pbf_query_index *index, uint32_t particle, uint32_t fields,
                               double values[VALUES]) {
  const uint32_t n = index->dimension, precision = index->precision;
  for (uint32_t k = 0; k < n && fields & PBF_QUERY_VELOCITIES; ++k)
    values[k] = pbf_query_number(index->velocities, (uint64_t)particle * n + k, precision);
  if (fields & PBF_QUERY_PRESSURES)
    values[3] = pbf_query_number(index->pressures, particle, precision);
}

static inline void add(moments *m, double w, const double r[3], const double values[VALUES],
                       uint32_t dimension) {
  m->weight += w;
  for (uint32_t k = 0; k < dimension; ++k) {
    m->way[k] += w * r[k];
    for (uint32_t l = 0; l <= k; ++l) m->ways[k][l] += w * r[k] * r[l];
  }
  for (uint32_t v = 0; v < VALUES; ++v) {
    m->value[v] += w * values[v];
    for (uint32_t k = 0; k < dimension; ++k) m->slope[v][k] += w * values[v] * r[k];
  }
}

static inline __attribute__((always_inline)) void collect(const pbf_query_index *index,
                                                          const near *n, uint32_t fields,
                                                          uint32_t dimension, moments *m) {
  double values[VALUES] = {0};
  for (uint32_t j = 0; j < n->count; ++j) {
    read_values(index, n->particles[j], fields, values);                /* NOLINT */
    add(m, kernel(sqrt(n->squares[j])), n->ways[j], values, dimension); /* NOLINT */
  }
}

static void collect_all(const pbf_query_place *place, const double *point, uint32_t fields,
                        moments *m) {
  near n;
  for (uint32_t run = 0; run < place->count; ++run) {
    for (uint32_t begin = place->runs[run].begin; begin < place->runs[run].end;) {
      find_part(place->index, point, &place->runs[run], &begin, &n);
      if (place->index->dimension == 3)
        collect(place->index, &n, fields, 3, m);
      else
        collect(place->index, &n, fields, 2, m);
    }
  }
}

/* Sums become means, and products those about the means. */
static void centre(moments *m, uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k) m->way[k] /= m->weight;
  for (uint32_t v = 0; v < VALUES; ++v) {
    m->value[v] /= m->weight;
    for (uint32_t k = 0; k < dimension; ++k)
      m->slope[v][k] = m->slope[v][k] / m->weight - m->value[v] * m->way[k];
  }
  for (uint32_t k = 0; k < dimension; ++k)
    for (uint32_t l = 0; l <= k; ++l)
      m->ways[k][l] = m->ways[k][l] / m->weight - m->way[k] * m->way[l];
}

/* The square of 0.22 spacings in the radius that three of them are: half a spacing above a surface
 * particles spread by 0.28 across it. Along what they spread less, a slope would be noise. */
static const double min_spread = 0.0055;

/* L D Lᵀ of the symmetric m->ways, in its place; a D of 0 stands for one that is too small. */
static void decompose(moments *m, uint32_t n) {
  for (uint32_t k = 0; k < n; ++k) {
    double pivot = m->ways[k][k];
    for (uint32_t j = 0; j < k; ++j) pivot -= m->ways[k][j] * m->ways[k][j] * m->ways[j][j];
    m->ways[k][k] = pivot = pivot > min_spread ? pivot : 0;
    for (uint32_t i = k + 1; i < n; ++i) {
      double sum = m->ways[i][k];
      for (uint32_t j = 0; j < k; ++j) sum -= m->ways[i][j] * m->ways[k][j] * m->ways[j][j];
      m->ways[i][k] = pivot > 0 ? sum / pivot : 0;
    }
  }
}

static void solve(const moments *m, double b[3], uint32_t n) {
  for (uint32_t k = 0; k < n; ++k)
    for (uint32_t j = 0; j < k; ++j) b[k] -= m->ways[k][j] * b[j];
  for (uint32_t k = 0; k < n; ++k) b[k] = m->ways[k][k] > 0 ? b[k] / m->ways[k][k] : 0;
  for (uint32_t k = n; k-- > 0;)
    for (uint32_t i = k + 1; i < n; ++i) b[k] -= m->ways[i][k] * b[i];
}

void pbf_query_fields(pbf_query_place *place, const double *point, uint32_t fields,
                      double values[VALUES]) {
  const uint32_t n = place->index->dimension;
  double images[PBF_QUERY_IMAGES][3];
  moments m = {0};
  memset(values, 0, VALUES * sizeof *values);
  for (uint32_t i = pbf_query_images(place->index, point, images); i-- > 0;) {
    pbf_query_go(place, images[i]);
    collect_all(place, images[i], fields, &m);
  }
  if (!(m.weight > 0)) return;
  centre(&m, n);
  decompose(&m, n);
  for (uint32_t v = 0; v < VALUES; ++v) {
    solve(&m, m.slope[v], n);
    values[v] = m.value[v];
    for (uint32_t k = 0; k < n; ++k) values[v] -= m.slope[v][k] * m.way[k];
  }
}
