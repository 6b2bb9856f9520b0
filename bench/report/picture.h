/* Pictures of particles, coloured by speed, and of colliders. */
#ifndef PBF_BENCH_PICTURE_H
#define PBF_BENCH_PICTURE_H

#include <array>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace bench {

struct Frame {
  unsigned dimension;
  std::vector<Vector> positions;
  std::vector<double> speeds;
  std::vector<pbf_collider> colliders;  // in their poses
  std::vector<Vector> diffuse{};        // spray, foam and bubbles
};

// From rows of `dimension` numbers.
Frame particles_of(const std::vector<double> &positions, const std::vector<double> &velocities,
                   unsigned dimension);

// What frames that are to be compared must share.
struct View {
  Vector lower{}, upper{};  // the part of the domain to show
  double fastest = 1;       // the speed at the upper end of the colours
  double particle_radius = 1;
  int width = 1200;  // pixels
};

using Color = std::array<double, 3>;  // sRGB, 0 … 255

// From slow to fast.
const std::vector<Color> &speed_colors();
Color picture_background();

// A PNG file's bytes. 2D: x to the right, y up. 3D: orthographic, from the front right above.
std::string draw_png(const Frame &frame, const View &view);

}  // namespace bench

#endif
