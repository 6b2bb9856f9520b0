/* A scene: what a benchmark runs. Read from a JSON file (bench/scenes/). */
#ifndef PBF_BENCH_SCENE_H
#define PBF_BENCH_SCENE_H

#include <pbf/emit.h>
#include <pbf/pbf.h>
#include <pbf/phases.h>
#include <pbf/shapes.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/document.h"
#include "scene/shape.h"

namespace bench {

using Vector = std::array<double, 3>;  // 2D: the third is 0

// Points x with  sum over the axes of squares (x - center)² + slopes (x - center) < below:
// half-spaces, ellipsoids, cylinders, paraboloids, their outsides.
struct Region {
  Vector center{}, squares{}, slopes{};
  double below = 0;
};

// A body of fluid that is filled with particles. A lattice has its first particle at `first`; a
// box from `min` to `max` and a ball have theirs in the middles of cells of side `spacing`. Only
// particles that lie in every region of `within` are there.
struct Block {
  enum class Shape { lattice, box, ball } shape = Shape::lattice;
  Vector first{}, min{}, max{}, center{};
  std::array<uint32_t, 3> counts{1, 1, 1};
  double radius = 0;
  double spacing = 0;
  uint32_t phase = 0;                         // of its particles
  Vector velocity{};                          // of the block's middle
  Vector angular_velocity{};                  // about the block's middle
  std::array<Vector, 3> velocity_gradient{};  // row k: of velocity k, from the block's middle
  std::vector<Region> within;
};

// A stretch of a collider's motion; the stretches play over and over.
struct Stretch {
  double duration;
  Vector velocity{}, angular_velocity{};
};

struct Collider {
  pbf_collider start;
  std::vector<Stretch> motion;  // empty: as `start` moves
  std::string geometry;         // the name of its shape, if it has one
};

// A solid that colliders may have for their geometry.
struct SceneShape {
  std::string name;
  ShapeSource source;
  ShapeHandle handle;  // what source has been made into
};

// What another number of particles does to the scene.
struct Scaling {
  enum class Rule { refine, grow } rule = Rule::refine;
  std::array<bool, 3> axes{};  // grow: along which the lattice grows
  Vector upper_walls{};        // grow: how far a wall moves for each unit of growth
};

struct Scene {
  std::string name, description, purpose;
  unsigned dimension = 3;
  pbf_params params{};
  std::vector<pbf_phase> phases;
  std::vector<Block> blocks;
  std::vector<SceneShape> shapes;
  std::vector<Collider> colliders;
  std::vector<pbf_emitter> emitters;
  std::vector<pbf_volume> drains;
  std::vector<pbf_reservoir> reservoirs;
  uint32_t capacity = 0;  // 0: as capacity_of finds it
  uint32_t lead_in_steps = 0;
  uint32_t steps = 1;
  std::optional<Scaling> scaling;
  std::shared_ptr<const Document> document;  // the file; null of a scene that a program made
};

// A parameter's value in place of the scene's.
struct Override {
  std::string parameter;  // one of param_fields()
  nlohmann::json value;
  std::string origin;  // what messages name in place of the scene's file and line
};

// What the command line or a sweep changes about a scene.
struct SceneOptions {
  std::string name = "report-30k";    // of a scene that comes with the program, or a file's path
  std::vector<std::string> settings;  // key=value
  std::vector<Override> overrides;    // after the settings
  uint64_t particles = 0;             // 0: as the scene has it
  double finer = 1;                   // so many times as fine, by the scene's rule
  uint64_t steps = 0;                 // 0: as the scene has it
};

// All throw Error(exit_usage) with file, line, column and reason.
Scene load_scene(const SceneOptions &options);
std::vector<std::string> scene_names();

// Changes the scene so that it has about `particles` of them; refused when the scene says not how.
void scale_scene(Scene &scene, uint64_t particles);

// The same scene with all its lengths of discretisation divided by `finer`.
void refine_scene(Scene &scene, double finer);

// One sentence where the particles of a box that reaches to an upper wall do not fit between the
// walls, which changes the fluid there from the start; empty where they do.
std::string lattice_misfit(const Scene &scene);

// Says so on standard error, if it is the options that made it so.
void tell_of_misfit(const SceneOptions &options, const Scene &scene);

// Positions and velocities of the particles at the start, `dimension` numbers each.
struct Particles {
  uint64_t count = 0;
  std::vector<double> positions, velocities;
  std::vector<uint32_t> phases;  // a number each, where the scene has phases
};

uint64_t count_particles(const Scene &scene);

// So many particles a solver wants room for, at least 1: those of the blocks, and what emitters add
// in all steps, but no more than the domain holds.
uint32_t capacity_of(const Scene &scene);
Particles fill_scene(const Scene &scene);

}  // namespace bench

#endif
