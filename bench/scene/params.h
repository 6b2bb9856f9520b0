/* The fields of pbf_params by their names, for scene files and --set. */
#ifndef PBF_BENCH_PARAMS_H
#define PBF_BENCH_PARAMS_H

#include <pbf/pbf.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/document.h"

namespace bench {

// Of what a scene file has: vector is a list of numbers, one an axis, walls one a wall; one_of is a
// name, some_of a list of names.
enum class ParamType { number, integer, vector, walls, one_of, some_of };

struct ParamField {
  const char *name;
  size_t offset;
  ParamType type;
  std::vector<const char *> names;  // one_of: of the values 0, 1, …; some_of: of the bits
};

// All of them, by physics/params.def.
const std::vector<ParamField> &param_fields();

// Overwrites the fields that `object` has, an object that keeps to the schema. Throws ValueError
// for a list whose length does not fit the dimension.
void read_params(const nlohmann::json &object, const nlohmann::json::json_pointer &where,
                 unsigned dimension, pbf_params &params);

// "gravity.1=-3", "kernel=poly6_spiky", "collide=in_iteration,after_solve": puts the value into
// the scene, where the schema then judges it.
void apply_setting(const std::string &setting, Document &scene);

// The list as three numbers, those that it lacks 0. Throws ValueError unless it has `dimension`.
void read_vector(const nlohmann::json &list, const nlohmann::json::json_pointer &where,
                 unsigned dimension, double *out);

}  // namespace bench

#endif
