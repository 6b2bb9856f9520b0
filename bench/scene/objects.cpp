#include "scene/objects.h"

#include "core/near.h"
#include "scene/members.h"

namespace bench {
namespace {

using nlohmann::json;
using Where = json::json_pointer;

}  // namespace

// The columns `name` and `type` of objects.def.
#define FIELD_ENTRY(kind, ...) \
  FieldType::kind, { __VA_ARGS__ }
#define FIELD_NUMBER FIELD_ENTRY(number, )
#define FIELD_INTEGER FIELD_ENTRY(integer, )
#define FIELD_FLAG FIELD_ENTRY(flag, )
#define FIELD_VECTOR FIELD_ENTRY(vector, )
#define FIELD_VECTOR3 FIELD_ENTRY(vector3, )
#define FIELD_QUATERNION FIELD_ENTRY(quaternion, )
#define FIELD_NAME FIELD_ENTRY(other, )
#define FIELD_ONE_OF(...) FIELD_ENTRY(one_of, __VA_ARGS__)

const std::vector<Field> &phase_fields() {
  static const std::vector<Field> fields = {
#define PBF_PHASE_FIELD(name, type, range, of, presence, doc) \
  {#name, offsetof(pbf_phase, name), FIELD_##type},
#include "scene/objects.def"
  };
  return fields;
}

const std::vector<Field> &collider_fields() {
  static const std::vector<Field> fields = {
#define PBF_COLLIDER_FIELD(name, type, range, of, presence, doc) \
  {#name, offsetof(pbf_collider, name), FIELD_##type},
#include "scene/objects.def"
  };
  return fields;
}

const std::vector<Field> &emitter_fields() {
  static const std::vector<Field> fields = {
#define PBF_EMITTER_FIELD(name, type, range, of, presence, doc) \
  {#name, offsetof(pbf_emitter, name), FIELD_##type},
#include "scene/objects.def"
  };
  return fields;
}

const std::vector<Field> &drain_fields() {
  static const std::vector<Field> fields = {
#define PBF_DRAIN_FIELD(name, type, range, of, presence, doc) \
  {#name, offsetof(pbf_volume, name), FIELD_##type},
#include "scene/objects.def"
  };
  return fields;
}

const std::vector<Field> &reservoir_fields() {
  static const std::vector<Field> fields = {
#define PBF_RESERVOIR_FIELD(name, type, range, of, presence, doc) \
  {#name, offsetof(pbf_reservoir, name), FIELD_##type},
#include "scene/objects.def"
  };
  return fields;
}

#undef FIELD_ENTRY
#undef FIELD_NUMBER
#undef FIELD_INTEGER
#undef FIELD_FLAG
#undef FIELD_VECTOR
#undef FIELD_VECTOR3
#undef FIELD_QUATERNION
#undef FIELD_NAME
#undef FIELD_ONE_OF

namespace {

// The number of the value that the object's `shape` names.
uint32_t kind_of_object(const json &object, const std::vector<Field> &fields) {
  uint32_t kind = 0;
  for (const Field &field : fields) {
    if (std::string(field.name) != "shape") continue;
    while (object.at("shape") != field.names[kind]) ++kind;
  }
  return kind;
}

pbf_phase read_phase(const json &object, const Where &where, unsigned dimension) {
  pbf_phase phase;
  pbf_phase_init(&phase, sizeof phase);
  read_fields(phase_fields(), object, where, dimension, &phase);
  return phase;
}

pbf_emitter read_emitter(const json &object, const Where &where, unsigned dimension) {
  pbf_emitter emitter;
  pbf_emitter_init(&emitter, sizeof emitter, kind_of_object(object, emitter_fields()));
  read_fields(emitter_fields(), object, where, dimension, &emitter);
  return emitter;
}

pbf_volume read_drain(const json &object, const Where &where, unsigned dimension) {
  pbf_volume drain;
  pbf_volume_init(&drain, sizeof drain, kind_of_object(object, drain_fields()));
  read_fields(drain_fields(), object, where, dimension, &drain);
  return drain;
}

pbf_reservoir read_reservoir(const json &object, const Where &where, unsigned dimension) {
  pbf_reservoir reservoir;
  pbf_reservoir_init(&reservoir, sizeof reservoir);
  read_fields(reservoir_fields(), object, where, dimension, &reservoir);
  return reservoir;
}

std::vector<Stretch> read_motion(const Members &in, unsigned dimension) {
  std::vector<Stretch> motion;
  if (!in.has("motion")) return motion;
  for (const json &item : in.at("motion")) {
    const Members members(item, in.pointer("motion") / motion.size(), dimension);
    Stretch stretch{};
    members.value("duration", stretch.duration);
    members.vector("velocity", stretch.velocity);
    members.vector3("angular_velocity", stretch.angular_velocity);
    motion.push_back(stretch);
  }
  return motion;
}

Collider read_collider(const json &object, const Where &where, unsigned dimension) {
  Collider collider{};
  pbf_collider &start = collider.start;
  pbf_collider_init(&start, sizeof start, kind_of_object(object, collider_fields()));
  read_fields(collider_fields(), object, where, dimension, &start);
  const Members in(object, where, dimension);
  in.value("geometry", collider.geometry);
  collider.motion = read_motion(in, dimension);
  if (!collider.motion.empty()) {
    std::copy_n(collider.motion[0].velocity.data(), 3, start.velocity);
    std::copy_n(collider.motion[0].angular_velocity.data(), 3, start.angular_velocity);
  }
  return collider;
}

template <typename T>
using ReadObject = T (*)(const json &object, const Where &where, unsigned dimension);

template <typename T>
void read_each(const json &root, const char *key, unsigned dimension, ReadObject<T> read,
               std::vector<T> &out) {
  if (!root.contains(key)) return;
  for (const json &object : root.at(key))
    out.push_back(read(object, Where() / std::string(key) / out.size(), dimension));
}

void check_phase(uint32_t phase, const Scene &scene, const char *key, size_t index) {
  // Without phases all particles are of phase 0.
  if (phase < std::max<size_t>(scene.phases.size(), 1)) return;
  throw ValueError{Where() / std::string(key) / index / std::string("phase"),
                   "the value is " + std::to_string(phase) + "; the scene has " +
                       std::to_string(scene.phases.size()) + " phases, counted from 0"};
}

const SceneShape &shape_of_collider(const Scene &scene, size_t index) {
  const std::string &name = scene.colliders[index].geometry;
  std::vector<std::string> known;
  for (const SceneShape &shape : scene.shapes) {
    if (shape.name == name) return shape;
    known.push_back(shape.name);
  }
  throw ValueError{Where("/colliders") / index / std::string("geometry"),
                   "there is no shape \"" + name + "\"" + did_you_mean(name, known) +
                       "; the scene's \"shapes\" has them by their names"};
}

}  // namespace

void read_objects(const json &root, const std::string &folder, Scene &scene) {
  const unsigned dimension = scene.dimension;
  read_each(root, "phases", dimension, read_phase, scene.phases);
  read_each(root, "colliders", dimension, read_collider, scene.colliders);
  read_each(root, "emitters", dimension, read_emitter, scene.emitters);
  read_each(root, "drains", dimension, read_drain, scene.drains);
  read_each(root, "reservoirs", dimension, read_reservoir, scene.reservoirs);
  if (!root.contains("shapes")) return;
  for (const auto &item : root.at("shapes").items()) {
    const Where where = Where("/shapes") / item.key();
    scene.shapes.push_back(
        {item.key(), read_shape(item.value(), where, dimension, folder), nullptr});
  }
}

void bake_shapes(Scene &scene) {
  for (size_t i = 0; i < scene.colliders.size(); ++i)
    if (!scene.colliders[i].geometry.empty())
      shape_of_collider(scene, i);  // before what takes long
  for (SceneShape &shape : scene.shapes) {
    try {
      shape.handle = bake_shape(shape.source, scene.dimension);
    } catch (const std::runtime_error &error) {
      throw ValueError{Where("/shapes") / shape.name, error.what()};
    }
  }
  for (size_t i = 0; i < scene.colliders.size(); ++i)
    if (!scene.colliders[i].geometry.empty())
      scene.colliders[i].start.geometry = shape_of_collider(scene, i).handle.get();
}

void check_phases(const Scene &scene) {
  for (size_t i = 0; i < scene.blocks.size(); ++i)
    check_phase(scene.blocks[i].phase, scene, "blocks", i);
  for (size_t i = 0; i < scene.emitters.size(); ++i)
    check_phase(scene.emitters[i].phase, scene, "emitters", i);
  for (size_t i = 0; i < scene.reservoirs.size(); ++i)
    check_phase(scene.reservoirs[i].phase, scene, "reservoirs", i);
}

}  // namespace bench
