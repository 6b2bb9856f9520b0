#include "solver.h"

#include <stdio.h>
#include <stdlib.h>

#include "flow.h"

const char *checked_backend = "cuda";

void must(pbf_status status, const char *what) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s: %s: %s\n", what, pbf_status_string(status), pbf_last_error());
  exit(status == PBF_ERROR_UNAVAILABLE ? 2 : 1);
}

static void put_part(const scene *s, uint32_t first, uint32_t count, uint32_t precision,
                     void *positions) {
  const uint32_t dim = s->dimension;
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < dim; ++k) {
      const size_t at = (size_t)i * dim + k;
      const float x = (float)scene_coordinate(s, first + i, k);
      if (precision == PBF_FLOAT32)
        ((float *)positions)[at] = x;
      else /* the same numbers as in float32 */
        ((double *)positions)[at] = x;
    }
}

void fill(const scene *s, pbf_solver *solver, uint32_t precision) {
  enum { MOST_AT_ONCE = 1 << 22 };
  const uint32_t count = scene_count(s), most = count < MOST_AT_ONCE ? count : MOST_AT_ONCE;
  void *positions = malloc((size_t)most * s->dimension * precision);
  for (uint32_t first = 0, part; first < count; first += part) {
    part = count - first < most ? count - first : most;
    put_part(s, first, part, precision, positions);
    must(pbf_add_particles(solver, part, positions, NULL, NULL), "pbf_add_particles");
  }
  free(positions);
  if (s->collider_count)
    must(pbf_set_colliders(solver, s->collider_count, s->colliders), "pbf_set_colliders");
}

pbf_solver *solver_for(const scene *s, const char *name, uint32_t precision) {
  pbf_desc desc;
  pbf_solver *solver;
  must(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
  desc.backend = name;
  desc.strict = 1;
  desc.dimension = s->dimension;
  desc.precision = precision;
  desc.capacity = scene_count(s);
  if (getenv("PBF_CHECK_CAPACITY")) /* a backend may choose its way by the capacity */
    desc.capacity = (uint32_t)strtoul(getenv("PBF_CHECK_CAPACITY"), NULL, 10);
  must(pbf_create(&desc, &s->params, &solver), "pbf_create");
  fill(s, solver, precision);
  add_flow(s, solver);
  return solver;
}

double *positions_of(pbf_solver *solver, uint32_t count, uint32_t dim, uint32_t precision) {
  double *out = malloc(sizeof(double) * count * dim);
  if (precision == PBF_FLOAT64) {
    must(pbf_get_positions(solver, 0, count, out), "pbf_get_positions");
    return out;
  }
  float *read = malloc(sizeof(float) * count * dim);
  must(pbf_get_positions(solver, 0, count, read), "pbf_get_positions");
  for (size_t k = 0; k < (size_t)count * dim; ++k) out[k] = read[k];
  free(read);
  return out;
}

pbf_stats stats_of(pbf_solver *solver) {
  pbf_stats stats = {.struct_size = sizeof stats};
  must(pbf_get_stats(solver, &stats), "pbf_get_stats");
  return stats;
}

uint64_t hash_of(pbf_solver *solver) {
  uint64_t hash;
  must(pbf_hash(solver, &hash), "pbf_hash");
  return hash;
}

void *saved(pbf_solver *solver, uint64_t *size) {
  must(pbf_save(solver, NULL, size), "pbf_save");
  void *buffer = malloc(*size);
  must(pbf_save(solver, buffer, size), "pbf_save");
  return buffer;
}
