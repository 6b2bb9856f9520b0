/* pbf-bench worlds and startup: what they write, and that what they count is what they say. */
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using nlohmann::json;

void worlds_are_stepped_in_three_ways(void **) {
  const std::string folder = work_folder("worlds");
  skip_unless_available(folder, "reference");
  const Outcome worlds = run_program(
      folder,
      "worlds --scene dam-break-2d --particles 200 --worlds 3 --steps 2 --repetitions 2 "
      "--threads 2 --backends reference,nonesuch --json w.json");
  assert_string_equal(worlds.err.c_str(), "");
  assert_int_equal(worlds.exit_code, 0);
  expect_contains(worlds.out, "| million particle-steps a second | of one world |");
  expect_contains(worlds.out, "nonesuch");
  const json rows = json::parse(read_text(folder + "/w.json")).at("rows");
  const char *const ways[] = {"batch", "one after another", "one world"};
  assert_int_equal(rows.size(), 6);
  for (size_t k = 0; k < 3; ++k) {
    const json &row = rows.at(k);
    assert_string_equal(row.at("way").get<std::string>().c_str(), ways[k]);
    assert_int_equal(row.at("worlds").get<int>(), k == 2 ? 1 : 3);
    const double particles = row.at("particles"), all = row.at("worlds").get<double>() * particles;
    assert_true(all > 540 && all < 660);
    const json &times = row.at("ms_per_step");
    assert_int_equal(times.size(), 2);
    const double mean = (times.at(0).get<double>() + times.at(1).get<double>()) / 2;
    const double rate = row.at("particle_steps_per_second");
    assert_float_equal(rate, 1e3 * all / mean, 1e-6 * rate);
    assert_true(!rows.at(3 + k).at("reason").get<std::string>().empty());
  }
  assert_int_equal(rows.at(0).at("threads").get<int>(), 2);
}

void startup_has_all_times(void **) {
  const std::string folder = work_folder("startup");
  skip_unless_available(folder, "reference");
  const Outcome startup = run_program(
      folder,
      "startup --scene dam-break-2d --particles 100 --cycles 3 --worlds 2 --backends reference "
      "--json s.json");
  assert_string_equal(startup.err.c_str(), "");
  assert_int_equal(startup.exit_code, 0);
  const json row = json::parse(read_text(folder + "/s.json")).at("rows").at(0);
  for (const char *key : {"first_ms", "create_ms", "step_ms", "destroy_ms", "world_ms", "reset_ms"})
    assert_true(row.at(key).get<double>() > 0);
  assert_int_equal(run_program(folder, "startup --backends nonesuch").exit_code, 3);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(worlds_are_stepped_in_three_ways),
      cmocka_unit_test(startup_has_all_times),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
