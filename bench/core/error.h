/* Errors that end a command, each with the exit code that --help promises. */
#ifndef PBF_BENCH_ERROR_H
#define PBF_BENCH_ERROR_H

#include <new>
#include <stdexcept>
#include <string>

namespace bench {

enum ExitCode {
  exit_ok = 0,
  exit_failure = 1,       // a step, a file or a device failed
  exit_usage = 2,         // the command line or the scene is wrong
  exit_unavailable = 3,   // no backend can do it here
  exit_interrupted = 130  // Ctrl-C
};

// As a terminal may be given it: names of files and words of a command line may hold what moves its
// cursor, or begins a line that looks like the program's own.
inline std::string one_line(std::string text) {
  for (char &byte : text)
    if ((byte >= 0 && byte < ' ') || byte == 0x7f) byte = '?';
  return text;
}

// What went wrong: of memory the C++ library has the name of a type.
inline std::string sentence_of(const std::exception &error) {
  const bool is_memory = dynamic_cast<const std::bad_alloc *>(&error) != nullptr ||
                         dynamic_cast<const std::length_error *>(&error) != nullptr;
  return is_memory ? "there is no memory for what it holds" : error.what();
}

class Error : public std::runtime_error {
 public:
  Error(ExitCode exit_code, const std::string &sentence)
      : std::runtime_error(sentence), code(exit_code) {}
  const ExitCode code;
};

}  // namespace bench

#endif
