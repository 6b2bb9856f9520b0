/* What has to hold at any time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "river.h"

#define FAIL(r, ...) (snprintf((r)->fault, sizeof(r)->fault, __VA_ARGS__), 0)

/* What came is there, or has gone. */
static int check_balance(river *r, uint32_t count) {
  pbf_in_out io = {.struct_size = sizeof io};
  river_must(pbf_get_in_out(r->solver, &io), "what came and went");
  const uint64_t came = r->put + io.emitted;
  const uint64_t went = r->taken + io.drained + io.expired + io.recycled;
  if (came == count + went) return 1;
  return FAIL(r, "%llu particles came and %llu went, but %u are there", (unsigned long long)came,
              (unsigned long long)went, count);
}

static void read_rows(river *r, uint32_t field, uint32_t count, double *rows) {
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = field,
                        .count = count,
                        .element_type = PBF_TYPE_FLOAT64,
                        .data = rows};
  if (count > 0) river_must(pbf_read(r->solver, &read), "the particles");
}

static int check_particles(river *r, uint32_t count, const double *x, const double *v) {
  pbf_params params = {.struct_size = sizeof params};
  river_must(pbf_get_params(r->solver, &params), "the parameters");
  for (uint32_t i = 0; i < count * r->dimension; ++i) {
    const uint32_t k = i % r->dimension;
    /* In float32 a wall stands at the nearest number. */
    const double off = 1e-6;
    if (!(x[i] >= params.domain_min[k] - off && x[i] <= params.domain_max[k] + off))
      return FAIL(r, "particle %u is at %g along axis %u, outside of the domain", i / r->dimension,
                  x[i], k);
    if (!isfinite(v[i])) return FAIL(r, "particle %u has the velocity %g", i / r->dimension, v[i]);
    r->fastest = fmax(r->fastest, fabs(v[i]));
  }
  return 1;
}

static int check_ids(river *r, uint32_t count) {
  uint32_t *ids = malloc((count + 1) * sizeof *ids);
  int increase = ids != NULL;
  if (ids && count > 0) river_must(pbf_get_ids(r->solver, 0, count, ids), "the ids");
  for (uint32_t i = 1; increase && i < count; ++i) increase = ids[i] > ids[i - 1];
  free(ids);
  return increase ? 1 : FAIL(r, "ids do not increase");
}

/* Of a point from a collider, below 0 inside. All turn about z alone. */
static double distance_to(const pbf_collider *c, const double *x, uint32_t dimension) {
  const double s = 2 * c->orientation[3] * c->orientation[2],
               cosine = 1 - 2 * c->orientation[2] * c->orientation[2];
  const double a = x[0] - c->position[0], b = x[1] - c->position[1];
  double local[3] = {cosine * a + s * b, cosine * b - s * a, 0}, distance = -INFINITY;
  if (dimension == 3) local[2] = x[2] - c->position[2];
  if (c->shape == PBF_COLLIDER_SHAPE) {
    for (int k = 0; k < 3; ++k) local[k] /= c->scale;
    river_must(pbf_get_shape_distance(c->geometry, local, &distance, NULL), "a distance");
    return c->scale * distance;
  }
  for (uint32_t k = 0; k < dimension; ++k)
    distance = fmax(distance, fabs(local[k]) - c->half_extents[k]);
  return distance;
}

/* Centres stay out of solids. One that two close upon has no room and stays until it has; one in
 * which a solid has jumped or grown is pushed out at a bounded speed; so those are counted, and
 * only the bed, which does neither, must have none that the wheel and crates let alone. */
