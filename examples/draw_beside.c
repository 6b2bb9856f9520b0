/* One thread steps, another draws the last finished step meanwhile, by snapshots. POSIX threads. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include <pbf/pbf.h>

enum { COUNT = 4000 };

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

/* code: draw */
typedef struct renderer {
  pbf_solver *fluid;
  atomic_int *running;
  int frames;
  double front;
} renderer;

/* As often as the screen wants; it never waits for a step, and no step for it. */
static void *draw(void *data) {
  renderer *r = data;
  while (atomic_load(r->running)) {
    pbf_snapshot now = {.struct_size = sizeof now};
    check(pbf_acquire_snapshot(r->fluid, &now));
    const float *x = now.positions; /* (count, dimension), in the order of adding */
    double front = 0;
    for (uint32_t i = 0; i < now.count; ++i)
      if ((double)x[3 * i] > front) front = (double)x[3 * i];
    r->front = front;
    ++r->frames;
    check(pbf_release_snapshot(&now));
  }
  return NULL;
}
/* end */

int main(void) {
  static float x[COUNT][3];
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid;
  atomic_int running = 1;
  pthread_t thread;
  for (int i = 0; i < COUNT; ++i) {
    x[i][0] = 0.025f + 0.05f * (float)(i % 10);
    x[i][1] = 0.025f + 0.05f * (float)(i / 10 % 20);
    x[i][2] = 0.025f + 0.05f * (float)(i / 200);
  }
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  desc.capacity = COUNT;
  params.domain_max[0] = 2;
  check(pbf_create(&desc, &params, &fluid));
  check(pbf_add_particles(fluid, COUNT, x, NULL, NULL));
  /* code: step */
  check(pbf_set_snapshots(fluid, 3)); /* one that is written, one that is next, one that is drawn */
  renderer r = {.fluid = fluid, .running = &running};
  if (pthread_create(&thread, NULL, draw, &r) != 0) return 1;
  for (int frame = 0; frame < 60; ++frame) check(pbf_step(fluid, 2));
  atomic_store(&running, 0);
  /* end */
  pthread_join(thread, NULL);
  printf("%s, the front at %.2f m\n", r.frames > 0 ? "drawn beside the steps" : "never drawn",
         r.front);
  pbf_destroy(fluid);
  return r.frames > 0 ? 0 : 1;
}
