/* What a program has to see to about its standard input, output and error. */
#ifndef PBF_BENCH_CORE_STANDARD_STREAMS_H
#define PBF_BENCH_CORE_STANDARD_STREAMS_H

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#if __has_include(<unistd.h>)
#include <fcntl.h>
#include <unistd.h>
#endif

namespace bench {

// Before anything else. The file that is opened next would get the number of one that is closed,
// and what is then printed: in its place is one that can't be written to. And a reader that goes
// away, or a file as large as it may become, is an error like others. How programs end that this
// one starts is not told where SIGCHLD is ignored, as it may be in what has started this one.
inline void prepare_standard_streams() {
#ifdef F_GETFD
  for (int number = 0; number < 3; ++number)
    if (fcntl(number, F_GETFD) < 0 && open("/dev/null", O_RDONLY) != number) break;
#endif
#ifdef SIGPIPE
  std::signal(SIGPIPE, SIG_IGN);
#endif
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);
#endif
#ifdef SIGCHLD
  std::signal(SIGCHLD, SIG_DFL);
#endif
}

// After all else: a program that lost its output has failed. Of a reader that has read enough
// nothing is said, nor where it is known that something has failed.
inline int exit_after_output(int code, int failure, const char *program) {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout) return code;
  if (code != 0) return code;
  if (errno != EPIPE)
    std::fprintf(stderr, "%s: the standard output can't be written: %s\n", program,
                 std::strerror(errno ? errno : EIO));
  return failure;
}

}  // namespace bench

#endif
