// SPDX-License-Identifier: MIT
#include "view_icons.hh"

#include "view_lines.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

namespace gnomon::view {

namespace {

constexpr glm::vec4 lamp_color(0.9F, 0.84F, 0.63F, 1.0F);
constexpr glm::vec4 camera_color(0.68F, 0.77F, 0.9F, 1.0F);
constexpr glm::vec4 selected_color(1.0F, 0.6F, 0.15F, 1.0F);

/** Lengths on the screen, pixels. */
constexpr double sun_px = 120.0;
constexpr double cone_px = 130.0;
constexpr double arrow_px = 45.0;
constexpr double dome_px = 28.0;
constexpr double frustum_px = 60.0;
/** Rays start outside of the circle that the window draws around a lamp. */
constexpr double ray_start_px = 10.0;
constexpr double ray_end_px = 16.0;

/** Frame of a lamp or camera, with the brush and map to draw it. */
struct Place {
  LineBrush brush;
  const PictureMap &map;
  glm::dmat4 world;

  [[nodiscard]] glm::dvec3 position_ws() const
  {
    return glm::dvec3(world[3]);
  }
  /** Unit vectors. */
  [[nodiscard]] glm::dvec3 x_ws() const
  {
    return glm::dvec3(world[0]);
  }
  [[nodiscard]] glm::dvec3 y_ws() const
  {
    return glm::dvec3(world[1]);
  }
  [[nodiscard]] glm::dvec3 forward_ws() const
  {
    return -glm::dvec3(world[2]);
  }
  [[nodiscard]] double metres(double pixels) const
  {
    return pixels * map.metres_per_pixel(position_ws());
  }
  void arrow(double length_px) const
  {
    const glm::dvec3 tip = position_ws() + metres(length_px) * forward_ws();
    brush.line(position_ws(), tip);
    for (const glm::dvec3 &side : {x_ws(), -x_ws(), y_ws(), -y_ws()}) {
      brush.line(tip, tip - metres(8.0) * forward_ws() + metres(3.0) * side);
    }
  }
};

void add_point(const Place &place, const scene::PlacedLamp &lamp)
{
  if (lamp.radius > 0.0F) {
    // The lamp is a disk that faces each point that it lights.
    const double radius = double(lamp.radius);
    place.brush.path(ellipse(place.position_ws(), radius * place.map.axis_ws(0), radius * place.map.axis_ws(1)), true);
  }
}

void add_sun(const Place &place)
{
  const glm::dvec3 right = place.map.axis_ws(0);
  const glm::dvec3 up = place.map.axis_ws(1);
  const std::vector<glm::dvec3> inner =
      ellipse(place.position_ws(), place.metres(ray_start_px) * right, place.metres(ray_start_px) * up, 8);
  const std::vector<glm::dvec3> outer =
      ellipse(place.position_ws(), place.metres(ray_end_px) * right, place.metres(ray_end_px) * up, 8);
  for (std::size_t i = 0; i < inner.size(); i++) {
    place.brush.line(inner[i], outer[i]);
  }
  place.arrow(sun_px);
}

void add_spot(const Place &place, const scene::PlacedLamp &lamp)
{
  const double length = lamp.range > 0.0F ? double(lamp.range) : place.metres(cone_px);
  const glm::dvec2 scale = scene::spot_scale(lamp);
  const auto rim = [&](double angle) {
    const glm::dvec3 center = place.position_ws() + length * std::cos(angle) * place.forward_ws();
    const double radius = length * std::sin(angle);
    return ellipse(center, radius * scale.x * place.x_ws(), radius * scale.y * place.y_ws());
  };
  const double outer = double(lamp.spot_outer_angle);
  const std::vector<glm::dvec3> edge = rim(outer);
  place.brush.path(edge, true);
  for (std::size_t i = 0; i < edge.size(); i += edge.size() / 4) {
    place.brush.line(place.position_ws(), edge[i]);
  }
  if (lamp.spot_blend > 0.0F) {
    // The inner circle shows where the falloff begins: scene::Lamp::spot_blend.
    const double inner = std::acos(std::cos(outer) + (1.0 - std::cos(outer)) * double(lamp.spot_blend));
    LineBrush faint = place.brush;
    faint.color = glm::vec4(0.6F * glm::vec3(faint.color), 1.0F);
    faint.path(rim(inner), true);
  }
}

void add_area(const Place &place, const scene::PlacedLamp &lamp)
{
  const glm::dvec2 half = scene::area_half_size(lamp);
  const glm::dvec3 x = half.x * place.x_ws();
  const glm::dvec3 y = half.y * place.y_ws();
  const glm::dvec3 middle = place.position_ws();
  if (lamp.area_shape == scene::AreaShape::Ellipse) {
    place.brush.path(ellipse(middle, x, y), true);
  }
  else {
    place.brush.path(std::array{middle - x - y, middle + x - y, middle + x + y, middle - x + y}, true);
  }
  place.arrow(arrow_px);
}

/** Draw the hemisphere of sky that the lamp represents, which is behind the lamp. */
void add_hemi(const Place &place)
{
  const double radius = place.metres(dome_px);
  const glm::dvec3 up = -radius * place.forward_ws();
  place.brush.path(ellipse(place.position_ws(), radius * place.x_ws(), radius * place.y_ws()), true);
  place.brush.path(ellipse(place.position_ws(), radius * place.x_ws(), up, 24, 0.5), false);
  place.brush.path(ellipse(place.position_ws(), radius * place.y_ws(), up, 24, 0.5), false);
  place.arrow(arrow_px);
}

void add_camera(const Place &place, const scene::PlacedCamera &camera)
{
  const bool is_parallel = camera.kind == scene::CameraKind::Orthographic;
  const double depth = place.metres(frustum_px);
  glm::dvec2 half(camera.half_width, camera.half_height);
  if (!is_parallel) {
    half.y = depth * std::tan(0.5 * double(camera.vertical_angle));
    half.x = half.y * (camera.aspect > 0.0F ? double(camera.aspect) : 1.5);
  }
  const glm::dvec3 middle = place.position_ws() + depth * place.forward_ws();
  const glm::dvec3 x = half.x * place.x_ws();
  const glm::dvec3 y = half.y * place.y_ws();
  const std::array corners = {middle - x - y, middle + x - y, middle + x + y, middle - x + y};
  place.brush.path(corners, true);
  for (const glm::dvec3 &corner : corners) {
    place.brush.line(is_parallel ? corner - depth * place.forward_ws() : place.position_ws(), corner);
  }
  // A triangle marks the upper edge of the camera's picture.
  place.brush.path(std::array{middle + y - 0.4 * x, middle + 1.5 * y, middle + y + 0.4 * x}, false);
}

}  // namespace

std::vector<overlay::Line> icon_lines(const scene::Scene &scene, const PictureMap &map,
                                      std::span<const scene::Handle<scene::Node>> selected,
                                      const std::function<bool(scene::Handle<scene::Node>)> &is_shown)
{
  std::vector<overlay::Line> lines;
  const std::unordered_set<scene::Handle<scene::Node>> highlighted(selected.begin(), selected.end());
  const auto brush = [&](scene::Handle<scene::Node> node, const glm::vec4 &color) {
    const bool is_selected = highlighted.contains(node);
    return LineBrush{lines, is_selected ? selected_color : color, 1.5F, is_selected};
  };
  for (const scene::PlacedLamp &lamp : scene.placed_lamps()) {
    if (!is_shown(lamp.node)) {
      continue;
    }
    const Place place{brush(lamp.node, lamp_color), map, lamp.world_from_lamp};
    switch (lamp.kind) {
      case scene::LampKind::Point: add_point(place, lamp); break;
      case scene::LampKind::Sun: add_sun(place); break;
      case scene::LampKind::Spot: add_spot(place, lamp); break;
      case scene::LampKind::Hemi: add_hemi(place); break;
      case scene::LampKind::Area: add_area(place, lamp); break;
    }
  }
  for (const scene::PlacedCamera &camera : scene.placed_cameras()) {
    // Leave out a camera at the eye, where the size of a pixel is nearly 0.
    const glm::dvec3 position_ws(camera.world_from_camera[3]);
    if (scene.is_visible(camera.node) && is_shown(camera.node) && map.metres_per_pixel(position_ws) > 1e-6) {
      add_camera({brush(camera.node, camera_color), map, camera.world_from_camera}, camera);
    }
  }
  return lines;
}

}  // namespace gnomon::view
