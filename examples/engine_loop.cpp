// How a game engine drives a fluid: a fixed time step behind a varying frame time, a collider that
// moves, a tap and a drain, and a vertex buffer that is filled between two steps.
#include <pbf/emit.h>

#include <algorithm>
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
    check(pbf_keep_previous(solver_, 1));  // what drawing between steps wants
    open_tap_and_drain();
  }
  ~Fluid() { pbf_destroy(solver_); }
  Fluid(const Fluid &) = delete;
  Fluid &operator=(const Fluid &) = delete;

  // Whole steps only; what is left of the frame waits for the next one. Of a pause only a tenth of
  // a second is made up for. The paddle comes to where it is to be at their end.
  void advance(double frame_time) {
    debt_ = std::min(debt_ + frame_time, 0.1);
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

  // A tap over the middle of the tank, and a corner of the floor in which everything leaves: the
  // library's own, in each step.
  void open_tap_and_drain() {
    pbf_emitter tap;
    pbf_volume corner;
    check(pbf_emitter_init(&tap, sizeof tap, PBF_EMITTER_RECTANGLE));
    tap.position[0] = tap.position[2] = 0.5;
    tap.position[1] = 0.95;
    tap.half_width = 0.1;
    tap.half_height = 0.075;
    tap.velocity[1] = -3;  // 4 x 3 columns of particles 0.05 apart: 720 a second
    check(pbf_set_emitters(solver_, 1, &tap));
    check(pbf_volume_init(&corner, sizeof corner, PBF_VOLUME_BOX));
    for (int k = 0; k < 3; ++k) corner.position[k] = corner.half_extents[k] = 0.05;
    check(pbf_set_drains(solver_, 1, &corner));
  }

  // Into a vertex buffer, between the last two steps: as far as the frame is ahead of the last one.
  void draw() {
    uint32_t count = 0;
    check(pbf_get_count(solver_, &count));
    vertices_.resize(count);
    pbf_read_desc read = {};
    read.struct_size = sizeof read;
    read.field = PBF_FIELD_POSITION;
    read.count = count;
    read.components = 4;
    read.w = PBF_W_SPEED;  // for its colour
    read.element_type = PBF_TYPE_FLOAT32;
    read.stride = sizeof(Vertex);
    read.order = PBF_ORDER_STORED;  // the fastest; which is which does not matter here
    read.behind = 1 - debt_ / step_;
    read.data = vertices_.data();
    if (count > 0) check(pbf_read(solver_, &read));
    double height = 0;  // a renderer would draw them; here their mean height stands in
    for (const Vertex &vertex : vertices_) height += static_cast<double>(vertex.position[1]);
    std::printf("%5u particles, mean height %.3f\n", count, count ? height / count : 0.0);
  }

 private:
  struct Vertex {
    float position[4];
    float texture[2];
  };

  pbf_solver *solver_ = nullptr;
  pbf_collider paddle_;
  double step_ = 0, debt_ = 0, time_ = 0;
  std::vector<Vertex> vertices_;
};

}  // namespace

int main() try {
  Fluid fluid;
  for (int frame = 0; frame < 60; ++frame) {
    const double frame_time = frame % 3 ? 1.0 / 60 : 1.0 / 48;  // frames vary
    fluid.advance(frame_time);
    if (frame % 10 == 9) fluid.draw();
  }
  return 0;
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
