#include "spheres.h"

#include "report/picture.h"

namespace view {
namespace {

const char *const sphere_vertex_shader = R"(#version 330 core
layout(location = 0) in vec4 particle;
uniform mat4 to_eye, projection;
uniform float radius, height, top;
uniform vec3 stops[6];
flat out vec3 color;
flat out float depth, thickness;
void main() {
  vec4 eye = to_eye * vec4(particle.xyz, 1);
  vec4 front = projection * (eye + vec4(0, 0, radius, 0));
  gl_Position = projection * eye;
  gl_PointSize = radius * projection[1][1] * height / gl_Position.w;
  depth = 0.5 + 0.5 * gl_Position.z / gl_Position.w;
  thickness = depth - (0.5 + 0.5 * front.z / front.w);
  float at = 5 * clamp(particle.w / top, 0, 1);
  int below = min(int(at), 4);
  color = particle.w < 0 ? vec3(0.62, 0.6, 0.58) : mix(stops[below], stops[below + 1], at - float(below));
}
)";

const char *const sphere_fragment_shader = R"(#version 330 core
flat in vec3 color;
flat in float depth, thickness;
out vec4 pixel;
void main() {
  vec2 at = 2 * gl_PointCoord - 1;
  float square = dot(at, at);
  if (square > 1) discard;
  vec3 normal = vec3(at.x, -at.y, sqrt(1 - square));
  float light = max(dot(normal, vec3(-0.4, 0.6, 0.69)), 0);
  float sky = 0.5 + 0.5 * normal.y;
  float gloss = pow(max(dot(normal, vec3(-0.22, 0.33, 0.92)), 0), 40);
  pixel = vec4(color * (0.2 + 0.2 * sky + 0.65 * light) + 0.18 * gloss, 1);
  gl_FragDepth = depth - thickness * normal.z;
}
)";

}  // namespace

Spheres::Spheres() : program_(sphere_vertex_shader, sphere_fragment_shader) {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
  float stops[18];
  for (unsigned i = 0; i < 18; ++i)
    stops[i] = static_cast<float>(bench::speed_colors()[i / 3][i % 3] / 255);
  program_.use();
  glUniform3fv(program_.uniform("stops"), 6, stops);
}

Spheres::~Spheres() {
  glDeleteBuffers(1, &buffer_);
  glDeleteVertexArrays(1, &array_);
}

void Spheres::set(const std::vector<std::array<float, 4>> &points, float radius) {
  count_ = static_cast<GLsizei>(points.size());
  radius_ = radius;
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(points.size() * sizeof points[0]),
               points.data(), GL_STREAM_DRAW);
}

void Spheres::draw(const Matrix &to_eye, const Matrix &projection, int height, float top) const {
  program_.use();
  glUniformMatrix4fv(program_.uniform("to_eye"), 1, GL_FALSE, to_eye.data());
  glUniformMatrix4fv(program_.uniform("projection"), 1, GL_FALSE, projection.data());
  glUniform1f(program_.uniform("radius"), radius_);
  glUniform1f(program_.uniform("height"), static_cast<float>(height));
  glUniform1f(program_.uniform("top"), top);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(array_);
  glDrawArrays(GL_POINTS, 0, count_);
}

}  // namespace view
