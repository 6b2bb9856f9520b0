/* The triangles of a mesh in a file. */
#ifndef PBF_BAKE_MESH_FILE_H
#define PBF_BAKE_MESH_FILE_H

#include <cstdint>
#include <string>
#include <vector>

namespace bake {

struct Mesh {
  std::vector<double> vertices;  // three numbers each
  std::vector<uint32_t> faces;   // three vertices each
  uint32_t collapsed = 0;        // triangles with two corners in one place, which are left out
  double step = 0;  // its numbers have been read so far apart
};

// What Assimp reads: OBJ, STL, PLY, glTF, FBX and others. All meshes of the file where its scene puts
// them, as triangles. Throws std::runtime_error with a sentence that names what is wrong.
Mesh read_mesh(const std::string &path);

}  // namespace bake

#endif
