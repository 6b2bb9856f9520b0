/* A dam breaks, with spray, foam and air bubbles. Writes them as points for other programs, and the
 * state, of which `pbf-bench picture` makes a picture.
 *
 *   foam [foam.ply [foam.state [backend]]] */
#include <pbf/diffuse.h>
#include <stdio.h>
#include <stdlib.h>

#include "tutorial/tank.h"

static const double spacing = 0.04;

/* One of them, as a renderer may want it. */
typedef struct point {
  float position[3], velocity[3], life;
  uint32_t kind;
} point;

/* code: set */
static void ask_for_foam(pbf_solver *fluid) {
  pbf_diffuse_desc desc;
  check(pbf_diffuse_init(fluid, &desc, sizeof desc)); /* what suits its spacing and gravity */
  desc.capacity = 30000;                              /* never more at once */
  check(pbf_set_diffuse(fluid, &desc));
}
/* end */

/* code: read */
static uint32_t read_foam(pbf_solver *fluid, point *points) {
  pbf_diffuse_info info = {.struct_size = sizeof info};
  check(pbf_get_diffuse_info(fluid, &info));
  const pbf_diffuse_read read = {.struct_size = sizeof read,
                                 .count = info.count,
                                 .stride = sizeof *points, /* into an array of structs */
                                 .positions = points->position,
                                 .velocities = points->velocity,
                                 .lives = &points->life,
                                 .kinds = &points->kind};
  check(pbf_read_diffuse(fluid, &read));
  return info.count;
}
/* end */

static void write_points(const char *path, uint32_t count, const point *points) {
  FILE *file = fopen(path, "w");
  if (!file) exit(1);
  fprintf(file, "ply\nformat ascii 1.0\nelement vertex %u\n", count);
  fprintf(file, "property float x\nproperty float y\nproperty float z\n");
  fprintf(file, "property float life\nproperty uchar kind\nend_header\n");
  for (uint32_t i = 0; i < count; ++i)
    fprintf(file, "%g %g %g %g %u\n", (double)points[i].position[0], (double)points[i].position[1],
            (double)points[i].position[2], (double)points[i].life, points[i].kind);
  fclose(file);
}

int main(int argc, char **argv) {
  static point points[30000];
  pbf_desc desc;
  pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  check(pbf_desc_init(&desc, sizeof desc));
  if (argc > 3) desc.backend = argv[3];
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = 1.0 / 240;
  params.domain_max[0] = 2.4;
  params.domain_max[1] = 2;
  params.domain_max[2] = 1;
  check(pbf_create(&desc, &params, &fluid));
  add_block(fluid, spacing, (double[3]){0, 0, 0}, 20, 30, 25);
  ask_for_foam(fluid);
  for (int quarter = 1; quarter <= 6; ++quarter) {
    pbf_diffuse_info info = {.struct_size = sizeof info};
    check(pbf_step(fluid, 60));
    check(pbf_get_diffuse_info(fluid, &info));
    printf("%.2f s: %u of spray, %u of foam, %u bubbles\n", info.time, info.spray, info.foam,
           info.bubbles);
  }
  if (argc > 1) write_points(argv[1], read_foam(fluid, points), points);
  if (argc > 2) save(fluid, argv[2]);
  pbf_destroy(fluid);
  return 0;
}
