/* A folder for files that are not kept. */
#ifndef PBF_BENCH_SCRATCH_H
#define PBF_BENCH_SCRATCH_H

#include <string>

namespace bench {

// In the system's folder for temporary files; it goes with everything in it.
class Scratch {
 public:
  explicit Scratch(const std::string &purpose);  // a part of its name
  ~Scratch();
  Scratch(const Scratch &) = delete;
  Scratch &operator=(const Scratch &) = delete;

  const std::string &path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace bench

#endif
