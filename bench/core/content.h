/* The bytes of a file that a user names. */
#ifndef PBF_BENCH_CORE_CONTENT_H
#define PBF_BENCH_CORE_CONTENT_H

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

namespace bench {

// All of a file, a pipe or whatever the system can read, of at most `most` bytes. What does not
// begin with `mark` is read no further: a device may have no end, and what reads the bytes says
// that they are none of its own. Throws std::runtime_error with a sentence that names the file.
inline std::string content_of(const std::string &path, uintmax_t most,
                              const std::string &mark = "") {
  const auto failed = [&path](int error) {
    return std::runtime_error(path + " can't be read: " + std::strerror(error));
  };
  std::FILE *opened = nullptr;  // a signal is no reason to give a pipe up
  do opened = std::fopen(path.c_str(), "rb");
  while (!opened && errno == EINTR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(opened, std::fclose);
  if (!file) throw failed(errno);
  std::string bytes;
  static char chunk[1 << 16];
  try {
    for (;;) {
      errno = 0;
      const size_t count = std::fread(chunk, 1, sizeof chunk, file.get());
      bytes.append(chunk, count);
      if (std::ferror(file.get()) && errno == EINTR)
        std::clearerr(file.get());
      else if (count == 0)
        break;
      const size_t seen = std::min(bytes.size(), mark.size());
      if (bytes.compare(0, seen, mark, 0, seen) != 0) return bytes;
      if (bytes.size() > most)
        throw std::runtime_error(path + " has more than " + std::to_string(most) +
                                 " bytes, the most that such a file has");
    }
  } catch (const std::bad_alloc &) {
    throw failed(ENOMEM);
  }
  if (std::ferror(file.get())) throw failed(errno);
  return bytes;
}

}  // namespace bench

#endif
