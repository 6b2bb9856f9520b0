/* A dam break: 4,000 particles fall and spread, the front is printed ten times a second. */
#include <stdio.h>
#include <pbf/pbf.h>

int main(void) {
  enum { NX = 10, NY = 20, NZ = 20, N = NX * NY * NZ };
  static float positions[N][3];
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid = NULL;
  pbf_desc_init(&desc, sizeof desc);
  pbf_params_init(&params, sizeof params);
  desc.capacity = N;
  params.domain_max[0] = 2; /* a tank of 2 x 1 x 1, particles 0.05 apart */
  for (int i = 0; i < N; ++i) {
    positions[i][0] = 0.025f + 0.05f * (float)(i % NX);
    positions[i][1] = 0.025f + 0.05f * (float)(i / NX % NY);
    positions[i][2] = 0.025f + 0.05f * (float)(i / NX / NY);
  }
  pbf_status status = pbf_create(&desc, &params, &fluid);
  if (status == PBF_OK) status = pbf_add_particles(fluid, N, positions, NULL, NULL);
  for (int frame = 0; status == PBF_OK && frame < 10; ++frame) {
    pbf_stats stats = {.struct_size = sizeof stats};
    status = pbf_step(fluid, (uint32_t)(0.1 / params.time_step + 0.5));
    if (status == PBF_OK) status = pbf_get_stats(fluid, &stats);
    if (status == PBF_OK)
      printf("%.1f s: front at %.2f m\n", 0.1 * (frame + 1), stats.position_max[0]);
  }
  if (status != PBF_OK) fprintf(stderr, "%s: %s\n", pbf_status_string(status), pbf_last_error());
  pbf_destroy(fluid);
  return status == PBF_OK ? 0 : 1;
}
