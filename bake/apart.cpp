#include "apart.h"

#include <stdexcept>

#include "core/error.h"

#if __has_include(<sys/wait.h>)
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#endif

#if defined(__linux__)
#include <sys/prctl.h>
#endif

namespace bake {

#if __has_include(<sys/wait.h>)

namespace {

constexpr char done = 'd', failed = 'f';  // the first byte of what comes back

void limit(int resource, rlim_t most) {
  rlimit now = {};
  if (getrlimit(resource, &now) != 0 || now.rlim_cur <= most) return;
  now.rlim_cur = most;
  setrlimit(resource, &now);
}

bool write_all(int to, const std::string &bytes) {
  for (size_t at = 0; at < bytes.size();) {
    const ssize_t count = write(to, bytes.data() + at, bytes.size() - at);
    if (count > 0) at += static_cast<size_t>(count);
    if (count < 0 && errno != EINTR) return false;
  }
  return true;
}

std::string read_all(int from) {
  std::string bytes;
  static char chunk[1 << 16];
  for (;;) {
    const ssize_t count = read(from, chunk, sizeof chunk);
    if (count > 0) bytes.append(chunk, static_cast<size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) return bytes;
  }
}

std::string outcome_of(const std::function<std::string()> &work) {
  try {
    return done + work();
  } catch (const std::exception &error) {
    return failed + bench::sentence_of(error);
  }
}

// A program that is killed leaves none behind that reads on.
void end_with(pid_t program) {
#if defined(__linux__)
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != program) _exit(1);
}

// What a library prints before it aborts is no sentence of the program's.
[[noreturn]] void work_and_end(const std::function<std::string()> &work, unsigned seconds, int to) {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, seconds);
  _exit(write_all(to, outcome_of(work)) ? 0 : 1);
}

std::string end_of(int status) {
  if (!WIFSIGNALED(status)) return "has ended";
  if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) return "has come to no end";
  return "has crashed by signal " + std::to_string(WTERMSIG(status));
}

}  // namespace

std::string run_apart(const std::function<std::string()> &work, unsigned seconds) {
  int ends[2], status = 0;
  if (pipe(ends) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  const pid_t program = getpid(), child = fork();
  if (child == 0) close(ends[0]), end_with(program), work_and_end(work, seconds, ends[1]);
  const int error = errno;
  close(ends[1]);
  const std::string bytes = child < 0 ? "" : read_all(ends[0]);
  close(ends[0]);
  if (child < 0) throw std::runtime_error(std::string("no process: ") + std::strerror(error));
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (status != 0 || bytes.empty()) throw std::runtime_error("what reads it " + end_of(status));
  if (bytes[0] == failed) throw std::runtime_error(bytes.substr(1));
  return bytes.substr(1);
}

#else

std::string run_apart(const std::function<std::string()> &work, unsigned) { return work(); }

#endif

}  // namespace bake
