/* Shapes, which live beside solvers. */
#include <math.h>
#include <string.h>

#include <pbf/shapes.h>

#include "table.h"

enum { SIDE = 9 };

static pbf_status outcome(actor *a, pbf_status status) {
  check_status(a, status, pbf_last_error());
  return status;
}

/* A ball's distances, one of which may be wrong. */
static pbf_status make_grid(actor *a, pbf_shape **shape) {
  static _Thread_local float values[SIDE * SIDE * SIDE];
  const uint32_t dimension = 2 + dice_below(&a->dice, 2);
  const pbf_grid_desc grid = {.struct_size = sizeof grid,
                              .dimension = dimension,
                              .nodes = {SIDE, SIDE, SIDE},
                              .origin = {-1, -1, -1},
                              .cell = 0.25,
                              .values = values};
  for (int n = 0; n < SIDE * SIDE * SIDE; ++n) {
    const double x = 0.25 * (n % SIDE) - 1, y = 0.25 * (n / SIDE % SIDE) - 1;
    const double z = dimension == 3 ? 0.25 * (n / SIDE / SIDE) - 1 : 0;
    values[n] = (float)(sqrt(x * x + y * y + z * z) - 0.6);
  }
  if (dice_one_in(&a->dice, 4))
    values[dice_below(&a->dice, SIDE * SIDE)] = dice_one_in(&a->dice, 2) ? NAN : -1;
  return outcome(a, pbf_shape_from_grid(&grid, shape));
}

void call_shape_from_grid(actor *a) {
  pbf_shape *shape = NULL;
  insist(a, (make_grid(a, &shape) == PBF_OK) == (shape != NULL));
  pbf_release_shape(shape);
}

/* A tetrahedron, one corner of which may be anywhere. */
void call_shape_from_mesh(actor *a) {
  double vertices[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  pbf_shape *shape = NULL;
  if (dice_one_in(&a->dice, 2)) faces[dice_below(&a->dice, 12)] = dice_below(&a->dice, 6);
  if (dice_one_in(&a->dice, 2)) vertices[dice_below(&a->dice, 12)] = dice_in(&a->dice, -1, 1);
  const pbf_mesh_desc mesh = {.struct_size = sizeof mesh,
                              .dimension = 3,
                              .vertex_count = 4,
                              .face_count = 4,
                              .vertices = vertices,
                              .faces = faces,
                              .cell = 0.1,
                              .thickness = dice_one_in(&a->dice, 3) ? 0.2 : 0};
  insist(a, (outcome(a, pbf_shape_from_mesh(&mesh, &shape)) == PBF_OK) == (shape != NULL));
  pbf_release_shape(shape);
}

void call_shape_from_heights(actor *a) {
  double heights[16];
  pbf_shape *shape = NULL;
  for (int i = 0; i < 16; ++i) heights[i] = dice_in(&a->dice, 0.5, 1);
  if (dice_one_in(&a->dice, 4)) heights[dice_below(&a->dice, 16)] = -1;
  const pbf_heights_desc desc = {.struct_size = sizeof desc,
                                 .dimension = 2 + dice_below(&a->dice, 2),
                                 .count = {4, 4},
                                 .heights = heights,
                                 .spacing = 0.25,
                                 .base = 0,
                                 .cell = 0.1};
  insist(a, (outcome(a, pbf_shape_from_heights(&desc, &shape)) == PBF_OK) == (shape != NULL));
  pbf_release_shape(shape);
}

void call_shape_from_points(actor *a) {
  double points[24];
  pbf_shape *shape = NULL;
  for (int i = 0; i < 24; ++i) points[i] = dice_in(&a->dice, -1, 1);
  const pbf_hull_desc desc = {.struct_size = sizeof desc,
                              .dimension = 2 + dice_below(&a->dice, 2),
                              .point_count = dice_below(&a->dice, 9),
                              .points = points,
                              .cell = 0.1};
  insist(a, (outcome(a, pbf_shape_from_points(&desc, &shape)) == PBF_OK) == (shape != NULL));
  pbf_release_shape(shape);
}

void call_hold_shape(actor *a) {
  pbf_shape *shape = NULL;
  if (make_grid(a, &shape) != PBF_OK) return;
  insist(a, pbf_hold_shape(shape) == PBF_OK);
  pbf_release_shape(shape);
  pbf_release_shape(shape);
}

void call_release_shape(actor *a) {
  (void)a;
  pbf_release_shape(NULL);
}

void call_get_shape_info(actor *a) {
  pbf_shape *shape = NULL;
  pbf_shape_info info = {.struct_size = sizeof info};
  if (make_grid(a, &shape) != PBF_OK) return;
  insist(a, pbf_get_shape_info(shape, &info) == PBF_OK && info.references == 1);
  pbf_release_shape(shape);
}

void call_get_shape_distance(actor *a) {
  pbf_shape *shape = NULL;
  const double middle[3] = {0, 0, 0};
  double distance = 0, normal[3];
  if (make_grid(a, &shape) != PBF_OK) return;
  insist(a, pbf_get_shape_distance(shape, middle, &distance, normal) == PBF_OK && distance < 0);
  pbf_release_shape(shape);
}

void call_get_shape_values(actor *a) {
  pbf_shape *shape = NULL;
  float values[SIDE * SIDE * SIDE];
  if (make_grid(a, &shape) != PBF_OK) return;
  const uint64_t count = dice_one_in(&a->dice, 2) ? SIDE * SIDE : SIDE * SIDE * SIDE;
  pbf_shape_info info = {.struct_size = sizeof info};
  insist(a, pbf_get_shape_info(shape, &info) == PBF_OK);
  const int fits = count == (info.dimension == 2 ? SIDE * SIDE : SIDE * SIDE * SIDE);
  insist(a, (outcome(a, pbf_get_shape_values(shape, count, values)) == PBF_OK) == fits);
  pbf_release_shape(shape);
}

/* Bytes that may be changed on the way come back as the same shape, or as none. */
void call_load_shape(actor *a) {
  unsigned char bytes[4096];
  uint64_t size = sizeof bytes;
  pbf_shape *shape = NULL, *again = NULL;
  if (make_grid(a, &shape) != PBF_OK) return;
  insist(a, pbf_save_shape(shape, bytes, &size) == PBF_OK);
  const int same = dice_one_in(&a->dice, 2);
  if (!same)
    bytes[dice_below(&a->dice, (uint32_t)size)] ^= (unsigned char)(1 << dice_below(&a->dice, 8));
  insist(a, (outcome(a, pbf_load_shape(bytes, size, &again)) == PBF_OK) == same);
  insist(a, (again != NULL) == same);
  pbf_release_shape(shape);
  pbf_release_shape(again);
}

void call_save_shape(actor *a) {
  uint64_t size = 0;
  pbf_shape *shape = NULL;
  if (make_grid(a, &shape) != PBF_OK) return;
  insist(a, pbf_save_shape(shape, NULL, &size) == PBF_OK && size > 72);
  size = 71;
  insist(a, outcome(a, pbf_save_shape(shape, &size, &size)) != PBF_OK);
  pbf_release_shape(shape);
}
