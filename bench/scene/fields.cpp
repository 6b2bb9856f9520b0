#include "scene/fields.h"

#include <algorithm>
#include <cstring>

namespace bench {
namespace {

using nlohmann::json;

uint32_t number_of(const json &name, const Field &field) {
  const auto found = std::find(field.names.begin(), field.names.end(), name);
  return static_cast<uint32_t>(found - field.names.begin());
}

uint32_t bits_of(const json &names, const Field &field) {
  uint32_t bits = 0;
  for (const json &name : names) bits |= 1u << number_of(name, field);
  return bits;
}

void read_list(const json &list, const json::json_pointer &where, size_t wanted, double *out) {
  if (list.size() != wanted) {
    throw ValueError{where, "the list has " + std::to_string(list.size()) +
                                " numbers; this scene's dimension wants " + std::to_string(wanted)};
  }
  for (size_t i = 0; i < wanted; ++i) out[i] = list[i].get<double>();
}

template <typename T>
void store(void *target, const Field &field, T value) {
  std::memcpy(static_cast<char *>(target) + field.offset, &value, sizeof value);
}

void read_field(const Field &field, const json &value, const json::json_pointer &where,
                unsigned dimension, void *target) {
  switch (field.type) {
    case FieldType::number:
      return store(target, field, value.get<double>());
    case FieldType::integer:
      return store(target, field, value.get<uint32_t>());
    case FieldType::flag:
      return store(target, field, uint32_t{value.get<bool>()});
    case FieldType::one_of:
      return store(target, field, number_of(value, field));
    case FieldType::some_of:
      return store(target, field, bits_of(value, field));
    case FieldType::vector:
    case FieldType::vector3:
    case FieldType::quaternion:
    case FieldType::walls: {
      auto *out = reinterpret_cast<double *>(static_cast<char *>(target) + field.offset);
      return read_list(value, where, list_length(field.type, dimension), out);
    }
    case FieldType::other:
      return;
  }
}

}  // namespace

size_t list_length(FieldType type, unsigned dimension) {
  switch (type) {
    case FieldType::walls:
      return 2 * dimension;
    case FieldType::vector3:
      return 3;
    case FieldType::quaternion:
      return 4;
    default:
      return dimension;
  }
}

void read_fields(const std::vector<Field> &fields, const json &object,
                 const json::json_pointer &where, unsigned dimension, void *target) {
  for (const Field &field : fields) {
    const auto found = object.find(field.name);
    if (found != object.end()) {
      read_field(field, *found, where / std::string(field.name), dimension, target);
    }
  }
}

void read_vector(const json &list, const json::json_pointer &where, unsigned dimension,
                 double *out) {
  std::fill(out, out + 3, 0.0);
  read_list(list, where, dimension, out);
}

}  // namespace bench
