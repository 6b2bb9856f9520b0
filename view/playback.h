/* Steps in another thread, while pictures of the last reading are drawn in this one. */
#ifndef PBF_VIEW_PLAYBACK_H
#define PBF_VIEW_PLAYBACK_H

#include <future>

#include "simulation.h"

namespace view {

class Playback {
 public:
  explicit Playback(Simulation &simulation) : simulation_(simulation) {}
  ~Playback();

  // Nobody is inside the simulation: it may be changed, and steps be started.
  bool idle() const { return !pending_.valid(); }

  void start(uint32_t steps, Coloring coloring);

  // Takes the reading of steps that have ended; false: there is none. Throws what they threw.
  bool take(Reading &reading);

 private:
  Simulation &simulation_;
  std::future<Reading> pending_;
};

}  // namespace view

#endif
