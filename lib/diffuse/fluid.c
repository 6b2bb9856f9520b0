#include "fluid.h"

#include <math.h>

#include "compiler.h"
#include "physics/spacing.h"
#include "query/fit.h"
#include "query/near.h"

/* A particle's neighbours at a flat surface are 0.3 h from it in the mean; inside of moving fluid
 * that is a few hundredths. */
static const double surface_offset = 0.12;

/* The square of 0.22 spacings in the radius h that mostly two of them are, as for queries. */
static const double min_spread = 0.0124;

static double rest_weight(double spacing, double radius, uint32_t dimension) {
  const int reach = (int)(radius / spacing), depth = dimension == 3 ? reach : 0;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -depth; k <= depth; ++k) {
        const double q = sqrt((double)(i * i + j * j + k * k)) * spacing / radius;
        if (q > 0 && q < 1) sum += 1 - q;
      }
  return sum;
}

pbf_fluid pbf_fluid_of(const pbf_solver *solver, const pbf_query_index *index) {
  const double h = solver->params.smoothing_radius;
  return (pbf_fluid){
      .place = {.index = index},
      .radius = h,
      .rest_weight = rest_weight(pbf_derive_spacing(&solver->params), h, solver->kind.dimension)};
}

/* ---- Loops over what is near ----------------------------------------------------------------- */

typedef void (*add_fn)(void *sums, const pbf_fluid *fluid, const pbf_near *near);

static void for_near(pbf_fluid *fluid, const double *point, add_fn add, void *sums) {
  const pbf_query_index *index = fluid->place.index;
  double images[PBF_QUERY_IMAGES][3];
  pbf_near near;
  for (uint32_t i = pbf_query_images(index, point, images); i-- > 0;) {
    pbf_query_go_within(&fluid->place, images[i], fluid->radius);
    for (uint32_t run = 0; run < fluid->place.count; ++run)
      for (uint32_t begin = fluid->place.runs[run].begin; begin < fluid->place.runs[run].end;) {
        pbf_near_find(index, images[i], 1 / fluid->radius, &fluid->place.runs[run], &begin, &near);
        add(sums, fluid, &near);
      }
  }
}

static PBF_ALWAYS_INLINE void read_as(const void *array, uint32_t particle, uint32_t n,
                                      uint32_t precision, double v[3]) {
  for (uint32_t k = 0; k < n; ++k)
    v[k] = pbf_query_number(array, (uint64_t)particle * n + k, precision);
}

/* Calls add_as(…, dimension, precision) with these as constants, which loops go by. */
#define FOR_KIND(index, add_as, ...)                                  \
  do {                                                                \
    if ((index)->dimension == 3 && (index)->precision == PBF_FLOAT32) \
      add_as(__VA_ARGS__, 3, PBF_FLOAT32);                            \
    else if ((index)->dimension == 3)                                 \
      add_as(__VA_ARGS__, 3, PBF_FLOAT64);                            \
    else if ((index)->precision == PBF_FLOAT32)                       \
      add_as(__VA_ARGS__, 2, PBF_FLOAT32);                            \
    else                                                              \
      add_as(__VA_ARGS__, 2, PBF_FLOAT64);                            \
  } while (0)

/* ---- At a point ------------------------------------------------------------------------------ */

typedef struct flow_sums {
  uint32_t count;
  pbf_fit fit;
} flow_sums;

static PBF_ALWAYS_INLINE void add_flow_as(flow_sums *s, const pbf_query_index *index,
                                          const pbf_near *near, uint32_t n, uint32_t precision) {
  double values[PBF_FIT_VALUES] = {0};
  for (uint32_t j = 0; j < near->count; ++j) {
    read_as(index->velocities, near->particles[j], n, precision, values);
    pbf_fit_add(&s->fit, 1 - sqrt(near->squares[j]), near->ways[j], values, n);
  }
}

static void add_flow(void *sums, const pbf_fluid *fluid, const pbf_near *near) {
  const pbf_query_index *index = fluid->place.index;
  flow_sums *s = sums;
  s->count += near->count;
  FOR_KIND(index, add_flow_as, s, index, near);
}

