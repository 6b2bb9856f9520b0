/* The benchmark's own figures, on the backend PBF_TEST_BACKEND: they come from the report's
 * equations, solved by another program. */
#include <cmath>
#include <vector>

#include "program.h"

namespace {

std::string backend;

struct Row {
  double step, time, com_x, com_y, com_z, energy, max_x, max_y, max_z, error_mean, error_max,
      iterations;
};

std::vector<Row> rows;

void run_the_benchmark() {
  const std::string folder = work_folder("report_30k_" + backend);
  skip_unless_available(folder, backend);
  const Outcome run =
      run_program(folder, "run --scene report-30k --csv t.csv --backend " + backend);
  if (run.exit_code != 0) print_error("%s\n", run.err.c_str());
  assert_int_equal(run.exit_code, 0);
  std::istringstream csv(read_text(folder + "/t.csv"));
  std::string line;
  std::getline(csv, line);
  while (std::getline(csv, line)) {
    double cells[12];
    std::istringstream in(line);
    for (double &cell : cells) {
      std::string text;
      assert_true(static_cast<bool>(std::getline(in, text, ',')));
      cell = std::stod(text);
      assert_true(std::isfinite(cell));
    }
    rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7],
                    cells[8], cells[9], cells[10], cells[11]});
  }
}

void there_is_a_row_for_each_of_100_steps(void **) {
  run_the_benchmark();
  assert_int_equal(rows.size(), 100);
  assert_float_equal(rows[99].time, 5, 1e-9);
  assert_float_equal(rows[99].iterations, 5, 0);
}

// Half a unit of the last digit given.
void after_one_step_it_is_where_the_report_is(void **) {
  assert_true(rows.size() == 100);
  assert_float_equal(rows[0].com_x, 143.7128, 0.00006);
  assert_float_equal(rows[0].com_y, 17.2080, 0.00006);
  assert_float_equal(rows[0].energy, 0.1837, 0.00006);
  assert_float_equal(rows[0].max_y, 34.337, 0.0006);
}

// 2 %: the flow is chaotic.
void after_100_steps_it_is_near(void **) {
  assert_true(rows.size() == 100);
  assert_float_equal(rows[99].com_x, 146.1, 0.02 * 146.1);
  assert_float_equal(rows[99].com_y, 16.6, 0.02 * 16.6);
  assert_float_equal(rows[99].max_x, 354, 0.02 * 354);
}

}  // namespace

int main() {
  const char *name = std::getenv("PBF_TEST_BACKEND");
  backend = name ? name : "reference";
  const CMUnitTest tests[] = {
      cmocka_unit_test(there_is_a_row_for_each_of_100_steps),
      cmocka_unit_test(after_one_step_it_is_where_the_report_is),
      cmocka_unit_test(after_100_steps_it_is_near),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
