#include "interface.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>

namespace view {

Interface::Interface(GLFWwindow *window) : windowed_(true) {
  open();
  ImGui_ImplGlfw_InitForOpenGL(window, true);
}

Interface::Interface(int width, int height, int finer) : windowed_(false) {
  open();
  const auto scale = static_cast<float>(finer);
  ImGui::GetIO().DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  ImGui::GetIO().FontGlobalScale = scale;
  ImGui::GetStyle().ScaleAllSizes(scale);
}

void Interface::open() {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file is left behind
  ImGui::StyleColorsDark();
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Interface::~Interface() {
  ImGui_ImplOpenGL3_Shutdown();
  if (windowed_) ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Interface::begin() {
  ImGui_ImplOpenGL3_NewFrame();
  if (windowed_) ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Interface::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Controls controls_of(const Options &options, const Simulation &simulation) {
  Controls controls;
  controls.scenes = bench::scene_names();
  const auto at = std::find(controls.scenes.begin(), controls.scenes.end(), options.scene.name);
  if (at != controls.scenes.end()) controls.scene = static_cast<int>(at - controls.scenes.begin());
  controls.params = simulation.params();
  controls.dimension = simulation.dimension();
  controls.coloring = options.coloring;
  controls.top = options.top;
  controls.steps_a_picture = static_cast<int>(options.steps_a_picture);
  if (!options.record.empty()) controls.record_to = options.record;
  controls.recording = !options.record.empty();
  return controls;
}

}  // namespace view
