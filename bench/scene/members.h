/* The members of an object of a scene file. */
#ifndef PBF_BENCH_MEMBERS_H
#define PBF_BENCH_MEMBERS_H

#include <string>

#include "scene/fields.h"
#include "scene/scene.h"

namespace bench {

// Reads the members of one object that has passed the schema.
class Members {
 public:
  Members(const nlohmann::json &object, const nlohmann::json::json_pointer &where,
          unsigned dimension)
      : object_(object), where_(where), dimension_(dimension) {}

  void vector(const char *key, Vector &out) const { list(key, dimension_, out.data()); }
  void vector(const char *key, double *out) const { list(key, dimension_, out); }
  void vector3(const char *key, Vector &out) const { list(key, 3, out.data()); }
  void vector3(const char *key, double *out) const { list(key, 3, out); }

  template <typename T>
  void value(const char *key, T &out) const {
    if (has(key)) out = object_.at(key).get<T>();
  }

  void counts(const char *key, std::array<uint32_t, 3> &out) const {
    Vector numbers{1, 1, 1};
    vector(key, numbers);
    for (unsigned axis = 0; axis < dimension_; ++axis)
      out[axis] = static_cast<uint32_t>(numbers[axis]);
  }

  bool has(const char *key) const { return object_.contains(key); }
  const nlohmann::json &at(const char *key) const { return object_.at(key); }
  std::string text(const char *key) const { return object_.at(key).get<std::string>(); }
  nlohmann::json::json_pointer pointer(const char *key) const { return where_ / std::string(key); }

 private:
  void list(const char *key, unsigned length, double *out) const {
    if (has(key)) read_vector(object_.at(key), pointer(key), length, out);
  }

  const nlohmann::json &object_;
  nlohmann::json::json_pointer where_;
  unsigned dimension_;
};

}  // namespace bench

#endif
