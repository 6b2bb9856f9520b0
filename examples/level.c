/* A level editor over water that runs: solids come, move and go, a rock is baked once and kept as
 * bytes, a click finds the water's surface, and an edit is undone. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/query.h>
#include <pbf/shapes.h>

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

/* code: level */
/* The editor's solids; the solver has copies, which are replaced when one comes or goes. */
typedef struct level {
  pbf_solver *fluid;
  pbf_collider solids[64];
  uint32_t count;
} level;

/* Gives the new one's number. What can't be is refused in words, and nothing has changed. */
static pbf_status add_solid(level *l, const pbf_collider *solid, uint32_t *number) {
  if (l->count == 64) return PBF_ERROR_CAPACITY;
  l->solids[l->count] = *solid;
  const pbf_status status = pbf_set_colliders(l->fluid, l->count + 1, l->solids);
  if (status == PBF_OK) *number = l->count++;
  return status;
}

/* Those behind it move up by one. */
static void remove_solid(level *l, uint32_t number) {
  --l->count;
  memmove(l->solids + number, l->solids + number + 1, (l->count - number) * sizeof *l->solids);
  check(pbf_set_colliders(l->fluid, l->count, l->solids));
}

/* While the mouse drags it: over the time of a frame, so that it pushes water instead of jumping.
 */
static void drag_solid(level *l, uint32_t number, double x, double y, double z, double time) {
  const double place[3] = {x, y, z};
  memcpy(l->solids[number].position, place, sizeof place);
  check(pbf_move_colliders(l->fluid, l->count, l->solids, time));
}
/* end */

/* code: kept */
/* A tetrahedron stands for the level's mesh. Baked once; the bytes are what a file would hold. */
static unsigned char *baked_rock(uint64_t *size) {
  static const double corners[12] = {-.2, -.15, -.15, .2, -.15, -.15, 0, -.15, .2, 0, .2, 0};
  static const uint32_t faces[12] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  const pbf_mesh_desc mesh = {.struct_size = sizeof mesh,
                              .dimension = 3,
                              .vertex_count = 4,
                              .face_count = 4,
                              .vertices = corners,
                              .faces = faces,
                              .cell = 0.025}; /* half a spacing of the fluid */
  pbf_shape *rock;
  check(pbf_shape_from_mesh(&mesh, &rock));
  check(pbf_save_shape(rock, NULL, size));
  unsigned char *bytes = malloc(*size);
  if (!bytes) exit(1);
  check(pbf_save_shape(rock, bytes, size));
  pbf_release_shape(rock);
  return bytes;
}
/* end */

/* code: click */
/* Where a click's ray meets the water; 0: nowhere. */
static int pick(pbf_solver *fluid, const double eye[3], const double way[3], double at[3]) {
  double distance, length = 20;
  check(pbf_cast_rays(fluid, 1, eye, way, length, &distance, NULL));
  if (!(distance < length)) return 0; /* INFINITY where it meets none; `way` has the length 1 */
  for (int k = 0; k < 3; ++k) at[k] = eye[k] + distance * way[k];
  return 1;
}
/* end */

static void pool(pbf_solver *fluid) {
  static float x[20 * 8 * 20][3];
  for (int i = 0; i < 20 * 8 * 20; ++i) {
    x[i][0] = 0.025f + 0.05f * (float)(i % 20);
    x[i][1] = 0.025f + 0.05f * (float)(i / 20 % 8);
    x[i][2] = 0.025f + 0.05f * (float)(i / 160);
  }
  check(pbf_add_particles(fluid, 20 * 8 * 20, x, NULL, NULL));
}

int main(void) {
  level l = {0};
  pbf_desc desc;
  pbf_params params;
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  desc.capacity = 3200;
  check(pbf_create(&desc, &params, &l.fluid));
  pool(l.fluid);

  uint64_t size;
  unsigned char *bytes = baked_rock(&size);
  pbf_shape *rock;
  check(pbf_load_shape(bytes, size, &rock));
  free(bytes);

  pbf_collider solid;
  uint32_t stone, post;
  check(pbf_collider_init(&solid, sizeof solid, PBF_COLLIDER_SHAPE));
  solid.geometry = rock;
  solid.position[0] = solid.position[2] = 0.5;
  solid.position[1] = 0.15;
  check(add_solid(&l, &solid, &stone));
  pbf_release_shape(rock); /* the solver keeps it */
  check(pbf_step(l.fluid, 60));

  check(pbf_collider_init(&solid, sizeof solid, PBF_COLLIDER_SPHERE));
  solid.radius = -1;
  if (add_solid(&l, &solid, &post) != PBF_OK) printf("refused: %s\n", pbf_last_error());
  solid.radius = 0.1;
  solid.position[0] = solid.position[1] = solid.position[2] = 0.25;

  /* code: undo */
  uint64_t room;
  check(pbf_save(l.fluid, NULL, &room)); /* before each edit */
  void *before = malloc(room);
  if (!before) exit(1);
  check(pbf_save(l.fluid, before, &room));
  check(add_solid(&l, &solid, &post));
  for (int frame = 1; frame <= 30; ++frame) {
    drag_solid(&l, post, 0.25, 0.25 + 0.01 * frame, 0.25, 1.0 / 60);
    check(pbf_step(l.fluid, 2));
  }
  remove_solid(&l, post);
  check(pbf_load(l.fluid, before, room)); /* the water is as it was, and so are solids */
  check(pbf_get_collider_count(l.fluid, &l.count));
  /* end */
  free(before);

  double at[3] = {0, 0, 0};
  const double eye[3] = {0.8, 1, 0.8}, way[3] = {0, -1, 0};
  if (pick(l.fluid, eye, way, at)) printf("the click meets the water %.2f m high\n", at[1]);
  printf("%u solid is left\n", l.count);
  pbf_destroy(l.fluid);
  return l.count == 1 && at[1] > 0.35 && at[1] < 0.5 ? 0 : 1;
}
