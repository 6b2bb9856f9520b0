/* pbf_load with states that pbf_save may never have written. The first byte says which kind of
 * solver loads, and whether the input gets the size and the checksum that a forger would give it.
 */
#include <math.h>
#include <string.h>

#include "kind.h"
#include "target.h"

enum { CAPACITY = 64, SEALED = 4, SIZED = 8, AT_HEADER_SIZE = 12, MOST_ITERATIONS = 8 };

typedef struct shape {
  uint64_t hash;
  pbf_params params;
  uint32_t colliders;
} shape;

static shape shape_of(pbf_solver *solver) {
  shape now;
  memset(&now, 0, sizeof now);
  now.params.struct_size = sizeof now.params;
  insist(pbf_hash(solver, &now.hash) == PBF_OK);
  insist(pbf_get_params(solver, &now.params) == PBF_OK);
  insist(pbf_get_collider_count(solver, &now.colliders) == PBF_OK);
  return now;
}

static void fill(pbf_solver *solver, kind k) {
  _Alignas(8) unsigned char positions[3 * 3 * 8];
  for (uint32_t i = 0; i < 3; ++i)
    for (uint32_t axis = 0; axis < k.dimension; ++axis)
      put_number(positions, i * k.dimension + axis, k.precision, 0.3 + 0.05 * i);
  insist(pbf_add_particles(solver, 3, positions, NULL, NULL) == PBF_OK);
}

static void *saved_state(pbf_solver *solver, uint64_t *size) {
  insist(pbf_save(solver, NULL, size) == PBF_OK);
  void *buffer = malloc(*size);
  insist(pbf_save(solver, buffer, size) == PBF_OK);
  return buffer;
}

/* What has been loaded can be saved, and loaded again, and is the same then. */
static void insist_on_return(pbf_solver *solver, kind k) {
  uint64_t size, again;
  void *one = saved_state(solver, &size);
  pbf_solver *twin = make_solver("serial", k, CAPACITY);
  insist(pbf_load(twin, one, size) == PBF_OK);
  void *two = saved_state(twin, &again);
  insist(size == again && memcmp(one, two, size) == 0);
  pbf_destroy(twin);
  free(one);
  free(two);
}

/* Whatever was loaded runs, or says why not: hostile numbers may lead anywhere but out of bounds.
 */
static void run_on(pbf_solver *solver) {
  pbf_params params = {.struct_size = sizeof params};
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_collider collider = {.struct_size = sizeof collider};
  _Alignas(8) unsigned char densities[CAPACITY * 8];
  uint32_t count;
  insist(pbf_get_params(solver, &params) == PBF_OK);
  insist(pbf_get_count(solver, &count) == PBF_OK && count <= CAPACITY);
  if (params.iterations <= MOST_ITERATIONS) pbf_step(solver, 2);
  pbf_get_stats(solver, &stats);
  pbf_get_densities(solver, 0, count, densities);
  pbf_get_collider(solver, 0, &collider);
}

static unsigned char *forged(const uint8_t *data, size_t size, unsigned flags) {
  unsigned char *state = malloc(size + !size);
  if (size) memcpy(state, data, size);
  uint64_t told = size;
  if (flags & SIZED && size >= AT_HEADER_SIZE + 4) { /* the header ends with the size */
    uint32_t header;
    memcpy(&header, state + AT_HEADER_SIZE, sizeof header);
    if (header >= sizeof told && header <= size)
      memcpy(state + header - sizeof told, &told, sizeof told);
  }
  if (flags & SEALED && size >= 8) {
    uint64_t checksum = checksum_of(state, size - 8);
    memcpy(state + size - 8, &checksum, sizeof checksum);
  }
  return state;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return 0;
  kind k = kind_of(data[0]);
  unsigned char *state = forged(data + 1, size - 1, data[0]);
  pbf_solver *solver = make_solver("serial", k, CAPACITY);
  fill(solver, k);
  shape before = shape_of(solver);
  pbf_status status = pbf_load(solver, state, size - 1);
  free(state); /* nothing of it may be needed any more */
  if (status == PBF_OK) {
    insist_on_return(solver, k);
    run_on(solver);
  } else {
    shape after = shape_of(solver);
    insist(status == PBF_ERROR_DATA || status == PBF_ERROR_CAPACITY);
    insist(pbf_last_error()[0]);
    insist(memcmp(&before, &after, sizeof before) == 0);
  }
  pbf_destroy(solver);
  return 0;
}