pbf_fluid_flow pbf_fluid_flow_at(pbf_fluid *fluid, const double *point) {
  const uint32_t n = fluid->place.index->dimension;
  flow_sums sums = {0};
  pbf_fit *fit = &sums.fit;
  for_near(fluid, point, add_flow, &sums);
  pbf_fluid_flow flow = {.neighbors = sums.count};
  if (!(fit->weight > 0)) return flow;
  pbf_fit_centre(fit, n);
  pbf_fit_decompose(fit, min_spread, n);
  for (uint32_t v = 0; v < n; ++v) {
    pbf_fit_solve(fit, fit->slope[v], n);
    flow.velocity[v] = fit->value[v];
    for (uint32_t k = 0; k < n; ++k) {
      flow.velocity[v] -= fit->slope[v][k] * fit->way[k];
      flow.gradient[v][k] = fit->slope[v][k] / fluid->radius;
    }
  }
  return flow;
}

/* ---- Around a particle ----------------------------------------------------------------------- */

typedef struct around {
  uint32_t own;
  double velocity[3];
  double closing, weight, way[3];
} around;

/* Between particles in the same place there is no direction. */
static PBF_ALWAYS_INLINE void add_around_as(around *a, const pbf_query_index *index,
                                            const pbf_near *near, uint32_t n, uint32_t precision) {
  for (uint32_t j = 0; j < near->count; ++j) {
    const double q = sqrt(near->squares[j]), w = 1 - q;
    double other[3], speed2 = 0, along = 0;
    if (near->particles[j] == a->own) continue;
    read_as(index->velocities, near->particles[j], n, precision, other);
    for (uint32_t k = 0; k < n; ++k) {
      const double v = a->velocity[k] - other[k];
      speed2 += v * v;
      along -= v * near->ways[j][k]; /* x_ij is from the other one */
      a->way[k] += w * near->ways[j][k];
    }
    a->weight += w;
    if (q > 0) a->closing += w * (sqrt(speed2) - along / q);
  }
}

static void add_around(void *sums, const pbf_fluid *fluid, const pbf_near *near) {
  const pbf_query_index *index = fluid->place.index;
  FOR_KIND(index, add_around_as, sums, index, near);
}

pbf_fluid_sums pbf_fluid_sums_around(pbf_fluid *fluid, uint32_t own) {
  const uint32_t n = fluid->place.index->dimension;
  double position[3], square = 0;
  around a = {.own = own};
  pbf_fluid_sums sums = {0};
  pbf_fluid_particle(fluid, own, position, a.velocity);
  for_near(fluid, position, add_around, &a);
  sums.closing = a.closing / fluid->rest_weight;
  for (uint32_t k = 0; k < n; ++k) square += a.way[k] * a.way[k];
  const double length = sqrt(square);
  if (length > surface_offset * a.weight)
    for (uint32_t k = 0; k < n; ++k) sums.normal[k] = -a.way[k] / length;
  return sums;
}

void pbf_fluid_particle(const pbf_fluid *fluid, uint32_t own, double position[3],
                        double velocity[3]) {
  const pbf_query_index *index = fluid->place.index;
  position[2] = velocity[2] = 0;
  read_as(index->points, own, index->dimension, index->precision, position);
  read_as(index->velocities, own, index->dimension, index->precision, velocity);
}

typedef struct visitor {
  uint32_t own;
  pbf_fluid_visit visit;
  void *context;
} visitor;

static void add_visit(void *sums, const pbf_fluid *fluid, const pbf_near *near) {
  const visitor *v = sums;
  (void)fluid;
  for (uint32_t j = 0; j < near->count; ++j)
    if (near->particles[j] != v->own)
      v->visit(v->context, near->particles[j], near->ways[j], 1 - sqrt(near->squares[j]));
}

void pbf_fluid_each_near(pbf_fluid *fluid, uint32_t own, pbf_fluid_visit visit, void *context) {
  double position[3], velocity[3];
  visitor v = {own, visit, context};
  pbf_fluid_particle(fluid, own, position, velocity);
  for_near(fluid, position, add_visit, &v);
}
