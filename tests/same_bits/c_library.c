/* c_library [print]: results do not depend on how the C library rounds its functions. glibc chooses
 * them by processor, so the program runs itself once more as on one without AVX2 and fused
 * multiply-add. The spacings are such that powers and exponentials of them were rounded otherwise
 * there (glibc 2.36), as was once to be seen in loads and in saved states. */
#define _GNU_SOURCE /* popen */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/all.h>

enum { COUNT = 64, WALLS = 6, SPACINGS = 5, LINE = 80, SKIPPED = 77 };

static const double spacings[SPACINGS] = {0x1.78ddd116919ecp-5, 0x1.08883782c5bcdp-4,
                                          0x1.fbe96e71810f6p-5, 0x1.af9d8e8d571c2p-5,
                                          0x1.f7742f16ecfaep-5};

static void expect(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "c_library: %s\n", pbf_last_error());
  exit(status == PBF_ERROR_UNAVAILABLE ? SKIPPED : 1);
}

static uint64_t hash_of(const void *bytes, size_t size) {
  const unsigned char *at = bytes;
  uint64_t hash = 0xcbf29ce484222325;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ at[i]) * 0x100000001b3;
  return hash;
}

static pbf_solver *block(double spacing, pbf_params *params) {
  const char *backend = getenv("PBF_TEST_BACKEND");
  pbf_desc desc;
  pbf_solver *solver = NULL;
  float x[COUNT][3];
  expect(pbf_desc_init(&desc, sizeof desc));
  expect(pbf_params_init(params, sizeof *params));
  desc.backend = backend ? backend : "serial";
  desc.strict = 1;
  desc.capacity = COUNT;
  params->spacing = spacing;
  params->smoothing_radius = 2 * spacing;
  params->loads = 1;
  expect(pbf_create(&desc, params, &solver));
  for (int i = 0; i < COUNT; ++i)
    for (int k = 0, rest = i; k < 3; ++k, rest /= 4) x[i][k] = (float)(spacing * (0.5 + rest % 4));
  expect(pbf_add_particles(solver, COUNT, x, NULL, NULL));
  return solver;
}

static uint64_t loads_of(pbf_solver *solver) {
  pbf_collider_load loads[WALLS];
  memset(loads, 0, sizeof loads);
  for (int wall = 0; wall < WALLS; ++wall) loads[wall].struct_size = sizeof loads[wall];
  expect(pbf_get_wall_loads(solver, WALLS, loads));
  return hash_of(loads, sizeof loads);
}

static uint64_t state_of(pbf_solver *solver) {
  uint64_t size = 0;
  expect(pbf_save(solver, NULL, &size));
  char *state = malloc(size);
  if (!state) exit(1);
  expect(pbf_save(solver, state, &size));
  const uint64_t hash = hash_of(state, size);
  free(state);
  return hash;
}

/* Steps of other lengths: what is allowed for of a change goes exponentially. */
static void write_line(double spacing, char line[LINE]) {
  static const double lengths[] = {1 / 120.0, 1 / 60.0, 1 / 90.0, 1 / 40.0};
  static const uint32_t steps[] = {3, 3, 2, 2};
  uint64_t loads = 0;
  pbf_params params;
  pbf_solver *solver = block(spacing, &params);
  for (int k = 0; k < 4; ++k) {
    params.time_step = lengths[k];
    expect(pbf_set_params(solver, &params));
    expect(pbf_step(solver, steps[k]));
    loads ^= loads_of(solver);
  }
  snprintf(line, LINE, "%a %016" PRIx64 " %016" PRIx64 "\n", spacing, loads, state_of(solver));
  pbf_destroy(solver);
}

static int compare(const char *program) {
  char command[4096], here[LINE], there[LINE];
  int differ = 0;
  snprintf(command, sizeof command,
           "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-FMA_Usable,-AVX2_Usable '%s' print",
           program);
  FILE *other = popen(command, "r");
  if (!other) return 1;
  for (int k = 0; k < SPACINGS; ++k) {
    write_line(spacings[k], here);
    if (fgets(there, LINE, other) && strcmp(here, there) == 0) continue;
    fprintf(stderr, "c_library: %sis without AVX2 and FMA\n%s", here, there);
    differ = 1;
  }
  return pclose(other) != 0 || differ;
}

int main(int count, char **arguments) {
  char line[LINE];
  if (count == 1) return compare(arguments[0]);
  for (int k = 0; k < SPACINGS; ++k) {
    write_line(spacings[k], line);
    fputs(line, stdout);
  }
  return 0;
}
