/* Sentences have a point in their numbers also where a program's locale has a comma. */
#include <locale.h>
#include <stdio.h>

#include "../../examples/record.h"
#include "support.h"

static char folder[] = "/tmp/pbf-locale-XXXXXX";

/* A locale with a comma: the system's, or one that is made for the test. */
static int take_comma(void) {
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "ru_RU.UTF-8"};
  char command[256];
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
    if (setlocale(LC_ALL, names[i])) return 1;
  if (!mkdtemp(folder)) return 0;
  snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 2>/dev/null",
           folder);
  int made = system(command) == 0;
  setenv("LOCPATH", folder, 1);
  return made && setlocale(LC_ALL, "de_DE.UTF-8") != NULL;
}

static char logged[512];

static void take_log(void *user, int32_t level, const char *message) {
  (void)user, (void)level;
  snprintf(logged, sizeof logged, "%s", message);
}

static void numbers_have_points(void **state) {
  (void)state;
  char number[8];
  pbf_params params = test_params();
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_collider ball;
  pbf_solver *solver;
  const float outside[3] = {1.5f, 0.25f, 0.25f};
  desc.log = take_log;
  if (!take_comma()) test_skip("no locale with a comma, and none can be made");
  snprintf(number, sizeof number, "%.1f", 0.5);
  assert_string_equal(number, "0,5");
  solver = test_create(&desc, &params);
  params.spacing = 0.75;
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT, "spacing is 0.75;");
  params = test_params();
  params.cohesion = -1.25e-7;
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT, "is -1.25e-07;");
  assert_fails(pbf_add_particles(solver, 1, outside, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "1.5");
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.orientation[0] = 0.125;
  assert_fails(pbf_set_colliders(solver, 1, &ball), PBF_ERROR_INVALID_ARGUMENT, "(0.125, 0, 0, 1)");
  params = test_params();
  params.time_step = 0.5;
  assert_ok(pbf_set_params(solver, &params));
  assert_ok(pbf_step(solver, 1));
  assert_non_null(strstr(logged, "params.time_step, 0.5, is too long"));
  snprintf(number, sizeof number, "%.1f", 0.5);
  assert_string_equal(number, "0,5"); /* the program's locale is as it was */
  pbf_destroy(solver);
}

/* The header that programs copy: what it writes is read with points. */
static void recordings_have_points(void **state) {
  (void)state;
  static const double durations[] = {0.015625, 1e-5, 2, 4.5, 0.1};
  static const char *const written[] = {"move 0 0.015625 ", "move 0 1.0000000000000001e-05 ",
                                        "move 0 2 ", "move 0 4.5 ", "move 0 0.10000000000000001 "};
  if (!take_comma()) test_skip("no locale with a comma, and none can be made");
  pbf_solver *solver = test_solver(3, PBF_FLOAT32, 8);
  pbf_collider ball;
  char line[64];
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  FILE *file = tmpfile();
  assert_non_null(file);
  for (int k = 0; k < 5; ++k) record_move(file, solver, 0, &ball, durations[k]);
  rewind(file);
  for (int k = 0; k < 5; ++k) {
    assert_non_null(fgets(line, sizeof line, file));
    assert_memory_equal(line, written[k], strlen(written[k]));
  }
  fclose(file);
  pbf_destroy(solver);
}

static int drop_locale(void **state) {
  (void)state;
  char command[128];
  setlocale(LC_ALL, "C");
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return strstr(folder, "XXXXXX") ? 0 : system(command);
}

int main(void) {
  const struct CMUnitTest locales[] = {
      cmocka_unit_test(recordings_have_points),
      cmocka_unit_test_teardown(numbers_have_points, drop_locale),
  };
  return TEST_RUN(locales);
}
