/* Ten steps of a block that falls beside a sphere; the velocity of particle ARGUMENT begins with
 * another last bit. */
#include <pbf/pbf.h>
#include <stdio.h>
#include <stdlib.h>

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(status == PBF_ERROR_UNAVAILABLE ? 77 : 1);
}

int main(int count, char **arguments) {
  static float x[1000][3], v[1000][3];
  for (int i = 0; i < 1000; ++i)
    for (int k = 0; k < 3; ++k) {
      const int at = k == 0 ? i % 10 : k == 1 ? i / 10 % 10 : i / 100;
      x[i][k] = 0.025f + 0.05f * (float)at;
      v[i][k] = 0.25f;
    }
  if (count > 1) v[atoi(arguments[1])][0] = 0.25f + 0x1p-25f;
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid = NULL;
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  params.viscosity = 0.01;
  desc.backend = "serial";
  desc.capacity = 1000;
  const pbf_collider sphere = {.struct_size = sizeof sphere,
                               .shape = PBF_COLLIDER_SPHERE,
                               .position = {0.7, 0.2, 0.3},
                               .orientation = {0, 0, 0, 1},
                               .radius = 0.15};
  check(pbf_create(&desc, &params, &fluid));
  check(pbf_add_particles(fluid, 1000, x, v, NULL));
  check(pbf_set_colliders(fluid, 1, &sphere));
  check(pbf_step(fluid, 10));
  pbf_destroy(fluid);
  return 0;
}
