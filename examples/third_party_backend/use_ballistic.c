/* Loads the plugin beside it and lets one particle fall for a second. */
#include <stdio.h>

#include <pbf/pbf.h>

int main(void) {
  const float start[3] = {0.5f, 0.9f, 0.5f};
  float end[3] = {0, 0, 0};
  pbf_solver *solver = NULL;
  pbf_desc desc;
  pbf_params params;
  pbf_desc_init(&desc, sizeof desc);
  pbf_params_init(&params, sizeof params);
  params.gravity[1] = -1;
  params.time_step = 0.01;
  desc.capacity = 1;
  desc.backend = "ballistic";
  desc.strict = 1;
  pbf_status status = pbf_load_backend(PLUGIN);
  if (status == PBF_OK) status = pbf_create(&desc, &params, &solver);
  if (status == PBF_OK) status = pbf_add_particles(solver, 1, start, NULL, NULL);
  if (status == PBF_OK) status = pbf_step(solver, 100);
  if (status == PBF_OK) status = pbf_get_positions(solver, 0, 1, end);
  if (status != PBF_OK) fprintf(stderr, "%s\n", pbf_last_error());
  pbf_destroy(solver);
  /* symplectic Euler: n (n + 1) / 2 * dt² = 0.505 below the start */
  printf("fell %.4f\n", (double)(start[1] - end[1]));
  return status == PBF_OK && start[1] - end[1] > 0.504f && start[1] - end[1] < 0.506f ? 0 : 1;
}
