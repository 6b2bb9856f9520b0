/* The edges of the domain and of colliders, as lines. Planes have no edge and are not drawn. */
#ifndef PBF_VIEW_OUTLINES_H
#define PBF_VIEW_OUTLINES_H

#include "camera.h"
#include "program.h"
#include "simulation.h"

namespace view {

class Outlines {
 public:
  Outlines();
  ~Outlines();
  Outlines(const Outlines &) = delete;
  Outlines &operator=(const Outlines &) = delete;

  void set(const Reading &reading);
  void draw(const Matrix &to_eye, const Matrix &projection) const;

 private:
  Program program_;
  GLuint array_ = 0, buffer_ = 0;
  GLsizei domain_ = 0, colliders_ = 0;  // points
};

}  // namespace view

#endif
