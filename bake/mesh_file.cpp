#include "mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <stdexcept>

#include "apart.h"
#include "core/error.h"

namespace bake {
namespace {

// Corners of a face: cutting one into triangles takes the square of their number.
constexpr unsigned max_corners = 10000;

// What Assimp's readers hand on as it stands in the file, and what it would do with it next reads
// without looking.
void check_faces(const aiMesh &mesh) {
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace &face = mesh.mFaces[i];
    const std::string where = "face " + std::to_string(i);
    if (face.mNumIndices > max_corners)
      throw std::runtime_error(where + " has " + std::to_string(face.mNumIndices) +
                               " corners; at most " + std::to_string(max_corners) +
                               " are cut into triangles");
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      if (face.mIndices[k] >= mesh.mNumVertices)
        throw std::runtime_error(where + " has vertex " + std::to_string(face.mIndices[k]) +
                                 "; there are " + std::to_string(mesh.mNumVertices));
  }
}

bool in_one_place(const aiVector3D &a, const aiVector3D &b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

void add_face(const aiMesh &from, const aiFace &face, uint32_t first, Mesh &mesh) {
  if (face.mNumIndices != 3) return;  // points and lines enclose nothing
  const unsigned *corner = face.mIndices;
  for (int k = 0; k < 3; ++k) {
    if (in_one_place(from.mVertices[corner[k]], from.mVertices[corner[(k + 1) % 3]])) {
      ++mesh.collapsed;
      return;
    }
  }
  for (int k = 0; k < 3; ++k) mesh.faces.push_back(first + corner[k]);
}

void add_mesh(const aiMesh &from, Mesh &mesh) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size() / 3);
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D &v = from.mVertices[i];
    mesh.vertices.insert(mesh.vertices.end(), {double{v.x}, double{v.y}, double{v.z}});
  }
  for (unsigned i = 0; i < from.mNumFaces; ++i) add_face(from, from.mFaces[i], first, mesh);
}

// Assimp has what was thrown in its own code as a text.
[[noreturn]] void fail(const std::string &reason) {
  if (reason == std::bad_alloc().what()) throw std::bad_alloc();
  throw std::runtime_error(reason);
}

// Of Assimp. Its readers crash, or do not end, with some damaged files.
Mesh read_here(const std::string &path) {
  Assimp::Importer importer;
  // Places and triangles alone: a mesh split by colours or normals is one again in the library.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_COLORS | aiComponent_TEXCOORDS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                  aiComponent_MATERIALS);
  const aiScene *scene = importer.ReadFile(path, aiProcess_RemoveComponent);
  for (unsigned i = 0; scene && i < scene->mNumMeshes; ++i) check_faces(*scene->mMeshes[i]);
  if (scene)
    scene = importer.ApplyPostProcessing(aiProcess_PreTransformVertices | aiProcess_Triangulate);
  if (!scene) fail(importer.GetErrorString());
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add_mesh(*scene->mMeshes[i], mesh);
  return mesh;
}

// ---- A mesh as bytes, of one process for another --------------------------------------------------

struct Head {
  uint64_t vertices, faces;  // numbers of them
  uint32_t collapsed, reserved;
};

template <typename T>
void add_bytes(std::string &bytes, const T *from, size_t count) {
  bytes.append(reinterpret_cast<const char *>(from), count * sizeof(T));
}

std::string bytes_of(const Mesh &mesh) {
  const Head head = {mesh.vertices.size(), mesh.faces.size(), mesh.collapsed, 0};
  std::string bytes;
  add_bytes(bytes, &head, 1);
  add_bytes(bytes, mesh.vertices.data(), mesh.vertices.size());
  add_bytes(bytes, mesh.faces.data(), mesh.faces.size());
  return bytes;
}

Mesh mesh_of(const std::string &bytes) {
  Head head = {};
  std::memcpy(&head, bytes.data(), std::min(bytes.size(), sizeof head));
  Mesh mesh;
  mesh.vertices.resize(head.vertices);
  mesh.faces.resize(head.faces);
  mesh.collapsed = head.collapsed;
  const char *const vertices = bytes.data() + sizeof head;
  const size_t size = head.vertices * sizeof mesh.vertices[0];
  if (size > 0) std::memcpy(mesh.vertices.data(), vertices, size);
  if (head.faces > 0)
    std::memcpy(mesh.faces.data(), vertices + size, head.faces * sizeof mesh.faces[0]);
  return mesh;
}

// 200 million triangles and more; a file of holes may have any size.
constexpr uintmax_t max_bytes = uintmax_t{1} << 34;

// 0 for a pipe.
uintmax_t size_of(const std::string &path) {
  std::error_code failed;
  const uintmax_t size = std::filesystem::file_size(path, failed);
  return failed ? 0 : size;
}

// A hundred times what a mesh takes.
unsigned seconds_for(uintmax_t bytes) { return 30 + static_cast<unsigned>(bytes >> 17); }

}  // namespace

// In the precision that Assimp was built with; 0 for what the library refuses.
static double step_of(const std::vector<double> &vertices) {
  double farthest = 0;
  for (const double x : vertices) farthest = std::max(farthest, std::abs(x));
  const double step = double{std::numeric_limits<ai_real>::epsilon()};
  return farthest > 0 && farthest < 1e30 ? std::ldexp(step, std::ilogb(farthest)) : 0;
}

Mesh read_mesh(const std::string &path) {
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed))
    throw std::runtime_error(path + " is a folder");
  if (!std::filesystem::exists(path, failed)) throw std::runtime_error(path + " does not exist");
  const uintmax_t size = size_of(path);
  if (size > max_bytes)
    throw std::runtime_error(path + " has " + std::to_string(size) + " bytes; at most " +
                             std::to_string(max_bytes) + " are read");
  Mesh mesh;
  try {
    mesh = mesh_of(run_apart([&path] { return bytes_of(read_here(path)); }, seconds_for(size)));
  } catch (const std::exception &error) {
    throw std::runtime_error(path + " can't be read: " + bench::sentence_of(error));
  }
  if (mesh.faces.empty()) throw std::runtime_error(path + " has no triangles");
  mesh.step = step_of(mesh.vertices);
  return mesh;
}

}  // namespace bake
