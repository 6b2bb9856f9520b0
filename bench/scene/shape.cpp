#include "scene/shape.h"

#include <filesystem>

#include "scene/fields.h"

namespace bench {
namespace {

using nlohmann::json;
using Where = json::json_pointer;

// What the table of objects has of a shape, by its key.
#define FIELD_NUMBER(name) {#name, offsetof(ShapeSource, name), FieldType::number, {}},
#define FIELD_VECTOR(name) {#name, offsetof(ShapeSource, name), FieldType::vector, {}},
#define FIELD_LIST(name)
#define FIELD_POINTS FIELD_LIST
#define FIELD_FACES FIELD_LIST
#define FIELD_HEIGHTS FIELD_LIST
#define FIELD_NUMBERS FIELD_LIST
#define FIELD_COUNTS FIELD_LIST
#define FIELD_TEXT FIELD_LIST
#define FIELD_ONE_OF(...) FIELD_LIST
#define PBF_SHAPE_FIELD(name, type, range, of, presence, doc) FIELD_##type(name)
const std::vector<Field> &shape_numbers() {
  static const std::vector<Field> fields = {
#include "scene/objects.def"
  };
  return fields;
}
#undef FIELD_NUMBER
#undef FIELD_VECTOR
#undef FIELD_LIST
#undef FIELD_POINTS
#undef FIELD_FACES
#undef FIELD_HEIGHTS
#undef FIELD_NUMBERS
#undef FIELD_COUNTS
#undef FIELD_TEXT
#undef FIELD_ONE_OF

// Rows of `length` numbers, one after another.
template <typename T>
std::vector<T> rows_of(const json &list, const Where &where, size_t length) {
  std::vector<T> numbers;
  numbers.reserve(list.size() * length);
  for (size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_array() || list[i].size() != length) {
      const std::string has = list[i].is_array()
                                  ? "the list has " + std::to_string(list[i].size()) + " numbers"
                                  : "this is no list";
      throw ValueError{where / i, has + "; wanted: " + std::to_string(length)};
    }
    for (const json &number : list[i]) numbers.push_back(number.get<T>());
  }
  return numbers;
}

// What `read` makes of the object's file. A path of its own stays as it is.
template <typename Read>
auto of_file(const json &object, const Where &where, unsigned dimension, const std::string &folder,
             Read read) {
  const auto path = std::filesystem::path(folder) / object.at("file").get<std::string>();
  try {
    return read(path.string(), dimension);
  } catch (const std::runtime_error &error) {
    throw ValueError{where / "file", error.what()};
  }
}

Mesh mesh_of(const json &object, const Where &where, unsigned dimension,
             const std::string &folder) {
  if (object.contains("file")) return of_file(object, where, dimension, folder, read_mesh_file);
  return {rows_of<double>(object.at("vertices"), where / "vertices", dimension),
          rows_of<uint32_t>(object.at("faces"), where / "faces", dimension)};
}

void read_heights(const json &list, const Where &where, unsigned dimension, ShapeSource &source) {
  if (dimension == 3) {
    const size_t along_x = list[0].is_array() ? list[0].size() : 0;
    source.numbers = rows_of<double>(list, where, along_x);
    source.counts = {static_cast<uint32_t>(along_x), static_cast<uint32_t>(list.size()), 1};
    return;
  }
  for (size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number()) throw ValueError{where / i, "in 2D heights are one list of numbers"};
    source.numbers.push_back(list[i].get<double>());
  }
  source.counts = {static_cast<uint32_t>(list.size()), 1, 1};
}

void read_grid(const json &object, const Where &where, unsigned dimension, ShapeSource &source) {
  double nodes[3];
  read_vector(object.at("nodes"), where / "nodes", dimension, nodes);
  double wanted = 1;
  for (unsigned axis = 0; axis < dimension; ++axis) {
    source.counts[axis] = static_cast<uint32_t>(nodes[axis]);
    wanted *= nodes[axis];
  }
  source.values = object.at("values").get<std::vector<float>>();
  if (static_cast<double>(source.values.size()) == wanted) return;
  throw ValueError{where / "values", "the list has " + std::to_string(source.values.size()) +
                                         " numbers; the nodes are " +
                                         std::to_string(static_cast<uint64_t>(wanted))};
}

template <typename T>
json as_rows(const std::vector<T> &numbers, size_t length) {
  json rows = json::array();
  for (size_t i = 0; i + length <= numbers.size(); i += length) {
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(i);
    rows.push_back(std::vector<T>(first, first + static_cast<std::ptrdiff_t>(length)));
  }
  return rows;
}

