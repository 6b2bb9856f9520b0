/* Stage 4: the same dam on what the machine has: a GPU, threads, one thread. */
#include <string.h>
#include <time.h>

#include "tank.h"

/* code: backends */
static void list_backends(void) {
  uint32_t count = 0;
  check(pbf_get_backend_count(&count));
  for (uint32_t i = 0; i < count; ++i) {
    pbf_backend_info backend = {.struct_size = sizeof backend};
    check(pbf_get_backend_info(NULL, i, &backend));
    printf("%s: %s\n", backend.name, backend.available ? backend.device_name : backend.reason);
  }
}
/* end */

/* code: run */
/* The dam on a backend, with so many threads (0: all); gives the hash of its state after 1 s. */
static uint64_t run(const char *backend, uint32_t threads, const char *path) {
  pbf_desc desc;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = 4000;
  desc.backend = backend; /* "auto" takes the fastest that can serve; others fall back to it */
  desc.threads = threads;
  pbf_solver *fluid = create_tank(&desc);
  add_block(fluid, 0.05, (const double[3]){0, 0, 0}, 20, 16, 12);

  struct timespec start, end;
  timespec_get(&start, TIME_UTC);
  check(pbf_begin_step(fluid, 120)); /* returns at once; here the program is free */
  check(pbf_end_step(fluid));        /* waits, and says how it went */
  check(pbf_synchronize(fluid));     /* a GPU may still be at work: reading would wait, too */
  timespec_get(&end, TIME_UTC);

  pbf_info info = {.struct_size = sizeof info};
  uint64_t hash = 0;
  check(pbf_get_info(fluid, &info));
  check(pbf_hash(fluid, &hash));
  if (path) save(fluid, path);
  pbf_destroy(fluid);
  const double seconds =
      (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
  printf("asked for %s: %s on %s, %u threads, %.2f ms a step, state %016llx\n", backend,
         info.backend, info.device_name, info.threads, 1e3 * seconds / 120,
         (unsigned long long)hash);
  if (info.fell_back) printf("  instead, because: %s\n", info.fallback_reason);
  return hash;
}
/* end */

int main(int argc, char **argv) {
  list_backends();
  run("auto", 0, argc > 1 ? argv[1] : NULL);
  run("cuda", 0, NULL);
  const uint64_t one = run("serial", 1, NULL), two = run("threads", 2, NULL);
  printf("%s\n", one == two ? "the same bits on one and on two threads" : "the bits differ");
  return one == two ? 0 : 1;
}
