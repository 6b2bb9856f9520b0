/* Prints what a scene that needs no feature comes to, bits and bytes, for comparing builds. */
#include <inttypes.h>
#include <stdio.h>

#include <pbf/pbf.h>

int main(void) {
  enum { SIDE = 12, N = SIDE * SIDE * SIDE };
  static float positions[N][3];
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid = NULL;
  pbf_plan plan = {.struct_size = sizeof plan};
  uint64_t hash = 0;
  pbf_desc_init(&desc, sizeof desc);
  pbf_params_init(&params, sizeof params);
  desc.capacity = N;
  params.solver = PBF_SOLVER_JACOBI;
  params.wall_density = 0;
  for (int i = 0; i < N; ++i) {
    positions[i][0] = 0.025f + 0.05f * (float)(i % SIDE);
    positions[i][1] = 0.025f + 0.05f * (float)(i / SIDE % SIDE);
    positions[i][2] = 0.025f + 0.05f * (float)(i / SIDE / SIDE);
  }
  if (pbf_create(&desc, &params, &fluid) != PBF_OK ||
      pbf_add_particles(fluid, N, positions, NULL, NULL) != PBF_OK ||
      pbf_step(fluid, 50) != PBF_OK || pbf_hash(fluid, &hash) != PBF_OK ||
      pbf_get_plan(fluid, &plan) != PBF_OK) {
    fprintf(stderr, "%s\n", pbf_last_error());
    return 1;
  }
  pbf_destroy(fluid);
  printf("%016" PRIx64 " %" PRIu64 " bytes\n", hash, plan.bytes);
  return 0;
}
