/* docs/many-worlds.md's program: eight tanks, each tilted by another angle, in one call. */
#include <pbf/batch.h>
#include <stdio.h>

enum { WORLDS = 8, COUNT = 500 };

/* A block of 0.5 x 0.5 x 0.25 m in the corner, particles 0.05 apart. */
static void place(float x[COUNT][3]) {
  for (int i = 0; i < COUNT; ++i) {
    x[i][0] = 0.025f + 0.05f * (float)(i % 10);
    x[i][1] = 0.025f + 0.05f * (float)(i / 10 % 10);
    x[i][2] = 0.025f + 0.05f * (float)(i / 100);
  }
}

static double mean(float x[COUNT][3]) {
  double sum = 0;
  for (int i = 0; i < COUNT; ++i) sum += (double)x[i][0];
  return sum / COUNT;
}

static void tell(pbf_batch *batch) {
  pbf_status statuses[WORLDS];
  printf("%s\n", pbf_last_error()); /* "world 3: …" */
  if (pbf_batch_get_statuses(batch, statuses) == PBF_OK)
    for (int k = 0; k < WORLDS; ++k) printf("%d %s\n", k, pbf_status_string(statuses[k]));
}

int main(void) {
  /* code: all */
  static float x[WORLDS][COUNT][3];
  uint32_t counts[WORLDS];
  double gravity[WORLDS][3];
  pbf_desc desc;
  pbf_batch *batch = NULL;
  pbf_desc_init(&desc, sizeof desc);
  desc.capacity = COUNT; /* of each world */
  for (int k = 0; k < WORLDS; ++k) {
    place(x[k]);
    counts[k] = COUNT;
    gravity[k][0] = 0.5 * k;
    gravity[k][1] = -9.81;
    gravity[k][2] = 0;
  }
  const pbf_read_desc positions = {
      .struct_size = sizeof positions, .field = PBF_FIELD_POSITION, .count = COUNT, .data = x};
  if (pbf_batch_create(&desc, NULL, WORLDS, &batch) != PBF_OK ||
      pbf_batch_add_particles(batch, counts, x, NULL) != PBF_OK ||
      pbf_batch_set_start(batch, NULL, NULL, 0) != PBF_OK || /* for pbf_batch_reset */
      pbf_batch_set_gravity(batch, NULL, gravity[0]) != PBF_OK ||
      pbf_batch_step(batch, NULL, 120) != PBF_OK ||
      pbf_batch_read(batch, NULL, &positions, 0) != PBF_OK)
    tell(batch);
  else
    for (int k = 0; k < WORLDS; ++k)
      printf("tilted by %.1f m/s²: mean x %.3f m\n", gravity[k][0], mean(x[k]));
  pbf_batch_destroy(batch);
  /* end */
  return 0;
}
