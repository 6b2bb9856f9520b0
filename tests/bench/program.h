/* Runs pbf-bench as a user would. */
#ifndef PBF_TESTS_BENCH_PROGRAM_H
#define PBF_TESTS_BENCH_PROGRAM_H

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "bench_test.h"

struct Outcome {
  int exit_code;
  std::string out, err;
};

// An empty folder of the test's own, where the program runs.
inline std::string work_folder(const std::string &name) {
  const std::string folder = PBF_TEST_WORK "/" + name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline Outcome run_program(const std::string &folder, const std::string &arguments) {
  const std::string command =
      "cd '" + folder + "' && '" PBF_TEST_PROGRAM "' " + arguments + " >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  assert_true(WIFEXITED(status));
  return {WEXITSTATUS(status), read_text(folder + "/out.txt"), read_text(folder + "/err.txt")};
}

// Exits with 77 when the backend is not built or has no device here.
inline void skip_unless_available(const std::string &folder, const std::string &backend) {
  const Outcome list = run_program(folder, "list");
  std::istringstream lines(list.out);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| " + backend + " ", 0) == 0 && line.find("| yes ") != std::string::npos)
      return;
  }
  std::printf("SKIPPED: %s can't serve here\n", backend.c_str());
  std::exit(test_skipped);
}

#endif
