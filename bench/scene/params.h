/* The fields of pbf_params by their names, for scene files and --set. */
#ifndef PBF_BENCH_PARAMS_H
#define PBF_BENCH_PARAMS_H

#include <pbf/pbf.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/document.h"
#include "scene/fields.h"

namespace bench {

// All of them, by physics/params.def.
const std::vector<Field> &param_fields();

// Overwrites the fields that `object` has, an object that keeps to the schema. Throws ValueError
// for a list of a length that does not fit the dimension.
void read_params(const nlohmann::json &object, const nlohmann::json::json_pointer &where,
                 unsigned dimension, pbf_params &params);

// "gravity.1=-3", "kernel=poly6_spiky", "collide=in_iteration,after_solve": puts the value into
// the scene, where the schema then judges it.
void apply_setting(const std::string &setting, Document &scene);

}  // namespace bench

#endif
