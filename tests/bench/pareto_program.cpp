/* pbf-bench pareto as a user runs it: the quick sweep, going on, Ctrl-C, files that are not its
 * own. */
#include <csignal>
#include <nlohmann/json.hpp>
#include <vector>

#include "child.h"
#include "program.h"
#include "support/amount.h"

namespace {

using nlohmann::json;

// The plain method and the library, one point each.
const char *const tiny = R"({"version": 1, "description": "d", "baseline": "plain", "subject": "b",
  "errors": [{"figure": "E1.own.interior.mean_abs@mean", "title": "density", "explains": "e"}],
  "families": [
    {"name": "plain", "title": "Plain", "set": {"solver": "jacobi", "cfm": 1.5}},
    {"name": "b", "title": "B", "vary": [{"iterations": [3]}]}]})";

const char *const options =
    "pareto --scene dam-break-2d --particles 300 --steps 8 --frames 2 --backends reference ";

json results_in(const std::string &path) { return json::parse(read_text(path)); }

std::string start(const char *name) {
  const std::string folder = work_folder(name);
  skip_unless_available(folder, "reference");
  if (std::system("'" PBF_TEST_PYTHON "' -c 'import numpy, scipy' 2>/dev/null") != 0) {
    std::printf(
        "SKIPPED: NumPy and SciPy are not here; python3-numpy and python3-scipy would do\n");
    std::exit(test_skipped);
  }
  write_text(folder + "/tiny.json", tiny);
  return folder;
}

void the_quick_sweep_writes_results_and_a_page(void **) {
  if (!test_is_long()) {
    std::puts("skipped: the whole sweep runs where PBF_TEST_LONG is set, as by ./run test long");
    skip();
  }
  const std::string folder = start("quick");
  const Outcome run = run_program(folder,
                                  "pareto --quick --scene dam-break-2d --backends reference --json "
                                  "q.json --html deep/q.html --cpu-time");
  assert_string_equal(run.err.c_str(), "");
  assert_int_equal(run.exit_code, 0);
  expect_contains(run.out, "| the library ");
  expect_contains(run.out, "smaller with the library than with the paper's plain method");
  const json results = results_in(folder + "/q.json");
  assert_int_equal(results.at("points").size(), 5);
  assert_true(results.at("context").at("clock") == "cpu");
  for (const json &point : results.at("points")) {
    assert_int_equal(point.at("outcome").at("seconds").size(), 2);
    assert_true(point.at("outcome").at("errors").at("E2.relative@largest").get<double>() >= 0);
    assert_true(point.at("seconds_per_simulated").get<double>() > 0);
  }
  for (const char *key : {"commit", "cpu_model", "compiler", "build_reference", "particles"}) {
    assert_true(results.at("context").contains(key));
  }
  const std::string page = read_text(folder + "/deep/q.html");
  for (const char *words :
       {"<svg", "float32 against float64", "Commit", "↙ better", "processor time"}) {
    expect_contains(page, words);
  }
  for (const char *words : {"{{", "http://", "https://", "<script"}) {
    assert_true(page.find(words) == std::string::npos);
  }
}

void a_sweep_goes_on_where_it_was(void **) {
  const std::string folder = start("resume");
  const std::string again = std::string(options) + "--sweep tiny.json --json r.json ";
  assert_int_equal(run_program(folder, again + "--repetitions 1").exit_code, 0);
  const json first = results_in(folder + "/r.json");
  const Outcome more = run_program(folder, again + "--repetitions 3");
  expect_contains(more.out, "2 points are there already");
  const json second = results_in(folder + "/r.json");
  for (size_t i = 0; i < 2; ++i) {
    const json before = first.at("points")[i].at("outcome");
    const json after = second.at("points")[i].at("outcome");
    assert_true(before.at("errors") == after.at("errors"));
    assert_int_equal(after.at("seconds").size(), 3);
    assert_true(before.at("seconds")[0] == after.at("seconds")[0]);
  }
  // Of another scene: measured anew, and the old ones kept.
  const Outcome other = run_program(folder, again + "--repetitions 1 --set gravity.1=-3");
  assert_int_equal(other.exit_code, 0);
  expect_contains(other.out, "2 points in r.json are of another build");
  assert_true(results_in(folder + "/r.json.old") == second);
}