pbf_status bake_mesh(const ShapeSource &source, unsigned dimension, pbf_shape **shape) {
  pbf_mesh_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = dimension;
  desc.vertex_count = static_cast<uint32_t>(source.mesh.vertices.size() / dimension);
  desc.face_count = static_cast<uint32_t>(source.mesh.faces.size() / dimension);
  desc.vertices = source.mesh.vertices.data();
  desc.faces = source.mesh.faces.data();
  desc.cell = source.cell;
  desc.thickness = source.thickness;
  return pbf_shape_from_mesh(&desc, shape);
}

pbf_status bake_heights(const ShapeSource &source, unsigned dimension, pbf_shape **shape) {
  pbf_heights_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = dimension;
  desc.count[0] = source.counts[0];
  desc.count[1] = source.counts[1];
  desc.heights = source.numbers.data();
  desc.spacing = source.spacing;
  desc.base = source.base;
  desc.cell = source.cell;
  return pbf_shape_from_heights(&desc, shape);
}

pbf_status bake_points(const ShapeSource &source, unsigned dimension, pbf_shape **shape) {
  pbf_hull_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = dimension;
  desc.point_count = static_cast<uint32_t>(source.numbers.size() / dimension);
  desc.points = source.numbers.data();
  desc.cell = source.cell;
  return pbf_shape_from_points(&desc, shape);
}

pbf_status bake_grid(const ShapeSource &source, unsigned dimension, pbf_shape **shape) {
  pbf_grid_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = dimension;
  for (unsigned axis = 0; axis < dimension; ++axis) {
    desc.nodes[axis] = source.counts[axis];
    desc.origin[axis] = source.origin[axis];
  }
  desc.cell = source.cell;
  desc.values = source.values.data();
  return pbf_shape_from_grid(&desc, shape);
}

}  // namespace

ShapeSource read_shape(const json &object, const Where &where, unsigned dimension,
                       const std::string &folder) {
  const auto from = object.at("from").get<std::string>();
  if (from == "baked") return of_file(object, where, dimension, folder, read_baked_file);
  ShapeSource source;
  read_fields(shape_numbers(), object, where, dimension, &source);
  if (from == "mesh") {
    source.mesh = mesh_of(object, where, dimension, folder);
  } else if (from == "heights") {
    source.from = ShapeSource::From::heights;
    read_heights(object.at("heights"), where / "heights", dimension, source);
  } else if (from == "points") {
    source.from = ShapeSource::From::points;
    source.numbers = rows_of<double>(object.at("points"), where / "points", dimension);
  } else {
    source.from = ShapeSource::From::grid;
    read_grid(object, where, dimension, source);
  }
  return source;
}

json shape_json(const ShapeSource &source, unsigned dimension) {
  switch (source.from) {
    case ShapeSource::From::mesh:
      return {{"from", "mesh"},
              {"vertices", as_rows(source.mesh.vertices, dimension)},
              {"faces", as_rows(source.mesh.faces, dimension)},
              {"thickness", source.thickness},
              {"cell", source.cell}};
    case ShapeSource::From::heights:
      return {{"from", "heights"},
              {"heights",
               dimension == 3 ? as_rows(source.numbers, source.counts[0]) : json(source.numbers)},
              {"spacing", source.spacing},
              {"base", source.base},
              {"cell", source.cell}};
    case ShapeSource::From::points:
      return {{"from", "points"},
              {"points", as_rows(source.numbers, dimension)},
              {"cell", source.cell}};
    default:
      const auto counts = source.counts.begin();
      const auto origin = source.origin.begin();
      return {{"from", "grid"},
              {"nodes", std::vector<uint32_t>(counts, counts + dimension)},
              {"origin", std::vector<double>(origin, origin + dimension)},
              {"values", source.values},
              {"cell", source.cell}};
  }
}

ShapeHandle bake_shape(const ShapeSource &source, unsigned dimension) {
  using Bake = pbf_status (*)(const ShapeSource &, unsigned, pbf_shape **);
  static const Bake bakes[] = {bake_mesh, bake_heights, bake_points, bake_grid};
  pbf_shape *shape = nullptr;
  if (bakes[static_cast<int>(source.from)](source, dimension, &shape) != PBF_OK)
    throw std::runtime_error(pbf_last_error());
  return ShapeHandle(shape, pbf_release_shape);
}

}  // namespace bench
