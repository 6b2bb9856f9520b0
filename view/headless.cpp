#include "headless.h"

#include <chrono>
#include <cstdio>
#include <memory>

#include "core/output_file.h"
#include "interface.h"
#include "offscreen.h"
#include "painter.h"
#include "playback.h"
#include "recorder.h"
#include "report/png.h"

namespace view {
namespace {

constexpr int finer = 2;  // smooth edges

using Clock = std::chrono::steady_clock;

void write_png(const std::string &path, int width, int height,
               const std::vector<unsigned char> &rgb) {
  bench::write_file(path, bench::encode_png(width, height, rgb.data()));
}

Camera camera_for(const Options &options, const Reading &reading) {
  Camera camera;
  camera.look_at(reading.domain, reading.dimension,
                 static_cast<float>(options.width) / static_cast<float>(options.height));
  return camera;
}

void draw_with_panel(const Options &options, const Simulation &simulation, const Reading &reading,
                     const Painter &painter, const Offscreen &target) {
  Interface interface(target.width(), target.height(), finer);
  Controls controls = controls_of(options, simulation);
  for (int i = 0; i < 2; ++i) {  // the first lays it out
    interface.begin();
    draw_panel(controls, reading, painter.top());
    interface.end();
  }
}

// Steps until there are enough, a picture after each few.
void run_pictures(const Options &options) {
  Simulation simulation(options.scene, options.solver);
  Offscreen target(options.width, options.height, finer);
  Painter painter;
  Reading reading = simulation.read(options.coloring);
  const Camera camera = camera_for(options, reading);
  std::unique_ptr<Recorder> recorder;
  if (!options.record.empty())
    recorder = std::make_unique<Recorder>(options.record, options.width, options.height, film_rate);
  for (uint32_t done = 0;;) {
    if (recorder || done == options.steps) {
      reading = simulation.read(options.coloring);
      painter.set(reading);
      painter.draw(camera, target.width(), target.height(), options.top);
    }
    if (recorder) recorder->add(target.pixels());
    if (done == options.steps) break;
    const uint32_t now =
        recorder ? std::min(options.steps_a_picture, options.steps - done) : options.steps;
    simulation.step(now);
    done += now;
  }
  if (recorder) recorder->finish();
  if (options.panel) draw_with_panel(options, simulation, reading, painter, target);
  if (!options.picture.empty())
    write_png(options.picture, options.width, options.height, target.pixels());
  std::printf("%s: %zu particles, step %llu, time %.6g\n", simulation.scene().c_str(),
              reading.particles.size(), static_cast<unsigned long long>(reading.step),
              reading.time);
}

// As a window does it: pictures of the last reading, while another thread steps.
void measure(const Options &options) {
  Simulation simulation(options.scene, options.solver);
  Offscreen target(options.width, options.height, 1);
  Painter painter;
  Reading reading = simulation.read(options.coloring);
  const Camera camera = camera_for(options, reading);
  Playback playback(simulation);
  painter.set(reading);
  const auto start = Clock::now();
  uint32_t pictures = 0;
  const auto draw = [&] {
    painter.draw(camera, target.width(), target.height(), options.top);
    glFinish();
    ++pictures;
  };
  for (uint32_t done = 0; done < options.steps;) {
    if (playback.idle()) playback.start(options.steps_a_picture, options.coloring);
    draw();
    if (playback.take(reading)) {
      painter.set(reading);
      done += options.steps_a_picture;
    }
  }
  const double moving = std::chrono::duration<double>(Clock::now() - start).count();
  const double moving_rate = pictures / moving;
  const auto still = Clock::now();
  for (pictures = 0; pictures < 20;) draw();
  const double still_rate = pictures / std::chrono::duration<double>(Clock::now() - still).count();
  std::printf(
      "%s: %zu particles, %d x %d pixels, %s: %.1f pictures/s while %.1f steps/s run, "
      "%.1f pictures/s paused\n",
      simulation.scene().c_str(), reading.particles.size(), options.width, options.height,
      reinterpret_cast<const char *>(glGetString(GL_RENDERER)), moving_rate, options.steps / moving,
      still_rate);
}

}  // namespace

void run_headless(const Options &options) {
  if (options.measure)
    measure(options);
  else
    run_pictures(options);
}

}  // namespace view
