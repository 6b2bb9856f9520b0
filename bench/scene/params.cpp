#include "scene/params.h"

#include <algorithm>
#include <cstring>
#include <sstream>

#include "core/near.h"

namespace bench {
namespace {

using nlohmann::json;

using Names = std::vector<const char *>;
const Names kernel_names = {"wendland_c2", "poly6_spiky"};                        // PBF_KERNEL_…
const Names solver_names = {"jacobi", "chebyshev"};                               // PBF_SOLVER_…
const Names collide_names = {"after_prediction", "in_iteration", "after_solve"};  // by bit

uint32_t number_of(const json &name, const Names &names) {
  return static_cast<uint32_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

uint32_t collide_bits(const json &names) {
  uint32_t bits = 0;
  for (unsigned bit = 0; bit < collide_names.size(); ++bit) {
    if (std::find(names.begin(), names.end(), collide_names[bit]) != names.end()) bits |= 1u << bit;
  }
  return bits;
}

size_t list_length(ParamType type, unsigned dimension) {
  return type == ParamType::walls ? 2 * dimension : dimension;
}

void read_list(const json &list, const json::json_pointer &where, size_t wanted, double *out) {
  if (list.size() != wanted) {
    throw ValueError{where, "the list has " + std::to_string(list.size()) +
                                " numbers; this scene's dimension wants " + std::to_string(wanted)};
  }
  for (size_t i = 0; i < wanted; ++i) out[i] = list[i].get<double>();
}

template <typename T>
void store(pbf_params &params, const ParamField &field, T value) {
  std::memcpy(reinterpret_cast<char *>(&params) + field.offset, &value, sizeof value);
}

void read_param(const ParamField &field, const json &value, const json::json_pointer &where,
                unsigned dimension, pbf_params &params) {
  switch (field.type) {
    case ParamType::number:
      return store(params, field, value.get<double>());
    case ParamType::integer:
      return store(params, field, value.get<uint32_t>());
    case ParamType::kernel:
      return store(params, field, number_of(value, kernel_names));
    case ParamType::solver:
      return store(params, field, number_of(value, solver_names));
    case ParamType::collide:
      return store(params, field, collide_bits(value));
    case ParamType::vector:
    case ParamType::walls: {
      auto *out = reinterpret_cast<double *>(reinterpret_cast<char *>(&params) + field.offset);
      return read_list(value, where, list_length(field.type, dimension), out);
    }
  }
}

const ParamField &find_field(const std::string &name, const std::string &setting) {
  std::vector<std::string> known;
  for (const ParamField &field : param_fields()) {
    if (name == field.name) return field;
    known.push_back(field.name);
  }
  throw Error(exit_usage, "--set " + setting + ": there is no parameter \"" + name + "\"" +
                              did_you_mean(name, known));
}

// What a list holds when the scene leaves it out: --set may change one element of it.
json default_list(const ParamField &field, unsigned dimension) {
  pbf_params params;
  pbf_params_init(&params, sizeof params);
  const auto *values =
      reinterpret_cast<const double *>(reinterpret_cast<const char *>(&params) + field.offset);
  return std::vector<double>(values, values + list_length(field.type, dimension));
}

json setting_value(const ParamField &field, const std::string &text) {
  const json parsed = json::parse(text, nullptr, false);
  if (!parsed.is_discarded()) return parsed;
  if (field.type != ParamType::collide) return text;
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

const std::vector<ParamField> &param_fields() {
#define PBF_FIELD(name, type) \
  { #name, ParamType::type, offsetof(pbf_params, name) }
  static const std::vector<ParamField> fields = {
      PBF_FIELD(kernel, kernel),
      PBF_FIELD(smoothing_radius, number),
      PBF_FIELD(spacing, number),
      PBF_FIELD(particle_volume, number),
      PBF_FIELD(time_step, number),
      PBF_FIELD(iterations, integer),
      PBF_FIELD(collide, collide),
      PBF_FIELD(gravity, vector),
      PBF_FIELD(attraction, number),
      PBF_FIELD(attraction_center, vector),
      PBF_FIELD(relaxation, number),
      PBF_FIELD(epsilon, number),
      PBF_FIELD(separation, number),
      PBF_FIELD(min_diagonal, number),
      PBF_FIELD(wall_density, number),
      PBF_FIELD(scorr_k, number),
      PBF_FIELD(scorr_dq, number),
      PBF_FIELD(scorr_n, integer),
      PBF_FIELD(solver, solver),
      PBF_FIELD(vorticity, number),
      PBF_FIELD(viscosity, number),
      PBF_FIELD(domain_min, vector),
      PBF_FIELD(domain_max, vector),
      PBF_FIELD(wall_velocity, walls),
      PBF_FIELD(wall_amplitude, walls),
      PBF_FIELD(wall_frequency, walls),
      PBF_FIELD(wall_phase, walls),
      PBF_FIELD(search_cell_width, number),
      PBF_FIELD(sleep_speed, number),
      PBF_FIELD(sleep_time, number),
      PBF_FIELD(tolerance, number),
      PBF_FIELD(pressure_grid, number),
      PBF_FIELD(prestabilization, number),
      PBF_FIELD(undamping, number),
      PBF_FIELD(torque_correction, number),
  };
#undef PBF_FIELD
  return fields;
}

void read_params(const json &object, const json::json_pointer &where, unsigned dimension,
                 pbf_params &params) {
  for (const ParamField &field : param_fields()) {
    const auto found = object.find(field.name);
    if (found != object.end()) {
      read_param(field, *found, where / std::string(field.name), dimension, params);
    }
  }
}

void apply_setting(const std::string &setting, Document &scene) {
  const auto equals = setting.find('=');
  if (equals == std::string::npos) {
    throw Error(exit_usage, "--set " + setting + ": no \"=\"; wanted: key=value, as gravity.1=-3");
  }
  const std::string key = setting.substr(0, equals);
  const auto dot = key.find('.');
  const ParamField &field = find_field(key.substr(0, dot), setting);
  const json value = setting_value(field, setting.substr(equals + 1));
  json::json_pointer pointer("/params");
  pointer /= std::string(field.name);
  if (dot == std::string::npos) return scene.override_value(pointer, value, "--set " + setting);
  if (field.type != ParamType::vector && field.type != ParamType::walls) {
    throw Error(exit_usage, "--set " + setting + ": " + field.name + " is not a list");
  }
  const auto dimension = scene.value.at("dimension").get<unsigned>();
  const unsigned index = index_of(key.substr(dot + 1), list_length(field.type, dimension), setting);
  if (!scene.value.contains(pointer)) scene.value[pointer] = default_list(field, dimension);
  scene.override_value(pointer / index, value, "--set " + setting);
}

void read_vector(const json &list, const json::json_pointer &where, unsigned dimension,
                 double *out) {
  std::fill(out, out + 3, 0.0);
  read_list(list, where, dimension, out);
}

}  // namespace bench
