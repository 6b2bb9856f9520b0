#include "panel.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "sliders.h"

namespace view {
namespace {

void draw_scene(Controls &controls) {
  const char *shown =
      controls.scene < 0 ? "file" : controls.scenes[static_cast<size_t>(controls.scene)].c_str();
  if (!ImGui::BeginCombo("scene", shown)) return;
  for (size_t i = 0; i < controls.scenes.size(); ++i) {
    if (ImGui::Selectable(controls.scenes[i].c_str(), controls.scene == static_cast<int>(i))) {
      controls.scene = static_cast<int>(i);
      controls.load = true;
    }
  }
  ImGui::EndCombo();
}

void draw_playing(Controls &controls) {
  if (ImGui::Button(controls.playing ? "Pause" : "Play")) controls.playing = !controls.playing;
  ImGui::SameLine();
  if (ImGui::Button("Step")) controls.step = true;
  ImGui::SameLine();
  if (ImGui::Button("Reset")) controls.reset = true;
  ImGui::SameLine();
  if (ImGui::Button("Look")) controls.look = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("brings all of the domain into the picture");
  ImGui::SliderInt("steps a picture", &controls.steps_a_picture, 1, 20);
  if (ImGui::Checkbox("record to", &controls.recording)) controls.message.clear();
  ImGui::SameLine();
  ImGui::BeginDisabled(controls.recording);
  ImGui::InputText("##path", &controls.record_to);
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("a video, as water.mp4, or a folder for PNG files");
}

void draw_colors(Controls &controls, double shown_top) {
  int coloring = static_cast<int>(controls.coloring);
  const auto &names = coloring_names();
  if (ImGui::Combo("color", &coloring, names.data(), static_cast<int>(names.size()))) {
    controls.coloring = static_cast<Coloring>(coloring);
    controls.top = 0;
  }
  auto top = static_cast<float>(controls.top);
  char automatic[48];
  std::snprintf(automatic, sizeof automatic, "by itself: %.3g", shown_top);
  if (ImGui::DragFloat("up to", &top, static_cast<float>(0.01 * shown_top), 0, 1e9f,
                       controls.top > 0 ? "%.3g" : automatic))
    controls.top = static_cast<double>(std::max(top, 0.0f));
}

void draw_facts(const Controls &controls, const Reading &reading) {
  ImGui::Text("%zu particles, %s", reading.particles.size(), reading.backend.c_str());
  ImGui::Text("step %llu, time %.3f", static_cast<unsigned long long>(reading.step), reading.time);
  ImGui::Text("%.2f ms a step, %.0f pictures/s", reading.milliseconds,
              static_cast<double>(ImGui::GetIO().Framerate));
  if (!controls.message.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 150, 120, 255));
    ImGui::TextWrapped("%s", controls.message.c_str());
    ImGui::PopStyleColor();
  }
}

}  // namespace

void draw_panel(Controls &controls, const Reading &reading, double shown_top) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowSize({26 * em, ImGui::GetIO().DisplaySize.y - 16}, ImGuiCond_FirstUseEver);
  ImGui::Begin("pbf-view");
  ImGui::PushItemWidth(11 * em);
  draw_scene(controls);
  draw_playing(controls);
  draw_colors(controls, shown_top);
  draw_facts(controls, reading);
  ImGui::Separator();
  if (draw_sliders(controls.params, controls.dimension)) controls.params_changed = true;
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace view
