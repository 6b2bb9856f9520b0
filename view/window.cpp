#include "window.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <memory>
#include <string>

#include "core/error.h"
#include "interface.h"
#include "painter.h"
#include "pixels.h"
#include "playback.h"
#include "recorder.h"

namespace view {
namespace {

using bench::Error;

std::string &reason() {
  static std::string words;
  return words;
}

class Window {
 public:
  Window(int width, int height) {
    glfwSetErrorCallback([](int, const char *words) { reason() = words; });
    if (!glfwInit()) fail();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, "pbf-view", nullptr, nullptr);
    if (!window_) fail();
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
  }
  ~Window() { glfwTerminate(); }
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;

  GLFWwindow *handle() const { return window_; }

 private:
  [[noreturn]] static void fail() {
    glfwTerminate();
    throw Error(bench::exit_unavailable, "there is no window: " + reason() +
                                             ". Without a display --headless N makes pictures");
  }

  GLFWwindow *window_ = nullptr;
};

// The left button turns, the right one shifts, the wheel comes nearer.
void move_camera(Camera &camera) {
  const ImGuiIO &io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 0))
    camera.turn(-0.008f * io.MouseDelta.x, 0.008f * io.MouseDelta.y);
  if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0))
    camera.shift(io.MouseDelta.x / io.DisplaySize.y, -io.MouseDelta.y / io.DisplaySize.y);
  if (io.MouseWheel > 0) camera.approach(0.9f);
  if (io.MouseWheel < 0) camera.approach(1 / 0.9f);
}

void hear_keys(Controls &controls) {
  if (ImGui::GetIO().WantTextInput) return;
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) controls.playing = !controls.playing;
  if (ImGui::IsKeyPressed(GLFW_KEY_S)) controls.step = true;
  if (ImGui::IsKeyPressed(GLFW_KEY_R, false)) controls.reset = true;
}

class Viewer {
 public:
  explicit Viewer(const Options &options)
      : options_(options),
        window_(options.width, options.height),
        interface_(window_.handle()),
        simulation_(std::make_unique<Simulation>(options.scene, options.solver)),
        playback_(std::make_unique<Playback>(*simulation_)),
        controls_(controls_of(options, *simulation_)) {
    show(simulation_->read(controls_.coloring));
    controls_.look = true;
  }

  void run() {
    while (!glfwWindowShouldClose(window_.handle())) {
      glfwPollEvents();
      int width = 1, height = 1;
      glfwGetFramebufferSize(window_.handle(), &width, &height);
      if (width < 1 || height < 1) continue;  // an icon
      advance();
      draw(width, height);
      glfwSwapBuffers(window_.handle());
    }
  }

 private:
  void show(Reading reading) {
    reading_ = std::move(reading);
    painter_.set(reading_);
    fresh_ = true;
  }

  // What is asked for may be impossible; the panel then shows the sentence.
  template <typename Action>
  void attempt(Action action) {
    try {
      action();
    } catch (const Error &error) {
      controls_.message = error.what();
      controls_.playing = controls_.recording = false;
    }
  }

  void advance() {
    attempt([this] {
      Reading reading;
      if (playback_->take(reading)) show(std::move(reading));
    });
    if (!playback_->idle()) return;
    attempt([this] { apply_requests(); });
    const bool step = controls_.playing || controls_.step || drawn_ != controls_.coloring;
    const bool still = !controls_.playing && !controls_.step;
    if (!step) return;
    drawn_ = controls_.coloring;
    controls_.step = false;
    playback_->start(still ? 0 : static_cast<uint32_t>(controls_.steps_a_picture), drawn_);
  }

  void apply_requests() {
    const Controls asked = controls_;
    controls_.load = controls_.params_changed = controls_.reset = false;
    if (asked.load) return load(asked.scenes[static_cast<size_t>(asked.scene)]);
    if (asked.params_changed) {
      controls_.params = simulation_->params();  // stays so where the new ones are refused
      simulation_->set_params(asked.params);
      controls_.params = asked.params;
      controls_.message.clear();
    }
    if (!asked.reset) return;
    simulation_->reset();
    show(simulation_->read(controls_.coloring));
  }

  void load(const std::string &name) {
    bench::SceneOptions scene;
    scene.name = name;
    auto simulation = std::make_unique<Simulation>(scene, options_.solver);
    playback_ = std::make_unique<Playback>(*simulation);
    simulation_ = std::move(simulation);
    controls_.params = simulation_->params();
    controls_.dimension = simulation_->dimension();
    controls_.message.clear();
    controls_.look = true;
    show(simulation_->read(controls_.coloring));
  }

  void draw(int width, int height) {
    interface_.begin();
    move_camera(camera_);
    hear_keys(controls_);
    if (controls_.look)
      camera_.look_at(reading_.domain, reading_.dimension,
                      static_cast<float>(width) / static_cast<float>(height));
    controls_.look = false;
    painter_.draw(camera_, width, height, controls_.top);
    attempt([&] { record(width, height); });
    draw_panel(controls_, reading_, painter_.top());
    interface_.end();
  }

  // Before the panel is drawn over it; each reading once.
  void record(int width, int height) {
    if (!controls_.recording) {
      if (recorder_) std::exchange(recorder_, nullptr)->finish();
      return;
    }
    if (!recorder_) {
      glfwSetWindowAttrib(window_.handle(), GLFW_RESIZABLE, GLFW_FALSE);
      recorder_ = std::make_unique<Recorder>(controls_.record_to, width, height, film_rate);
      record_width_ = width;
      record_height_ = height;
    }
    if (width != record_width_ || height != record_height_)
      throw Error(bench::exit_failure, "the window's size has changed, which a recording can't");
    if (std::exchange(fresh_, false)) recorder_->add(read_pixels(width, height));
  }

  const Options &options_;
  Window window_;
  Interface interface_;
  Painter painter_;
  Camera camera_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<Playback> playback_;  // after the simulation, which its thread is in
  Reading reading_;
  Controls controls_;
  Coloring drawn_ = controls_.coloring;
  std::unique_ptr<Recorder> recorder_;
  int record_width_ = 0, record_height_ = 0;
  bool fresh_ = false;  // the reading has not been recorded
};

}  // namespace

void run_window(const Options &options) { Viewer(options).run(); }

}  // namespace view
