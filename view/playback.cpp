#include "playback.h"

#include <chrono>

namespace view {

Playback::~Playback() {
  if (pending_.valid()) pending_.wait();
}

void Playback::start(uint32_t steps, Coloring coloring) {
  pending_ = std::async(std::launch::async, [this, steps, coloring] {
    simulation_.step(steps);
    return simulation_.read(coloring);
  });
}

bool Playback::take(Reading &reading) {
  if (idle() || pending_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return false;
  reading = pending_.get();
  return true;
}

}  // namespace view
