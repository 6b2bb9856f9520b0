/* The CPU solver, in scalar lanes and one thread: what it runs and holds. */
#define PBF_VARIANT_API PBF_KERNELS_API
#include "cpu/kernels.cpp"
#undef PBF_VARIANT_API
#define PBF_VARIANT_API cpu_under_test
extern "C" const pbf_backend_api cpu_under_test;
#include "cpu/backend.cpp"

static pbf_status begin(const pbf_backend_desc *desc, const pbf_params *params,
                        pbf_backend_solver **solver, const pbf_backend_api **api) {
  const cpu_desc with_team = {*desc, &cpu_team};
  return create(&with_team.desc, params, solver, api);
}

#include "entered.h"

template <class Element>
static uint64_t held_bytes(Element *const *, extent e) {
  return e.count * sizeof(Element);
}
static uint64_t held_bytes(const field *, extent e) { return e.count * sizeof(pbf_real); }
static uint64_t held_bytes(const pbf_pressure_grid_storage *, extent e) {
  return e.count * sizeof(double);
}
static uint64_t held_bytes(const pbf_topology_memory *, extent e) { return e.count; }
static uint64_t held_bytes(const pbf_cell_moves *, extent e) { return e.count * sizeof(int64_t); }
static uint64_t held_bytes() { return 0; }

static uint64_t wanted_bytes(const solver *s, const pbf_schedule &has, const pbf_params &params) {
  uint64_t bytes = 0;
#define PBF_ARRAY(name, wanted, holders) \
  if (wanted) bytes += allocated(held_bytes(holders));
#define PBF_CPU(type, member, extent) &s->member, extent(s)
#define PBF_CPU_BUFFER(type, member, extent) &s->buffers.member, extent(s)
#include "physics/arrays.def"
  if (has.colliders)
    bytes +=
        allocated(pbf_collider_table_bytes(pbf_collider_room((uint32_t)has.colliders), s->threads));
  return bytes;
}

static const watched *watched_at(unsigned k) {
  static const watched list[] = {
      WATCH_STAGE(predict, NOTHING, "predict"),
      WATCH_STAGE(sort_particles, NOTHING, "neighbors"),
      WATCH_STAGE(find_neighbors, NOTHING, "neighbors"),
      WATCH_STAGE(lambda, NOTHING, "lambda"),
      WATCH_STAGE(move, NOTHING, "move"),
      WATCH_STAGE(update_velocity, NOTHING, "velocity"),
      WATCH_STAGE(curl, VORTICITY, "curl"),
      WATCH_STAGE(confine, VORTICITY, "confine"),
#ifndef __clang__ /* which has no address of a member function as a pointer */
      WATCH_STAGE(executor::viscosity, VISCOSITY, "viscosity"),
#endif
      WATCH_STAGE(solve_pressure_grid, PRESSURE_GRID, "pressure grid"),
      WATCH_STAGE(update_sleep, SLEEP, "sleep"),
      WATCH(pbf_activity, SLEEP),
      WATCH(poly6<pbf_real>, POLY6),
      WATCH(artificial_pressure<pbf_real>, SCORR),
      WATCH(add_cross<pbf_real>, VORTICITY),
      WATCH(pbf_confine, VORTICITY),
      WATCH(pbf_surface_at, COLLIDERS),
      WATCH(pbf_find_contact<pbf_surface>, COLLIDERS),
      WATCH(resolve_group, COLLIDERS),
      WATCH(pbf_wall_interpolated, WALL_DENSITY),
      WATCH(group_near_obstacles, WALL_DENSITY),
      WATCH(clear_totals, CHEBYSHEV),
      WATCH(pbf_accelerate, CHEBYSHEV),
      WATCH(pbf_error_units, TOLERANCE),
      WATCH(end_when_converged, TOLERANCE),
      WATCH(density, STATS | PRESSURE_GRID),
      WATCH(diagnose_densities, STATS),
      WATCH(pbf_stats_add, STATS),
      WATCH(pbf_seconds, TIMING),
      WATCH(pbf_derive_from, NOTHING),
      WATCH(pbf_set_walls, NOTHING),
      WATCH(pbf_region_basins_of, NOTHING),
      WATCH(field_at, NOTHING),
      {NULL, NULL, 0, NULL},
  };
  static_assert(sizeof list / sizeof *list <= MAX_WATCHED + 1, "counters for all");
  return &list[k];
}

int main(void) { return test_the_plan(); }
