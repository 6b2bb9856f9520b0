#include "core/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace bench {
namespace {

int start(const std::vector<std::string> &words, const std::string &errors, pid_t &child) {
  std::vector<char *> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string &word : words) arguments.push_back(const_cast<char *>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (!errors.empty()) {
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
  }
  const int failed = posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  return failed;
}

}  // namespace

Ended run_program(const std::vector<std::string> &words, const std::string &errors) {
  pid_t child = 0;
  const int failed = start(words, errors, child);
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
