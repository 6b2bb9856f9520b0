/* FNV-1a, 64 bit, over what decides a result: two results with one digest are interchangeable. */
#ifndef PBF_BENCH_DIGEST_H
#define PBF_BENCH_DIGEST_H

#include <cstdint>
#include <string>

#include "scene/scene.h"

namespace bench {

class Digest {
 public:
  Digest &add(const std::string &text);
  Digest &add(uint64_t number);
  Digest &add(const pbf_params &params);
  Digest &add(const Particles &particles);
  // Colliders, phases, emitters and drains.
  Digest &add_objects(const Scene &scene);

  std::string text() const;  // 16 hexadecimal digits

 private:
  Digest &bytes(const void *data, size_t size);

  uint64_t hash_ = 14695981039346656037u;
};

// Of its bytes; empty when it can't be read.
std::string digest_of_file(const std::string &path);

}  // namespace bench

#endif
