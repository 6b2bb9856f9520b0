/* A progress bar with the time left, on standard error and only when that is a terminal. */
#ifndef PBF_BENCH_PROGRESS_H
#define PBF_BENCH_PROGRESS_H

#include <chrono>
#include <string>

namespace bench {

class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;

  // `fraction` in 0 … 1 is the share of the work that is done.
  void show(double fraction, const std::string &label);

 private:
  using Clock = std::chrono::steady_clock;
  bool on_terminal_;
  bool shown_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace bench

#endif
