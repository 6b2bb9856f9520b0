/* Whatever flags the project is built with, NaNs and infinities are refused by name, and loading
 * the library and its backends leaves the program its subnormal numbers. Before main begins, as in
 * global objects of C++, all is as later. */
#include <float.h>
#include <math.h>
#include <pbf/pbf.h>
#include <stdio.h>
#include <string.h>

static int failures;

static void expect(int holds, const char *what) {
  if (holds) return;
  fprintf(stderr, "not so: %s (%s)\n", what, pbf_last_error());
  ++failures;
}

static int subnormal_numbers_are_there(void) {
  volatile float smallest = FLT_MIN;
  return smallest / 2 > 0;
}

static char early[128], later[128];

/* What a solver runs on; nothing where a sentence is not as it should be. */
static void look(char device[128]) {
  pbf_desc desc;
  pbf_solver *solver;
  pbf_info info = {.struct_size = sizeof info};
  pbf_desc_init(&desc, sizeof desc);
  desc.capacity = 0, desc.backend = "serial";
  if (pbf_create(&desc, NULL, &solver) == PBF_OK) return;
  if (!strstr(pbf_last_error(), "desc.capacity is 0")) return;
  desc.capacity = 8;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return;
  if (pbf_get_info(solver, &info) == PBF_OK) snprintf(device, 128, "%s", info.device_name);
  pbf_destroy(solver);
}

__attribute__((constructor)) static void begin(void) { look(early); }

int main(void) {
  look(later);
  expect(later[0] && strcmp(early, later) == 0, "a solver before main is like one after it");
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver;
  pbf_desc_init(&desc, sizeof desc);
  pbf_params_init(&params, sizeof params);
  desc.capacity = 8, desc.backend = "serial";
  expect(subnormal_numbers_are_there(), "subnormal numbers once libpbf is loaded");
  const double step = params.time_step;
  params.time_step = (double)NAN;
  expect(pbf_create(&desc, &params, &solver) != PBF_OK && strstr(pbf_last_error(), "is NaN"),
         "a step that is no number is refused");
  params.time_step = step;
  if (pbf_create(&desc, &params, &solver) != PBF_OK) return 1;
  expect(subnormal_numbers_are_there(), "subnormal numbers once a backend is loaded");
  const float positions[6] = {0.5f, 0.5f, 0.5f, 0.5f, INFINITY, 0.5f};
  expect(pbf_add_particles(solver, 2, positions, NULL, NULL) != PBF_OK &&
             strstr(pbf_last_error(), "is inf"),
         "a position is finite");
  pbf_destroy(solver);
  return failures != 0;
}
