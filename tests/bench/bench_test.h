/* What the tests of the harness share. */
#ifndef PBF_TESTS_BENCH_TEST_H
#define PBF_TESTS_BENCH_TEST_H

#include <csetjmp>
#include <cstdarg>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

extern "C" {
#include <cmocka.h>
}

enum { test_skipped = 77 };

inline void write_text(const std::string &path, const std::string &text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  assert_true(static_cast<bool>(file));
}

inline std::string read_text(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  assert_true(static_cast<bool>(file));
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline void expect_contains(const std::string &text, const std::string &part) {
  if (text.find(part) == std::string::npos) {
    print_error("\"%s\" is not in:\n%s\n", part.c_str(), text.c_str());
  }
  assert_true(text.find(part) != std::string::npos);
}

#endif