void files_that_are_not_its_own_stay_untouched(void **) {
  const std::string folder = start("foreign");
  const std::string run = std::string(options) + "--sweep tiny.json --json f.json";
  for (const char *text : {"{\"tool\": \"other\"}", "not JSON at all", "[]"}) {
    write_text(folder + "/f.json", text);
    const Outcome outcome = run_program(folder, run);
    assert_int_equal(outcome.exit_code, 2);
    expect_contains(outcome.err, "name another file");
    assert_string_equal(read_text(folder + "/f.json").c_str(), text);
  }
}

void wrong_command_lines_say_what_is_wrong(void **) {
  const std::string folder = start("wrong");
  write_text(folder + "/bad.json", "{\"version\": 2}");
  const struct {
    const char *arguments, *words;
    int exit_code;
  } wrong[] = {
      {"--sweep nowhere.json", "nowhere.json can't be read", 2},
      {"--sweep bad.json", "bad.json:1:", 2},
      {"--duration 1", "excludes", 2},
      {"--sweep tiny.json --backends nonesuch", "no point can run", 3},
      {"--sweep tiny.json --backends serial,serial", "stands twice", 2},
  };
  for (const auto &[arguments, words, exit_code] : wrong) {
    const std::string line = std::string(options);
    const Outcome outcome =
        run_program(folder, (std::string(arguments).find("--backends") == std::string::npos
                                 ? line
                                 : line.substr(0, line.find("--backends"))) +
                                arguments);
    expect_contains(outcome.err, words);
    assert_int_equal(outcome.exit_code, exit_code);
  }
}

void a_python_that_cant_judge_is_named_before_anything_runs(void **) {
  const std::string folder = start("python");
  setenv("PBF_PYTHON", "/nowhere/python", 1);
  const Outcome run = run_program(folder, std::string(options) + "--sweep tiny.json --json p.json");
  unsetenv("PBF_PYTHON");
  assert_int_equal(run.exit_code, 1);
  expect_contains(run.err, "/nowhere/python can't be started");
  assert_false(std::filesystem::exists(folder + "/p.json"));
}

// A run that takes too long is a point without a result, not the end of the sweep.
void a_point_that_fails_does_not_end_the_sweep(void **) {
  const std::string folder = start("patience");
  const Outcome run =
      run_program(folder, std::string(options) + "--sweep tiny.json --patience 1e-9 --json p.json");
  assert_int_equal(run.exit_code, 1);
  expect_contains(results_in(folder + "/p.json").at("points")[0].at("outcome").at("reason"),
                  "given up after");
}

void an_interrupted_sweep_keeps_what_there_was(void **) {
  const std::string folder = start("interrupt");
  const pid_t child =
      start_program(folder, {"pareto", "--scene", "dam-break-2d", "--particles", "300", "--steps",
                             "8", "--backends", "reference", "--sweep", "tiny.json", "--json",
                             "i.json", "--html", "i.html", "--repetitions", "1000000"});
  const bool began = wait_for_bytes(folder + "/i.json", 3000);
  assert_int_equal(exit_code_after_interrupt(child), 130);
  assert_true(began);
  const json results = results_in(folder + "/i.json");
  assert_false(results.at("points")[0].at("outcome").is_null());
  expect_contains(read_text(folder + "/i.html"), "</html>");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_quick_sweep_writes_results_and_a_page),
      cmocka_unit_test(a_sweep_goes_on_where_it_was),
      cmocka_unit_test(files_that_are_not_its_own_stay_untouched),
      cmocka_unit_test(wrong_command_lines_say_what_is_wrong),
      cmocka_unit_test(a_python_that_cant_judge_is_named_before_anything_runs),
      cmocka_unit_test(a_point_that_fails_does_not_end_the_sweep),
      cmocka_unit_test(an_interrupted_sweep_keeps_what_there_was),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
