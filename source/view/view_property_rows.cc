// SPDX-License-Identifier: MIT
#include "view_panels.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::view {

namespace {

/** The slider shows smaller values as 0. */
constexpr double slider_min = 1e-4;

/** The label in the first column; the next item fills the second. */
void begin_row(const char *label)
{
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0F);
}

template <typename T>
bool show_choice(const ChoiceProperty<T> &property, T &thing)
{
  const int current = property.get(thing);
  if (property.options.size() == 2 && std::strcmp(property.options[0], "off") == 0) {
    bool is_on = current == 1;
    if (ImGui::Checkbox("", &is_on)) {
      property.set(thing, is_on ? 1 : 0);
      return true;
    }
    return false;
  }
  int chosen = current;
  if (ImGui::Combo("", &chosen, property.options.data(), int(property.options.size())) && chosen != current) {
    property.set(thing, chosen);
    return true;
  }
  return false;
}

template <typename T>
bool show_color(const NumberProperty<T> &property, T &thing)
{
  std::array<float, 3> color{};
  for (int i = 0; i < 3; i++) {
    color[std::size_t(i)] = float(property.get(thing, i));
  }
  if (!ImGui::ColorEdit3("", color.data(), ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR)) {
    return false;
  }
  for (int i = 0; i < 3; i++) {
    property.set(thing, i, std::clamp(double(color[std::size_t(i)]), property.min, property.max));
  }
  return true;
}

/** Whether the first \a count values fit into the \a count fields of a row, with their unit. */
bool fit(const std::array<double, 3> &values, int count, int digits, const char *unit)
{
  const ImGuiStyle &style = ImGui::GetStyle();
  const float row = ImGui::CalcItemWidth() - float(count - 1) * style.ItemInnerSpacing.x;
  const float field = row / float(count) - 2.0F * style.FramePadding.x;
  return std::all_of(values.begin(), values.begin() + count, [&](double value) {
    return ImGui::CalcTextSize(fmt::format("{:.{}g} {}", value, digits, unit).c_str()).x <= field;
  });
}

template <typename T>
bool show_number(const NumberProperty<T> &property, T &thing)
{
  std::array<double, 3> values{};
  double largest = 0.0;
  for (int i = 0; i < property.width; i++) {
    values[std::size_t(i)] = shown_number(property.get(thing, i), property.unit(thing));
    largest = std::max(largest, std::abs(values[std::size_t(i)]));
  }
  const std::array<double, 3> before = values;
  // A drag of a hundred pixels changes a number by about half of it.
  const auto speed = float(0.005 * std::max(largest, 0.01 * std::min(property.max, 100.0)));
  const int digits = largest >= 1e4 ? 5 : 4;
  const char *unit = property.unit(thing);
  const bool has_unit = *unit != 0 && fit(values, property.width, digits, unit);
  const std::string format = fmt::format("%.{}g{}{}", digits, has_unit ? " " : "", has_unit ? unit : "");
  const Limits limits = property.limits(thing);
  const bool is_changed = ImGui::DragScalarN("", ImGuiDataType_Double, values.data(), property.width, speed,
                                             &limits.min, &limits.max, format.c_str(), ImGuiSliderFlags_AlwaysClamp);
  if (*unit != 0 && !has_unit && ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s", unit);
  }
  if (!is_changed) {
    return false;
  }
  // Numbers that the user does not change keep all digits.
  for (int i = 0; i < property.width; i++) {
    const auto at = std::size_t(i);
    if (values[at] != before[at] && std::isfinite(values[at])) {
      property.set(thing, i, values[at]);
    }
  }
  return true;
}

template <typename T>
bool show_slider(const NumberProperty<T> &property, T &thing)
{
  double value = property.get(thing, 0);
  // Four decimals suffice for the smallest value above 0.
  const std::string format = value == 0.0 ? property.slider_zero : fmt::format("%.4f {}", property.unit(thing));
  if (!ImGui::SliderScalar(
          "", ImGuiDataType_Double, &value, &property.min, &property.max, format.c_str(),
          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat)) {
    return false;
  }
  // The lower end of the slider means 0.
  property.set(thing, 0, value < slider_min ? 0.0 : value);
  return true;
}

