// SPDX-License-Identifier: MIT
#include "cli_debug.hh"

#include "cli.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::cli {

DebugView parse_debug(const std::string &text)
{
  constexpr std::string_view shadow = "shadow:";
  constexpr std::string_view density = "density:";
  if (text.empty()) {
    return {};
  }
  if (text == "cascades") {
    return {.kind = DebugView::Kind::Cascades, .lamp = {}, .layer = {}};
  }
  DebugView view{.kind = DebugView::Kind::Shadow, .lamp = {}, .layer = {}};
  if (text.starts_with(density)) {
    view.kind = DebugView::Kind::Density;
    view.lamp = text.substr(density.size());
  }
  if (text.starts_with(shadow)) {
    view.lamp = text.substr(shadow.size());
    // Names may contain colons, so the last one separates the layer.
    const std::size_t colon = view.lamp.rfind(':');
    if (colon != std::string::npos) {
      view.layer = view.lamp.substr(colon + 1);
      view.lamp.resize(colon);
      const bool is_number =
          !view.layer.empty() && std::ranges::all_of(view.layer, [](char c) { return c >= '0' && c <= '9'; });
      constexpr std::array names = {"all", "octahedral", "map", "+X", "-X", "+Y", "-Y", "+Z", "-Z"};
      if (!is_number && std::ranges::find(names, view.layer) == names.end()) {
        view.lamp.clear();
      }
    }
    view.layer = view.layer == "all" ? "" : view.layer;
  }
  if (view.lamp.empty()) {
    throw UsageError(
        fmt::format("--debug '{}' is neither cascades nor density:LAMP nor shadow:LAMP[:LAYER], where LAYER "
                    "is a number, an axis as in +X or -Z, map, octahedral or all",
                    text));
  }
  return view;
}

std::size_t shadowed_lamp(const DebugView &view, const scene::Scene &scene, const eevee::Inspection &inspection)
{
  std::vector<std::string> with_layers;
  bool is_lamp = false;
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  for (std::size_t i = 0; i < lamps.size(); i++) {
    const bool has_layers = !inspection.shadow_layers(i).empty();
    if (has_layers && lamps[i].name == view.lamp) {
      return i;
    }
    if (has_layers) {
      with_layers.push_back(lamps[i].name);
    }
    is_lamp |= lamps[i].name == view.lamp;
  }
  throw std::runtime_error(fmt::format("{}: {} '{}'{}; lamps with a visible shadow: {}", scene.path,
                                       is_lamp ? "lamp" : "no lamp", view.lamp, is_lamp ? " has no visible shadow" : "",
                                       with_layers.empty() ? "none" : fmt::format("{}", fmt::join(with_layers, ", "))));
}

const gpu::Texture &shadow_picture(const DebugView &view, const scene::Scene &scene,
                                   const eevee::Inspection &inspection)
{
  const std::size_t lamp = shadowed_lamp(view, scene, inspection);
  if (view.layer.empty()) {
    return inspection.shadow_picture(lamp);
  }
  const std::vector<std::string> layers = inspection.shadow_layers(lamp);
  const std::optional<std::size_t> layer = eevee::find_layer(layers, view.layer);
  if (!layer) {
    throw std::runtime_error(fmt::format("{}: the shadow of lamp '{}' has no layer '{}'; it has, from 0: {}",
                                         scene.path, view.lamp, view.layer, fmt::join(layers, ", ")));
  }
  return inspection.shadow_picture(lamp, layer);
}

std::vector<std::uint8_t> to_bytes(std::span<const float> rgba)
{
  std::vector<std::uint8_t> bytes(rgba.size());
  std::ranges::transform(rgba, bytes.begin(),
                         [](float value) { return std::uint8_t(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))); });
  return bytes;
}

std::vector<float> alpha_in_all(std::span<const float> rgba)
{
  std::vector<float> values(rgba.size());
  for (std::size_t i = 0; i < rgba.size(); i++) {
    values[i] = rgba[i / 4 * 4 + 3];
  }
  return values;
}

}  // namespace gnomon::cli
