#include <filesystem>
#include <limits>

#include "scene/document.h"
#include "scene/find.h"
#include "scene/params.h"
#include "scene/scene.h"
#include "scene/schema.h"

namespace bench {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

// Reads the members of one object that has passed the schema.
class Members {
 public:
  Members(const json &object, const Pointer &where, unsigned dimension)
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
  const json &at(const char *key) const { return object_.at(key); }
  std::string text(const char *key) const { return object_.at(key).get<std::string>(); }
  Pointer pointer(const char *key) const { return where_ / std::string(key); }

 private:
  void list(const char *key, unsigned length, double *out) const {
    if (has(key)) read_vector(object_.at(key), pointer(key), length, out);
  }

  const json &object_;
  Pointer where_;
  unsigned dimension_;
};

double spacing_of(const pbf_params &params) {
  return params.spacing > 0 ? params.spacing : params.smoothing_radius / 2;
}

void read_gradient(const Members &in, unsigned dimension, std::array<Vector, 3> &rows) {
  if (!in.has("velocity_gradient")) return;
  const json &list = in.at("velocity_gradient");
  const Pointer where = in.pointer("velocity_gradient");
  if (list.size() != dimension) {
    throw ValueError{where, "the list has " + std::to_string(list.size()) +
                                " rows; this scene's dimension wants " + std::to_string(dimension)};
  }
  for (unsigned row = 0; row < dimension; ++row)
    read_vector(list[row], where / row, dimension, rows[row].data());
}

std::vector<Region> read_regions(const Members &in, unsigned dimension) {
  std::vector<Region> regions;
  if (!in.has("within")) return regions;
  for (const json &item : in.at("within")) {
    const Members members(item, in.pointer("within") / regions.size(), dimension);
    Region region;
    members.vector("center", region.center);
    members.vector("squares", region.squares);
    members.vector("slopes", region.slopes);
    members.value("below", region.below);
    regions.push_back(region);
  }
  return regions;
}

Block read_block(const Members &in, const pbf_params &params, unsigned dimension) {
  Block block;
  const std::string shape = in.text("shape");
  block.shape = shape == "box"    ? Block::Shape::box
                : shape == "ball" ? Block::Shape::ball
                                  : Block::Shape::lattice;
  in.vector("first", block.first);
  in.vector("min", block.min);
  in.vector("max", block.max);
  in.vector("center", block.center);
  if (in.has("counts")) in.counts("counts", block.counts);
  in.value("radius", block.radius);
  block.spacing = spacing_of(params);
  in.value("spacing", block.spacing);
  if (!(block.spacing > 0)) {
    throw ValueError{in.pointer("spacing"), "the spacing is 0, as half of smoothing_radius is"};
  }
  in.vector("velocity", block.velocity);
  in.vector3("angular_velocity", block.angular_velocity);
  read_gradient(in, dimension, block.velocity_gradient);
  block.within = read_regions(in, dimension);
  return block;
}

uint32_t collider_shape(const std::string &name) {
  return name == "plane"     ? PBF_COLLIDER_PLANE
         : name == "sphere"  ? PBF_COLLIDER_SPHERE
         : name == "capsule" ? PBF_COLLIDER_CAPSULE
                             : PBF_COLLIDER_BOX;
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

Collider read_collider(const Members &in, unsigned dimension) {
  Collider collider{};
  pbf_collider &start = collider.start;
  pbf_collider_init(&start, sizeof start, collider_shape(in.text("shape")));
  bool inverted = false;
  in.value("inverted", inverted);
  start.inverted = inverted;
  in.vector("position", start.position);
  if (in.has("orientation")) {
    for (unsigned i = 0; i < 4; ++i) start.orientation[i] = in.at("orientation")[i].get<double>();
  }
  in.vector("velocity", start.velocity);
  in.vector3("angular_velocity", start.angular_velocity);
  in.vector("axis", start.axis);
  in.vector("half_extents", start.half_extents);
  if (in.has("half_extents") && dimension == 2) start.half_extents[2] = 1;
  in.value("radius", start.radius);
  in.value("half_length", start.half_length);
  collider.motion = read_motion(in, dimension);
  if (!collider.motion.empty()) {
    std::copy_n(collider.motion[0].velocity.data(), 3, start.velocity);
    std::copy_n(collider.motion[0].angular_velocity.data(), 3, start.angular_velocity);
  }
  return collider;
}

Scaling read_scaling(const Members &in) {
  Scaling scaling;
  if (in.text("rule") == "grow") {
    scaling.rule = Scaling::Rule::grow;
    for (const json &axis : in.at("axes")) {
      scaling.axes[static_cast<size_t>(axis.get<std::string>()[0] - 'x')] = true;
    }
    in.vector("upper_walls", scaling.upper_walls);
  }
  return scaling;
}

Scene build_scene(const json &root) {
  Scene scene;
  scene.dimension = root.at("dimension").get<unsigned>();
  const Members in(root, Pointer(), scene.dimension);
  scene.description = in.text("description");
  scene.purpose = in.text("purpose");
  pbf_params_init(&scene.params, sizeof scene.params);
  read_params(in.at("params"), in.pointer("params"), scene.dimension, scene.params);
  for (const json &item : in.at("blocks")) {
    const Pointer where = in.pointer("blocks") / scene.blocks.size();
    scene.blocks.push_back(
        read_block(Members(item, where, scene.dimension), scene.params, scene.dimension));
  }
  if (in.has("colliders")) {
    for (const json &item : in.at("colliders")) {
      const Pointer where = in.pointer("colliders") / scene.colliders.size();
      scene.colliders.push_back(
          read_collider(Members(item, where, scene.dimension), scene.dimension));
    }
  }
  in.value("lead_in_steps", scene.lead_in_steps);
  in.value("steps", scene.steps);
  if (in.has("scaling")) {
    scene.scaling = read_scaling(Members(in.at("scaling"), in.pointer("scaling"), scene.dimension));
  }
  if (count_particles(scene) > PBF_MAX_CAPACITY) {
    throw ValueError{in.pointer("blocks"),
                     "the blocks hold " + std::to_string(count_particles(scene)) +
                         " particles; at most " + std::to_string(PBF_MAX_CAPACITY) + " fit"};
  }
  return scene;
}

}  // namespace

Scene load_scene(const SceneOptions &options) {
  const std::string path = find_scene_file(options.name);
  Document document = read_document(path);
  scene_schema().check(document);
  for (const std::string &setting : options.settings) apply_setting(setting, document);
  for (const Override &value : options.overrides) {
    document.override_value(json::json_pointer("/params/" + value.parameter), value.value,
                            value.origin);
  }
  if (!options.settings.empty() || !options.overrides.empty()) scene_schema().check(document);
  try {
    Scene scene = build_scene(document.value);
    scene.name = std::filesystem::path(path).stem().string();
    if (options.particles > 0) scale_scene(scene, options.particles);
    if (options.finer != 1) refine_scene(scene, options.finer);
    if (options.steps > 0) {
      if (options.steps > std::numeric_limits<uint32_t>::max()) {
        throw Error(exit_usage,
                    "--steps " + std::to_string(options.steps) + " is above 4294967295");
      }
      scene.steps = static_cast<uint32_t>(options.steps);
    }
    return scene;
  } catch (const ValueError &error) {
    throw document.error(error);
  }
}

}  // namespace bench
