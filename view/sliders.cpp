#include "sliders.h"

#include <imgui.h>

#include <algorithm>

#include "parameters.h"

namespace view {
namespace {

constexpr uint32_t longest_slider = 32;  // of whole numbers, whose most is often all that there are

// From low to high, and as far as twice the value, so that a scene's own can be moved both ways.
bool draw_real(const char *label, double &value, const Parameter &parameter) {
  const double low = std::min(parameter.low, 2 * value), high = std::max(parameter.high, 2 * value);
  return ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, "%.4g");
}

bool draw_reals(const Parameter &parameter, double *values, unsigned dimension) {
  static const char *const axes[] = {"x", "y", "z"};
  static const char *const walls[] = {"x lower", "x upper", "y lower",
                                      "y upper", "z lower", "z upper"};
  if (!ImGui::TreeNode(parameter.name)) return false;
  bool moved = false;
  const unsigned count = parameter.count / 3 * dimension;
  for (unsigned i = 0; i < count; ++i)
    moved |= draw_real(parameter.count == 3 ? axes[i] : walls[i], values[i], parameter);
  ImGui::TreePop();
  return moved;
}

bool draw_number(const Parameter &parameter, uint32_t &value) {
  const uint32_t most = std::min(parameter.most, std::max(longest_slider, 2 * value));
  return ImGui::SliderScalar(parameter.name, ImGuiDataType_U32, &value, &parameter.least, &most);
}

bool draw_choice(const Parameter &parameter, uint32_t &value) {
  int chosen = static_cast<int>(value);
  const bool moved = ImGui::Combo(parameter.name, &chosen, parameter.names.data(),
                                  static_cast<int>(parameter.names.size()));
  value = static_cast<uint32_t>(chosen);
  return moved;
}

bool draw_bits(const Parameter &parameter, uint32_t &value) {
  if (!ImGui::TreeNode(parameter.name)) return false;
  bool moved = false;
  for (size_t bit = 0; bit < parameter.names.size(); ++bit)
    moved |= ImGui::CheckboxFlags(parameter.names[bit], &value, 1u << bit);
  ImGui::TreePop();
  return moved;
}

bool draw(const Parameter &parameter, pbf_params &params, unsigned dimension) {
  switch (parameter.kind) {
    case Parameter::Kind::number:
      return draw_number(parameter, value_of<uint32_t>(params, parameter));
    case Parameter::Kind::one_of:
      return draw_choice(parameter, value_of<uint32_t>(params, parameter));
    case Parameter::Kind::some_of:
      return draw_bits(parameter, value_of<uint32_t>(params, parameter));
    case Parameter::Kind::real:
      return draw_real(parameter.name, value_of<double>(params, parameter), parameter);
    default:
      return draw_reals(parameter, &value_of<double>(params, parameter), dimension);
  }
}

void draw_help(const Parameter &parameter) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 28);
  ImGui::TextUnformatted(parameter.doc);
  if (*parameter.unit) ImGui::TextDisabled("%s", parameter.unit);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace

bool draw_sliders(pbf_params &params, unsigned dimension) {
  static ImGuiTextFilter filter;
  filter.Draw("find a parameter");
  ImGui::BeginChild("parameters");
  ImGui::PushItemWidth(9 * ImGui::GetFontSize());
  bool moved = false;
  for (const Parameter &parameter : parameters()) {
    if (!filter.PassFilter(parameter.name)) continue;
    moved |= draw(parameter, params, dimension);
    draw_help(parameter);
  }
  ImGui::PopItemWidth();
  ImGui::EndChild();
  return moved;
}

}  // namespace view
