/* Shapes that pbf_save_shape or pbf-bake wrote to a file. */
#include <stdexcept>

#include "core/content.h"
#include "scene/shape.h"

namespace bench {
namespace {

// What the library takes, and the header.
constexpr uintmax_t max_baked_size = uintmax_t{4} * PBF_MAX_SHAPE_NODES + 4096;

void check(pbf_status status, const std::string &path) {
  if (status != PBF_OK) throw std::runtime_error(path + ": " + pbf_last_error());
}

ShapeHandle load_shape(const std::string &path) {
  const std::string bytes = content_of(path, max_baked_size, "PBFSHAPE");
  pbf_shape *shape = nullptr;
  check(pbf_load_shape(bytes.data(), bytes.size(), &shape), path);
  return ShapeHandle(shape, pbf_release_shape);
}

}  // namespace

ShapeSource read_baked_file(const std::string &path, unsigned dimension) {
  const ShapeHandle shape = load_shape(path);
  pbf_shape_info info = {};
  info.struct_size = sizeof info;
  check(pbf_get_shape_info(shape.get(), &info), path);
  if (info.dimension != dimension)
    throw std::runtime_error(path + " holds a shape of dimension " +
                             std::to_string(info.dimension) + "; the scene has " +
                             std::to_string(dimension));
  ShapeSource source;
  source.from = ShapeSource::From::grid;
  size_t nodes = 1;
  for (unsigned axis = 0; axis < dimension; ++axis) {
    source.counts[axis] = info.nodes[axis];
    source.origin[axis] = info.origin[axis];
    nodes *= info.nodes[axis];
  }
  source.cell = info.cell;
  source.values.resize(nodes);
  check(pbf_get_shape_values(shape.get(), nodes, source.values.data()), path);
  return source;
}

}  // namespace bench