/** A number with a check box, which is unchecked if the number is absent. */
template <typename T>
bool show_optional_number(const NumberProperty<T> &property, T &thing)
{
  bool is_present = !property.is_absent(thing);
  if (ImGui::Checkbox("##present", &is_present)) {
    if (is_present) {
      const Limits limits = property.limits(thing);
      property.set(thing, 0, std::clamp(property.get(thing, 0), limits.min, limits.max));
    }
    else {
      property.remove(thing);
    }
    return true;
  }
  ImGui::SameLine();
  if (!is_present) {
    ImGui::TextDisabled("%s", property.absent);
    return false;
  }
  ImGui::SetNextItemWidth(-1.0F);
  return show_number(property, thing);
}

template <typename T>
bool show_row(const NumberProperty<T> &property, T &thing)
{
  if (property.absent) {
    return show_optional_number(property, thing);
  }
  if (property.slider_zero) {
    return show_slider(property, thing);
  }
  return property.is_color ? show_color(property, thing) : show_number(property, thing);
}

/** Calls \a function with each property of the group, choices first, that applies to \a thing. */
template <typename T, typename Function>
void for_each_property(const T &thing, std::string_view group, Function &&function)
{
  const auto visit = [&](const auto &property) {
    if (property.group == group && (!property.applies || property.applies(thing))) {
      function(property);
    }
  };
  std::ranges::for_each(properties<T>().choices, visit);
  std::ranges::for_each(properties<T>().numbers, visit);
}

/** The groups in the order of their first property. */
template <typename T>
std::vector<std::string_view> groups()
{
  std::vector<std::string_view> found;
  const auto note = [&](const auto &property) {
    if (*property.group != 0 && std::ranges::find(found, property.group) == found.end()) {
      found.emplace_back(property.group);
    }
  };
  std::ranges::for_each(properties<T>().choices, note);
  std::ranges::for_each(properties<T>().numbers, note);
  return found;
}

template <typename T>
bool is_default(const ChoiceProperty<T> &property, const T &thing)
{
  return property.get(thing) == property.get(T());
}

template <typename T>
bool is_default(const NumberProperty<T> &property, const T &thing)
{
  if (property.absent && property.is_absent(thing) != property.is_absent(T())) {
    return false;
  }
  for (int i = 0; i < property.width; i++) {
    if (property.get(thing, i) != property.get(T(), i)) {
      return false;
    }
  }
  return true;
}

template <typename T>
bool show_row(const ChoiceProperty<T> &property, T &thing)
{
  return show_choice(property, thing);
}

template <typename T>
bool show_rows(T &thing, std::string_view group)
{
  if (!ImGui::BeginTable("properties", 2)) {
    return false;
  }
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 8.0F * ImGui::GetFontSize());
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
  bool is_changed = false;
  for_each_property(thing, group, [&](const auto &property) {
    ImGui::PushID(property.name);
    begin_row(property.label);
    is_changed |= show_row(property, thing);
    ImGui::PopID();
  });
  ImGui::EndTable();
  return is_changed;
}

}  // namespace

template <typename T>
bool show_properties(T &thing)
{
  bool is_changed = show_rows(thing, "");
  for (const std::string_view group : groups<T>()) {
    bool has_rows = false;
    bool is_used = false;
    for_each_property(std::as_const(thing), group, [&](const auto &property) {
      has_rows = true;
      is_used |= !is_default(property, thing);
    });
    // A header with default values is folded at first. Later, only a click folds it, not a drag to the default.
    if (is_used) {
      ImGui::SetNextItemOpen(true, ImGuiCond_Once);
    }
    if (has_rows && ImGui::TreeNodeEx(group.data(), ImGuiTreeNodeFlags_SpanAvailWidth)) {
      is_changed |= show_rows(thing, group);
      ImGui::TreePop();
    }
  }
  return is_changed;
}

template bool show_properties(Placement &);
template bool show_properties(scene::Node &);
template bool show_properties(scene::Lamp &);
template bool show_properties(ShadowOfLamp &);
template bool show_properties(scene::Camera &);
template bool show_properties(scene::Material &);
template bool show_properties(scene::World &);
template bool show_properties(WindowSettings &);

}  // namespace gnomon::view
