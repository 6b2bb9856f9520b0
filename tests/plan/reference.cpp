/* The reference: what it runs and holds. */
#define PBF_VARIANT_API reference_under_test
#include "reference/plugin.h"
extern "C" const pbf_backend_api reference_under_test;
#include "reference/backend.cpp"

static pbf_status begin(const pbf_backend_desc *desc, const pbf_params *params,
                        pbf_backend_solver **solver, const pbf_backend_api **api) {
  return create(desc, params, solver, api);
}

#include "entered.h"

template <class Element>
static uint64_t held_bytes(Element *const *) {
  return COUNT * sizeof(Element);
}
static uint64_t held_bytes(const pbf_pressure_grid_storage *) {
  return pbf_pressure_grid_words(COUNT) * sizeof(double);
}
static uint64_t held_bytes(const pbf_topology_memory *) { return pbf_topology_memory_bytes(COUNT); }
static uint64_t held_bytes(const pbf_cell_moves *) {
  return pbf_cell_move_words(COUNT) * sizeof(int64_t);
}
static uint64_t held_bytes() { return 0; }

static uint64_t wanted_bytes(const solver *s, const pbf_schedule &has, const pbf_params &params) {
  uint64_t bytes = 0;
#define PBF_ARRAY(name, wanted, holders) \
  if (wanted) bytes += allocated(held_bytes(holders));
#define PBF_REFERENCE(type, member) &s->member
#include "physics/arrays.def"
  if (has.colliders)
    bytes += allocated(pbf_collider_table_bytes(pbf_collider_room((uint32_t)has.colliders), 1));
  return bytes;
}

static const watched *watched_at(unsigned k) {
  static const watched list[] = {
      WATCH_STAGE(predict, NOTHING, "predict"),
      WATCH_STAGE(grid_build, NOTHING, "neighbors"),
      WATCH_STAGE(compute_lambda, NOTHING, "lambda"),
      WATCH_STAGE(move, NOTHING, "move"),
      WATCH_STAGE(end_solve, NOTHING, "velocity"),
      WATCH_STAGE(compute_curl, VORTICITY, "curl"),
      WATCH_STAGE(confine_vorticity, VORTICITY, "confine"),
      WATCH_STAGE(apply_viscosity, VISCOSITY, "viscosity"),
      WATCH_STAGE(solve_pressure_grid, PRESSURE_GRID, "pressure grid"),
      WATCH_STAGE(update_sleep, SLEEP, "sleep"),
      WATCH(pbf_activity, SLEEP),
      WATCH(poly6<pbf_real>, POLY6),
      WATCH(artificial_pressure<pbf_real>, SCORR),
      WATCH(add_cross<pbf_real>, VORTICITY),
      WATCH(pbf_confine, VORTICITY),
      WATCH(pbf_surface_at, COLLIDERS),
      WATCH(pbf_find_contact<pbf_surface>, COLLIDERS),
      WATCH(pbf_wall_density, WALL_DENSITY),
      WATCH(pbf_accelerate, CHEBYSHEV),
      WATCH(pbf_error_units, TOLERANCE),
      WATCH(solver_density, STATS),
      WATCH(add_to_stats, STATS),
      WATCH(pbf_derive_from, NOTHING),
      WATCH(pbf_set_walls, NOTHING),
      WATCH(pbf_region_basins_of, NOTHING),
      {"field_at", NULL, NOTHING, NULL}, /* it has none: particles are read at once */
      {NULL, NULL, 0, NULL},
  };
  static_assert(sizeof list / sizeof *list <= MAX_WATCHED + 1, "counters for all");
  return &list[k];
}

void reference_probe(const pbf_workload *workload, pbf_probe_result *result) {
  (void)workload, (void)result;
}

int main(void) { return test_the_plan(); }
