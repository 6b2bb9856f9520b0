/* A linked pair of shaders. */
#ifndef PBF_VIEW_PROGRAM_H
#define PBF_VIEW_PROGRAM_H

#include <epoxy/gl.h>

namespace view {

class Program {
 public:
  // Throws bench::Error with the driver's words.
  Program(const char *vertex, const char *fragment);
  ~Program();
  Program(const Program &) = delete;
  Program &operator=(const Program &) = delete;

  void use() const { glUseProgram(program_); }
  GLint uniform(const char *name) const { return glGetUniformLocation(program_, name); }

 private:
  GLuint program_;
};

}  // namespace view

#endif
