/* The README's program. */
/* code: all */
#include <pbf/pbf.h>
#include <stdio.h>

int main(void) {
  static float x[4000][3]; /* a block of 0.5 x 1 x 1 m, particles 0.05 apart */
  for (int i = 0; i < 4000; ++i)
    for (int k = 0; k < 3; ++k)
      x[i][k] = 0.025f + 0.05f * (float)(k == 0 ? i % 10 : k == 1 ? i / 10 % 20 : i / 200);
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid = NULL;
  pbf_desc_init(&desc, sizeof desc);       /* 3D, float32, the fastest backend */
  pbf_params_init(&params, sizeof params); /* water in a box of side 1 */
  params.domain_max[0] = 2;
  if (pbf_create(&desc, &params, &fluid) != PBF_OK || /* each call gives a status, */
      pbf_add_particles(fluid, 4000, x, NULL, NULL) != PBF_OK || pbf_step(fluid, 30) != PBF_OK ||
      pbf_get_positions(fluid, 0, 4000, x) != PBF_OK)
    printf("%s\n", pbf_last_error()); /* and a sentence that says what was wrong */
  else
    printf("in a quarter of a second the block's foot has come from 0.48 to %.2f\n",
           (double)x[9][0]);
  pbf_destroy(fluid);
  return 0;
}
/* end */
