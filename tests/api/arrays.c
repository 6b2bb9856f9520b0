/* Arrays of numbers that do not lie as their elements must, which no call looks at, and arrays that
 * overlap, which every call comes to an end of. */
#include <math.h>

#include <pbf/all.h>

#include "support.h"

/* A byte off whatever malloc and compilers align to. */
static _Alignas(16) char room[4096];
static double *const reals = (double *)(void *)(room + 1);
static float *const singles = (float *)(void *)(room + 1);
static uint32_t *const integers = (uint32_t *)(void *)(room + 1);
static uint64_t *const longs = (uint64_t *)(void *)(room + 1);

/* Each names the argument, and leaves it and the solver as they were. */
#define REFUSED(call, name) assert_fails(call, PBF_ERROR_INVALID_ARGUMENT, name " is 0x")

static void arrays_of_a_solver(void **state) {
  (void)state;
  const double zeros[3] = {0, 0, 0};
  uint32_t count, ids[3];
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 10);
  const uint64_t before = test_hash(s);
  REFUSED(pbf_find_in_box(s, reals, zeros, 0, NULL, &count), "lower");
  REFUSED(pbf_find_in_box(s, zeros, reals, 0, NULL, &count), "upper");
  REFUSED(pbf_find_in_box(s, zeros, zeros, 3, integers, &count), "ids");
  REFUSED(pbf_find_in_box(s, zeros, zeros, 3, ids, integers), "count");
  REFUSED(pbf_remove_in_box(s, reals, zeros, &count), "lower");
  REFUSED(pbf_remove_in_box(s, zeros, zeros, integers), "count");
  REFUSED(pbf_add_particles(s, 1, zeros, NULL, integers), "first_id");
  REFUSED(pbf_shift_diffuse(s, reals), "way");
  REFUSED(pbf_get_step_limit(s, reals), "limit");
  REFUSED(pbf_hash(s, longs), "hash");
  REFUSED(pbf_get_count(s, integers), "count");
  REFUSED(pbf_get_collider_count(s, integers), "count");
  REFUSED(pbf_save(s, NULL, longs), "size");
  REFUSED(pbf_get_backend_count(integers), "count");
  for (size_t i = 0; i < sizeof room; ++i) assert_int_equal(room[i], 0);
  assert_true(test_hash(s) == before);
  pbf_destroy(s);
}

static void arrays_of_shapes(void **state) {
  (void)state;
  const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  double distance, point[3] = {0, 0, 0};
  pbf_shape *shape = NULL, *other = NULL;
  pbf_mesh_desc mesh = {.struct_size = sizeof mesh,
                        .dimension = 3,
                        .vertex_count = 4,
                        .face_count = 4,
                        .vertices = corners,
                        .faces = faces,
                        .cell = 0.1};
  assert_ok(pbf_shape_from_mesh(&mesh, &shape));
  mesh.faces = integers;
  REFUSED(pbf_shape_from_mesh(&mesh, &other), "mesh.faces");
  mesh.vertices = reals;
  REFUSED(pbf_shape_from_mesh(&mesh, &other), "mesh.vertices");
  const pbf_hull_desc hull = {
      .struct_size = sizeof hull, .dimension = 3, .point_count = 4, .points = reals, .cell = 0.1};
  REFUSED(pbf_shape_from_points(&hull, &other), "hull.points");
  const pbf_heights_desc heights = {.struct_size = sizeof heights,
                                    .dimension = 2,
                                    .count = {4, 0},
                                    .heights = reals,
                                    .spacing = 1,
                                    .base = -1,
                                    .cell = 0.1};
  REFUSED(pbf_shape_from_heights(&heights, &other), "heights.heights");
  const pbf_grid_desc grid = {
      .struct_size = sizeof grid, .dimension = 2, .nodes = {3, 3, 0}, .cell = 1, .values = singles};
  REFUSED(pbf_shape_from_grid(&grid, &other), "grid.values");
  REFUSED(pbf_get_shape_values(shape, 1, singles), "values");
  REFUSED(pbf_get_shape_distance(shape, reals, &distance, NULL), "point");
  REFUSED(pbf_get_shape_distance(shape, point, reals, NULL), "distance");
  REFUSED(pbf_get_shape_distance(shape, point, &distance, reals), "normal");
  REFUSED(pbf_save_shape(shape, NULL, longs), "size");
  assert_null(other);
  pbf_release_shape(shape);
}

static void arrays_of_a_batch(void **state) {
  (void)state;
  const double zeros[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  pbf_batch *batch = NULL;
  assert_ok(pbf_batch_create(&desc, NULL, 2, &batch));
  REFUSED(pbf_batch_get_counts(batch, integers), "counts");
  REFUSED(pbf_batch_get_statuses(batch, (pbf_status *)integers), "statuses");
  REFUSED(pbf_batch_set_gravity(batch, NULL, reals), "gravity");
  REFUSED(pbf_batch_add_particles(batch, integers, NULL, NULL), "counts");
  REFUSED(pbf_batch_move_colliders(batch, NULL, 1, reals, zeros, 1), "positions");
  REFUSED(pbf_batch_move_colliders(batch, NULL, 1, zeros, reals, 1), "orientations");
  pbf_batch_destroy(batch);
}

/* Normals go to where the next rays' directions are: of a ray that meets nothing 0, which leads
 * nowhere from within the fluid. */
static void rays_whose_normals_overlap_directions(void **state) {
  (void)state;
  enum { RAYS = 20 };
  double origins[3 * RAYS], directions[3 * RAYS + 3], distances[RAYS];
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 100);
  for (int i = 0; i < RAYS; ++i)
    for (int k = 0; k < 3; ++k) {
      origins[3 * i + k] = i % 2 ? 0.3 : -10;
      directions[3 * i + k] = i % 2 ? 1 : -1;
    }
  assert_ok(pbf_cast_rays(s, RAYS, origins, directions, INFINITY, distances, directions + 3));
  for (int i = 0; i < RAYS; i += 2) assert_true(isinf(distances[i]));
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(arrays_of_a_solver),
      cmocka_unit_test(arrays_of_shapes),
      cmocka_unit_test(arrays_of_a_batch),
      cmocka_unit_test(rays_whose_normals_overlap_directions),
  };
  return TEST_RUN(tests);
}
