/* A program that records what it does: a ball that is moved through a pool, gravity that turns, a
 * tap. `pbf-bench replay FILE` then runs it again. */
#include "record.h"

#include <math.h>

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

int main(int argc, char **argv) {
  static float positions[1600][3];
  for (int i = 0; i < 1600; ++i) { /* 1 x 0.2 x 1 m */
    positions[i][0] = 0.025f + 0.05f * (float)(i % 20);
    positions[i][1] = 0.025f + 0.05f * (float)(i / 20 % 4);
    positions[i][2] = 0.025f + 0.05f * (float)(i / 80);
  }
  FILE *file = fopen(argc > 1 ? argv[1] : "run.record", "w");
  if (!file) return 1;
  pbf_desc desc;
  pbf_params params;
  pbf_collider ball;
  pbf_solver *fluid = NULL;
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  check(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  desc.capacity = 2000;
  check(pbf_create(&desc, &params, &fluid));
  check(pbf_add_particles(fluid, 1600, positions, NULL, NULL));
  ball.radius = 0.12;
  ball.position[0] = 0.3, ball.position[1] = 0.5, ball.position[2] = 0.5;
  check(pbf_set_colliders(fluid, 1, &ball));
  record_begin(file, fluid);
  for (int frame = 1; frame <= 40; ++frame) {
    if (frame == 20) {
      params.gravity[0] = 3;
      check(pbf_set_params(fluid, &params));
      record_params(file, fluid, &params);
    }
    if (frame % 10 == 0) {
      const float drop[3] = {0.5f, 0.9f, 0.5f};
      check(pbf_add_particles(fluid, 1, drop, NULL, NULL));
      record_state(file, fluid);
    }
    /* code: frame */
    ball.position[0] = 0.5 - 0.2 * cos(0.1 * frame);
    ball.position[1] = 0.5 - 0.3 * sin(0.07 * frame);
    check(pbf_move_colliders(fluid, 1, &ball, 1.0 / 60));
    record_move(file, fluid, 1, &ball, 1.0 / 60);
    check(pbf_step(fluid, 2));
    record_hash(file, fluid);
    /* end */
  }
  pbf_destroy(fluid);
  return fclose(file) == 0 ? 0 : 1;
}
