// SPDX-License-Identifier: MIT
#include "view_panels.hh"

#include "eevee_frame_text.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace gnomon::view {

namespace {

/** The range of an axis of the plot: powers of ten that hold all values. */
struct LogRange {
  double low = 0.0;
  double high = 0.0;

  void take(double value)
  {
    const bool is_first = low == high;
    low = is_first ? std::floor(std::log10(value)) : std::min(low, std::floor(std::log10(value)));
    high = std::max(is_first ? low + 1.0 : high, std::floor(std::log10(value)) + 1.0);
  }
  /** Position of \a value on the axis, in [0, 1]. */
  [[nodiscard]] float place(double value) const
  {
    return float((std::log10(value) - low) / (high - low));
  }
};

/** An error of 0 cannot be shown on a logarithmic scale. */
bool is_plotted(const measure::TimedError &point)
{
  return point.error.rmse > 0.0 && point.seconds > 0.0;
}

/** RMSE against time, both on logarithmic scales, with a bar of two standard errors at each point. */
void plot(const std::vector<measure::TimedError> &points)
{
  LogRange seconds;
  LogRange errors;
  for (const measure::TimedError &point : points) {
    if (is_plotted(point)) {
      seconds.take(point.seconds);
      errors.take(point.error.rmse);
    }
  }
  if (seconds.low == seconds.high) {
    return;
  }
  const float line_height = ImGui::GetTextLineHeight();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 space(ImGui::GetContentRegionAvail().x, 200.0F);
  ImGui::Dummy(space);
  const float left = corner.x + ImGui::CalcTextSize("0.0001 ").x;
  const float right = corner.x + space.x - 0.5F * line_height;
  const float top = corner.y + 0.5F * line_height;
  const float bottom = corner.y + space.y - 1.5F * line_height;
  const auto x_of = [&](double value) { return std::lerp(left, right, seconds.place(value)); };
  const auto y_of = [&](double value) { return std::lerp(bottom, top, errors.place(value)); };
  ImDrawList &list = *ImGui::GetWindowDrawList();
  const ImU32 grid = ImGui::GetColorU32(ImGuiCol_Border);
  const ImU32 text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const ImU32 curve = ImGui::GetColorU32(ImGuiCol_PlotLines);
  for (double power = seconds.low; power <= seconds.high; power += 1.0) {
    const double value = std::pow(10.0, power);
    const std::string label = eevee::seconds_text(value);
    const float x = x_of(value);
    list.AddLine({x, top}, {x, bottom}, grid);
    const float width = ImGui::CalcTextSize(label.c_str()).x;
    list.AddText({std::min(x - 0.5F * width, corner.x + space.x - width), bottom + 2.0F}, text, label.c_str());
  }
  for (double power = errors.low; power <= errors.high; power += 1.0) {
    const double value = std::pow(10.0, power);
    const float y = y_of(value);
    list.AddLine({left, y}, {right, y}, grid);
    list.AddText({corner.x, y - 0.5F * line_height}, text, fmt::format("{:g}", value).c_str());
  }
  list.PushClipRect({left, top - 0.5F * line_height}, {right + 0.5F * line_height, bottom}, true);
  const measure::TimedError *before = nullptr;
  for (const measure::TimedError &point : points) {
    if (!is_plotted(point)) {
      continue;
    }
    const ImVec2 place(x_of(point.seconds), y_of(point.error.rmse));
    if (before) {
      list.AddLine({x_of(before->seconds), y_of(before->error.rmse)}, place, curve, 1.5F);
    }
    const double deviation = 2.0 * point.error.standard_error;
    const double least = 1e-3 * point.error.rmse;
    list.AddLine({place.x, y_of(std::max(point.error.rmse - deviation, least))},
                 {place.x, y_of(point.error.rmse + deviation)}, curve);
    list.AddCircleFilled(place, 3.0F, curve);
    before = &point;
  }
  list.PopClipRect();
}

void show_table(const std::vector<measure::TimedError> &points)
{
  if (!ImGui::BeginTable("points", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
    return;
  }
  for (const char *name : {"Samples", "Time", "RMSE"}) {
    ImGui::TableSetupColumn(name);
  }
  ImGui::TableHeadersRow();
  for (const measure::TimedError &point : points) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::Text("%d", point.sample_count);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(eevee::seconds_text(point.seconds).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(
        fmt::format("{:.5f} \u00b1 {:.5f}", point.error.rmse, 2.0 * point.error.standard_error).c_str());
  }
  ImGui::EndTable();
}

}  // namespace

void ErrorPanel::begin(const Document &document, const WindowViewport &viewport, gpu::Backend backend)
{
  if (measurement_) {
    throw std::runtime_error("A measurement is under way");
  }
  clear();
  key_ = key_of(document);
  size_px_ = viewport.size_px();
  measurement_ = std::make_unique<ErrorMeasurement>(document.scene(), viewport.camera(document), size_px_,
                                                    document.settings().eevee, backend);
}

void ErrorPanel::clear()
{
  cancel();
  points_.clear();
  untraced_.clear();
}

std::string ErrorPanel::take()
{
  const std::unique_ptr<ErrorMeasurement> ended = std::move(measurement_);
  // A cancelled measurement may belong to a closed document. Its result is not shown, even if it is complete.
  if (ended->is_cancelled()) {
    throw measure::Cancelled();
  }
  std::vector<std::string> untraced = ended->finish();
  points_ = ended->points();
  untraced_ = std::move(untraced);
  const std::string left_out =
      untraced_.empty() ? "" : ", which counts as error what rays leave out: " + untraced_.front();
  return fmt::format("Error against time is measured: RMSE {:.5f} with {} samples{}", points_.back().error.rmse,
                     points_.back().sample_count, left_out);
}

ErrorPanel::Key ErrorPanel::key_of(const Document &document)
{
  return {document.scene().revision(), document.settings_revision()};
}

bool ErrorPanel::show(const Document &document)
{
  bool is_asked = false;
  if (measurement_) {
    ImGui::ProgressBar(measurement_->progress(), {-70.0F, 0.0F});
    ImGui::SameLine();
    if (ImGui::Button("Cancel", {-1.0F, 0.0F})) {
      cancel();
    }
  }
  else {
    is_asked = ImGui::Button("Measure error against time", {-1.0F, 0.0F});
  }
  const std::vector<measure::TimedError> points = measurement_ ? measurement_->points() : points_;
  if (points.empty()) {
    ImGui::TextWrapped(
        "Draws the active viewport's picture in the background, with 1, 2, 4, ... samples up to the number in the "
        "tab Render, and compares it with traced rays.");
    return is_asked;
  }
  plot(points);
  show_table(points);
  ImGui::TextDisabled("%dx%d px, \u00b1 two standard errors", size_px_.x, size_px_.y);
  if (key_ != key_of(document)) {
    ImGui::TextWrapped("The scene or the settings have changed since.");
  }
  for (const std::string &line : untraced_) {
    ImGui::TextWrapped("Rays leave out: %s", line.c_str());
  }
  return is_asked;
}

}  // namespace gnomon::view
