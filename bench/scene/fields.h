/* The members of the library's structs by their names, for scene files. */
#ifndef PBF_BENCH_FIELDS_H
#define PBF_BENCH_FIELDS_H

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "scene/document.h"

namespace bench {

// Of what a scene file has: vector is a list of numbers, one an axis, walls one a wall; one_of is a
// name, some_of a list of names, flag true or false; other is read by the object's own code.
enum class FieldType {
  number,
  integer,
  flag,
  vector,
  vector3,
  quaternion,
  walls,
  one_of,
  some_of,
  other
};

struct Field {
  const char *name;
  size_t offset;
  FieldType type;
  std::vector<const char *> names;  // one_of: of the values 0, 1, …; some_of: of the bits
};

// Of a list.
size_t list_length(FieldType type, unsigned dimension);

// Overwrites the members of `target` that `object` has, an object that keeps to the schema. Throws
// ValueError for a list of a length that does not fit the dimension.
void read_fields(const std::vector<Field> &fields, const nlohmann::json &object,
                 const nlohmann::json::json_pointer &where, unsigned dimension, void *target);

// The list as three numbers, those that it lacks 0. Throws ValueError unless it has `dimension`.
void read_vector(const nlohmann::json &list, const nlohmann::json::json_pointer &where,
                 unsigned dimension, double *out);

}  // namespace bench

#endif
