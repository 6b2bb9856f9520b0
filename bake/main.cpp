/* pbf-bake: makes a file that pbf_load_shape takes of a mesh. */
#include <pbf/shapes.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/command_line.h"
#include "core/content.h"
#include "core/error.h"
#include "core/failure_message.h"
#include "core/number_option.h"
#include "core/output_file.h"
#include "core/standard_streams.h"
#include "mesh_file.h"

namespace {

namespace fs = std::filesystem;

enum { exit_failure = 1, exit_usage = 2 };

struct Options {
  std::string mesh, out, shown;
  double cell = 0, spacing = 0, thickness = 0, scale = 1;
  unsigned cells = 0;
  bool z_up = false, centred = false, hull = false;
};

struct Release {
  void operator()(pbf_shape *shape) const { pbf_release_shape(shape); }
};
using Shape = std::unique_ptr<pbf_shape, Release>;

void check(pbf_status status, const std::string &path) {
  if (status != PBF_OK) throw std::runtime_error(path + ": " + pbf_last_error());
}

// ---- What is baked ------------------------------------------------------------------------------

struct Box {
  double lower[3], upper[3];
};

Box box_of(const std::vector<double> &vertices) {
  const double end = std::numeric_limits<double>::infinity();
  Box box = {{end, end, end}, {-end, -end, -end}};
  for (size_t i = 0; i < vertices.size(); ++i) {
    box.lower[i % 3] = std::min(box.lower[i % 3], vertices[i]);
    box.upper[i % 3] = std::max(box.upper[i % 3], vertices[i]);
  }
  return box;
}

void place(bake::Mesh &mesh, const Options &options) {
  for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
    double *v = &mesh.vertices[i];
    if (options.z_up) {
      const double y = v[1];
      v[1] = v[2], v[2] = -y;
    }
    for (int k = 0; k < 3; ++k) v[k] *= options.scale;
  }
  if (!options.centred) return;
  const Box box = box_of(mesh.vertices);
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices[i] -= (box.lower[i % 3] + box.upper[i % 3]) / 2;
}

double cell_of(const bake::Mesh &mesh, const Options &options) {
  if (options.cell > 0) return options.cell;
  if (options.spacing > 0) return options.spacing / 2;
  const Box box = box_of(mesh.vertices);
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, box.upper[k] - box.lower[k]);
  if (!(longest > 0)) throw std::runtime_error(options.mesh + " has no size; name --cell");
  return longest / options.cells;
}

// As of a survey in metres, whose origin is far away: corners would lie in other places.
void check_resolution(const bake::Mesh &mesh, const Options &options, double cell) {
  const double step = mesh.step * options.scale;
  if (!(step > cell / 4)) return;
  char text[200];
  std::snprintf(text, sizeof text,
                " reaches so far from the origin that its numbers are read %g apart, and cells are "
                "%g; move it to the origin, or take larger cells",
                step, cell);
  throw std::runtime_error(options.mesh + text);
}

Shape bake_mesh(const bake::Mesh &mesh, const Options &options, double cell) {
  pbf_shape *shape = nullptr;
  pbf_mesh_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = 3;
  desc.vertex_count = static_cast<uint32_t>(mesh.vertices.size() / 3);
  desc.face_count = static_cast<uint32_t>(mesh.faces.size() / 3);
  desc.vertices = mesh.vertices.data();
  desc.faces = mesh.faces.data();
  desc.cell = cell;
  desc.thickness = options.thickness;
  check(pbf_shape_from_mesh(&desc, &shape), options.mesh);
  return Shape(shape);
}

Shape bake_hull(const bake::Mesh &mesh, const Options &options, double cell) {
  pbf_shape *shape = nullptr;
  pbf_hull_desc desc = {};
  desc.struct_size = sizeof desc;
  desc.dimension = 3;
  desc.point_count = static_cast<uint32_t>(mesh.vertices.size() / 3);
  desc.points = mesh.vertices.data();
  desc.cell = cell;
  check(pbf_shape_from_points(&desc, &shape), options.mesh);
  return Shape(shape);
}

// ---- Files ---------------------------------------------------------------------------------------

void write(pbf_shape *shape, const std::string &path) {
  uint64_t size = 0;
  check(pbf_save_shape(shape, nullptr, &size), path);
  std::string bytes(size, '\0');
  check(pbf_save_shape(shape, bytes.data(), &size), path);
  bench::write_file(path, bytes);
}

Shape read(const std::string &path) {
  const uintmax_t most = uintmax_t{4} * PBF_MAX_SHAPE_NODES + 4096;
  const std::string bytes = bench::content_of(path, most, "PBFSHAPE");
  pbf_shape *shape = nullptr;
  check(pbf_load_shape(bytes.data(), bytes.size(), &shape), path);
  return Shape(shape);
}

