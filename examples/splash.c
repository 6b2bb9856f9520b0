/* The program of docs/start.md: a block of water falls, and its state goes into a file. */
/* code: all */
#include <pbf/pbf.h>
#include <stdio.h>

static unsigned char state[1 << 20];

static int failed(void) { return puts(pbf_last_error()), 1; }

int main(void) {
  float positions[1000][3];
  for (int i = 0; i < 1000; ++i) { /* a cube of 10 x 10 x 10, its bottom 0.4 above the floor */
    positions[i][0] = 0.275f + 0.05f * (float)(i % 10);
    positions[i][1] = 0.425f + 0.05f * (float)(i / 10 % 10);
    positions[i][2] = 0.275f + 0.05f * (float)(i / 100);
  }
  pbf_desc desc;
  pbf_desc_init(&desc, sizeof desc);
  desc.capacity = 1000;
  pbf_solver *fluid;
  if (pbf_create(&desc, NULL, &fluid) != PBF_OK) return failed(); /* NULL: the defaults */
  if (pbf_add_particles(fluid, 1000, positions, NULL, NULL) != PBF_OK) return failed();
  if (pbf_step(fluid, 48) != PBF_OK) return failed(); /* 0.4 s */

  uint64_t size = sizeof state;
  if (pbf_save(fluid, state, &size) != PBF_OK) return failed();
  FILE *file = fopen("splash.state", "wb");
  if (!file || fwrite(state, 1, size, file) != size || fclose(file) != 0) return 1;
  printf("1000 particles after 0.4 s: splash.state, %u bytes\n", (unsigned)size);
  pbf_destroy(fluid);
  return 0;
}
/* end */
