/* Stage 5: frames for a renderer. Dam, cup and tap at once, drawn 30 times a second.
 *
 *    5_frames [FOLDER [SPACING]]    writes FOLDER/000.state … for `pbf-bench picture` */
#include <math.h>
#include <string.h>

#include "cup.h"
#include "tank.h"

/* code: vertex */
typedef struct vertex { /* as a renderer wants it */
  float position[3];
  float speed;
} vertex;

static void read_vertices(pbf_solver *fluid, double behind, uint32_t count, vertex *vertices) {
  pbf_read_desc read = {.struct_size = sizeof read};
  read.field = PBF_FIELD_POSITION;
  read.count = count;
  read.components = 4; /* x, y, z and … */
  read.w = PBF_W_SPEED;
  read.order = PBF_ORDER_STORED; /* which particle is which does not matter here */
  read.behind = behind;          /* between the last two steps */
  read.data = vertices;
  check(pbf_read(fluid, &read));
}
/* end */

static double mean_height(const vertex *vertices, uint32_t count) {
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) sum += (double)vertices[i].position[1];
  return count > 0 ? sum / count : 0;
}

int main(int argc, char **argv) {
  const double d = argc > 2 ? atof(argv[2]) : 0.05;
  pbf_params params = tank_params();
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = d / 6;        /* as 1/120 is with d = 0.05 */
  params.damping_compensation = 1; /* livelier waves */
  pbf_desc desc;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = (uint32_t)(1.5 / (d * d * d));
  pbf_solver *fluid = NULL;
  check(pbf_create(&desc, &params, &fluid));
  const int a = (int)(1 / d + 0.5), b = (int)(0.8 / d + 0.5), c = (int)(0.6 / d + 0.5);
  add_block(fluid, d, (const double[3]){0, 0, 0}, a, b, c);
  pbf_collider parts[CUP_PARTS];
  cup_at(0, parts);
  check(pbf_set_colliders(fluid, CUP_PARTS, parts));
  const int in_cup = (int)(2 * cup_inside / d + 1e-9);
  const double corner[3] = {2.4 - cup_inside, 1.05 - cup_inside, 0.3 - cup_inside};
  add_block(fluid, d, corner, in_cup, in_cup, in_cup);

  /* code: loop */
  check(pbf_keep_previous(fluid, 1)); /* for `behind` */
  vertex *vertices = malloc(desc.capacity * sizeof *vertices);
  if (!vertices) exit(1);
  double debt = 0, time = 0;
  for (int frame = 0; frame < 105; ++frame) {
    debt += 1.0 / 30; /* a frame's time, measured in a game */
    const uint32_t steps = (uint32_t)(debt / params.time_step);
    if (steps > 0) {
      time += steps * params.time_step;
      debt -= steps * params.time_step;
      cup_at(time, parts);
      check(pbf_move_colliders(fluid, CUP_PARTS, parts, steps * params.time_step));
      check(pbf_step(fluid, steps));
    }
    uint32_t count = 0;
    check(pbf_get_count(fluid, &count));
    read_vertices(fluid, 1 - debt / params.time_step, count, vertices);
    if (frame % 15 == 0) /* here `vertices` would go to the renderer */
      printf("frame %3d: %u vertices, mean height %.3f\n", frame, count,
             mean_height(vertices, count));
    /* end */
    if (argc > 1) {
      char path[512];
      snprintf(path, sizeof path, "%.480s/%03d.state", argv[1], frame);
      save(fluid, path);
    }
  }
  free(vertices);
  pbf_destroy(fluid);
  return 0;
}
