// SPDX-License-Identifier: MIT
// Texel density of the selected lamp's shadow over the picture.
#include "view_viewport.hh"

#include "eevee_texel_density.hh"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace gnomon::view {

void WindowViewport::draw_density(Document &document, eevee::Engine &eevee, const draw::Target &target)
{
  DensityKey key{viewport_->restart_count(), size_px_, eevee.is_complete(*viewport_), document.selected};
  if (key != density_key_) {
    if (viewport_->has_begun_sample()) {
      // The surfaces are drawn into the depths that the rest of the sample needs.
      draw::Engine *one = &eevee;
      canvas_.clear(backdrop);
      viewport_->draw(std::span(&one, 1), drawn_view_, target);
      key.is_last = eevee.is_complete(*viewport_);
    }
    const auto lamps = document.render_scene().lamps();
    const auto lamp = std::ranges::find(lamps, document.selected, &scene::PlacedLamp::node);
    density_.reset();
    if (lamp != lamps.end()) {
      density_ = eevee::Inspection(eevee, *viewport_).texel_density(drawn_view_, std::size_t(lamp - lamps.begin()));
    }
    density_key_ = key;
  }
  if (density_) {
    std::vector<std::uint8_t> rgba = canvas_.read();
    eevee::show_texel_density(rgba, *density_);
    canvas_.upload(viewport_->device(), size_px_, rgba);
  }
}

void WindowViewport::show_density_scale(Document &document, glm::vec2 corner, glm::vec2 size) const
{
  constexpr float width = 180.0F;
  constexpr float height = 10.0F;
  constexpr float margin = 8.0F;
  const scene::Node *node = document.scene().nodes().find(document.selected);
  const bool is_lamp = node && document.scene().lamps().is_live(node->lamp);
  const bool has_none = density_key_.lamp == document.selected && !density_;
  const std::string text = is_lamp ? fmt::format("Texels of {}{}", node->name, has_none ? ": no shadow" : ", in pixels")
                                   : "Texel density: select a lamp";
  ImDrawList &list = *ImGui::GetWindowDrawList();
  const float line = ImGui::GetTextLineHeight();
  const glm::vec2 low(corner.x + margin, corner.y + size.y - margin);
  const float box_width = std::max(width, ImGui::CalcTextSize(text.c_str()).x) + 2.0F * margin;
  list.PushClipRect({corner.x, corner.y}, {corner.x + size.x, corner.y + size.y}, true);
  list.AddRectFilled({low.x, low.y - 2.0F * line - height - 2.0F * margin}, {low.x + box_width, low.y},
                     IM_COL32(20, 20, 22, 210), 3.0F);
  const glm::vec2 place(low.x + margin, low.y - 2.0F * line - height - margin);
  list.AddText({place.x, place.y}, IM_COL32(235, 235, 235, 255), text.c_str());
  // Colours from small to large texels.
  const float top = place.y + line;
  for (int x = 0; x < int(width); x++) {
    const float size_in_pixels = std::pow(eevee::texel_density_max, 2.0F * (float(x) + 0.5F) / width - 1.0F);
    const glm::ivec3 color(255.0F * eevee::texel_density_color(1.0F / size_in_pixels));
    list.AddRectFilled({place.x + float(x), top}, {place.x + float(x) + 1.0F, top + height},
                       IM_COL32(color.r, color.g, color.b, 255));
  }
  for (const auto &[label, share] : {std::pair{"1/4", 0.0F}, {"1", 0.5F}, {"4", 1.0F}}) {
    const float label_width = ImGui::CalcTextSize(label).x;
    list.AddText({place.x + share * (width - label_width), top + height}, IM_COL32(235, 235, 235, 255), label);
  }
  list.PopClipRect();
}

}  // namespace gnomon::view
