/* What every stage of the tutorial has: a tank of 3 x 1.6 x 0.6 m, and a block of water in it. */
#ifndef PBF_TUTORIAL_TANK_H
#define PBF_TUTORIAL_TANK_H

#include <pbf/pbf.h>
#include <stdio.h>
#include <stdlib.h>

/* code: check */
static inline void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s: %s\n", pbf_status_string(status), pbf_last_error());
  exit(1);
}
/* end */

/* code: block */
/* A lattice of nx x ny x nz particles, the first of them half a spacing from `corner`. */
static inline void add_block(pbf_solver *fluid, double spacing, const double corner[3], int nx,
                             int ny, int nz) {
  const int count = nx * ny * nz;
  float(*positions)[3] = malloc((size_t)count * sizeof *positions);
  if (!positions) exit(1);
  for (int i = 0; i < count; ++i) {
    const int at[3] = {i % nx, i / nx % ny, i / nx / ny};
    for (int k = 0; k < 3; ++k) positions[i][k] = (float)(corner[k] + (at[k] + 0.5) * spacing);
  }
  check(pbf_add_particles(fluid, (uint32_t)count, positions, NULL, NULL));
  free(positions);
}
/* end */

/* code: tank */
static inline pbf_params tank_params(void) {
  pbf_params params;
  check(pbf_params_init(&params, sizeof params)); /* water, 0.05 apart, 120 steps a second */
  params.spacing = 0.05;                          /* the same, said aloud */
  params.domain_max[0] = 3;
  params.domain_max[1] = 1.6;
  params.domain_max[2] = 0.6;
  return params;
}

static inline pbf_solver *create_tank(const pbf_desc *desc) {
  const pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  check(pbf_create(desc, &params, &fluid));
  return fluid;
}
/* end */

/* code: save */
/* The whole state as a file: `pbf-bench picture` draws it, pbf_load goes on from it. */
static inline void save(pbf_solver *fluid, const char *path) {
  uint64_t size = 0;
  check(pbf_save(fluid, NULL, &size)); /* how much room it takes */
  void *state = malloc(size);
  FILE *file = fopen(path, "wb");
  if (!state || !file) exit(1);
  check(pbf_save(fluid, state, &size));
  if (fwrite(state, 1, size, file) != size || fclose(file) != 0) exit(1);
  free(state);
}
/* end */

#endif
