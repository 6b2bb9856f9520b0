/* A scene from its JSON file. */
#include <filesystem>
#include <limits>

#include "scene/document.h"
#include "scene/find.h"
#include "scene/members.h"
#include "scene/objects.h"
#include "scene/params.h"
#include "scene/scene.h"
#include "scene/schema.h"

namespace bench {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

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
  in.value("phase", block.phase);
  in.vector("velocity", block.velocity);
  in.vector3("angular_velocity", block.angular_velocity);
  read_gradient(in, dimension, block.velocity_gradient);
  block.within = read_regions(in, dimension);
  return block;
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

Scene build_scene(const json &root, const std::string &folder) {
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
  read_objects(root, folder, scene);
  in.value("lead_in_steps", scene.lead_in_steps);
  in.value("steps", scene.steps);
  in.value("capacity", scene.capacity);
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
    const std::filesystem::path file(path);
    Scene scene = build_scene(document.value, file.parent_path().string());
    scene.name = file.stem().string();
    if (options.particles > 0) scale_scene(scene, options.particles);
    if (options.finer != 1) refine_scene(scene, options.finer);
    if (options.steps > 0) {
      if (options.steps > std::numeric_limits<uint32_t>::max()) {
        throw Error(exit_usage,
                    "--steps " + std::to_string(options.steps) + " is above 4294967295");
      }
      scene.steps = static_cast<uint32_t>(options.steps);
    }
    bake_shapes(scene);
    check_phases(scene);
    scene.document = std::make_shared<const Document>(std::move(document));
    return scene;
  } catch (const ValueError &error) {
    throw document.error(error);
  }
}

}  // namespace bench
