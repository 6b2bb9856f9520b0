/* What a scene has beside params and blocks: phases, shapes, colliders, emitters, drains and
 * reservoirs. */
#ifndef PBF_BENCH_OBJECTS_H
#define PBF_BENCH_OBJECTS_H

#include <string>
#include <vector>

#include "scene/fields.h"
#include "scene/scene.h"

namespace bench {

// The members that objects.def has of each struct.
const std::vector<Field> &phase_fields();
const std::vector<Field> &collider_fields();
const std::vector<Field> &emitter_fields();
const std::vector<Field> &drain_fields();
const std::vector<Field> &reservoir_fields();

// Of a document that keeps to the schema; files are looked for in `folder`. Throws ValueError.
void read_objects(const nlohmann::json &root, const std::string &folder, Scene &scene);

// Makes the library's shapes of what they are made from, once the scene has been scaled, and gives
// colliders theirs. Throws ValueError.
void bake_shapes(Scene &scene);

// Throws ValueError where a block, an emitter or a reservoir names a phase that there is not.
void check_phases(const Scene &scene);

}  // namespace bench

#endif
