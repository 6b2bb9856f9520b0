#include "round_solids.h"

#include "rotation.h"

namespace view {
namespace {

constexpr int spheres_of_a_capsule = 64;  // so near each other that it looks straight

std::vector<std::array<float, 4>> centers_of(const pbf_collider &collider) {
  const bool capsule = collider.shape == PBF_COLLIDER_CAPSULE;
  const bench::Vector axis = unit({collider.axis[0], collider.axis[1], collider.axis[2]});
  const bench::Vector along = turned(collider.orientation, axis);
  const int count = capsule ? spheres_of_a_capsule : 1;
  std::vector<std::array<float, 4>> centers;
  for (int i = 0; i < count; ++i) {
    const double at = capsule ? collider.half_length * (2.0 * i / (count - 1) - 1) : 0;
    std::array<float, 4> center{0, 0, 0, -1};
    for (unsigned k = 0; k < 3; ++k)
      center[k] = static_cast<float>(collider.position[k] + at * along[k]);
    centers.push_back(center);
  }
  return centers;
}

}  // namespace

void RoundSolids::set(const Reading &reading) {
  solids_.clear();
  for (const pbf_collider &collider : reading.colliders) {
    const bool is_round =
        collider.shape == PBF_COLLIDER_SPHERE || collider.shape == PBF_COLLIDER_CAPSULE;
    if (is_round && !collider.inverted && reading.dimension == 3)
      solids_.push_back({centers_of(collider), static_cast<float>(collider.radius)});
  }
}

void RoundSolids::draw(const Matrix &to_eye, const Matrix &projection, int height) const {
  for (const Solid &solid : solids_) {
    spheres_.set(solid.points, solid.radius);
    spheres_.draw(to_eye, projection, height, 1);
  }
}

}  // namespace view
