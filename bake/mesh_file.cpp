#include "mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>
#include <stdexcept>

namespace bake {
namespace {

// Corners of a face: cutting one into triangles takes the square of their number.
constexpr unsigned max_corners = 10000;

// What Assimp's readers hand on as it stands in the file, and what it would do with it next reads
// without looking.
void check_faces(const aiMesh &mesh, const std::string &path) {
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace &face = mesh.mFaces[i];
    const std::string where = path + " can't be read: face " + std::to_string(i);
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

}  // namespace

Mesh read_mesh(const std::string &path) {
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed))
    throw std::runtime_error(path + " is a folder");
  if (!std::filesystem::exists(path, failed)) throw std::runtime_error(path + " does not exist");
  Assimp::Importer importer;
  // Places and triangles alone: a mesh split by colours or normals is one again in the library.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_COLORS | aiComponent_TEXCOORDS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                  aiComponent_MATERIALS);
  const aiScene *scene = importer.ReadFile(path, aiProcess_RemoveComponent);
  for (unsigned i = 0; scene && i < scene->mNumMeshes; ++i) check_faces(*scene->mMeshes[i], path);
  if (scene)
    scene =
        importer.ApplyPostProcessing(aiProcess_PreTransformVertices | aiProcess_Triangulate);
  if (!scene) throw std::runtime_error(path + " can't be read: " + importer.GetErrorString());
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add_mesh(*scene->mMeshes[i], mesh);
  if (mesh.faces.empty()) throw std::runtime_error(path + " has no triangles");
  return mesh;
}

}  // namespace bake
