/* A part of a program that it loads and unloads, with the static library in it. */
#include <stddef.h>

#include <pbf/pbf.h>

/* A fluid that has threads: of a pool, or one of steps that have begun. 0 where it went well. */
int use_pbf(const char *backend, int leaves_it) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  static float x[2000][3];
  for (int i = 0; i < 2000; ++i)
    for (int k = 0; k < 3; ++k)
      x[i][k] = 0.025f + 0.05f * (float)(k == 0 ? i % 10 : k == 1 ? i / 10 % 20 : i / 200);
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return 1;
  desc.backend = backend;
  desc.strict = 1;
  desc.threads = 3;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return 2;
  if (pbf_add_particles(solver, 2000, x, NULL, NULL) != PBF_OK) return 3;
  if (pbf_step(solver, 2) != PBF_OK) return 4;
  if (pbf_begin_step(solver, 2) != PBF_OK || pbf_end_step(solver) != PBF_OK) return 5;
  if (!leaves_it) pbf_destroy(solver);
  return 0;
}
