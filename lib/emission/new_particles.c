#include "new_particles.h"

#include "memory.h"
#include "params.h"
#include "solver/solver_time.h"

pbf_status pbf_emission_reserve(pbf_solver *solver, pbf_emission *e, uint64_t count) {
  const uint64_t bytes = 2 * count * pbf_point_bytes(solver);
  void *memory;
  if (e->particles_bytes >= bytes) return PBF_OK;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "particles of emitters", &memory);
  if (status != PBF_OK) return status;
  pbf_memory_free(&solver->allocator, e->particles, e->particles_bytes);
  e->particles = memory;
  e->particles_bytes = bytes;
  return PBF_OK;
}

static double stored(double number, uint32_t precision) {
  return precision == PBF_FLOAT32 ? (double)(float)number : number;
}

void pbf_emission_put(const pbf_solver *solver, void *array, uint64_t index, double number) {
  if (solver->kind.precision == PBF_FLOAT32)
    ((float *)array)[index] = (float)number;
  else
    ((double *)array)[index] = number;
}

int pbf_emission_is_inside(const pbf_solver *solver, const double place[3]) {
  const uint32_t precision = solver->kind.precision;
  const pbf_box all =
      pbf_params_box(&solver->params, solver->kind.dimension, pbf_solver_time(solver));
  const pbf_box *box = &all;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    const double x = stored(place[k], precision);
    if (!(x >= stored(box->lower[k], precision) && x <= stored(box->upper[k], precision))) return 0;
  }
  return 1;
}
