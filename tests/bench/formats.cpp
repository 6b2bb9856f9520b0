/* Bytes that other programs read: .npy, CSV, base64, PNG, the table. */
#include <cstring>
#include <vector>

#include "bench_test.h"
#include "core/error.h"
#include "core/npy.h"
#include "core/table.h"
#include "core/trace.h"
#include "report/base64.h"
#include "report/picture.h"

namespace {

using namespace bench;

// The format's document: magic, version, little-endian length, a dictionary that ends at a
// multiple of 64, then the rows.
void npy_is_as_numpy_documents_it(void **) {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  const std::string path = PBF_TEST_WORK "/array.npy";
  write_npy(path, values.data(), 2, 3, 4);
  const std::string bytes = read_text(path);
  assert_memory_equal(bytes.data(), "\x93NUMPY\x01\x00", 8);
  const size_t length =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  assert_int_equal((10 + length) % 64, 0);
  const std::string dictionary = bytes.substr(10, length);
  expect_contains(dictionary, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }");
  assert_int_equal(dictionary.back(), '\n');
  assert_int_equal(bytes.size(), 10 + length + values.size() * sizeof(float));
  assert_memory_equal(bytes.data() + 10 + length, values.data(), values.size() * sizeof(float));
}

void npy_says_float64_and_fails_aloud(void **) {
  const double value = 0.5;
  const std::string path = PBF_TEST_WORK "/wide.npy";
  write_npy(path, &value, 1, 1, 8);
  expect_contains(read_text(path), "'<f8'");
  try {
    write_npy("/nowhere/at/all.npy", &value, 1, 1, 8);
    fail();
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_failure);
    expect_contains(error.what(), "/nowhere/at/all.npy");
  }
}

void a_trace_has_the_columns_in_their_order(void **) {
  assert_string_equal(trace_header().c_str(),
                      "step,time,com_x,com_y,com_z,kinetic_energy,max_x,max_y,max_z,"
                      "density_error_mean,density_error_max,iterations\n");
  pbf_info info = {};
  info.step = 3;
  info.time = 0.25;
  info.dimension = 3;
  pbf_stats stats = {};
  for (int axis = 0; axis < 3; ++axis) {
    stats.center_of_mass[axis] = 1 + axis;
    stats.position_max[axis] = 10 + axis;
  }
  stats.kinetic_energy = 0.1;
  stats.density_error_mean = 0.001;
  stats.density_error_max = 0.5;
  stats.iterations = 5;
  assert_string_equal(trace_row(info, stats).c_str(), "3,0.25,1,2,3,0.1,10,11,12,0.001,0.5,5\n");
  info.dimension = 2;
  assert_string_equal(trace_row(info, stats).c_str(), "3,0.25,1,2,0,0.1,10,11,0,0.001,0.5,5\n");
}

// RFC 4648, section 10.
void base64_is_the_rfcs(void **) {
  const char *const vectors[][2] = {{"", ""},
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}};
  for (const auto &[plain, coded] : vectors) assert_string_equal(base64(plain).c_str(), coded);
}

void a_table_is_markdown_with_even_columns(void **) {
  Table table({"name", "ms"});
  table.align_right(1, 1);
  table.add({"a", "1,234"});
  table.add({"b|c", "–"});
  assert_string_equal(table.text().c_str(),
                      "| name |    ms |\n"
                      "| ---- | ----: |\n"
                      "| a    | 1,234 |\n"
                      "| b/c  |     – |\n");
}

// Width and height stand in the first chunk, big-endian.
void a_picture_is_a_png_of_the_views_shape(void **) {
  Frame frame{2, {{0.5, 0.5, 0}, {3.5, 0.5, 0}}, {0, 1}};
  View view;
  view.upper = {4, 1, 0};
  view.particle_radius = 0.01;
  view.width = 404;
  const std::string png = draw_png(frame, view);
  assert_memory_equal(png.data(), "\x89PNG\r\n\x1a\n", 8);
  const auto number = [&](size_t at) {
    return 256 * static_cast<unsigned char>(png[at + 2]) + static_cast<unsigned char>(png[at + 3]);
  };
  assert_int_equal(number(16), 404);
  assert_in_range(number(20), 104, 105);
  assert_true(draw_png(frame, view) == png);
  frame.positions[1][0] = 2;
  assert_true(draw_png(frame, view) != png);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(npy_is_as_numpy_documents_it),
      cmocka_unit_test(npy_says_float64_and_fails_aloud),
      cmocka_unit_test(a_trace_has_the_columns_in_their_order),
      cmocka_unit_test(base64_is_the_rfcs),
      cmocka_unit_test(a_table_is_markdown_with_even_columns),
      cmocka_unit_test(a_picture_is_a_png_of_the_views_shape),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
