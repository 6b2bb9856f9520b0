#include "scene/params.h"

#include <sstream>

#include "core/near.h"

namespace bench {
namespace {

using nlohmann::json;

const Field &find_field(const std::string &name, const std::string &setting) {
  std::vector<std::string> known;
  for (const Field &field : param_fields()) {
    if (name == field.name) return field;
    known.push_back(field.name);
  }
  throw Error(exit_usage, "--set " + setting + ": there is no parameter \"" + name + "\"" +
                              did_you_mean(name, known));
}

// What a list holds when the scene leaves it out: --set may change one element of it.
json default_list(const Field &field, unsigned dimension) {
  pbf_params params;
  pbf_params_init(&params, sizeof params);
  const auto *values =
      reinterpret_cast<const double *>(reinterpret_cast<const char *>(&params) + field.offset);
  return std::vector<double>(values, values + list_length(field.type, dimension));
}

json setting_value(const Field &field, const std::string &text) {
  json parsed = json::parse(text, nullptr, false);
  if (!parsed.is_discarded()) return parsed;
  if (field.type != FieldType::some_of) return text;
  json names = json::array();
  std::istringstream list(text);
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

unsigned index_of(const std::string &text, size_t length, const std::string &setting) {
  const bool digit = text.size() == 1 && text[0] >= '0' && text[0] <= '9';
  if (!digit || static_cast<size_t>(text[0] - '0') >= length) {
    throw Error(exit_usage, "--set " + setting + ": \"" + text + "\" is no index; it must be 0 … " +
                                std::to_string(length - 1));
  }
  return static_cast<unsigned>(text[0] - '0');
}

}  // namespace

// The column `type` of params.def.
#define FIELD_NUMBER \
  FieldType::integer, {}
#define FIELD_ONE_OF(...) \
  FieldType::one_of, { __VA_ARGS__ }
#define FIELD_SOME_OF(...) \
  FieldType::some_of, { __VA_ARGS__ }

const std::vector<Field> &param_fields() {
  static const std::vector<Field> fields = {
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  {#name, offsetof(pbf_params, name), FIELD_##type},
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  {#name, offsetof(pbf_params, name), FieldType::number, {}},
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  {#name, offsetof(pbf_params, name), count == 3 ? FieldType::vector : FieldType::walls, {}},
#include "physics/params.def"
  };
  return fields;
}
#undef FIELD_NUMBER
#undef FIELD_ONE_OF
#undef FIELD_SOME_OF

void read_params(const json &object, const json::json_pointer &where, unsigned dimension,
                 pbf_params &params) {
  read_fields(param_fields(), object, where, dimension, &params);
}

void apply_setting(const std::string &setting, Document &scene) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos) {
    throw Error(exit_usage, "--set " + setting + ": no \"=\"; wanted: key=value, as gravity.1=-3");
  }
  const std::string key = setting.substr(0, equals);
  const auto dot = key.find('.');
  const Field &field = find_field(key.substr(0, dot), setting);
  const json value = setting_value(field, setting.substr(equals + 1));
  json::json_pointer pointer("/params");
  pointer /= std::string(field.name);
  if (dot == std::string::npos) return scene.override_value(pointer, value, "--set " + setting);
  if (field.type != FieldType::vector && field.type != FieldType::walls) {
    throw Error(exit_usage, "--set " + setting + ": " + field.name + " is not a list");
  }
  const auto dimension = scene.value.at("dimension").get<unsigned>();
  const unsigned index = index_of(key.substr(dot + 1), list_length(field.type, dimension), setting);
  if (!scene.value.contains(pointer)) scene.value[pointer] = default_list(field, dimension);
  scene.override_value(pointer / index, value, "--set " + setting);
}

}  // namespace bench
