#include "ablation/worker.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/error.h"

namespace bench {
namespace {

double seconds_of(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// In front of every answer.
struct Header {
  int32_t code;  // an ExitCode
  char sentence[1020];
};

bool write_all(int to, const void *data, size_t size) {
  const char *next = static_cast<const char *>(data);
  while (size > 0) {
    const ssize_t wrote = write(to, next, size);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    next += wrote;
    size -= static_cast<size_t>(wrote);
  }
  return true;
}

bool read_all(int from, void *data, size_t size) {
  char *next = static_cast<char *>(data);
  while (size > 0) {
    const ssize_t got = read(from, next, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    size -= static_cast<size_t>(got);
  }
  return true;
}

void answer(int to, int code, const std::string &sentence) {
  Header header = {};
  header.code = code;
  std::snprintf(header.sentence, sizeof header.sentence, "%s", sentence.c_str());
  write_all(to, &header, sizeof header);
}

// Runs `work` and answers with what it returns, or with its error; whether it went well.
template <class Value>
bool answer_with(int to, const std::function<Value()> &work) {
  try {
    const Value value = work();
    answer(to, exit_ok, "");
    write_all(to, &value, sizeof value);
    return true;
  } catch (const Error &error) {
    answer(to, error.code, error.what());
  } catch (const std::exception &error) {
    answer(to, exit_failure, sentence_of(error));
  }
  return false;
}

Header hear(int from) {
  Header header = {};
  if (!read_all(from, &header, sizeof header))
    throw Error(exit_failure, "a measuring process has died");
  if (header.code != exit_ok) throw Error(static_cast<ExitCode>(header.code), header.sentence);
  return header;
}

// ---- In the worker's process ----

class Seat {
 public:
  Seat(const Job &job, const Start &start) : job_(job) {
    if (!job.folder.empty()) setenv("PBF_BACKEND_PATH", job.folder.c_str(), 1);
    solver_ = std::make_unique<Solver>(job.variant.scene, job.solver);
    const std::string path = solver_->info().path;
    if (!job.folder.empty() && std::filesystem::path(path).parent_path() != job.folder) {
      throw Error(exit_unavailable,
                  job.folder + " has no backend \"" + job.solver.backend + "\" that can serve: " +
                      (path.empty() ? "it is linked in" : path) + " came instead");
    }
    if (!start.positions.empty()) solver_->place(start.positions, start.velocities);
    if (job.variant.requests.timing) solver_->set_timing(true);
    start_ = solver_->save();
  }

  double run() {
    solver_->load(start_);
    solver_->synchronize();
    const clockid_t clock = job_.cpu_time ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    const double begin = seconds_of(clock);
    if (!job_.variant.requests.stats) {
      solver_->step(job_.variant.scene.steps);
    } else {
      for (uint32_t k = 0; k < job_.variant.scene.steps; ++k) {
        solver_->step(1);
        solver_->stats();
      }
    }
    solver_->synchronize();
    return seconds_of(clock) - begin;
  }

  Facts facts() {
    Facts facts = {solver_->info(), solver_->plan(), {}, solver_->hash(), 1};
    try {
      facts.stats = solver_->stats();
    } catch (const Error &error) {
      if (error.code != exit_unavailable) throw;
      facts.has_stats = 0;
    }
    return facts;
  }

 private:
  const Job &job_;
  std::unique_ptr<Solver> solver_;
  Bytes start_;
};

void serve(const Job &job, const Start &start, int from, int to) {
  std::unique_ptr<Seat> seat;
  const auto sit = [&]() -> int {
    seat = std::make_unique<Seat>(job, start);
    return 0;
  };
  if (!answer_with<int>(to, sit)) return;
  for (char request; read_all(from, &request, 1) && request != 'q';) {
    if (request == 'r') answer_with<double>(to, [&] { return seat->run(); });
    if (request == 'f') answer_with<Facts>(to, [&] { return seat->facts(); });
  }
}

struct Pipes {
  int to[2], from[2];
};

pid_t fork_with(Pipes &pipes) {
  if (pipe(pipes.to) != 0 || pipe(pipes.from) != 0)
    throw Error(exit_failure, std::string("no pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw Error(exit_failure, std::string("no process: ") + std::strerror(errno));
  close(child == 0 ? pipes.to[1] : pipes.to[0]);
  close(child == 0 ? pipes.from[0] : pipes.from[1]);
  return child;
}

Bytes read_bytes(int from) {
  uint64_t size = 0;
  if (!read_all(from, &size, sizeof size))
    throw Error(exit_failure, "a measuring process has died");
  Bytes bytes(size);
  if (!read_all(from, bytes.data(), size))
    throw Error(exit_failure, "a measuring process has died");
  return bytes;
}

void write_bytes(int to, const Bytes &bytes) {
  const uint64_t size = bytes.size();
  write_all(to, &size, sizeof size);
  write_all(to, bytes.data(), bytes.size());
}

template <class Real>
void clamp_into(const Scene &scene, Bytes &positions) {
  Real *x = reinterpret_cast<Real *>(positions.data());
  for (size_t i = 0; i < positions.size() / sizeof(Real); ++i) {
    const size_t k = i % scene.dimension;
    x[i] = std::clamp(x[i], static_cast<Real>(scene.params.domain_min[k]),
                      static_cast<Real>(scene.params.domain_max[k]));
  }
}

}  // namespace

Worker::Worker(const Job &job, const Start &start) {
  std::signal(SIGPIPE, SIG_IGN);
  Pipes pipes;
  child_ = fork_with(pipes);
  if (child_ == 0) {
    serve(job, start, pipes.to[0], pipes.from[1]);
    _exit(0);
  }
  to_ = pipes.to[1];
  from_ = pipes.from[0];
  try {
    int ready;
    hear(from_);
    read_all(from_, &ready, sizeof ready);
  } catch (...) {
    close(to_);
    close(from_);
    waitpid(child_, nullptr, 0);
    throw;
  }
}

// Said in so many words: later workers have this one's pipe open too.
Worker::~Worker() {
  write_all(to_, "q", 1);
  close(to_);
  close(from_);
  waitpid(child_, nullptr, 0);
}

template <class Value>
Value Worker::ask(char request) {
  if (!write_all(to_, &request, 1)) throw Error(exit_failure, "a measuring process has died");
  hear(from_);
  Value value;
  if (!read_all(from_, &value, sizeof value))
    throw Error(exit_failure, "a measuring process has died");
  return value;
}

double Worker::run() { return ask<double>('r'); }
Facts Worker::facts() { return ask<Facts>('f'); }

Start run_up(const Scene &scene, const SolverOptions &options, uint32_t steps) {
  Pipes pipes;
  const pid_t child = fork_with(pipes);
  if (child == 0) {
    std::unique_ptr<Solver> solver;
    const bool done = answer_with<int>(pipes.from[1], [&] {
      solver = std::make_unique<Solver>(scene, options);
      solver->step(scene.lead_in_steps + steps);
      solver->synchronize();
      return 0;
    });
    if (done) write_bytes(pipes.from[1], solver->positions());
    if (done) write_bytes(pipes.from[1], solver->velocities());
    _exit(0);
  }
  Start start;
  close(pipes.to[1]);
  try {
    int done;
    hear(pipes.from[0]);
    read_all(pipes.from[0], &done, sizeof done);
    start.positions = read_bytes(pipes.from[0]);
    start.velocities = read_bytes(pipes.from[0]);
  } catch (...) {
    close(pipes.from[0]);
    waitpid(child, nullptr, 0);
    throw;
  }
  close(pipes.from[0]);
  waitpid(child, nullptr, 0);
  if (options.precision == PBF_FLOAT64)
    clamp_into<double>(scene, start.positions);
  else
    clamp_into<float>(scene, start.positions);
  return start;
}

}  // namespace bench
