/* What a wrong command line is told, by the words that it has: one line, and where help is. */
#ifndef PBF_BENCH_CORE_FAILURE_MESSAGE_H
#define PBF_BENCH_CORE_FAILURE_MESSAGE_H

#include <CLI/CLI.hpp>
#include <string>

#include "core/error.h"

namespace bench {

inline std::string failure_message(const CLI::App *app, const CLI::Error &error) {
  const CLI::Error plain(error.get_name(), one_line(error.what()), error.get_exit_code());
  return CLI::FailureMessage::simple(app, plain);
}

}  // namespace bench

#endif
