/* Meshes in OBJ files (v, f, and in 2D l; all else is left out) and STL files, text or binary. */
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "core/content.h"
#include "scene/shape.h"

namespace bench {
namespace {

constexpr uintmax_t max_mesh_size = 256u << 20;

std::runtime_error at_line(const std::string &path, size_t line, const std::string &reason) {
  return std::runtime_error(path + ":" + std::to_string(line) + ": " + reason);
}

// All of the word, in digits, and finite.
double number_of(const std::string &word) {
  char *end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  if (word.find_first_not_of("0123456789+-.eE") != word.npos || *end || !std::isfinite(number))
    throw std::runtime_error("\"" + word + "\" is no number");
  return number;
}

// The numbers that come next on a line.
void read_numbers(std::istringstream &words, unsigned count, Mesh &mesh) {
  for (std::string word; count > 0; --count) {
    if (!(words >> word)) throw std::runtime_error("a vertex has too few numbers");
    mesh.vertices.push_back(number_of(word));
  }
}

// "7", "7/1/3", "-1": the vertex from 0, of `count` so far; below 0 it counts from the last one.
uint32_t vertex_of(const std::string &word, size_t count) {
  char *end = nullptr;
  const long long number = std::strtoll(word.c_str(), &end, 10);
  const long long index = number < 0 ? static_cast<long long>(count) + number : number - 1;
  if ((*end && *end != '/') || number == 0 || index < 0 || index >= static_cast<long long>(count))
    throw std::runtime_error("\"" + word + "\" is none of the " + std::to_string(count) +
                             " vertices before it");
  return static_cast<uint32_t>(index);
}

// Faces of more than three corners become a fan of triangles, lines their segments.
void add_corners(const std::vector<uint32_t> &corners, unsigned dimension, Mesh &mesh) {
  if (corners.size() < dimension) throw std::runtime_error("there are too few corners");
  for (size_t i = dimension - 1; i < corners.size(); ++i) {
    if (dimension == 3) mesh.faces.push_back(corners[0]);
    mesh.faces.push_back(corners[i - 1]);
    mesh.faces.push_back(corners[i]);
  }
}

void read_obj_line(std::istringstream &words, unsigned dimension, Mesh &mesh) {
  std::string kind, word;
  words >> kind;
  if (kind == "v") {
    read_numbers(words, dimension, mesh);
  } else if (kind == (dimension == 3 ? "f" : "l")) {
    std::vector<uint32_t> corners;
    while (words >> word) corners.push_back(vertex_of(word, mesh.vertices.size() / dimension));
    add_corners(corners, dimension, mesh);
  }
}

// Editors of Windows begin a text with a mark of UTF-8.
std::string without_mark(const std::string &line) {
  return line.rfind("\xef\xbb\xbf", 0) == 0 ? line.substr(3) : line;
}

Mesh read_obj(const std::string &path, const std::string &text, unsigned dimension) {
  Mesh mesh;
  std::istringstream lines(text);
  size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(number == 1 ? without_mark(line) : line);
    try {
      read_obj_line(words, dimension, mesh);
    } catch (const std::runtime_error &error) {
      throw at_line(path, number, error.what());
    }
  }
  if (mesh.faces.empty())
    throw std::runtime_error(path + " has no " + (dimension == 3 ? "faces" : "lines (l)"));
  return mesh;
}

// Every triangle has its own vertices; the library joins those in one place.
void add_triangles(Mesh &mesh) {
  for (size_t i = 0; i < mesh.vertices.size() / 3; ++i)
    mesh.faces.push_back(static_cast<uint32_t>(i));
}

Mesh read_binary_stl(const std::string &text, uint32_t triangles) {
  constexpr size_t head = 84, triangle = 50, normal = 12;
  Mesh mesh;
  for (uint32_t i = 0; i < triangles; ++i) {
    float x[9];
    std::memcpy(x, text.data() + head + i * triangle + normal, sizeof x);
    mesh.vertices.insert(mesh.vertices.end(), x, x + 9);
  }
  return mesh;
}

Mesh read_text_stl(const std::string &path, const std::string &text) {
  Mesh mesh;
  std::istringstream lines(text);
  size_t number = 0;
  for (std::string line, word; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    if (!(words >> word) || word != "vertex") continue;
    try {
      read_numbers(words, 3, mesh);
    } catch (const std::runtime_error &error) {
      throw at_line(path, number, error.what());
    }
  }
  if (mesh.vertices.empty() || mesh.vertices.size() % 9 != 0)
    throw std::runtime_error(path + " has " + std::to_string(mesh.vertices.size() / 3) +
                             " vertices, which make no triangles; is it an STL file?");
  return mesh;
}

// A binary file is as long as its number of triangles says; "solid" may stand in it, too.
Mesh read_stl(const std::string &path, const std::string &text, unsigned dimension) {
  if (dimension != 3)
    throw std::runtime_error(path +
                             ": STL files hold triangles; in 2D an OBJ file with lines does");
  uint32_t triangles = 0;
  if (text.size() >= 84) std::memcpy(&triangles, text.data() + 80, sizeof triangles);
  const bool binary = triangles > 0 && text.size() == 84 + uint64_t{50} * triangles;
  Mesh mesh = binary ? read_binary_stl(text, triangles) : read_text_stl(path, text);
  add_triangles(mesh);
  return mesh;
}

}  // namespace

Mesh read_mesh_file(const std::string &path, unsigned dimension) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char &c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (ending != ".obj" && ending != ".stl")
    throw std::runtime_error(path + " ends in \"" + ending +
                             "\"; meshes are read from .obj and .stl files, and shapes of "
                             "pbf-bake where \"from\" is \"baked\"");
  const std::string text = content_of(path, max_mesh_size);
  return ending == ".obj" ? read_obj(path, text, dimension) : read_stl(path, text, dimension);
}

}  // namespace bench
