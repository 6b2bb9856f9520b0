/* Which compartment of a divided cell a place is in: one on its own side of what divides the cell,
 * whichever point of the cell is nearest to it. */
#include "solids.h"

#include "physics/pressure_grid/particles.h"

static const double spacing = 0.05, side = 12 * 0.05;

/* Through all of a tank, so thick, at an angle about the third axis, its middle at a place. */
static pbf_surface plate_at(double x, double y, double thick, double angle) {
  pbf_collider box = collider(PBF_COLLIDER_BOX);
  const double middle[3] = {x, y, side / 2};
  for (int k = 0; k < 3; ++k) box.position[k] = middle[k];
  box.half_extents[0] = thick / 2;
  box.half_extents[1] = box.half_extents[2] = 10 * side;
  box.orientation[2] = sin(angle / 2);
  box.orientation[3] = cos(angle / 2);
  return surface_at(&box, 0, 1);
}

/* A grid, and what a plate divides of it. */
typedef struct divided {
  pbf_pressure_grid grid;
  pbf_pressure_grid_topology topology;
  void *memory;
} divided;

static divided divided_by(const pbf_surface *plate) {
  divided of;
  const pbf_domain domain = {.lower = point(0, 0, 0), .upper = point(side, side, side)};
  pbf_params params = test_params(0);
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.pressure_grid = 2;
  for (int k = 0; k < PBF_DIM; ++k) params.domain_max[k] = side;
  of.grid = pbf_pressure_grid_between(&params, &domain, 0, 1 << 16);
  const uint64_t limit = 4 * (uint64_t)of.grid.nodes;
  of.memory = calloc(1, pbf_pressure_grid_topology_bytes(limit));
  assert_non_null(of.memory);
  of.topology = pbf_pressure_grid_topology_in(of.memory, limit, limit);
  of.topology.surfaces = plate;
  of.topology.is_active = of.topology.surface_count = 1;
  of.topology.domain = domain;
  for (uint32_t cell = 0; cell < of.grid.nodes; ++cell) {
    int i[PBF_DIM];
    pbf_pressure_grid_place(&of.grid, cell, i);
    if (pbf_cell_is_inside(&of.grid, i)) pbf_divide_cell(&of.grid, &of.topology, cell, i);
  }
  return of;
}

/* How far a place is before the middle of a plate. */
static double before(const pbf_surface *plate, pbf_vec x) {
  return pbf_dot(pbf_sub(x, plate->center), plate->frame[0]);
}

/* Whether all points of a compartment are on this side of the plate. */
static int lies_before(const divided *of, const pbf_surface *plate, uint32_t compartment,
                       int is_before) {
  const uint32_t cell = pbf_compartment_cell(&of->topology, compartment);
  int i[PBF_DIM], at[PBF_DIM];
  pbf_pressure_grid_place(&of->grid, cell, i);
  for (int p = 0; p < 64; ++p) {
    if (!(of->topology.samples[compartment] >> p & 1)) continue;
    pbf_sample_place(p, at);
    if ((before(plate, pbf_sample_at(&of->grid, i, at)) > 0) != is_before) return 0;
  }
  return 1;
}

static void test_places_are_on_their_own_side(void **state) {
  (void)state;
  uint32_t random = 7;
  int found = 0, met = 0;
  for (int turn = 0; turn < 12; ++turn) {
    const double thick = (turn % 3 ? 0.02 : 0.9) * spacing, angle = 0.29 * turn;
    const pbf_surface plate = plate_at(side * (0.4 + 0.2 * next_random(&random)),
                                       side * (0.4 + 0.2 * next_random(&random)), thick, angle);
    const divided of = divided_by(&plate);
    for (int k = 0; k < 10000; ++k) {
      pbf_vec x;
      double at[PBF_DIM];
      for (int a = 0; a < PBF_DIM; ++a) x.c[a] = (pbf_real)(side * next_random(&random));
      const double away = before(&plate, x);
      const uint32_t cell = pbf_pressure_grid_cell(&of.grid, x, at);
      if (fabs(away) < 0.51 * thick || !pbf_cell_is_cut(&of.topology, cell)) continue;
      double cells[PBF_DIM];
      for (int a = 0; a < PBF_DIM; ++a) cells[a] = pbf_pressure_grid_before(&of.grid, a, x.c[a]);
      const uint32_t compartment = pbf_nearest_compartment(&of.grid, &of.topology, x, cells);
      ++met;
      if (compartment == PBF_NO_INDEX) continue;
      ++found;
      if (pbf_cell_is_cut(&of.topology, pbf_compartment_cell(&of.topology, compartment)))
        assert_true(lies_before(&of, &plate, compartment, away > 0));
    }
    free(of.memory);
  }
  assert_true(met > 20000);
  assert_true(found > 0.95 * met); /* what a plate hides from all points is next to it */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_places_are_on_their_own_side)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
