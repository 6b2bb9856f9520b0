#include "program.h"

#include "core/error.h"

namespace view {
namespace {

GLuint compile(GLenum type, const char *source) {
  const GLuint shader = glCreateShader(type);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char words[1024] = "";
  glGetShaderInfoLog(shader, sizeof words, nullptr, words);
  throw bench::Error(bench::exit_unavailable,
                     std::string("OpenGL does not compile a shader: ") + words);
}

}  // namespace

Program::Program(const char *vertex, const char *fragment) : program_(glCreateProgram()) {
  const GLuint shaders[] = {compile(GL_VERTEX_SHADER, vertex),
                            compile(GL_FRAGMENT_SHADER, fragment)};
  for (const GLuint shader : shaders) glAttachShader(program_, shader);
  glLinkProgram(program_);
  for (const GLuint shader : shaders) glDeleteShader(shader);
  GLint good = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &good);
  if (good) return;
  char words[1024] = "";
  glGetProgramInfoLog(program_, sizeof words, nullptr, words);
  throw bench::Error(bench::exit_unavailable,
                     std::string("OpenGL does not link a shader: ") + words);
}

Program::~Program() { glDeleteProgram(program_); }

}  // namespace view
