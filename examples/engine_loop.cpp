// How a game engine drives a fluid: a fixed time step behind a varying frame time, a collider that
// moves, particles that come from a tap and leave through a drain, and a view for the renderer
// without a copy.
#include <pbf/pbf.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace {

void check(pbf_status status) {
  if (status != PBF_OK) throw std::runtime_error(pbf_last_error());
}

class Fluid {
 public:
  Fluid() {
    pbf_desc desc;
    pbf_params params;
    check(pbf_desc_init(&desc, sizeof desc));
    check(pbf_params_init(&params, sizeof params));
    desc.capacity = 20000;
    step_ = params.time_step;
    check(pbf_create(&desc, &params, &solver_));
    check(pbf_collider_init(&paddle_, sizeof paddle_, PBF_COLLIDER_SPHERE));
    paddle_.radius = 0.15;
    place_paddle(0);
    check(pbf_set_colliders(solver_, 1, &paddle_));
  }
  ~Fluid() { pbf_destroy(solver_); }
  Fluid(const Fluid &) = delete;
  Fluid &operator=(const Fluid &) = delete;

  // Whole steps only; what is left of the frame waits for the next one. The paddle comes to where
  // it is to be at their end.
  void advance(double frame_time) {
    debt_ += frame_time;
    const auto steps = static_cast<uint32_t>(debt_ / step_);
    if (steps == 0) return;
    debt_ -= steps * step_;
    time_ += steps * step_;
    place_paddle(time_);
    check(pbf_move_colliders(solver_, 1, &paddle_, steps * step_));
    check(pbf_step(solver_, steps));
  }

  void place_paddle(double time) {
    const double turn = 1.5;
    paddle_.position[0] = 0.5 + 0.25 * std::cos(turn * time);
    paddle_.position[1] = 0.2;
    paddle_.position[2] = 0.5 + 0.25 * std::sin(turn * time);
  }

  void open_tap() {
    float positions[36], velocities[36] = {};
    for (int i = 0; i < 12; ++i) {
      positions[3 * i] = 0.4f + 0.05f * static_cast<float>(i % 4);
      positions[3 * i + 1] = 0.95f;
      positions[3 * i + 2] = 0.4f + 0.05f * static_cast<float>(i / 4);
      velocities[3 * i + 1] = -1.5f;
    }
    check(pbf_add_particles(solver_, 12, positions, velocities, nullptr));
  }

  // Everything in one corner of the floor leaves.
  void drain() {
    uint32_t count = 0;
    check(pbf_get_count(solver_, &count));
    std::vector<float> positions(3 * count);
    std::vector<uint32_t> ids(count), gone;
    check(pbf_get_positions(solver_, 0, count, positions.data()));
    check(pbf_get_ids(solver_, 0, count, ids.data()));
    for (uint32_t i = 0; i < count; ++i)
      if (positions[3 * i] < 0.1f && positions[3 * i + 1] < 0.1f && positions[3 * i + 2] < 0.1f)
        gone.push_back(ids[i]);
    check(pbf_remove_particles(solver_, static_cast<uint32_t>(gone.size()), gone.data()));
  }

  // A renderer would hand view.data and its strides to the GPU; here the mean height stands in, for
  // which positions on a device are copied.
  void draw() {
    pbf_view view = {};
    view.struct_size = sizeof view;
    check(pbf_map(solver_, PBF_FIELD_POSITION, &view));
    std::vector<float> copy;
    if (view.device_type != PBF_DEVICE_CPU) {
      copy.resize(3 * view.count);
      check(pbf_get_positions(solver_, 0, view.count, copy.data()));
      view.data = copy.data();
      view.particle_stride = 3 * sizeof(float);
      view.component_stride = sizeof(float);
    }
    double height = 0;
    const auto *bytes = static_cast<const char *>(view.data);
    for (uint32_t i = 0; i < view.count; ++i)
      height += *reinterpret_cast<const float *>(bytes + i * view.particle_stride +
                                                 view.component_stride);
    const uint32_t count = view.count;
    check(pbf_unmap(solver_, PBF_FIELD_POSITION));
    std::printf("%5u particles, mean height %.3f\n", count, count ? height / count : 0.0);
  }

 private:
  pbf_solver *solver_ = nullptr;
  pbf_collider paddle_;
  double step_ = 0, debt_ = 0, time_ = 0;
};

}  // namespace

int main() try {
  Fluid fluid;
  for (int frame = 0; frame < 60; ++frame) {
    const double frame_time = frame % 3 ? 1.0 / 60 : 1.0 / 48;  // frames vary
    fluid.open_tap();
    fluid.advance(frame_time);
    if (frame % 10 == 9) {
      fluid.drain();
      fluid.draw();
    }
  }
  return 0;
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
