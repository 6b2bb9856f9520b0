/* pbf-bench ablation: its rows, and other builds beside this one. */
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using nlohmann::json;

const char *const small =
    "ablation --scene dam-break-2d --particles 300 --steps 4 --run-up 3 --rounds 3 --backend "
    "serial ";

json run_for_json(const std::string &folder, const std::string &arguments) {
  const std::string path = folder + "/ablation.json";
  const Outcome outcome = run_program(folder, small + arguments + " --json " + path);
  assert_int_equal(outcome.exit_code, 0);
  return json::parse(read_text(path));
}

json row_of(const json &rows, const std::string &name) {
  for (const json &row : rows)
    if (row["name"] == name) return row;
  fail_msg("no row %s", name.c_str());
  return {};
}

void one_feature_at_a_time(void **) {
  const std::string folder = work_folder("ablation");
  skip_unless_available(folder, "serial");
  const json rows = run_for_json(folder, "--html " + folder + "/ablation.html")["features"];
  const json bare = rows.at(0);
  assert_true(bare["name"] == "minimal");
  assert_int_equal(bare["ms_per_step"].size(), 3);
  assert_int_equal(bare["stages"].size(), 5);
  assert_int_equal(row_of(rows, "+ vorticity")["stages"].size(), 7);
  assert_int_equal(row_of(rows, "+ viscosity")["stages"].size(), 6);
  assert_int_equal(row_of(rows, "+ damping_compensation")["stages"].size(),
                   row_of(rows, "+ chebyshev")["stages"].size() + 2);
  assert_int_equal(row_of(rows, "+ angular_momentum_correction")["stages"].size(),
                   row_of(rows, "+ chebyshev")["stages"].size() + 3);
  assert_true(row_of(rows, "+ chebyshev")["bytes_per_particle"] > bare["bytes_per_particle"]);
  for (const char *looks : {"+ timing", "+ stats"})
    assert_true(row_of(rows, looks)["state"] == bare["state"]);
  for (const char *acts :
       {"+ scorr_k", "+ vorticity", "+ viscosity", "+ wall_density", "+ chebyshev",
        "+ damping_compensation", "+ angular_momentum_correction"})
    assert_true(row_of(rows, acts)["state"] != bare["state"]);
  expect_contains(read_text(folder + "/ablation.html"), "<td>+ wall_density</td>");
}

void a_build_against_itself(void **) {
  const std::string folder = work_folder("against");
  skip_unless_available(folder, "serial");
  const json rows = run_for_json(folder, "--against itself=" PBF_TEST_BACKENDS)["builds"];
  assert_int_equal(rows.size(), 3);
  assert_true(rows.at(2)["name"] == "itself");
  for (const json &row : rows) {
    assert_true(row["state"] == rows.at(0)["state"]);
    assert_true(row["bytes"] == rows.at(0)["bytes"]);
    assert_true(row["ratio_median"] > 0.0);
  }
}

void folders_without_the_backend(void **) {
  const std::string folder = work_folder("against");
  skip_unless_available(folder, "serial");
  const Outcome nowhere = run_program(folder, std::string(small) + "--against /no/where");
  assert_int_equal(nowhere.exit_code, 2);
  expect_contains(nowhere.err, "--against /no/where");
  const Outcome empty = run_program(folder, std::string(small) + "--against " + folder);
  assert_int_equal(empty.exit_code, 0);
  expect_contains(empty.out, "has no backend \"serial\"");
}

void a_backend_that_is_not_there(void **) {
  const std::string folder = work_folder("against");
  const Outcome outcome =
      run_program(folder, "ablation --scene dam-break-2d --particles 300 --backend nonesuch");
  assert_int_equal(outcome.exit_code, 3);
  expect_contains(outcome.err, "nonesuch");
}

}  // namespace

int main() {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_feature_at_a_time),
      cmocka_unit_test(a_build_against_itself),
      cmocka_unit_test(folders_without_the_backend),
      cmocka_unit_test(a_backend_that_is_not_there),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
