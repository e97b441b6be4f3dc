// SPDX-License-Identifier: MIT
#include "view_time_line.hh"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace gnomon::view {

void TimeLine::open(const scene::Scene &scene)
{
  *this = {};
  animations_ = scene.animations;
  scene::Animation all;
  all.name = "all";
  const bool is_joined =
      std::ranges::all_of(animations_, [&](const scene::Animation &one) { return scene::join(all, one); });
  if (is_joined && animations_.size() > 1) {
    animations_.insert(animations_.begin(), std::move(all));
  }
}

void TimeLine::set_time(Document &document, double seconds)
{
  if (is_empty()) {
    return;
  }
  const scene::Animation &animation = animations_[chosen_];
  seconds_ = std::clamp(seconds, 0.0, animation.duration());
  document.pose(animation, seconds_);
  is_posed_ = true;
}

void TimeLine::pose_again(Document &document)
{
  if (is_posed_) {
    set_time(document, seconds_);
  }
}

void TimeLine::step(Document &document, double seconds)
{
  // A pose would end the transform.
  if (!is_playing_ || document.operation()) {
    return;
  }
  const double duration = animations_[chosen_].duration();
  try {
    set_time(document, duration > 0.0 ? std::fmod(seconds_ + seconds, duration) : 0.0);
  }
  catch (...) {
    is_playing_ = false;
    throw;
  }
}

void TimeLine::show(Document &document)
{
  if (ImGui::Button(is_playing_ ? "Pause" : "Play", {60.0F, 0.0F})) {
    play(!is_playing_);
  }
  if (animations_.size() > 1) {
    const std::size_t chosen_before = chosen_;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(140.0F);
    if (ImGui::BeginCombo("##animation", animations_[chosen_].name.c_str())) {
      for (std::size_t i = 0; i < animations_.size(); i++) {
        // Names are not unique.
        ImGui::PushID(int(i));
        if (ImGui::Selectable(animations_[i].name.c_str(), i == chosen_)) {
          chosen_ = i;
        }
        ImGui::PopID();
      }
      ImGui::EndCombo();
    }
    // It may throw, therefore after the end of the list.
    if (chosen_ != chosen_before) {
      set_time(document, seconds_);
    }
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  auto seconds = float(seconds_);
  const auto duration = float(animations_[chosen_].duration());
  if (ImGui::SliderFloat("##time", &seconds, 0.0F, duration, "%.2f s", ImGuiSliderFlags_AlwaysClamp)) {
    set_time(document, double(seconds));
  }
}

}  // namespace gnomon::view
