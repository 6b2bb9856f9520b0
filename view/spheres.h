/* Shaded spheres, of particles or what else is round. Each is a square towards the viewer, of whose
 * pixels those within the sphere's outline get the sphere's normal and depth: an impostor. */
#ifndef PBF_VIEW_SPHERES_H
#define PBF_VIEW_SPHERES_H

#include "camera.h"
#include "program.h"

#include <array>
#include <vector>

namespace view {

class Spheres {
 public:
  Spheres();
  ~Spheres();
  Spheres(const Spheres &) = delete;
  Spheres &operator=(const Spheres &) = delete;

  // Each with a position and the number that colours it; below 0: a solid.
  void set(const std::vector<std::array<float, 4>> &points, float radius);

  // `top`: the number at the upper end of the colours. `height`: of the picture, pixels.
  void draw(const Matrix &to_eye, const Matrix &projection, int height, float top) const;

 private:
  Program program_;
  GLuint array_ = 0, buffer_ = 0;
  GLsizei count_ = 0;
  float radius_ = 0;
};

}  // namespace view

#endif
