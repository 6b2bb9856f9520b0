/* The shapes of a scene: what each is made from, and the library's shape of it. */
#ifndef PBF_BENCH_SHAPE_H
#define PBF_BENCH_SHAPE_H

#include <pbf/shapes.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/document.h"

namespace bench {

// Vertices, `dimension` numbers each, and as many vertices' numbers a face.
struct Mesh {
  std::vector<double> vertices;
  std::vector<uint32_t> faces;
};

// An OBJ or STL file. Throws std::runtime_error with a sentence that names what is wrong.
Mesh read_mesh_file(const std::string &path, unsigned dimension);

struct ShapeSource {
  enum class From { mesh, heights, points, grid } from = From::mesh;
  Mesh mesh;
  double thickness = 0;
  std::vector<double> numbers;              // heights, or the points of a hull
  std::vector<float> values;                // distances
  std::array<uint32_t, 3> counts{1, 1, 1};  // heights along x and z, nodes along each axis
  std::array<double, 3> origin{};
  double spacing = 0, base = 0;
  double cell = 0;
};

// What pbf_save_shape or pbf-bake wrote: a grid of distances. Throws std::runtime_error with a
// sentence that names what is wrong.
ShapeSource read_baked_file(const std::string &path, unsigned dimension);

using ShapeHandle = std::shared_ptr<pbf_shape>;

// An object that keeps to the schema; files are looked for beside the scene's, in `folder`. Throws
// ValueError.
ShapeSource read_shape(const nlohmann::json &object, const nlohmann::json::json_pointer &where,
                       unsigned dimension, const std::string &folder);

// The same as an object, without files.
nlohmann::json shape_json(const ShapeSource &source, unsigned dimension);

// Throws std::runtime_error with the library's sentence.
ShapeHandle bake_shape(const ShapeSource &source, unsigned dimension);

}  // namespace bench

#endif
