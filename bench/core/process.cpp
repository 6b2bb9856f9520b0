#include "core/process.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace bench {

Ended run_program(const std::vector<std::string> &words) {
  std::vector<char *> arguments;
  for (const std::string &word : words) arguments.push_back(const_cast<char *>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (failed != 0) return {0, 0, words[0] + " can't be started: " + std::strerror(failed)};
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return {0, 0, words[0] + ": " + std::strerror(errno)};
  }
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status), ""};
  return {WEXITSTATUS(status), 0, ""};
}

std::string this_program() {
  std::error_code failed;
  const std::string path = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? "pbf-bench" : path;
}

}  // namespace bench
