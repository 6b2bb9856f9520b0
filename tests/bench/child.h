/* Starts pbf-bench and interrupts it. */
#ifndef PBF_TESTS_BENCH_CHILD_H
#define PBF_TESTS_BENCH_CHILD_H

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "bench_test.h"

inline pid_t start_program(const std::string &folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), PBF_TEST_PROGRAM);
  std::vector<char *> argv;
  for (std::string &argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child > 0) return child;
  const int out = open((folder + "/out.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(out, STDOUT_FILENO);
  if (chdir(folder.c_str()) == 0) execv(argv[0], argv.data());
  _exit(99);
}

inline bool wait_for_bytes(const std::string &path, uintmax_t bytes) {
  for (int i = 0; i < 3000; ++i) {
    std::error_code failed;
    const uintmax_t size = std::filesystem::file_size(path, failed);
    if (!failed && size >= bytes) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

inline int exit_code_after_interrupt(pid_t child) {
  assert_int_equal(kill(child, SIGINT), 0);
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

#endif
