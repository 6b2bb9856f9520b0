/* Another program, run to its end. */
#ifndef PBF_BENCH_PROCESS_H
#define PBF_BENCH_PROCESS_H

#include <string>
#include <vector>

namespace bench {

struct Ended {
  int code = 0;        // exit code, when no signal ended it
  int signal = 0;      // 0: it ended by itself
  std::string reason;  // why it can't have been started; else empty
};

// The first word is looked for in PATH unless it has a slash. Output goes where ours does, unless
// `errors` names a file for standard error: standard output then goes nowhere.
Ended run_program(const std::vector<std::string> &words, const std::string &errors = "");

// Path of the running program.
std::string this_program();

}  // namespace bench

#endif
