#include "pareto/digest.h"

#include <cstdio>
#include <fstream>
#include <sstream>

namespace bench {
namespace {

uint64_t hash_of(pbf_shape *shape) {
  pbf_shape_info info = {};
  info.struct_size = sizeof info;
  return pbf_get_shape_info(shape, &info) == PBF_OK ? info.hash : 0;
}

}  // namespace

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
  bytes(particles.velocities.data(), particles.velocities.size() * sizeof(double));
  return bytes(particles.phases.data(), particles.phases.size() * sizeof(uint32_t));
}

// Where a shape lies in memory decides nothing; what is in it does.
Digest &Digest::add_objects(const Scene &scene) {
  for (const Collider &collider : scene.colliders) {
    pbf_collider start = collider.start;
    start.geometry = nullptr;
    bytes(&start, sizeof start);
    if (!collider.geometry.empty()) add(hash_of(collider.start.geometry));
    for (const Stretch &stretch : collider.motion) bytes(&stretch, sizeof stretch);
  }
  // A scene without these has the digest that it had before there were any.
  bytes(scene.phases.data(), scene.phases.size() * sizeof(pbf_phase));
  bytes(scene.emitters.data(), scene.emitters.size() * sizeof(pbf_emitter));
  bytes(scene.drains.data(), scene.drains.size() * sizeof(pbf_volume));
  return scene.capacity > 0 ? add(uint64_t{scene.capacity}) : *this;
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