static int check_solids(river *r, uint32_t count, const double *x) {
  pbf_collider colliders[RIVER_COLLIDERS];
  river_colliders(r, colliders);
  for (uint32_t i = 0; i < count; ++i) {
    double depth[RIVER_COLLIDERS], nearest = INFINITY;
    for (int c = 0; c < RIVER_COLLIDERS; ++c) {
      const double distance =
          distance_to(&colliders[c], x + (size_t)i * r->dimension, r->dimension);
      depth[c] = -distance / river_spacing;
      if (c != RIVER_BED) nearest = fmin(nearest, distance);
      r->in_solid += depth[c] > 0.1;
    }
    r->deepest = fmax(r->deepest, depth[RIVER_BED]);
    if (depth[RIVER_BED] > 0.5 && nearest > 2 * river_spacing)
      return FAIL(r, "particle %u is %g spacings in the bed, and nothing presses it", i,
                  depth[RIVER_BED]);
  }
  return 1;
}

static int check_probes(river *r) {
  enum { POINTS = 16 };
  const uint32_t n = r->dimension;
  double at[POINTS * 3], down[POINTS * 3] = {0}, levels[POINTS], far[POINTS], normals[POINTS * 3];
  double densities[POINTS], velocities[POINTS * 3];
  uint8_t wet[POINTS];
  pbf_params params = {.struct_size = sizeof params};
  river_must(pbf_get_params(r->solver, &params), "the parameters");
  for (uint32_t i = 0; i < POINTS; ++i) {
    for (uint32_t k = 0; k < n; ++k) at[i * n + k] = k == 1 ? 0.5 : k == 0 ? 0.1 + 0.1 * i : 0.25;
    down[i * n + 1] = -1;
  }
  const pbf_samples samples = {.struct_size = sizeof samples,
                               .count = POINTS,
                               .points = at,
                               .densities = densities,
                               .velocities = velocities,
                               .wet = wet};
  river_must(pbf_sample(r->solver, &samples), "the probes");
  river_must(pbf_cast_rays(r->solver, POINTS, at, down, 2, far, normals), "the rays");
  river_must(pbf_get_levels(r->solver, POINTS, at, levels), "the levels");
  for (uint32_t i = 0; i < POINTS; ++i) {
    int fine = densities[i] >= 0 && densities[i] < 20 && wet[i] == (densities[i] >= 0.5);
    for (uint32_t k = 0; k < n; ++k) fine = fine && isfinite(velocities[i * n + k]);
    fine = fine && far[i] >= 0 && (isinf(far[i]) || far[i] <= 2) && !isinf(levels[i]);
    if (!fine)
      return FAIL(r, "probe %u tells density %g, a ray %g, a level %g", i, densities[i], far[i],
                  levels[i]);
  }
  pbf_volume volume;
  pbf_volume_flow flow = {.struct_size = sizeof flow};
  river_must(pbf_volume_init(&volume, sizeof volume, PBF_VOLUME_SPHERE), "a volume");
  volume.position[0] = 0.5, volume.position[1] = 0.4, volume.position[2] = 0.25;
  volume.radius = 0.15;
  river_must(pbf_measure_volumes(r->solver, 1, &volume, &flow), "a volume");
  if (!(flow.fraction >= 0 && flow.fraction <= 1))
    return FAIL(r, "a volume tells that %g of it is water", flow.fraction);
  return 1;
}

int river_check(river *r) {
  uint32_t count = 0;
  pbf_stats stats = {.struct_size = sizeof stats};
  if (r->fault[0]) return 0;
  river_must(pbf_get_count(r->solver, &count), "the count");
  river_must(pbf_get_stats(r->solver, &stats), "the sums");
  r->squeezed += stats.squeezed;
  double *x = malloc(sizeof *x * 6 * (count + 1)), *v = x ? x + (size_t)3 * (count + 1) : NULL;
  if (!x) return FAIL(r, "there is no memory to look at %u particles", count);
  read_rows(r, PBF_FIELD_POSITION, count, x);
  read_rows(r, PBF_FIELD_VELOCITY, count, v);
  const int fine = check_balance(r, count) && check_particles(r, count, x, v) &&
                   check_ids(r, count) && check_solids(r, count, x) && check_probes(r);
  free(x);
  return fine;
}