void tell(pbf_shape *shape, const std::string &path) {
  pbf_shape_info info = {};
  info.struct_size = sizeof info;
  check(pbf_get_shape_info(shape, &info), path);
  const double nodes =
      double{1} * info.nodes[0] * info.nodes[1] * (info.dimension == 3 ? info.nodes[2] : 1);
  if (info.dimension == 3)
    std::printf("%s: %u x %u x %u nodes, cells of %g, %.1f MB\n", path.c_str(), info.nodes[0],
                info.nodes[1], info.nodes[2], info.cell, nodes * 4e-6);
  else
    std::printf("%s: 2D, %u x %u nodes, cells of %g, %.1f MB\n", path.c_str(), info.nodes[0],
                info.nodes[1], info.cell, nodes * 4e-6);
  for (uint32_t k = 0; k < info.dimension; ++k)
    std::printf("  %c from %.6g to %.6g\n", "xyz"[k], info.lower[k], info.upper[k]);
  std::printf("  %s %.6g, %s %.6g\n", info.dimension == 3 ? "volume" : "area", info.volume,
              info.dimension == 3 ? "surface" : "length", info.area);
}

void bake_file(const Options &options) {
  const auto begin = std::chrono::steady_clock::now();
  std::error_code one_is_not_there;
  if (std::filesystem::equivalent(options.mesh, options.out, one_is_not_there))
    throw std::runtime_error(options.out + " is the mesh itself, which would be lost");
  bake::Mesh mesh = bake::read_mesh(options.mesh);
  place(mesh, options);
  const double cell = cell_of(mesh, options);
  check_resolution(mesh, options, cell);
  const Shape shape =
      options.hull ? bake_hull(mesh, options, cell) : bake_mesh(mesh, options, cell);
  write(shape.get(), options.out);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  tell(shape.get(), options.out);
  std::printf("  of %zu triangles, in %.2f s\n", mesh.faces.size() / 3, took.count());
  if (mesh.collapsed > 0)
    std::printf("  %u triangles with two corners in one place were left out\n", mesh.collapsed);
}

// ---- The command line -----------------------------------------------------------------------------

void add_options(CLI::App &app, Options &options) {
  auto *mesh = app.add_option("mesh", options.mesh, "OBJ, STL, PLY, glTF, or what else Assimp reads");
  auto *out = app.add_option("out", options.out, "the file that is written");
  auto *show = app.add_option("--show", options.shown, "says what is in a file that is there");
  mesh->type_name("MESH");
  out->type_name("FILE");
  show->type_name("FILE")->excludes(mesh)->excludes(out);
  auto *cells = app.add_option_group("cells", "One of these");
  cells->add_option("--cell", options.cell, "length between nodes");
  cells->add_option("--spacing", options.spacing, "of the fluid's particles: cells of half of it");
  cells->add_option("--cells", options.cells, "so many along the longest side");
  for (CLI::Option *option : cells->get_options())
    option->type_name("N")->check(bench::above_zero());
  cells->require_option(0, 1);
  app.add_option("--scale", options.scale, "0.01 for centimetres in a scene of metres")
      ->type_name("S")
      ->check(bench::above_zero())
      ->capture_default_str();
  auto *thickness =
      app.add_option("--thickness", options.thickness,
                     "a shell along the mesh, which may be open; in lengths of the scene")
          ->type_name("T")
          ->check(bench::above_zero());
  app.add_flag("--hull", options.hull, "the convex hull of its vertices")->excludes(thickness);
  app.add_flag("--z-up", options.z_up, "turns what has z upwards, so that y is");
  app.add_flag("--centre", options.centred, "puts the middle of its box to the origin");
}

int run(const Options &options) {
  if (!options.shown.empty()) {
    tell(read(options.shown).get(), options.shown);
    return 0;
  }
  const char *missing = options.mesh.empty()  ? "a mesh"
                        : options.out.empty() ? "a file to write"
                        : options.cell == 0 && options.spacing == 0 && options.cells == 0
                            ? "--cell, --spacing or --cells"
                            : nullptr;
  if (missing) {
    std::fprintf(stderr, "pbf-bake: %s is missing; see pbf-bake --help\n", missing);
    return exit_usage;
  }
  bake_file(options);
  return 0;
}

int run_command(CLI::App &app, const Options &options, int argc, char **argv) {
  try {
    bench::parse(app, argc, argv);
    return run(options);
  } catch (const CLI::ParseError &error) {
    return app.exit(error) == 0 ? 0 : exit_usage;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "pbf-bake: %s\n", bench::one_line(bench::sentence_of(error)).c_str());
    return exit_failure;
  }
}

}  // namespace

int main(int argc, char **argv) {
  bench::prepare_standard_streams();
  CLI::App app("Makes a shape of a mesh: signed distances, for pbf_load_shape", "pbf-bake");
  Options options;
  add_options(app, options);
  app.footer("Exit codes: 0 done; 1 the mesh or a file is at fault; 2 wrong command line.");
  app.failure_message(bench::failure_message);
  return bench::exit_after_output(run_command(app, options, argc, argv), exit_failure, "pbf-bake");
}
