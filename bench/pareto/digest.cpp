#include "pareto/digest.h"

#include <cstdio>
#include <fstream>
#include <sstream>

namespace bench {

Digest &Digest::bytes(const void *data, size_t size) {
  const auto *byte = static_cast<const unsigned char *>(data);
  for (size_t i = 0; i < size; ++i) hash_ = (hash_ ^ byte[i]) * 1099511628211u;
  return *this;
}

Digest &Digest::add(const std::string &text) {
  add(uint64_t{text.size()});
  return bytes(text.data(), text.size());
}

Digest &Digest::add(uint64_t number) { return bytes(&number, sizeof number); }

// The struct has no holes, which a test of the table of fields sees to.
Digest &Digest::add(const pbf_params &params) { return bytes(&params, sizeof params); }

Digest &Digest::add(const Particles &particles) {
  bytes(particles.positions.data(), particles.positions.size() * sizeof(double));
  return bytes(particles.velocities.data(), particles.velocities.size() * sizeof(double));
}

Digest &Digest::add(const std::vector<Collider> &colliders) {
  for (const Collider &collider : colliders) {
    bytes(&collider.start, sizeof collider.start);
    for (const Stretch &stretch : collider.motion) bytes(&stretch, sizeof stretch);
  }
  return *this;
}

std::string Digest::text() const {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash_));
  return text;
}

std::string digest_of_file(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "";
  std::stringstream content;
  content << file.rdbuf();
  return Digest().add(content.str()).text();
}

}  // namespace bench
